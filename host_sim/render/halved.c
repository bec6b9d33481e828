/* SPDX-License-Identifier: MIT */
#include "render/halved.h"

#include "render/host_launch.h"

#include <stdlib.h>

struct hs_halved {
    const hs_cl *cl;
    cl_int4 source; /* voxels */
    hs_halved_view view;
    cl_kernel kernel;
    bool with_mean, fresh;
};

hs_halved *hs_halved_create(const hs_cl *cl, const uint32_t n[3], bool with_mean, hs_error *err) {
    hs_halved *halved = calloc(1, sizeof *halved);
    if (!halved) {
        (void)hs_fail(err, HS_ERR_MEMORY, "halved volume: no memory");
        return NULL;
    }
    halved->cl = cl;
    halved->with_mean = with_mean;
    for (int k = 0; k < 3; k++) {
        halved->source.s[k] = (cl_int)n[k];
        halved->view.dims.s[k] = (cl_int)((n[k] + 1) / 2);
    }
    halved->view.dims.s[3] = HS_HALVED_BORDER;
    return halved;
}

void hs_halved_destroy(hs_halved *halved) {
    if (!halved) return;
    if (halved->kernel) (void)clReleaseKernel(halved->kernel);
    if (halved->view.mean) (void)clReleaseMemObject(halved->view.mean);
    if (halved->view.marked) (void)clReleaseMemObject(halved->view.marked);
    free(halved);
}

void hs_halved_expire(hs_halved *halved) {
    halved->fresh = false;
}

/* Lookups read the next voxel along every axis, even of the last voxel, whose
 * neighbours then do not count. */
static size_t bytes_of(cl_int4 dims, cl_int border) {
    size_t n[3];
    for (int k = 0; k < 3; k++) n[k] = (size_t)dims.s[k] + 2 * (size_t)border;
    return n[0] * n[1] * n[2] + n[0] * n[1] + n[0] + 2;
}

static bool take_buffer(hs_halved *halved, cl_mem *buffer, cl_int border, const char *what, hs_error *err) {
    const size_t bytes = bytes_of(halved->view.dims, border);
    const cl_uchar nothing = 0;
    if (*buffer) return true;
    if (!hs_cl_take_buffer(halved->cl, bytes, what, buffer, err)) return false;
    /* The border is never written again. */
    const cl_int code = clEnqueueFillBuffer(halved->cl->queue, *buffer, &nothing, 1, 0, bytes, 0, NULL, NULL);
    return hs_cl_check(code, "clEnqueueFillBuffer(halved volume)", err);
}

static bool take_memory(hs_halved *halved, hs_error *err) {
    return hs_cl_take_kernel(halved->cl, "halve_volume", &halved->kernel, err) &&
           take_buffer(halved, &halved->view.marked, 0, "halved volume", err) &&
           (!halved->with_mean ||
            take_buffer(halved, &halved->view.mean, HS_HALVED_BORDER, "halved volume with a border", err));
}

static bool enqueue(hs_halved *halved, cl_mem voxels, hs_error *err) {
    cl_int4 dims = halved->view.dims;
    if (!halved->with_mean) dims.s[3] = -1;
    hs_launch launch = hs_launch_begin(halved->cl, halved->kernel, "halve_volume");
    hs_launch_buffer(&launch, voxels);
    hs_launch_arg(&launch, sizeof halved->source, &halved->source);
    hs_launch_arg(&launch, sizeof dims, &dims);
    hs_launch_buffer(&launch, halved->view.mean);
    hs_launch_buffer(&launch, halved->view.marked);
    return hs_launch_slices(&launch, dims, err);
}

bool hs_halved_make(hs_halved *halved, cl_mem voxels, hs_halved_view *view, hs_error *err) {
    if (!take_memory(halved, err)) return false;
    if (!halved->fresh && !enqueue(halved, voxels, err)) return false;
    halved->fresh = true;
    *view = halved->view;
    return true;
}
