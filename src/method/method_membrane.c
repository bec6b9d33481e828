/* SPDX-License-Identifier: MIT */
/* Method membrane: Laplace's equation with soft data terms, the surface of least slope. */
#include "frame/pipeline.h"
#include "method/method_grid.h"

/* Eigenvalues of A scaled by its diagonal lie below 2; the smoother damps those from 0.4 on. */
static const sv_grid_energy energy = {
    .tension = 1.0f, .bending = 0.0f, .omega = {0.566f, 1.577f}, .steps = 12};

static sv_status run(sv_pipeline *pipeline, sv_method_state *state, uint32_t planes) {
    return sv_grid_solve(pipeline, state, planes, &energy);
}

const sv_method sv_method_membrane = {.linear = true,
                                      .kernels = sv_grid_kernels,
                                      .source = sv_grid_source,
                                      .commands = sv_grid_commands,
                                      .create = sv_grid_create,
                                      .run = run};
