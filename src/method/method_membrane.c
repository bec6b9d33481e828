/* SPDX-License-Identifier: MIT */
/* Method membrane: Laplace's equation with soft data terms, the surface of least slope. */
#include "method/method.h"

#include "method/method_grid.h"
#include "ref/ref_membrane.h"

/* Eigenvalues of A scaled by its diagonal lie below 2; the smoother damps those from 0.4 on. */
static const sv_grid_energy energy = {
    .tension = 1.0f, .bending = 0.0f, .omega = {0.566f, 1.577f}, .steps = 12};

static sv_status run(const sv_map *map, sv_method_state *state, uint32_t planes) {
    return sv_grid_solve(map, state, planes, &energy);
}

static uint32_t passes(const sv_map *map) {
    return sv_grid_steps(map, &energy);
}

const sv_method sv_method_membrane = {.definition = &sv_ref_method_membrane,
                                      .bound = sv_grid_bound,
                                      .parameters = SV_GRID_PARAMETERS,
                                      .linear = true,
                                      .kernels = sv_grid_kernels,
                                      .source = sv_grid_source,
                                      .commands = sv_grid_commands,
                                      .buffers = sv_grid_buffers,
                                      .run = run,
                                      .passes = passes};
