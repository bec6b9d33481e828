/* SPDX-License-Identifier: MIT */
/* Method plate: thin plate with soft data terms, the surface of least bending (Eq. 3.4 on the pixel
 * grid). A slight tension settles what the points leave open: the slope across collinear points, and far
 * from all points. */
#include "method/method.h"

#include "method/method_grid.h"
#include "ref/ref_plate.h"

/* Eigenvalues of A scaled by its diagonal lie below 4; the smoother damps those from 0.4 on. */
static const sv_grid_energy energy = {
    .tension = 1e-3f, .bending = 1.0f, .omega = {0.288f, 1.079f}, .steps = 48};

static sv_status run(const sv_map *map, sv_method_state *state, uint32_t planes) {
    return sv_grid_solve(map, state, planes, &energy);
}

static uint32_t passes(const sv_map *map) {
    return sv_grid_steps(map, &energy);
}

const sv_method sv_method_plate = {.definition = &sv_ref_method_plate,
                                   .bound = sv_grid_bound,
                                   .parameters = SV_GRID_PARAMETERS,
                                   .linear = true,
                                   .kernels = sv_grid_kernels,
                                   .source = sv_grid_source,
                                   .commands = sv_grid_commands,
                                   .buffers = sv_grid_buffers,
                                   .run = run,
                                   .passes = passes};
