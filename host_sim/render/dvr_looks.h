/* SPDX-License-Identifier: MIT */
/* The two looks of the renderer: what they share, and the arguments of their kernels. docs/rendering.md
 * defines them. */
#ifndef HS_DVR_LOOKS_H
#define HS_DVR_LOOKS_H

#include "render/camera.h"
#include "render/derived_volume.h"
#include "render/device_volume.h"
#include "render/dvr_settings.h"
#include "render/host_cl.h"

#define HS_DVR_HARD_CUT 1e-6f /* steps: a ghost no wider than this is a hard cut */

/* Samples of a ray that crosses the whole box. */
uint32_t hs_dvr_count_steps(const hs_dvr_settings *settings, const hs_volume *shape, const hs_camera *camera);

/* The view as the kernels take it (cl/base_rays.cl, cl/dvr.cl). */
typedef struct {
    cl_mem voxels, maxima;
    cl_int4 dims, bricks;
    cl_float4 origin, dx, dy, dn;
    double slices; /* source slices along the box' depth */
} hs_ray_view;

/* Enqueues the volume's brick maxima if they are not there. HS_ERR_INPUT (more than HS_DVR_MAX_STEPS) or
 * HS_ERR_DEVICE. */
bool hs_ray_view_of(const hs_dvr_settings *settings, const hs_device_volume *source, const hs_camera *camera,
                    hs_ray_view *out, hs_error *err);

/* The next seven arguments of a kernel, as render_volume has them (cl/dvr.cl): the view but for what is
 * sampled. */
void hs_launch_view(hs_launch *launch, const hs_ray_view *view);

/* Runs a kernel over the picture, a work item a packet of pixels (cl/base.cl); does not wait. */
bool hs_dvr_launch(const hs_launch *launch, const hs_dvr_settings *settings, cl_event *event, hs_error *err);

#define HS_DVR_THESIS_KERNEL "render_volume"

/* All arguments of render_volume behind what it samples (SAMPLED in cl/dvr.cl). `depths` as for
 * hs_dvr_render; `rgba` and `termination` may be NULL. */
void hs_dvr_thesis_arguments(hs_launch *launch, const hs_dvr_settings *settings, const hs_ray_view *view,
                             const hs_start_depths *depths, cl_mem rgba, cl_mem termination);

#define HS_DVR_LIT_KERNEL "render_lit"

/* What is drawn, and how. Pointers are borrowed. */
typedef struct {
    hs_lit_view volume;
    const hs_volume *shape; /* the source's size and spacing */
    const hs_camera *camera;
    const hs_dvr_settings *settings;
    uint32_t steps; /* of a whole ray (hs_dvr_steps) */
} hs_dvr_lit_scene;

/* Enqueues one picture of width * height RGBA bytes; does not wait. `depths` NULL: unclipped. HS_ERR_USAGE
 * (too many steps) or HS_ERR_DEVICE. */
bool hs_dvr_lit_render(const hs_cl *cl, cl_kernel kernel, const hs_dvr_lit_scene *scene,
                       const hs_start_depths *depths, cl_mem rgba, cl_event *event, hs_error *err);

#endif
