/* SPDX-License-Identifier: MIT */
/* What the membrane and the plate share: a linear system over the pixel grid, solved by a fixed number of
 * conjugate gradient steps, each preconditioned by one multigrid V-cycle (cl/grid/grid.clh). */
#ifndef SV_METHOD_GRID_H
#define SV_METHOD_GRID_H

#include "method/method.h"

/* The energy's weights against the data term, and the steps that reach the bound of docs/numerics.md
 * (solver_steps = 0). */
typedef struct {
    float tension, bending;
    float omega[2]; /* damping of the two smoothing steps: Chebyshev's, over the upper part of the spectrum */
    uint32_t steps;
} sv_grid_energy;

/* What both tables are made of. */
extern const char *const sv_grid_kernels[];
sv_source sv_grid_source(void);
uint32_t sv_grid_commands(const sv_config *config);
double sv_grid_bound(const sv_map *map);
sv_status sv_grid_buffers(const sv_map *map, sv_method_state *state);
sv_status sv_grid_solve(const sv_map *map, sv_method_state *state, uint32_t planes,
                        const sv_grid_energy *energy);

/* Steps of a frame: those that were asked for, or the energy's own. */
uint32_t sv_grid_steps(const sv_map *map, const sv_grid_energy *energy);

#define SV_GRID_PARAMETERS                                                                                   \
    (SV_USES_POINTS | SV_USES(DATA_WEIGHT) | SV_USES(SOLVER_STEPS) | SV_USES(PRECISION))

#endif
