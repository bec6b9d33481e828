/* SPDX-License-Identifier: MIT */
#include "render/brick_grid.h"

#include "render/host_launch.h"

#include <stdlib.h>

#define BRICK_EDGE 8 /* 1 << BRICK_SHIFT in cl/base.cl */

struct hs_brick_grid {
    const hs_cl *cl;
    cl_int4 dims; /* voxels */
    hs_brick_view view;
    cl_kernel kernel;
    bool fresh;
};

hs_brick_grid *hs_brick_grid_create(const hs_cl *cl, cl_int4 dims, hs_error *err) {
    hs_brick_grid *grid = calloc(1, sizeof *grid);
    if (!grid) {
        (void)hs_fail(err, HS_ERR_MEMORY, "brick grid: no memory");
        return NULL;
    }
    grid->cl = cl;
    for (int k = 0; k < 3; k++) {
        grid->dims.s[k] = dims.s[k];
        grid->view.count.s[k] = dims.s[k] > 1 ? (dims.s[k] - 1 + BRICK_EDGE - 1) / BRICK_EDGE : 1;
    }
    return grid;
}

void hs_brick_grid_destroy(hs_brick_grid *grid) {
    if (!grid) return;
    if (grid->kernel) (void)clReleaseKernel(grid->kernel);
    if (grid->view.maxima) (void)clReleaseMemObject(grid->view.maxima);
    free(grid);
}

void hs_brick_grid_expire(hs_brick_grid *grid) {
    grid->fresh = false;
}

static bool take_memory(hs_brick_grid *grid, hs_error *err) {
    const cl_int4 n = grid->view.count;
    const size_t bytes = (size_t)n.s[0] * (size_t)n.s[1] * (size_t)n.s[2];
    return hs_cl_take_kernel(grid->cl, "build_brick_grid", &grid->kernel, err) &&
           hs_cl_take_buffer(grid->cl, bytes, "brick grid", &grid->view.maxima, err);
}

static bool enqueue(hs_brick_grid *grid, cl_mem voxels, hs_error *err) {
    const cl_int4 n = grid->view.count;
    hs_launch launch = hs_launch_begin(grid->cl, grid->kernel, "build_brick_grid");
    hs_launch_buffer(&launch, voxels);
    hs_launch_arg(&launch, sizeof grid->dims, &grid->dims);
    hs_launch_arg(&launch, sizeof n, &n);
    hs_launch_buffer(&launch, grid->view.maxima);
    return hs_launch_rows(&launch, n, err);
}

bool hs_brick_grid_make(hs_brick_grid *grid, cl_mem voxels, hs_brick_view *view, hs_error *err) {
    if (!take_memory(grid, err)) return false;
    if (!grid->fresh && !enqueue(grid, voxels, err)) return false;
    grid->fresh = true;
    *view = grid->view;
    return true;
}
