/* SPDX-License-Identifier: MIT */
/* The grid along the beams that a frame tells (docs/surface.md), for the definition and for the plugin. */
#pragma once

#include "sv_beams.h"
#include "wall_layout.h"

/* Side of the grid, mm: across the beams about its middle, and along them. A larger scan is cut to that. */
#define SV_WALL_GRID_MM 192.0

/* The layout of such grids; it is the same for all beams. */
sv_wall_layout sv_wall_grid_layout(const sv_wall_settings *settings);

/* Finds where the grid `along` the beams lies in the blocks of a camera, `layout`. Its middle is the
 * volume's. Parallel beams, and where only the probe's rotation is told, run along the probe's z. False: the
 * frame does not tell that, or there is only one layer of blocks. */
bool sv_wall_grid_of(const sv_wall_layout *layout, const sv_wall_layout *along, const double spacing_mm[3],
                     const sv_beams *beams, const sv_wall_settings *settings, sv_wall_grid *grid);
