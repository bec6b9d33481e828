/* SPDX-License-Identifier: MIT */
#include "loop/view.h"

#include "loop/loop_stages.h"
#include "loop/loop_state.h"
#include "loop/maps.h"
#include "loop/truth_surface.h"

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

/* A picture and, unless NULL, its termination depths. */
static bool draw(hs_loop *loop, const hs_device_volume *volume, const hs_camera *camera,
                 const hs_start_depths *start, uint8_t *rgba, float *termination, hs_error *err) {
    return hs_screen_render(loop->screen, volume, camera, start, termination != NULL, err) &&
           hs_screen_read(loop->screen, rgba, err) &&
           (!termination || hs_screen_read_termination(loop->screen, termination, err));
}

/* The same from where the frame's rays start; NULL: the full volume. */
static bool render_to(hs_loop *loop, const hs_device_volume *volume, const hs_camera *camera,
                      const hs_frame *frame, uint8_t *rgba, float *termination, hs_error *err) {
    hs_start_depths depths;
    const hs_start_depths *start =
        frame ? hs_clipper_start(loop->clipper, frame->clipped, frame->sure, &depths) : NULL;
    return draw(loop, volume, camera, start, rgba, termination, err);
}

/* In the lit look the truth is drawn as a result is: the frame's own volume, cut at the scene's surface, so
 * that a cut is drawn as one. */
static bool render_true_cut(hs_loop *loop, const hs_scene_data *scene, hs_view *view, hs_error *err) {
    hs_start_depths start = {0};
    const bool ok = hs_truth_surface(loop->cl, scene, &view->camera, &start, err) &&
                    draw(loop, loop->volume, &view->camera, &start, view->truth, NULL, err);
    if (start.depth) (void)clReleaseMemObject(start.depth);
    return ok;
}

static bool render_truth(hs_loop *loop, uint32_t index, hs_view *view, hs_error *err) {
    const hs_scene_data *scene = hs_source_scene_data(loop->source, index);
    if (scene && loop->options.dvr.look == HS_LOOK_LIT && hs_truth_surface_fits(&view->camera))
        return render_true_cut(loop, scene, view, err);
    hs_device_volume *truth = hs_device_volume_create(loop->cl, hs_source_truth(loop->source, index), err);
    bool ok = truth && render_to(loop, truth, &view->camera, NULL, view->truth, NULL, err);
    hs_device_volume_destroy(truth);
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
    hs_loop_camera(loop, index, &view->camera);
    view->look = loop->options.dvr.look;
    view->ghosted = loop->options.dvr.ghost_width > 0;
    const bool ok =
        allocate(loop, view, err) && run_frame(loop, index, view, err) &&
        (view->volume = hs_source_bring(loop->source, index % loop->source->count, err)) &&
        render_to(loop, loop->volume, &view->camera, &view->frame, view->result, view->termination, err) &&
        render_to(loop, loop->volume, &view->camera, NULL, view->full, view->full_termination, err) &&
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
    hs_camera camera;
    hs_loop_camera(loop, index, &camera);
    const bool ok = primary->flags & SV_PARAM_ADJUST ? hs_loop_adjust(loop, turned, &frame, NULL, err)
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
