/* SPDX-License-Identifier: MIT */
#include "guarded/guarded_ext.h"

#include "guarded/guard_link.h"

#include <string.h>

/* As much of a report as the reader has room for; the size stays the reader's. */
static void give(void *out, uint32_t size, const void *report, size_t bytes) {
    memcpy((char *)out + sizeof size, (const char *)report + sizeof size,
           (size < bytes ? size : bytes) - sizeof size);
}

/* What follows a frame comes with its message if it did so last time, and by a message of its own if not. */
static bool follow(hs_guard *guard, uint32_t what) {
    guard->habit |= what;
    if (guard->settled & what) return true;
    if (!guard->child.pid) return false;
    guard->block->follow = what;
    (void)hs_guard_ask(guard, HS_GUARD_FOLLOW, guard->options.frame_s);
    if (!guard->child.pid) return false;
    guard->settled |= what;
    return true;
}

/* -------------------------------------------------------------------------------------------- points -- */

static sv_status points_write(const sv_plugin *plugin, sv_points_report *out) {
    hs_guard *guard = hs_guard_of(plugin);
    if (!follow(guard, HS_GUARD_POINTS)) return SV_ERR_INTERNAL;
    const sv_points_report points = guard->block->points;
    if (points.size == 0) return SV_ERR_STATE;
    give(out, out->size, &points, sizeof points);
    return SV_OK;
}

/* ---------------------------------------------------------------------------------------- confidence -- */

static uint32_t confidence_offered(const sv_plugin *plugin) {
    return hs_guard_of(plugin)->offered;
}

static sv_status confidence_write(const sv_plugin *plugin, float *map, struct _cl_mem *object,
                                  uint64_t offset) {
    hs_guard *guard = hs_guard_of(plugin);
    (void)offset;
    if (!map || object) return SV_ERR_ARGUMENT;
    if (!follow(guard, HS_GUARD_CONFIDENCE)) return SV_ERR_INTERNAL;
    const sv_status status = guard->block->confidence;
    if (status == SV_OK)
        memcpy(map, hs_guard_map_of(guard, HS_GUARD_SURE_MAP), guard->pixels * sizeof *map);
    else
        hs_guard_note_error(guard);
    return status;
}

static sv_status confidence_read(const sv_plugin *plugin, float *map, sv_confidence_report *out) {
    hs_guard *guard = hs_guard_of(plugin);
    const sv_status status = hs_guard_ask(guard, HS_GUARD_SURE, guard->options.frame_s);
    if (status != SV_OK) return status;
    const sv_confidence_report sure = guard->block->sure;
    if (map) memcpy(map, hs_guard_map_of(guard, HS_GUARD_SURE_MAP), guard->pixels * sizeof *map);
    if (out) give(out, out->size, &sure, sizeof sure);
    guard->settled &= ~(uint32_t)HS_GUARD_CONFIDENCE;
    return SV_OK;
}

/* ------------------------------------------------------------------------------------ timing, spline -- */

static sv_status timing_enable(const sv_plugin *plugin, uint32_t on) {
    hs_guard *guard = hs_guard_of(plugin);
    guard->block->number = on;
    return hs_guard_ask(guard, HS_GUARD_TIME, guard->options.frame_s);
}

static sv_status timing_stage_times(const sv_plugin *plugin, sv_stage_times *out) {
    hs_guard *guard = hs_guard_of(plugin);
    const sv_status status = hs_guard_ask(guard, HS_GUARD_TIMES, guard->options.frame_s);
    const sv_stage_times times = guard->block->times;
    if (status == SV_OK) give(out, out->size, &times, sizeof times);
    return status;
}

static sv_status spline_report(const sv_plugin *plugin, sv_spline_report *out) {
    hs_guard *guard = hs_guard_of(plugin);
    const sv_status status = hs_guard_ask(guard, HS_GUARD_SPLINE, guard->options.frame_s);
    const sv_spline_report spline = guard->block->spline;
    if (status == SV_OK) give(out, out->size, &spline, sizeof spline);
    return status;
}

const void *hs_guarded_extension(const sv_plugin *plugin, const char *id) {
    static const sv_ext_timing timing = {
        .size = sizeof timing, .enable = timing_enable, .stage_times = timing_stage_times};
    static const sv_ext_points points = {.size = sizeof points, .write = points_write};
    static const sv_ext_confidence confidence = {.size = sizeof confidence,
                                                 .read = confidence_read,
                                                 .offered = confidence_offered,
                                                 .write = confidence_write};
    static const sv_ext_spline spline = {.size = sizeof spline, .report = spline_report};
    const struct {
        const char *id;
        uint32_t bit;
        const void *table;
    } known[] = {{SV_EXT_TIMING, HS_GUARD_HAS_TIMING, &timing},
                 {SV_EXT_POINTS, HS_GUARD_HAS_POINTS, &points},
                 {SV_EXT_CONFIDENCE, HS_GUARD_HAS_CONFIDENCE, &confidence},
                 {SV_EXT_SPLINE, HS_GUARD_HAS_SPLINE, &spline}};
    const uint32_t has = hs_guard_of(plugin)->facts.extensions;
    for (size_t i = 0; i < sizeof known / sizeof *known; i++)
        if (strcmp(id, known[i].id) == 0) return has & known[i].bit ? known[i].table : NULL;
    return NULL;
}
