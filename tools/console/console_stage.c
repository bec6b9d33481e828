/* SPDX-License-Identifier: MIT */
#include "console/console.h"

#include "base/progress.h"
#include "loop/loop_run.h"
#include "plugin/capabilities.h"
#include "plugin/loader_param.h"

#include <stdio.h>
#include <string.h>

/* ------------------------------------------------------------------------------------------------ lane -- */

static void close_plugin(hs_lane *lane) {
    hs_error ended = {0};
    if (lane->has_plugin) (void)hs_guarded_close(&lane->plugin, &ended); /* it is not asked any more */
    lane->has_plugin = false;
}

static void end_loop(hs_lane *lane) {
    hs_loop_destroy(lane->loop);
    lane->loop = NULL;
}

static void hs_lane_close(hs_lane *lane) {
    end_loop(lane);
    close_plugin(lane);
    *lane = (hs_lane){0};
}

void hs_lane_needs(hs_lane *lane, hs_lane_need need) {
    if (lane->need < need) lane->need = need;
}

/* Opens the offered plugin, or another one; its values are the defaults then. The loop must be built anew by
 * hs_lane_build. A plugin that cannot be opened is no failure: `failure` tells. */
static void hs_lane_choose(hs_lane *lane, const hs_console_offer *offer, const hs_guard_options *guard) {
    hs_lane_close(lane);
    lane->offer = offer;
    lane->failure = offer->failure;
    if (offer->id[0] != '\0')
        lane->has_plugin =
            hs_guarded_open(&lane->plugin, offer->path, offer->id, SV_LOG_ERROR, guard, &lane->failure);
}

static const hs_plugin *plugin_of(const hs_lane *lane) {
    return lane->has_plugin ? &lane->plugin : NULL;
}

static hs_loop_options with_values(const hs_lane *lane, const hs_loop_options *options) {
    hs_loop_options out = *options;
    out.values = lane->values;
    out.value_count = lane->count;
    return out;
}

/* Builds the loop on a source. HS_ERR_INPUT, HS_ERR_DEVICE, HS_ERR_MEMORY: there is no loop then. */
static bool hs_lane_build(hs_lane *lane, const hs_cl *cl, const hs_source *source,
                          const hs_loop_options *options, hs_error *err) {
    const hs_loop_options all = with_values(lane, options);
    const double start = hs_now();
    end_loop(lane);
    lane->loop = hs_loop_create(cl, source, plugin_of(lane), &all, err);
    lane->activation_ms = (hs_now() - start) * 1e3;
    lane->activations++;
    lane->need = HS_LANE_CONVERT;
    return lane->loop != NULL;
}

/* -------------------------------------------------------------------------------------------- values -- */

/* Whether a value may be sent to the plugin. */
static bool check_value(const hs_lane *lane, const hs_console_value *wanted, sv_param_info *info,
                        hs_error *err) {
    if (!hs_plugin_find_param(&lane->plugin, wanted->key, info))
        return hs_fail(err, HS_ERR_INPUT, "parameter '%s': %s has none of that name", wanted->key,
                       lane->offer->id);
    return (wanted->value >= info->min_value && wanted->value <= info->max_value) ||
           hs_fail(err, HS_ERR_INPUT, "parameter %s: %g is outside %g .. %g", wanted->key, wanted->value,
                   info->min_value, info->max_value);
}

static double value_before(const hs_lane *lane, const sv_param_info *info) {
    for (uint32_t i = 0; i < lane->count; i++)
        if (lane->values[i].id == info->id) return lane->values[i].value;
    return info->default_value;
}

/* What changed. */
typedef struct {
    sv_param_value values[HS_CONSOLE_VALUES];
    uint32_t count, changes, adjusted;
    bool adjustable, reactivates;
} change;

/* A parameter that is not named any more goes back to its default: that is a change, too. */
static bool find_dropped(const hs_lane *lane, const hs_console_lane *wanted, change *c, hs_error *err) {
    const sv_plugin *instance = lane->plugin.instance;
    const uint32_t params = hs_plugin_param_count(&lane->plugin);
    for (uint32_t i = 0; i < params; i++) {
        sv_param_info info = {.size = sizeof info};
        bool named = false;
        if (instance->param_info(instance, i, &info) != SV_OK || !info.key) continue;
        for (uint32_t k = 0; k < wanted->count && !named; k++)
            named = strcmp(wanted->values[k].key, info.key) == 0;
        if (named || value_before(lane, &info) == info.default_value) continue;
        if (c->count == HS_CONSOLE_VALUES)
            return hs_fail(err, HS_ERR_INPUT, "values: more than %d", HS_CONSOLE_VALUES);
        c->reactivates |= (info.flags & SV_PARAM_REACTIVATE) != 0;
        c->adjustable = (info.flags & SV_PARAM_ADJUST) != 0;
        c->adjusted = c->count;
        c->changes++;
        c->values[c->count++] = (sv_param_value){.id = info.id, .value = info.default_value};
    }
    return true;
}

static bool find_change(const hs_lane *lane, const hs_console_lane *wanted, change *c, hs_error *err) {
    *c = (change){0};
    for (uint32_t i = 0; i < wanted->count; i++) {
        sv_param_info info;
        if (!check_value(lane, &wanted->values[i], &info, err)) return false;
        c->values[c->count] = (sv_param_value){.id = info.id, .value = wanted->values[i].value};
        if (value_before(lane, &info) != wanted->values[i].value) {
            c->changes++;
            c->reactivates |= (info.flags & SV_PARAM_REACTIVATE) != 0;
            c->adjustable = (info.flags & SV_PARAM_ADJUST) != 0;
            c->adjusted = c->count;
        }
        c->count++;
    }
    return find_dropped(lane, wanted, c, err);
}

/* The plugin's own time, with the slabs it is given; the volume stays. */
static bool reactivate(hs_lane *lane, const hs_loop_options *options, hs_error *err) {
    const hs_loop_options all = with_values(lane, options);
    const double start = hs_now();
    const bool ok = hs_loop_reactivate(lane->loop, plugin_of(lane), &all, err);
    lane->activation_ms = (hs_now() - start) * 1e3;
    lane->activations++;
    lane->need = HS_LANE_CONVERT;
    if (!ok) end_loop(lane);
    return ok;
}

/* Takes the values of a state, and activates the plugin anew if one of them needs it. HS_ERR_INPUT names a
 * parameter that the plugin does not have, or a value out of its range: the values are then as they were.
 * HS_ERR_DEVICE or HS_ERR_MEMORY. */
static bool hs_lane_set(hs_lane *lane, const hs_console_lane *wanted, const hs_loop_options *options,
                        hs_error *err) {
    change c;
    if (!lane->has_plugin) return true;
    if (!find_change(lane, wanted, &c, err)) return false;
    if (c.changes == 0) return true;
    memcpy(lane->values, c.values, sizeof lane->values);
    lane->count = c.count;
    if (!lane->loop) return true; /* it is built with them */
    if (c.reactivates) return reactivate(lane, options, err);
    hs_loop_set_values(lane->loop, lane->values, lane->count);
    const bool adjust =
        c.changes == 1 && c.adjustable && lane->need == HS_LANE_NOTHING && lane->frame.clipped;
    lane->adjusted = c.adjusted;
    hs_lane_needs(lane, adjust ? HS_LANE_ADJUST : HS_LANE_ASK);
    return true;
}

/* ---------------------------------------------------------------------------------------------- frame -- */

/* Does what the lane needs for volume `index`, which is brought first.
 * HS_ERR_DEVICE, or the source's errors. */
static bool hs_lane_run(hs_lane *lane, uint32_t index, hs_error *err) {
    const double start = hs_now();
    memset(lane->ms, 0, sizeof lane->ms);
    if (!hs_loop_bring(lane->loop, index, err)) return false;
    const double brought = hs_now();
    if (lane->need >= HS_LANE_CONVERT && !hs_loop_convert(lane->loop, index, err)) return false;
    const double converted = hs_now();
    if (lane->need == HS_LANE_ADJUST) {
        if (!hs_loop_adjust(lane->loop, lane->values[lane->adjusted], &lane->frame, NULL, err)) return false;
        lane->was_adjusted = lane->frame.outcome >= SV_OK;
        if (!lane->was_adjusted) lane->need = HS_LANE_ASK; /* a plugin that cannot is asked as ever */
    }
    if (lane->need >= HS_LANE_ASK) {
        lane->was_adjusted = false;
        if (!hs_loop_ask(lane->loop, index, &lane->frame, err)) return false;
    }
    const double end = hs_now();
    lane->ms[HS_STAGE_UPLOAD] = (brought - start) * 1e3;
    lane->ms[HS_STAGE_CONVERT] = (converted - brought) * 1e3;
    lane->ms[HS_STAGE_PLUGIN] = (end - converted) * 1e3;
    lane->need = HS_LANE_NOTHING;
    return true;
}

static bool reason_words(const sv_confidence_report *r, char words[HS_CONSOLE_REASON]) {
    const double found = 100.0 * (double)r->found, wanted = 100.0 * (double)r->wanted;
    switch (r->reason) {
    case SV_REASON_EMPTY:
        (void)snprintf(words, HS_CONSOLE_REASON,
                       "Too little was scanned, or all of it has one grey level. Scan more of it.");
        return true;
    case SV_REASON_NO_FETUS:
        (void)snprintf(words, HS_CONSOLE_REASON,
                       "Only %.0f %% of the view shows tissue brighter than the wall behind it; %.0f %% are "
                       "needed. Turn the view, or move the probe, until the fetus lies behind the wall.",
                       found, wanted);
        return true;
    case SV_REASON_NO_FLUID:
    case SV_REASON_DOUBTFUL:
        (void)snprintf(
            words, HS_CONSOLE_REASON,
            "%.0f %% of what is as dark as fluid lies between wall and fetus; from %.0f %% on it is "
            "sure. Turn the view, or move the probe, until fluid lies between them.",
            found, wanted);
        return true;
    default:
        return false; /* of a later version */
    }
}

bool hs_lane_reason(const hs_lane *lane, sv_confidence_report *out, char words[HS_CONSOLE_REASON]) {
    const sv_plugin *instance = lane->has_plugin && lane->loop ? lane->plugin.instance : NULL;
    const sv_ext_confidence *ext = instance ? hs_plugin_confidence(instance) : NULL;
    *out = (sv_confidence_report){.size = sizeof *out};
    return ext && lane->frame.outcome >= SV_OK && ext->offered(instance) &&
           ext->read(instance, NULL, out) == SV_OK && reason_words(out, words);
}

const hs_error *hs_lane_error(const hs_lane *lane) {
    static const hs_error none;
    if (lane->frame.clipped || lane->frame.outcome > SV_OK) return &none;
    return lane->failure.code != HS_OK || !lane->loop ? &lane->failure : hs_loop_plugin_error(lane->loop);
}

/* ----------------------------------------------------------------------------------------------- stage -- */

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
    return hs_source_open_files(out, paths, 1, NULL, err);
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

/* ------------------------------------------------------------------------------------------- lanes -- */

/* The loop draws no picture of its own: the stage's screen does. */
static hs_loop_options loop_options(const hs_console_state *state) {
    hs_loop_options o;
    hs_loop_defaults(&o);
    o.from = state->source.from;
    o.turnable = true;
    o.yaw = state->yaw;
    o.pitch = state->pitch;
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

static bool follow_lane(hs_console_stage *stage, const hs_console_state *state, uint32_t i, hs_error *err) {
    hs_lane *lane = &stage->lane[i];
    const hs_console_lane *wanted = &state->lane[i];
    const hs_loop_options options = loop_options(state);
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
    }
    return hs_lane_set(lane, wanted, &options, err) &&
           (lane->loop || hs_lane_build(lane, &stage->cl, &stage->source, &options, err));
}

static bool follow_lanes(hs_console_stage *stage, const hs_console_state *state, hs_error *err) {
    for (uint32_t i = 0; i < HS_CONSOLE_LANES; i++)
        if (!follow_lane(stage, state, i, err)) return false;
    if (stage->truth || !hs_source_truth(&stage->source, 0)) return true;
    stage->truth = hs_truth_picture_create(stage->lane[0].loop, err);
    return stage->truth != NULL;
}

/* ------------------------------------------------------------------------------------------ picture -- */

/* But for its size. */
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
    const bool turned = now->yaw != state->yaw || now->pitch != state->pitch;
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
        hs_loop_look(lane->loop, state->yaw, state->pitch, state->zoom);
        hs_loop_want(lane->loop, false, shows_maps);
        if (turned || other_volume) hs_lane_needs(lane, HS_LANE_CONVERT);
        if (shows_maps && !showed_maps) hs_lane_needs(lane, HS_LANE_ASK);
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
    if (!follow_lanes(stage, state, err)) return can_go_on(stage, err) ? false : give_up(stage);
    if (!follow_screen(stage, state, err)) return give_up(stage);
    follow_camera(stage, state, index);
    stage->state = *state;
    stage->index = index;
    return run_lanes(stage, index, err) || give_up(stage);
}

hs_loop *hs_console_stage_loop(hs_console_stage *stage) {
    return stage->has_source ? stage->lane[0].loop : NULL;
}
