/* SPDX-License-Identifier: MIT */
/*
 * The lit look: one smooth surface a ray, in light. docs/rendering.md defines it.
 */
#ifndef HS_DVR_LIT_H
#define HS_DVR_LIT_H

#include "render/dvr_view.h"
#include "render/lit_volume.h"

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
