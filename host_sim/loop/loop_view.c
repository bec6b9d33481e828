/* SPDX-License-Identifier: MIT */
/* Everything the pictures of one frame are made of, read back to the host. Not on the frame path. */
#include "loop/loop_parts.h"

#include <stdlib.h>
#include <string.h>

static bool read_back(const hs_loop *loop, cl_mem from, size_t bytes, void *to, const char *what,
                      hs_error *err) {
    return hs_cl_check(clEnqueueReadBuffer(loop->cl->queue, from, CL_TRUE, 0, bytes, to, 0, NULL, NULL), what,
                       err);
}

static bool allocate(const hs_loop *loop, hs_view *view, hs_error *err) {
    const hs_slab_layout *layout = &loop->slabs.layout;
    view->width = loop->options.dvr.width;
    view->height = loop->options.dvr.height;
    view->map_width = layout->width;
    view->map_height = layout->height;
    view->slices = layout->slices;
    const size_t pixels = (size_t)view->width * view->height;
    const size_t rays = (size_t)view->map_width * view->map_height;
    view->result = malloc(pixels * 4);
    view->full = malloc(pixels * 4);
    view->mip = malloc(pixels);
    view->termination = malloc(pixels * sizeof(float));
    view->full_termination = malloc(pixels * sizeof(float));
    view->depth = calloc(rays, sizeof(float));
    view->status = calloc(rays, 1);
    bool ok = view->result && view->full && view->mip && view->termination && view->full_termination &&
              view->depth && view->status;
    if (ok && loop->source->truths) ok = (view->truth = malloc(pixels * 4)) != NULL;
    return ok ||
           hs_fail(err, HS_ERR_MEMORY, "pictures: no memory for %u x %u pixels", view->width, view->height);
}

/* A picture and, unless NULL, its termination depths. */
static bool render_to(hs_loop *loop, const hs_device_volume *volume, const hs_camera *camera,
                      const hs_frame *frame, uint8_t *rgba, float *termination, hs_error *err) {
    const size_t pixels = (size_t)loop->options.dvr.width * loop->options.dvr.height;
    return hs_loop_render(loop, volume, camera, frame, termination != NULL, err) &&
           read_back(loop, loop->rgba, pixels * 4, rgba, "clEnqueueReadBuffer (picture)", err) &&
           (!termination || read_back(loop, loop->termination, pixels * sizeof(float), termination,
                                      "clEnqueueReadBuffer (termination depths)", err));
}

static bool render_truth(hs_loop *loop, uint32_t index, hs_view *view, hs_error *err) {
    hs_device_volume *truth = hs_device_volume_create(loop->cl, hs_source_truth(loop->source, index), err);
    bool ok = truth && render_to(loop, truth, &view->camera, NULL, view->truth, NULL, err);
    hs_device_volume_destroy(truth);
    return ok;
}

/* The maximum projection goes through the picture's buffer: it needs a quarter of it. */
static bool project(hs_loop *loop, hs_view *view, hs_error *err) {
    return hs_dvr_mip(loop->dvr, loop->volume, &view->camera, loop->rgba, NULL, err) &&
           read_back(loop, loop->rgba, (size_t)view->width * view->height, view->mip,
                     "clEnqueueReadBuffer (MIP)", err);
}

static bool read_confidence(const hs_loop *loop, size_t rays, hs_view *view, hs_error *err) {
    view->sure = malloc(rays * sizeof(float));
    if (!view->sure) return hs_fail(err, HS_ERR_MEMORY, "confidence: no memory for %zu pixels", rays);
    return read_back(loop, loop->clipper.sure, rays * sizeof(float), view->sure,
                     "clEnqueueReadBuffer (confidence)", err);
}

bool hs_loop_view(hs_loop *loop, uint32_t index, hs_view *view, hs_error *err) {
    *view = (hs_view){0};
    bool ok = allocate(loop, view, err);
    if (ok) {
        const size_t rays = (size_t)view->map_width * view->map_height;
        hs_loop_camera(loop, index, &view->camera);
        const bool wanted = loop->clipper.want_confidence;
        loop->clipper.want_status = loop->clipper.want_confidence = true;
        ok = hs_loop_frame(loop, HS_SETTING_SMARTVIS, index, &view->frame, err);
        loop->clipper.want_status = false;
        loop->clipper.want_confidence = wanted;
        /* A map that was not used is not shown either: it may be an earlier frame's. */
        if (ok && view->frame.clipped)
            ok = read_back(loop, loop->clipper.depth, rays * sizeof(float), view->depth,
                           "clEnqueueReadBuffer (depthmap)", err);
        if (ok && view->frame.sure) ok = read_confidence(loop, rays, view, err);
        if (ok && view->frame.outcome >= SV_OK) memcpy(view->status, loop->clipper.status, rays);
    }
    ok = ok &&
         render_to(loop, loop->volume, &view->camera, &view->frame, view->result, view->termination, err) &&
         render_to(loop, loop->volume, &view->camera, NULL, view->full, view->full_termination, err) &&
         (!view->truth || render_truth(loop, index, view, err)) && project(loop, view, err);
    if (!ok) hs_view_free(view);
    return ok;
}

/* A whole frame with one more value, which comes last and so counts. */
static bool frame_with(hs_loop *loop, uint32_t index, sv_param_value value, hs_frame *frame, hs_error *err) {
    hs_clipper *clipper = &loop->clipper;
    const sv_param_value *before = clipper->values;
    const uint32_t count = clipper->value_count;
    sv_param_value *values = calloc(count + 1u, sizeof *values);
    if (!values) return hs_fail(err, HS_ERR_MEMORY, "plugin parameters: no memory for %u", count + 1u);
    if (count) memcpy(values, before, count * sizeof *values);
    values[count] = value;
    hs_loop_set_values(loop, values, count + 1);
    const bool ok = hs_loop_frame(loop, HS_SETTING_SMARTVIS, index, frame, err);
    hs_loop_set_values(loop, before, count);
    free(values);
    return ok;
}

bool hs_loop_turn(hs_loop *loop, uint32_t index, const sv_param_info *primary, double value, uint8_t *rgba,
                  hs_error *err) {
    const sv_param_value turned = {.id = primary->id, .value = value};
    hs_frame frame = {0};
    hs_camera camera;
    hs_loop_camera(loop, index, &camera);
    const bool ok = primary->flags & SV_PARAM_ADJUST ? hs_clipper_adjust(&loop->clipper, turned, &frame, err)
                                                     : frame_with(loop, index, turned, &frame, err);
    return ok && render_to(loop, loop->volume, &camera, &frame, rgba, NULL, err);
}

void hs_view_free(hs_view *view) {
    free(view->result);
    free(view->full);
    free(view->truth);
    free(view->mip);
    free(view->termination);
    free(view->full_termination);
    free(view->depth);
    free(view->status);
    free(view->sure);
    *view = (hs_view){0};
}
