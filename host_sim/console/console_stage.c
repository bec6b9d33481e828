/* SPDX-License-Identifier: MIT */
#include "console/console.h"

#include "core/progress.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

bool hs_console_stage_open(hs_console_stage *stage, const hs_console_offers *offers,
                           const hs_console_files *files, hs_error *err) {
    *stage = (hs_console_stage){.offers = offers, .files = files};
    return hs_cl_open(&stage->cl, err);
}

/* It draws with lane 0's loop. */
static void end_truth(hs_console_stage *stage) {
    hs_truth_picture_destroy(stage->truth);
    stage->truth = NULL;
}

static void end_loops(hs_console_stage *stage) {
    end_truth(stage);
    for (int i = 0; i < HS_CONSOLE_LANES; i++) {
        hs_loop_destroy(stage->lane[i].loop);
        stage->lane[i].loop = NULL;
    }
}

static void end_source(hs_console_stage *stage) {
    end_loops(stage);
    if (stage->has_source) hs_source_close(&stage->source);
    stage->has_source = false;
}

static void end_screen(hs_console_stage *stage) {
    hs_screen_destroy(stage->screen);
    stage->screen = NULL;
}

void hs_console_stage_rest(hs_console_stage *stage) {
    end_loops(stage);
    end_screen(stage);
}

void hs_console_stage_close(hs_console_stage *stage) {
    end_truth(stage);
    for (int i = 0; i < HS_CONSOLE_LANES; i++) hs_lane_close(&stage->lane[i]);
    end_screen(stage);
    end_source(stage);
    hs_cl_close(&stage->cl);
}

/* ------------------------------------------------------------------------------------------- source -- */

bool hs_console_stage_changes_source(const hs_console_stage *stage, const hs_console_state *state) {
    const hs_console_source *a = &stage->state.source, *b = &state->source;
    if (!stage->has_source || strcmp(a->scene, b->scene) != 0) return true;
    if (b->scene[0] != '\0') return a->size != b->size || a->volumes != b->volumes;
    return a->folder != b->folder || strcmp(a->path, b->path) != 0;
}

static bool open_source(hs_console_stage *stage, const hs_console_source *wanted, hs_source *out,
                        char path[1024], hs_error *err) {
    const hs_source_scene scene = {.name = wanted->scene, .size = wanted->size, .volumes = wanted->volumes};
    if (wanted->scene[0] != '\0') return hs_source_open_scene(out, &scene, err);
    if (!hs_console_files_find(stage->files, wanted->folder, wanted->path, path, 1024, err)) return false;
    const char *const paths[1] = {path};
    hs_source_files how = {0};
    if (!hs_kretz_is_file(path)) how.metaimage = stage->read;
    how.metaimage.folder = stage->files->folder[wanted->folder];
    return hs_source_open_files(out, paths, 1, &how, err);
}

/* The one before stays until the new one is there; so does its path, which a source borrows. */
static bool change_source(hs_console_stage *stage, const hs_console_state *state, hs_error *err) {
    hs_source source;
    const uint32_t spare = 1u - stage->path_used;
    const double start = hs_now();
    if (!open_source(stage, &state->source, &source, stage->path[spare], err)) return false;
    end_source(stage);
    stage->source = source;
    stage->has_source = true;
    stage->path_used = spare;
    stage->source_ms = (hs_now() - start) * 1e3;
    return true;
}

/* A box of the volume, or all of it; what is in probe geometry has loops of another kind with one. */
static bool follow_box(hs_console_stage *stage, const hs_crop *crop, hs_error *err) {
    const bool had_beams = hs_source_shape(&stage->source)->beams != NULL;
    if (hs_crop_same(crop, &stage->source.crop)) return true;
    if (!hs_source_crop(&stage->source, crop, err)) return false;
    end_truth(stage);
    if ((hs_source_shape(&stage->source)->beams != NULL) != had_beams) end_loops(stage);
    for (int i = 0; i < HS_CONSOLE_LANES; i++) hs_lane_needs(&stage->lane[i], HS_LANE_CONVERT);
    stage->scene_epoch++;
    return true;
}

/* ------------------------------------------------------------------------------------------- lanes -- */

/* The loop draws no picture of its own: the stage's screen does. */
static hs_loop_options loop_options(const hs_console_stage *stage, const hs_console_state *state) {
    hs_loop_options o;
    hs_loop_defaults(&o);
    o.lowres = stage->lowres;
    o.from = state->source.from;
    o.turnable = true;
    o.yaw = state->yaw;
    o.pitch = state->pitch;
    o.roll = state->roll;
    o.zoom = state->zoom;
    o.frames = 1;
    o.dvr.width = o.dvr.height = 16;
    return o;
}

static bool same_values(const hs_console_lane *a, const hs_console_lane *b) {
    bool same = a->count == b->count;
    for (uint32_t i = 0; same && i < a->count; i++)
        same = strcmp(a->values[i].key, b->values[i].key) == 0 && a->values[i].value == b->values[i].value;
    return same;
}

/* A plugin that ended so often that its guard has given it up gets another chance when its values change. */
static bool is_given_up(const hs_console_stage *stage, const hs_lane *lane, const hs_console_lane *before,
                        const hs_console_lane *wanted) {
    return lane->has_plugin && !hs_guarded_lives(&lane->plugin) &&
           hs_guarded_restarts(&lane->plugin) >= stage->offers->guard.restarts &&
           !same_values(before, wanted);
}

static bool follow_lane(hs_console_stage *stage, const hs_console_state *state, uint32_t i, bool rebuilt,
                        hs_error *err) {
    hs_lane *lane = &stage->lane[i];
    hs_console_lane kept = state->lane[i];
    const hs_console_lane *wanted = &kept;
    const hs_loop_options options = loop_options(stage, state);
    if (!wanted->used) {
        hs_lane_close(lane);
        return true;
    }
    if (wanted->plugin >= stage->offers->count)
        return hs_fail(err, HS_ERR_INPUT, "plugin %u: the console offers %u", wanted->plugin,
                       stage->offers->count);
    const hs_console_offer *offer = &stage->offers->offer[wanted->plugin];
    if (lane->offer != offer || is_given_up(stage, lane, &stage->state.lane[i], wanted)) {
        if (i == 0) end_truth(stage);
        hs_lane_choose(lane, offer, &stage->offers->guard);
        stage->told[i] = false;
        if (rebuilt) hs_lane_leave_out(lane, &kept);
    }
    return hs_lane_set(lane, wanted, &options, err) &&
           (lane->loop || hs_lane_build(lane, &stage->cl, &stage->source, &options, err));
}

static bool follow_lanes(hs_console_stage *stage, const hs_console_state *state, hs_error *err) {
    bool rebuilt[HS_CONSOLE_LANES];
    for (uint32_t i = 0; i < HS_CONSOLE_LANES; i++) rebuilt[i] = hs_lane_is_rebuilt(&stage->lane[i]);
    for (uint32_t i = 0; i < HS_CONSOLE_LANES; i++) { /* all first: dlopen takes what is still loaded */
        if (!rebuilt[i]) continue;
        if (i == 0) end_truth(stage);
        hs_lane_close(&stage->lane[i]);
    }
    for (uint32_t i = 0; i < HS_CONSOLE_LANES; i++)
        if (!follow_lane(stage, state, i, rebuilt[i], err)) return false;
    if (stage->truth || !hs_source_has_truth(&stage->source)) return true;
    stage->truth = hs_truth_picture_create(stage->lane[0].loop, err);
    return stage->truth != NULL;
}

/* ------------------------------------------------------------------------------------------ picture -- */

/* True if two pictures differ in nothing but their size. */
static bool same_renderer(const hs_dvr_settings *a, const hs_dvr_settings *b) {
    return a->look == b->look && a->light[0] == b->light[0] && a->light[1] == b->light[1] &&
           a->threshold_low == b->threshold_low && a->threshold_high == b->threshold_high &&
           a->ghost_offset == b->ghost_offset && a->ghost_width == b->ghost_width &&
           a->ghost_doubt == b->ghost_doubt && a->exposure == b->exposure;
}

static bool follow_screen(hs_console_stage *stage, const hs_console_state *state, hs_error *err) {
    hs_dvr_settings wanted = state->dvr;
    wanted.width = wanted.height = state->hurried ? state->draft : state->picture;
    const bool same = same_renderer(&wanted, &stage->screen_dvr);
    if (stage->screen && same && wanted.width == stage->screen_dvr.width) return true;
    if (!same) stage->scene_epoch++;
    end_screen(stage);
    stage->screen = hs_screen_create(&stage->cl, &wanted, err);
    stage->screen_dvr = wanted;
    return stage->screen != NULL;
}

/* What another camera or volume makes necessary. */
static void follow_camera(hs_console_stage *stage, const hs_console_state *state, uint32_t index) {
    const hs_console_state *now = &stage->state;
    const bool turned = now->yaw != state->yaw || now->pitch != state->pitch || now->roll != state->roll;
    const bool other_volume = index % stage->source.count != stage->index % stage->source.count;
    if (turned || other_volume || now->zoom != state->zoom) stage->scene_epoch++;
    const bool shows_maps =
        (state->views & (1u << HS_CONSOLE_ACROSS | 1u << HS_CONSOLE_ALONG | 1u << HS_CONSOLE_DEEP)) ||
        state->dvr.ghost_width > 0;
    const bool showed_maps =
        (now->views & (1u << HS_CONSOLE_ACROSS | 1u << HS_CONSOLE_ALONG | 1u << HS_CONSOLE_DEEP)) ||
        now->dvr.ghost_width > 0;
    for (int i = 0; i < HS_CONSOLE_LANES; i++) {
        hs_lane *lane = &stage->lane[i];
        if (!lane->loop) continue;
        hs_loop_look(lane->loop, state->yaw, state->pitch, state->roll, state->zoom);
        hs_loop_want(lane->loop, false, shows_maps);
        if (turned || other_volume) hs_lane_needs(lane, HS_LANE_CONVERT);
        if (shows_maps && !showed_maps) hs_lane_needs(lane, HS_LANE_ASK);
    }
}

static bool same_marks(const hs_console_state *a, const hs_console_state *b) {
    bool same = a->mark_count == b->mark_count;
    for (uint32_t i = 0; same && i < a->mark_count; i++) {
        const hs_mark *p = &a->marks[i], *q = &b->marks[i];
        same = p->place[0] == q->place[0] && p->place[1] == q->place[1] && p->place[2] == q->place[2] &&
               p->radius == q->radius && p->keep == q->keep;
    }
    return same;
}

/* They are of the stage's own state, which the loops borrow. */
static void follow_marks(hs_console_stage *stage, const hs_console_state *state) {
    const bool same = same_marks(&stage->state, state);
    for (int i = 0; i < HS_CONSOLE_LANES; i++) {
        if (!stage->lane[i].loop) continue;
        hs_loop_set_marks(stage->lane[i].loop, stage->state.marks, state->mark_count);
        if (!same) hs_lane_needs(&stage->lane[i], HS_LANE_ASK);
    }
}

static bool run_lanes(hs_console_stage *stage, uint32_t index, hs_error *err) {
    for (int i = 0; i < HS_CONSOLE_LANES; i++) {
        hs_lane *lane = &stage->lane[i];
        if (!lane->loop) continue;
        if (lane->need != HS_LANE_NOTHING) stage->clip_epoch++;
        if (!hs_lane_run(lane, index, err)) return false;
    }
    return true;
}

/* A stage that could not follow has none of it, and opens its source anew at the next state. */
static bool give_up(hs_console_stage *stage) {
    end_source(stage);
    return false;
}

/* A value that a plugin does not take costs nothing but itself. */
static bool can_go_on(const hs_console_stage *stage, const hs_error *err) {
    return err->code == HS_ERR_INPUT && stage->lane[0].loop && stage->screen;
}

bool hs_console_stage_show(hs_console_stage *stage, const hs_console_state *state, uint32_t index,
                           hs_error *err) {
    if (hs_console_stage_changes_source(stage, state)) {
        if (!change_source(stage, state, err)) return false;
        stage->scene_epoch++;
    } else if (state->source.from != stage->state.source.from) {
        stage->scene_epoch++;
        end_loops(stage);
    }
    if (!follow_box(stage, &state->crop, err)) return can_go_on(stage, err) ? false : give_up(stage);
    if (!follow_lanes(stage, state, err)) return can_go_on(stage, err) ? false : give_up(stage);
    if (!follow_screen(stage, state, err)) return give_up(stage);
    follow_camera(stage, state, index);
    follow_marks(stage, state);
    stage->state = *state;
    stage->index = index;
    return run_lanes(stage, index, err) || give_up(stage);
}

bool hs_console_stage_is_rebuilt(const hs_console_stage *stage) {
    return hs_lane_is_rebuilt(&stage->lane[0]) || hs_lane_is_rebuilt(&stage->lane[1]);
}

hs_loop *hs_console_stage_loop(hs_console_stage *stage) {
    return stage->has_source ? stage->lane[0].loop : NULL;
}

/* --------------------------------------------------------------------------------------------- marks -- */
/* Where in the volume a mark is that was put on a picture. */

#define SEEN 0.5f /* a ray's opacity at what is seen; tissue that lets light through has it, too */

/* How deep in the box what is seen at a place of the picture lies, mm. `frame` NULL: in the full volume. */
static bool find_seen(hs_console_stage *stage, hs_loop *loop, const hs_frame *frame, const double at[2],
                      double *mm, hs_error *err) {
    hs_dvr_settings s = stage->screen_dvr;
    s.look = HS_LOOK_THESIS; /* rays end at the same depth in either look, and are sooner drawn in this one */
    s.width = s.height = stage->state.picture;
    s.termination = SEEN;
    s.step = 1.0f;
    s.ghost_width = s.ghost_offset = 0.0f;
    const uint32_t x = (uint32_t)fmin(at[0] * s.width, s.width - 1.0);
    const uint32_t y = (uint32_t)fmin(at[1] * s.height, s.height - 1.0);
    hs_camera window;
    uint32_t steps = 1;
    hs_screen *screen = hs_screen_create(&stage->cl, &s, err);
    float *ends = screen ? calloc((size_t)s.width * s.height, sizeof *ends) : NULL;
    bool ok = ends || (screen && hs_fail(err, HS_ERR_MEMORY, "mark: no memory for %u^2 pixels", s.width));
    ok = ok && hs_loop_pick(loop, screen, stage->index, frame, &window, &steps, ends, err);
    const double end = ok ? (double)ends[(size_t)y * s.width + x] : 0.0;
    free(ends);
    hs_screen_destroy(screen);
    *mm = ok ? (end + 0.5) / steps * window.depth_extent : 0.0;
    return ok && (end < steps || hs_fail(err, HS_ERR_INPUT, "There is nothing to see at this place."));
}

static bool changes_something(const hs_mark *mark, const hs_volume *volume, const hs_maps *maps,
                              hs_error *err) {
    const uint32_t n[3] = {maps->width, maps->height, maps->slices};
    const size_t bytes = (size_t)n[0] * n[1] * sizeof(float);
    float *marked = malloc(bytes);
    if (!marked) return hs_fail(err, HS_ERR_MEMORY, "mark: no memory for %zu bytes", bytes);
    memcpy(marked, maps->depth, bytes);
    const bool ok = hs_marks_apply(mark, 1, volume, &maps->camera, n, marked, err);
    const bool same = memcmp(marked, maps->depth, bytes) == 0;
    free(marked);
    return ok && (!same || hs_fail(err, HS_ERR_INPUT,
                                   mark->keep ? "Nothing was cut from what is seen there."
                                              : "Nothing lies behind what is seen there."));
}

/* What is seen under the pointer; or, to keep it, the end of what was cut last before it. */
static bool find_place(hs_console_stage *stage, hs_console_view view, const double at[2],
                       const hs_volume *volume, const hs_maps *maps, hs_mark *mark, hs_error *err) {
    const hs_lane *lane = &stage->lane[view == HS_CONSOLE_OTHER];
    const uint32_t n[3] = {maps->width, maps->height, maps->slices};
    const bool was_cut = mark->keep && view != HS_CONSOLE_FULL;
    hs_camera window;
    float share;
    double mm = 0.5 * maps->camera.depth_extent;
    hs_loop_window(lane->loop, stage->index, &window, &share);
    if (!was_cut &&
        !find_seen(stage, lane->loop, view == HS_CONSOLE_FULL ? NULL : &lane->frame, at, &mm, err))
        return false;
    const double seen[3] = {(at[0] - 0.5) * window.extent, (at[1] - 0.5) * window.extent,
                            mm - 0.5 * window.depth_extent};
    hs_marks_place(volume, &window, seen, mark->place);
    if (was_cut && !hs_marks_find_cut(mark, volume, &maps->camera, n, maps->depth))
        return hs_fail(err, HS_ERR_INPUT, "Nothing was cut at this place.");
    for (int a = 0; a < 3; a++) mark->place[a] = round(mark->place[a] * 100.0) / 100.0;
    return true;
}

bool hs_console_stage_mark(hs_console_stage *stage, hs_console_view view, const double at[2], hs_mark *mark,
                           hs_error *err) {
    const hs_lane *lane = &stage->lane[view == HS_CONSOLE_OTHER];
    const bool shows_tissue =
        view == HS_CONSOLE_RESULT || view == HS_CONSOLE_FULL || view == HS_CONSOLE_OTHER;
    hs_maps maps;
    if (!shows_tissue || !lane->loop || !lane->frame.clipped)
        return hs_fail(err, HS_ERR_INPUT, "Nothing is clipped here, so there is nothing to mark.");
    const hs_volume *volume = hs_source_bring(&stage->source, stage->index % stage->source.count, err);
    if (!volume || !hs_loop_read_maps(lane->loop, stage->index, &lane->frame, &maps, err)) return false;
    const bool ok =
        find_place(stage, view, at, volume, &maps, mark, err) && changes_something(mark, volume, &maps, err);
    hs_maps_free(&maps);
    return ok;
}
