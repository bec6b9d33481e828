/* SPDX-License-Identifier: MIT */
#include "render/dvr_thesis.h"

/* Where the rays start, as render_volume takes it (cl/dvr.cl). */
typedef struct {
    cl_mem map, confidence; /* NULL: none */
    cl_int4 map_dims;
    cl_float4 to_map, to_steps;
} ray_start;

static ray_start plan_start(const hs_dvr_settings *s, const hs_ray_view *v, const hs_start_depths *depths) {
    ray_start out = {.map_dims = {{0, 0, (cl_int)s->width, (cl_int)s->height}},
                     .to_steps = {{0.0f, s->ghost_offset, 0.0f, 0.0f}}};
    if (!depths || !depths->depth) return out;
    out.map = depths->depth;
    out.map_dims.s[0] = (cl_int)depths->width;
    out.map_dims.s[1] = (cl_int)depths->height;
    out.to_map = hs_dvr_to_map(s, depths);
    out.to_steps.s[0] = (cl_float)(v->slices / ((double)depths->slices * (double)s->step));
    out.to_steps.s[2] = s->ghost_width > HS_DVR_HARD_CUT ? 1.0f / s->ghost_width : 0.0f;
    if (depths->confidence && out.to_steps.s[2] > 0.0f) {
        out.confidence = depths->confidence;
        out.to_steps.s[3] = s->ghost_width * s->ghost_doubt;
    }
    return out;
}

static void set_transfer(hs_launch *launch, const hs_dvr_settings *s) {
    const double low = (double)s->threshold_low * 255.0, high = (double)s->threshold_high * 255.0;
    const cl_float4 window = {{(cl_float)low, (cl_float)(1.0 / (high - low)), s->termination, s->step}};
    const float gain = s->exposure;
    const cl_float4 skin = {{gain * s->skin[0], gain * s->skin[1], gain * s->skin[2], 0.0f}};
    hs_launch_arg(launch, sizeof window, &window);
    hs_launch_arg(launch, sizeof skin, &skin);
}

/* A buffer that may be NULL, and whether it is wanted. */
static void set_output(hs_launch *launch, cl_mem buffer) {
    const cl_int wanted = buffer != NULL;
    hs_launch_buffer(launch, buffer);
    hs_launch_arg(launch, sizeof wanted, &wanted);
}

void hs_dvr_thesis_arguments(hs_launch *launch, const hs_dvr_settings *settings, const hs_ray_view *view,
                             const hs_start_depths *depths, cl_mem rgba, cl_mem termination) {
    const ray_start rays = plan_start(settings, view, depths);
    hs_launch_view(launch, view);
    hs_launch_buffer(launch, rays.map);
    hs_launch_arg(launch, sizeof rays.map_dims, &rays.map_dims);
    hs_launch_arg(launch, sizeof rays.to_map, &rays.to_map);
    hs_launch_arg(launch, sizeof rays.to_steps, &rays.to_steps);
    set_transfer(launch, settings);
    set_output(launch, rgba);
    set_output(launch, termination);
    hs_launch_buffer(launch, rays.confidence);
}
