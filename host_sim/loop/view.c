/* SPDX-License-Identifier: MIT */
#include "loop/view.h"

#include "loop/loop_stages.h"
#include "loop/loop_state.h"
#include "loop/maps.h"
#include "loop/truth_picture.h"

#include <stdlib.h>
#include <string.h>

static bool allocate(const hs_loop *loop, hs_view *view, hs_error *err) {
    const hs_slab_layout *layout = hs_loop_layout(loop);
    view->width = loop->options.dvr.width;
    view->height = loop->options.dvr.height;
    view->map_width = layout->width;
    view->map_height = layout->height;
    view->slices = layout->slices;
    const size_t pixels = (size_t)view->width * view->height;
    view->result = malloc(pixels * 4);
    view->full = malloc(pixels * 4);
    view->mip = malloc(pixels);
    view->termination = malloc(pixels * sizeof(float));
    view->full_termination = malloc(pixels * sizeof(float));
    bool ok = view->result && view->full && view->mip && view->termination && view->full_termination;
    if (ok && hs_source_truth(loop->source, 0)) ok = (view->truth = malloc(pixels * 4)) != NULL;
    return ok ||
           hs_fail(err, HS_ERR_MEMORY, "pictures: no memory for %u x %u pixels", view->width, view->height);
}

/* The picture from where the frame's rays start (NULL: the full volume) and, unless NULL, its termination
 * depths. */
static bool render_to(hs_loop *loop, uint32_t index, const hs_frame *frame, uint8_t *rgba, float *termination,
                      hs_error *err) {
    hs_start_depths depths;
    hs_camera window;
    const hs_start_depths *start = hs_loop_start(loop, index, frame, &window, &depths);
    return hs_screen_render(loop->screen, loop->volume, &window, start, termination != NULL, err) &&
           hs_screen_read(loop->screen, rgba, err) &&
           (!termination || hs_screen_read_termination(loop->screen, termination, err));
}

static bool render_truth(hs_loop *loop, uint32_t index, hs_view *view, hs_error *err) {
    hs_truth_picture *truth = hs_truth_picture_create(loop, err);
    const bool ok = truth && hs_truth_picture_draw(truth, loop->screen, loop->options.dvr.look, index, err) &&
                    hs_screen_read(loop->screen, view->truth, err);
    hs_truth_picture_destroy(truth);
    return ok;
}

/* The frame with every map the plugin has. */
static bool run_frame(hs_loop *loop, uint32_t index, hs_view *view, hs_error *err) {
    hs_maps maps;
    if (!hs_loop_maps(loop, index, &maps, err)) return false;
    view->depth = maps.depth;
    view->status = maps.status;
    view->sure = maps.sure;
    view->frame = maps.frame;
    return true;
}

bool hs_loop_view(hs_loop *loop, uint32_t index, hs_view *view, hs_error *err) {
    *view = (hs_view){0};
    hs_camera window;
    float share;
    hs_loop_camera(loop, index, &view->camera);
    hs_loop_window(loop, index, &window, &share);
    view->picture_mm = window.extent;
    view->look = loop->options.dvr.look;
    view->ghosted = loop->options.dvr.ghost_width > 0;
    const bool ok = allocate(loop, view, err) && run_frame(loop, index, view, err) &&
                    (view->volume = hs_source_bring(loop->source, index % loop->source->count, err)) &&
                    render_to(loop, index, &view->frame, view->result, view->termination, err) &&
                    render_to(loop, index, NULL, view->full, view->full_termination, err) &&
                    (!view->truth || render_truth(loop, index, view, err)) &&
                    hs_screen_project(loop->screen, loop->volume, &view->camera, view->mip, err);
    if (!ok) hs_view_free(view);
    return ok;
}

/* A whole frame with one more value, which comes last and so counts. */
static bool frame_with(hs_loop *loop, uint32_t index, sv_param_value value, hs_frame *frame, hs_error *err) {
    uint32_t count;
    const sv_param_value *before = hs_clipper_values(loop->clipper, &count);
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
    hs_frame frame;
    const bool ok = primary->flags & SV_PARAM_ADJUST ? hs_loop_adjust(loop, turned, &frame, NULL, err)
                                                     : frame_with(loop, index, turned, &frame, err);
    return ok && render_to(loop, index, &frame, rgba, NULL, err);
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
