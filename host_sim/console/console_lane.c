/* SPDX-License-Identifier: MIT */
/* A plugin with its values in a scan loop of its own. */
#include "console/console.h"

#include "core/progress.h"
#include "loop/loop_run.h"
#include "plugin/capabilities.h"
#include "plugin/loader_param.h"

#include <string.h>
#include <sys/stat.h>
#include <time.h>

#define SETTLED_NS 500000000 /* a linker writes for less, or at least this often */

static int64_t ns_of(struct timespec at) {
    return (int64_t)at.tv_sec * 1000000000 + at.tv_nsec;
}

static void close_plugin(hs_lane *lane) {
    hs_error ended = {0};
    if (lane->has_plugin) (void)hs_guarded_close(&lane->plugin, &ended); /* it is not asked any more */
    lane->has_plugin = false;
}

static void end_loop(hs_lane *lane) {
    hs_loop_destroy(lane->loop);
    lane->loop = NULL;
}

void hs_lane_close(hs_lane *lane) {
    end_loop(lane);
    close_plugin(lane);
    *lane = (hs_lane){0};
}

void hs_lane_needs(hs_lane *lane, hs_lane_need need) {
    if (lane->need < need) lane->need = need;
}

static hs_library_stamp stamp_of(const char *path, int64_t *age_ns) {
    struct stat file;
    struct timespec now;
    *age_ns = 0;
    if (stat(path, &file) != 0 || clock_gettime(CLOCK_REALTIME, &now) != 0) return (hs_library_stamp){0};
    *age_ns = ns_of(now) - ns_of(file.st_ctim);
    return (hs_library_stamp){.device = (uint64_t)file.st_dev,
                              .inode = (uint64_t)file.st_ino,
                              .bytes = (uint64_t)file.st_size,
                              .written_ns = ns_of(file.st_mtim)};
}

bool hs_lane_is_rebuilt(const hs_lane *lane) {
    int64_t age_ns;
    if (!lane->offer) return false;
    const hs_library_stamp now = stamp_of(lane->offer->path, &age_ns), then = lane->stamp;
    return now.bytes > 0 && age_ns > SETTLED_NS &&
           (now.device != then.device || now.inode != then.inode || now.bytes != then.bytes ||
            now.written_ns != then.written_ns);
}

void hs_lane_choose(hs_lane *lane, const hs_console_offer *offer, const hs_guard_options *guard) {
    int64_t age_ns;
    hs_lane_close(lane);
    lane->offer = offer;
    lane->stamp = stamp_of(offer->path, &age_ns);
    lane->has_plugin = hs_guarded_open(&lane->plugin, offer->path, offer->id[0] ? offer->id : NULL,
                                       SV_LOG_ERROR, guard, &lane->failure);
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

bool hs_lane_build(hs_lane *lane, const hs_cl *cl, const hs_source *source, const hs_loop_options *options,
                   hs_error *err) {
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

void hs_lane_leave_out(const hs_lane *lane, hs_console_lane *wanted) {
    hs_error ignored = {0};
    sv_param_info info;
    uint32_t kept = 0;
    for (uint32_t i = 0; lane->has_plugin && i < wanted->count; i++)
        if (check_value(lane, &wanted->values[i], &info, &ignored))
            wanted->values[kept++] = wanted->values[i];
    if (lane->has_plugin) wanted->count = kept;
}

static double value_before(const hs_lane *lane, const sv_param_info *info) {
    for (uint32_t i = 0; i < lane->count; i++)
        if (lane->values[i].id == info->id) return lane->values[i].value;
    return info->default_value;
}

/* How the wanted values differ from those that a lane has. */
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

bool hs_lane_set(hs_lane *lane, const hs_console_lane *wanted, const hs_loop_options *options,
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

bool hs_lane_run(hs_lane *lane, uint32_t index, hs_error *err) {
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

bool hs_lane_reason(const hs_lane *lane, sv_confidence_report *out, char words[HS_REASON_BYTES]) {
    const sv_plugin *instance = lane->has_plugin && lane->loop ? lane->plugin.instance : NULL;
    return instance && lane->frame.outcome >= SV_OK && hs_plugin_reason(instance, out, words);
}

const hs_error *hs_lane_error(const hs_lane *lane) {
    static const hs_error none;
    if (lane->frame.clipped || lane->frame.outcome > SV_OK) return &none;
    return lane->failure.code != HS_OK || !lane->loop ? &lane->failure : hs_loop_plugin_error(lane->loop);
}
