/* What the lengths of the definition become in voxels, labels and cells of one volume. */
#ifndef REF_WALL_LAYOUT_H
#define REF_WALL_LAYOUT_H

#include "ref/ref_wall.h"

/* Costs are fixed-point: 1 is SV_WALL_ONE on a ray and SV_WALL_CELL_ONE in a cell. */
#define SV_WALL_ONE        128
#define SV_WALL_CELL_ONE   2048
#define SV_WALL_KERNEL     64  /* taps to either side of the lateral Gaussian, at most */
#define SV_WALL_KERNEL_ONE 256 /* their sum: two passes without rounding between them fit into 32 bits */

typedef struct {
    uint32_t width, height, slices;
    uint32_t mean[3];         /* voxels to either side along x, y, z */
    uint32_t beside[2];       /* pixels to either side along x, y */
    uint32_t thin, gap, skin; /* slices */
    double tau;               /* slices */
    uint32_t step, labels;    /* slices of a label; label l is depth l * step */
    uint32_t cells_x, cells_y;
    uint32_t reach_x, reach_y; /* cells to either side that the Gaussian reaches */
    uint32_t kernel_x[SV_WALL_KERNEL + 1], kernel_y[SV_WALL_KERNEL + 1]; /* weights at 0, 1, .. cells */
    uint32_t cut, left, other, slack;                                    /* fixed-point */
} sv_wall_layout;

sv_wall_layout sv_wall_layout_of(const sv_wall_volume *volume, const sv_wall_settings *settings);

/* First scanned slice of a ray and the first one behind the scan. */
uint32_t sv_wall_first(const sv_wall_volume *volume, size_t pixel);
uint32_t sv_wall_end(const sv_wall_volume *volume, size_t pixel);

#endif
