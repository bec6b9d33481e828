/* SPDX-License-Identifier: MIT */
#include "console/console.h"

#include "base/progress.h"
#include "loop/loop_run.h"

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

void hs_console_stage_close(hs_console_stage *stage) {
    end_truth(stage);
    for (int i = 0; i < HS_CONSOLE_LANES; i++) hs_lane_close(&stage->lane[i]);
    hs_screen_destroy(stage->screen);
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
    const hs_source_files how = {.metaimage = stage->read};
    return hs_source_open_files(out, paths, 1, hs_kretz_is_file(path) ? NULL : &how, err);
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
    if (stage->truth || !hs_source_truth(&stage->source, 0)) return true;
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
    hs_screen_destroy(stage->screen);
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
