/* SPDX-License-Identifier: MIT */
/* Costs of cells: the mean over the rays of each. */
#ifndef REF_WALL_CELLS_H
#define REF_WALL_CELLS_H

#include "ref/ref_wall_rays.h"

/* Mean costs of the cells in units of 1 / SV_WALL_CELL_ONE; label i of cell (x, y) at [(y * cells_x + x) *
 * labels + i]. */
typedef struct {
    uint32_t *away, *wrong;
    uint64_t fetus; /* sum over the rays of the probability that the fetus is on them */
} sv_wall_cells;

/* A ray belongs to the cell that holds its centre; if that lies on the border of two, to both by half. The
 * mean is rounded half up; a cell without a scanned ray costs nothing. False: no memory. */
bool sv_wall_cells_create(const sv_wall_scan *scan, sv_wall_cells *cells);
void sv_wall_cells_destroy(sv_wall_cells *cells);

#endif
