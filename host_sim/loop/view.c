/* SPDX-License-Identifier: MIT */
#include "loop/view.h"

#include "loop/loop_run.h"
#include "loop/loop_state.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static bool allocate_maps(const hs_loop *loop, hs_maps *maps, hs_error *err) {
    const hs_slab_layout *layout = hs_loop_layout(loop);
    maps->width = layout->width;
    maps->height = layout->height;
    maps->slices = layout->slices;
    const size_t rays = (size_t)maps->width * maps->height;
    maps->depth = calloc(rays, sizeof *maps->depth);
    maps->status = calloc(rays, 1);
    return (maps->depth && maps->status) ||
           hs_fail(err, HS_ERR_MEMORY, "maps: no memory for %u x %u pixels", maps->width, maps->height);
}

static bool read_confidence(const hs_loop *loop, size_t rays, hs_maps *maps, hs_error *err) {
    maps->confidence = hs_memory(rays, sizeof *maps->confidence, "confidence", err);
    if (!maps->confidence) return false;
    return hs_clipper_read_confidence(loop->clipper, maps->confidence, err);
}

/* A map that was not used is not shown either, since it may be an earlier frame's. */
static bool read_back(const hs_loop *loop, hs_maps *maps, hs_error *err) {
    const size_t rays = (size_t)maps->width * maps->height;
    if (maps->frame.clipped && !hs_clipper_read_depth(loop->clipper, maps->depth, err)) return false;
    if (maps->frame.has_confidence && !read_confidence(loop, rays, maps, err)) return false;
    if (maps->frame.outcome >= SV_OK) memcpy(maps->status, hs_clipper_status(loop->clipper), rays);
    return true;
}

bool hs_loop_read_maps(hs_loop *loop, uint32_t index, const hs_frame *frame, hs_maps *maps, hs_error *err) {
    *maps = (hs_maps){.frame = *frame};
    hs_loop_camera(loop, index, &maps->camera);
    const bool ok = allocate_maps(loop, maps, err) && read_back(loop, maps, err);
    if (!ok) hs_maps_free(maps);
    return ok;
}

bool hs_loop_maps(hs_loop *loop, uint32_t index, hs_maps *maps, hs_error *err) {
    const bool wanted = hs_clipper_wants_confidence(loop->clipper);
    hs_frame frame;
    *maps = (hs_maps){0};
    hs_loop_want(loop, true, true);
    const bool ok = hs_loop_frame(loop, HS_SETTING_SMARTVIS, index, &frame, err);
    hs_loop_want(loop, false, wanted);
    return ok && hs_loop_read_maps(loop, index, &frame, maps, err);
}

void hs_maps_crop(hs_maps *maps, const hs_source *source) {
    const hs_volume *volume = hs_source_shape(source);
    const double wide = maps->camera.extent, half = 0.5 * maps->camera.depth_extent;
    for (uint32_t i = 0; source->crop.used && i < maps->width * maps->height; i++) {
        const uint32_t column = i % maps->width, row = i / maps->width;
        const double x = ((column + 0.5) / maps->width - 0.5) * wide;
        const double y = ((row + 0.5) / maps->height - 0.5) * wide;
        double near[3], far[3];
        hs_marks_place(volume, &maps->camera, (const double[3]){x, y, -half}, near);
        hs_marks_place(volume, &maps->camera, (const double[3]){x, y, half}, far);
        if (!hs_crop_meets(&source->crop, near, far)) maps->depth[i] = 0.0f;
    }
}

/* The slice of the first voxel on a ray that was scanned; as many as there are: none was. */
static uint32_t first_scanned(const hs_maps *maps, const hs_volume *volume, const hs_box_map *map,
                              uint32_t ray) {
    const size_t x = ray % maps->width, y = ray / maps->width;
    double place[3] = {((double)x + 0.5) / maps->width, ((double)y + 0.5) / maps->height};
    uint32_t at[3], slice = 0;
    for (; slice < maps->slices; slice++) {
        place[2] = (slice + 0.5) / maps->slices;
        if (hs_box_map_voxel(map, volume, place, at) &&
            volume->voxels[((size_t)at[2] * volume->ny + at[1]) * volume->nx + at[0]] > 0)
            break;
    }
    return slice;
}

void hs_maps_scan(hs_maps *maps, const hs_volume *volume) {
    hs_box_map map;
    hs_camera_box_map(&maps->camera, volume, &map);
    for (uint32_t i = 0; i < maps->width * maps->height; i++) {
        const uint32_t first = first_scanned(maps, volume, &map, i);
        if (first == maps->slices)
            maps->depth[i] = -1.0f;
        else if (maps->depth[i] < (float)first)
            maps->depth[i] = 0.0f;
    }
}

bool hs_loop_pick(hs_loop *loop, hs_screen *screen, uint32_t index, const hs_frame *frame, hs_camera *window,
                  uint32_t *steps, float *ends, hs_error *err) {
    hs_start_depths depths;
    const hs_start_depths *start = hs_loop_start(loop, index, frame, window, &depths);
    *steps = hs_screen_steps(screen, loop->volume, window);
    return hs_screen_render(screen, loop->volume, window, start, true, err) &&
           hs_screen_read_termination(screen, ends, err);
}

void hs_maps_free(hs_maps *maps) {
    free(maps->depth);
    free(maps->status);
    free(maps->confidence);
    *maps = (hs_maps){0};
}

/* True if the camera looks along the scene's own rays. */
static bool truth_surface_fits(const hs_camera *camera) {
    for (int k = 0; k < 9; k++) {
        const double expected = k % 4 == 0 ? 1.0 : 0.0;
        if (camera->rotation[k] < expected || camera->rotation[k] > expected) return false;
    }
    return true;
}

/* The voxel of a column under the middle of pixel i of `side`; -1 beside the volume. */
static int64_t column_at(uint32_t i, uint32_t side, double extent, uint32_t count, double spacing) {
    const double at = ((i + 0.5) / side - 0.5) * extent / spacing + 0.5 * count;
    return at >= 0.0 && at < count ? (int64_t)at : -1;
}

/* Depth of the map: the box may be deeper than the volume, which lies in its middle. */
static void fill_surface(const hs_scene_data *data, const hs_camera *camera, uint32_t side, float *map) {
    const hs_volume *v = &data->full;
    const double slice = v->spacing[2], front = 0.5 * (camera->depth_extent - v->nz * slice);
    for (uint32_t j = 0; j < side; j++)
        for (uint32_t i = 0; i < side; i++) {
            const int64_t x = column_at(i, side, camera->extent, v->nx, v->spacing[0]);
            const int64_t y = column_at(j, side, camera->extent, v->ny, v->spacing[1]);
            float *to = map + (size_t)j * side + i;
            *to = 0.0f;
            if (x < 0 || y < 0) continue;
            const double clip = (double)data->clip[(size_t)y * v->nx + (size_t)x];
            *to = (float)((front + (clip + 0.5) * slice) / camera->depth_extent * v->nz - 0.5);
        }
}

/* The scene's surface in a box as wide and deep as the camera's: as many pixels across as the wider side of
 * the scene has voxels, and its nz slices. A pixel beside the scene clips nothing. The caller releases the
 * buffer. */
static bool truth_surface(const hs_cl *cl, const hs_scene_data *data, const hs_camera *camera,
                          hs_start_depths *out, hs_error *err) {
    const hs_volume *v = &data->full;
    const uint32_t side = v->nx > v->ny ? v->nx : v->ny;
    const size_t bytes = (size_t)side * side * sizeof(float);
    float *map = hs_memory(1, bytes, "ground truth", err);
    if (!map) return false;
    fill_surface(data, camera, side, map);
    cl_int code;
    *out = (hs_start_depths){.width = side, .height = side, .slices = v->nz};
    out->depth = clCreateBuffer(cl->context, CL_MEM_READ_ONLY | CL_MEM_COPY_HOST_PTR, bytes, map, &code);
    free(map);
    return hs_cl_check(code, "clCreateBuffer (the truth's surface)", err);
}

#define SEEN 0.005 /* the share of the fetus from which on a cut is seen */

/* The truth is drawn as a cut through the full volume then. */
static bool is_cut(const hs_loop *loop, hs_look look, uint32_t index) {
    hs_camera window;
    float share;
    hs_loop_window(loop, index, &window, &share);
    return hs_source_scene_data(loop->source, index) && look == HS_LOOK_LIT && truth_surface_fits(&window);
}

bool hs_truth_shows_cut(const hs_loop *loop, hs_look look, uint32_t index) {
    return is_cut(loop, look, index) && hs_scene_touched(hs_source_scene_data(loop->source, index)) > SEEN;
}

struct hs_truth_picture {
    hs_loop *loop;
    hs_device_volume *volume; /* the truth of frame `index`, or NULL */
    uint32_t index;           /* of the source's volumes */
};

hs_truth_picture *hs_truth_picture_create(hs_loop *loop, hs_error *err) {
    hs_truth_picture *picture = calloc(1, sizeof *picture);
    if (picture)
        picture->loop = loop;
    else
        (void)hs_fail(err, HS_ERR_MEMORY, "ground truth: no memory");
    return picture;
}

void hs_truth_picture_destroy(hs_truth_picture *picture) {
    if (!picture) return;
    hs_device_volume_destroy(picture->volume);
    free(picture);
}

static bool bring_truth(hs_truth_picture *picture, uint32_t index, hs_error *err) {
    hs_loop *loop = picture->loop;
    const uint32_t wanted = index % loop->source->count;
    if (picture->volume && picture->index == wanted) return true;
    const hs_volume *truth = hs_source_truth(loop->source, wanted);
    picture->index = wanted;
    if (picture->volume) return hs_device_volume_replace(picture->volume, truth, err);
    picture->volume = hs_device_volume_create(loop->cl, truth, err);
    return picture->volume != NULL;
}

static bool wait_for_truth(const hs_loop *loop, hs_error *err) {
    return hs_cl_check(clFinish(loop->cl->queue), "clFinish (ground truth)", err);
}

static bool draw_cut(hs_loop *loop, const hs_scene_data *scene, uint32_t index, const hs_camera *window,
                     float share, hs_screen *screen, hs_error *err) {
    hs_camera box;
    hs_start_depths start = {0};
    hs_loop_camera(loop, index, &box);
    bool ok = truth_surface(loop->cl, scene, &box, &start, err);
    start.share = share;
    ok =
        ok && hs_screen_render(screen, loop->volume, window, &start, false, err) && wait_for_truth(loop, err);
    if (start.depth) (void)clReleaseMemObject(start.depth);
    return ok;
}

bool hs_truth_picture_draw(hs_truth_picture *picture, hs_screen *screen, hs_look look, uint32_t index,
                           hs_error *err) {
    hs_loop *loop = picture->loop;
    const hs_scene_data *scene = hs_source_scene_data(loop->source, index);
    hs_camera window;
    float share;
    hs_loop_window(loop, index, &window, &share);
    if (is_cut(loop, look, index)) return draw_cut(loop, scene, index, &window, share, screen, err);
    return bring_truth(picture, index, err) &&
           hs_screen_render(screen, picture->volume, &window, NULL, false, err) && wait_for_truth(loop, err);
}

static bool allocate_pictures(const hs_loop *loop, hs_view *view, hs_error *err) {
    view->width = loop->options.dvr.width;
    view->height = loop->options.dvr.height;
    const size_t pixels = (size_t)view->width * view->height;
    view->result = malloc(pixels * 4);
    view->full = malloc(pixels * 4);
    view->termination = malloc(pixels * sizeof(float));
    view->full_termination = malloc(pixels * sizeof(float));
    bool ok = view->result && view->full && view->termination && view->full_termination;
    if (ok && hs_source_has_truth(loop->source)) ok = (view->truth = malloc(pixels * 4)) != NULL;
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

bool hs_loop_view_result(hs_loop *loop, uint32_t index, hs_view *view, hs_error *err) {
    *view = (hs_view){0};
    hs_camera window;
    float share;
    hs_loop_window(loop, index, &window, &share);
    view->picture_mm = window.extent;
    view->look = loop->options.dvr.look;
    view->truth_cut = hs_truth_shows_cut(loop, view->look, index);
    view->ghosted = loop->options.dvr.ghost_width > 0;
    const bool ok = allocate_pictures(loop, view, err) && hs_loop_maps(loop, index, &view->maps, err) &&
                    (view->volume = hs_source_bring(loop->source, index % loop->source->count, err)) &&
                    render_to(loop, index, &view->maps.frame, view->result, view->termination, err);
    if (ok)
        hs_maps_crop(&view->maps, loop->source);
    else
        hs_view_free(view);
    return ok;
}

bool hs_loop_view_rest(hs_loop *loop, uint32_t index, hs_view *view, hs_error *err) {
    const bool ok = render_to(loop, index, NULL, view->full, view->full_termination, err) &&
                    (!view->truth || render_truth(loop, index, view, err));
    if (!ok) hs_view_free(view);
    return ok;
}

bool hs_loop_view(hs_loop *loop, uint32_t index, hs_view *view, hs_error *err) {
    return hs_loop_view_result(loop, index, view, err) && hs_loop_view_rest(loop, index, view, err);
}

/* A whole frame with one more value, which comes last and so counts. */
static bool frame_with(hs_loop *loop, uint32_t index, sv_param_value value, hs_frame *frame, hs_error *err) {
    uint32_t count;
    const sv_param_value *before = hs_clipper_values(loop->clipper, &count);
    sv_param_value *values = hs_memory(count + 1u, sizeof *values, "plugin parameters", err);
    if (!values) return false;
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
    free(view->termination);
    free(view->full_termination);
    hs_maps_free(&view->maps);
    *view = (hs_view){0};
}
