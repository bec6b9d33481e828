/* SPDX-License-Identifier: MIT */
#include "render/dvr.h"

#include "render/dvr_looks.h"

#include <math.h>
#include <stdlib.h>

struct hs_dvr {
    const hs_cl *cl;
    hs_dvr_settings settings;
    cl_kernel render;
    cl_kernel lit; /* NULL: the look is the thesis' */
};

static bool init(hs_dvr *dvr, const hs_dvr_settings *settings, hs_error *err) {
    if (!hs_dvr_check_settings(settings, err)) return false;
    dvr->settings = *settings;
    return hs_cl_take_kernel(dvr->cl, HS_DVR_THESIS_KERNEL, &dvr->render, err) &&
           (settings->look != HS_LOOK_LIT || hs_cl_take_kernel(dvr->cl, HS_DVR_LIT_KERNEL, &dvr->lit, err));
}

hs_dvr *hs_dvr_create(const hs_cl *cl, const hs_dvr_settings *settings, hs_error *err) {
    hs_dvr *dvr = hs_memory(1, sizeof *dvr, "renderer", err);
    if (!dvr) return NULL;
    dvr->cl = cl;
    if (init(dvr, settings, err)) return dvr;
    hs_dvr_destroy(dvr);
    return NULL;
}

void hs_dvr_destroy(hs_dvr *dvr) {
    if (!dvr) return;
    if (dvr->render) (void)clReleaseKernel(dvr->render);
    if (dvr->lit) (void)clReleaseKernel(dvr->lit);
    free(dvr);
}

uint32_t hs_dvr_steps(const hs_dvr_settings *settings, const hs_device_volume *source,
                      const hs_camera *camera) {
    const hs_device_view view = hs_device_volume_view(source);
    return hs_dvr_count_steps(settings, &view.shape, camera);
}

bool hs_dvr_prepare(hs_dvr *dvr, const hs_device_volume *source, hs_error *err) {
    const hs_dvr_settings *s = &dvr->settings;
    hs_lit_view lit;
    hs_brick_view bricks;
    return s->look == HS_LOOK_LIT
               ? hs_device_volume_lit(source, s->threshold_low, s->threshold_high, &lit, err)
               : hs_device_volume_bricks(source, &bricks, err);
}

static bool render_lit(hs_dvr *dvr, const hs_device_volume *source, const hs_camera *camera,
                       const hs_start_depths *depths, cl_mem rgba, cl_event *event, hs_error *err) {
    const hs_dvr_settings *s = &dvr->settings;
    const hs_device_view view = hs_device_volume_view(source);
    hs_dvr_lit_scene scene = {.shape = &view.shape,
                              .camera = camera,
                              .settings = s,
                              .steps = hs_dvr_count_steps(s, &view.shape, camera)};
    return hs_device_volume_lit(source, s->threshold_low, s->threshold_high, &scene.volume, err) &&
           hs_dvr_lit_render(dvr->cl, dvr->lit, &scene, depths, rgba, event, err);
}

/* The thesis' look, and the ends of rays in either. */
static bool render_thesis(hs_dvr *dvr, const hs_device_volume *source, const hs_camera *camera,
                          const hs_start_depths *depths, cl_mem rgba, cl_mem termination, cl_event *event,
                          hs_error *err) {
    hs_ray_view v;
    if (!hs_ray_view_of(&dvr->settings, source, camera, &v, err)) return false;
    hs_launch launch = hs_launch_begin(dvr->cl, dvr->render, HS_DVR_THESIS_KERNEL);
    hs_launch_buffer(&launch, v.voxels);
    hs_dvr_thesis_arguments(&launch, &dvr->settings, &v, depths, rgba, termination);
    return hs_dvr_launch(&launch, &dvr->settings, event, err);
}

bool hs_dvr_render(hs_dvr *dvr, const hs_device_volume *source, const hs_camera *camera,
                   const hs_start_depths *depths, cl_mem rgba, cl_mem termination, cl_event *event,
                   hs_error *err) {
    if (!hs_dvr_check_start(depths, err)) return false;
    const uint64_t pixels = (uint64_t)dvr->settings.width * dvr->settings.height;
    if (rgba && !hs_cl_check_size(rgba, pixels * 4, "the picture", err)) return false;
    if (termination && !hs_cl_check_size(termination, pixels * sizeof(float), "termination depths", err))
        return false;
    if (!dvr->lit) return render_thesis(dvr, source, camera, depths, rgba, termination, event, err);
    if (termination &&
        !render_thesis(dvr, source, camera, depths, NULL, termination, rgba ? NULL : event, err))
        return false;
    return !rgba || render_lit(dvr, source, camera, depths, rgba, event, err);
}
