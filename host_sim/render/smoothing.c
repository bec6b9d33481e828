/* SPDX-License-Identifier: MIT */
#include "render/smoothing.h"

#include "render/host_launch.h"

static const char kernel_name[] = "lit_smooth";

static bool smooth_once(const hs_smoothing *s, cl_mem from, cl_mem to, cl_int4 dims, hs_error *err) {
    hs_launch launch = hs_launch_begin(s->cl, s->kernel, kernel_name);
    hs_launch_buffer(&launch, from);
    hs_launch_arg(&launch, sizeof dims, &dims);
    hs_launch_buffer(&launch, to);
    return hs_launch_slices(&launch, dims, err);
}

bool hs_smoothing_run(hs_smoothing *s, cl_mem from, cl_mem to, cl_int4 dims, hs_error *err) {
    return hs_cl_take_kernel(s->cl, kernel_name, &s->kernel, err) &&
           hs_cl_take_voxels(s->cl, dims, "smoothed once", &s->between, err) &&
           smooth_once(s, from, s->between, dims, err) && smooth_once(s, s->between, to, dims, err);
}

void hs_smoothing_free(hs_smoothing *s) {
    if (s->kernel) (void)clReleaseKernel(s->kernel);
    if (s->between) (void)clReleaseMemObject(s->between);
    *s = (hs_smoothing){0};
}
