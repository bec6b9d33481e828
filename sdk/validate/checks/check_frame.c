/* SPDX-License-Identifier: MIT */
/* Checks of what a frame gives. */
#include "validate/checks/check.h"

#include "core/progress.h"
#include "plugin/loader.h"
#include "smartvis/confidence.h"

#include <stdlib.h>

void check_first_frame(v_run *run) {
    v_rig *r = v_rig_standard(run);
    for (int i = 0; i < 3; i++) { /* the first may compile what activate has not launched */
        (void)v_rig_frame(r, NULL, 0);
        atomic_store(&run->report->warm, true);
    }
}

static int by_size(const void *a, const void *b) {
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

/* With the host's queue a frame has ended when that is empty. */
void check_frame_time(v_run *run) {
    enum { SIDE = 128, FRAMES = 9 };
    const double allowed = 1.0 / 20.0; /* docs/spec.md */
    double seconds[FRAMES];
    v_rig *r = v_rig_open(run);
    const stage_way way = v_sized(v_standard_way(&r->s), SIDE, SIDE, SIDE);
    v_rig_set(r, &way, V_LAYERS);
    (void)v_rig_frame(r, NULL, 0);
    for (int i = 0; i < FRAMES; i++) {
        const double start = hs_now();
        (void)v_rig_frame(r, NULL, 0);
        seconds[i] = hs_now() - start;
    }
    qsort(seconds, FRAMES, sizeof *seconds, by_size);
    if (seconds[FRAMES / 2] > allowed)
        v_warn(run, "a frame of %d x %d x %d takes %.0f ms (median of %d), 20 volumes a second leave %.0f",
               SIDE, SIDE, SIDE, seconds[FRAMES / 2] * 1e3, FRAMES, allowed * 1e3);
}

/* A frame of a volume of this kind, from activation to deactivation. */
static v_map frame_of(v_rig *r, const stage_way *way, v_kind kind) {
    v_rig_set(r, way, kind);
    return v_rig_frame(r, NULL, 0);
}

void check_depth_values(v_run *run) {
    v_rig *r = v_rig_open(run);
    const stage_way way = v_standard_way(&r->s);
    for (int kind = 0; kind < V_KINDS; kind++) {
        char what[64];
        (void)snprintf(what, sizeof what, "a %s volume", v_kind_name((v_kind)kind));
        const v_map map = frame_of(r, &way, (v_kind)kind);
        v_map_check_depths(run, &map, way.slices, what);
    }
}

/* ---- outcome and statistics */
static rule_map judged_map(const v_map *map, const stage_way *way) {
    return (rule_map){map->width,  map->height, way->slices,   map->depth,
                      map->status, &map->stats, map->returned, way->own_queue};
}

void check_frame_outcome(v_run *run) {
    const rule_sink to = v_sink(run);
    v_rig *r = v_rig_open(run);
    const stage_way way = v_standard_way(&r->s);
    for (int kind = 0; kind < V_KINDS; kind++) {
        const sv_plugin *p = r->s.plugin;
        v_rig_set(r, &way, (v_kind)kind);
        sv_status status = v_begin(p, &r->stage, NULL, 0);
        V_EXPECT(run, status == SV_OK, "begin: %s, expected SV_OK", v_status(status));
        for (uint32_t n = 0; n < r->stage.slab_count; n++) {
            status = v_slab(p, &r->stage, n);
            V_EXPECT(run, status == SV_OK, "slab %u: %s, expected SV_OK", n, v_status(status));
        }
        status = v_end(p, &r->stage);
        V_EXPECT(run, hs_status_is_known(status), "end: %s", v_status(status));
        V_EXPECT(run, status >= 0, "end of a %s volume: %s: %s", v_kind_name((v_kind)kind), v_status(status),
                 p->last_error(p));
        const v_map map = v_collect(&r->stage, status);
        const rule_map judged = judged_map(&map, &way);
        rule_outcome(&to, &judged, v_kind_name((v_kind)kind));
    }
}

void check_frame_statistics(v_run *run) {
    const rule_sink to = v_sink(run);
    v_rig *r = v_rig_open(run);
    const stage_way way = v_standard_way(&r->s);
    for (int kind = 0; kind < V_KINDS; kind++) {
        const v_map map = frame_of(r, &way, (v_kind)kind);
        const rule_map judged = judged_map(&map, &way);
        rule_statistics(&to, &judged);
    }
}

/* ---- where results are written */
static void try_bands(v_rig *r, uint8_t byte, bool all) {
    const sv_plugin *p = r->s.plugin;
    stage *st = &r->stage;
    v_run *run = r->s.run;
    sv_status status = v_feed(p, st, NULL, 0);
    sv_result result = stage_result(st);
    stage_poison(st, byte);
    if (!all) {
        result.status = NULL;
        result.stats = NULL;
    }
    v_where(run, "end with guard bands");
    if (status >= 0) status = p->end(p, &result);
    V_EXPECT(run, status >= 0, "%s: %s: %s", run->report->where, v_status(status), p->last_error(p));
    const v_map map = v_collect(st, status);
    const char *place = stage_trespass(st, byte);
    V_EXPECT(run, !place, "end: surface wrote beyond its %u rays: %s", st->format.width * st->format.height,
             place);
    v_map_check_depths(run, &map, st->format.slices,
                       st->way.pitch ? "with a depth_pitch" : "without a depth_pitch");
    for (uint32_t i = 0; !all && i < map.width * map.height; i++)
        V_EXPECT(run, map.status[i] == byte, "end writes a status map where none was asked for");
}

void check_guard_bands(v_run *run) {
    v_rig *r = v_rig_open(run);
    stage_way way = v_standard_way(&r->s);
    for (uint32_t pitch = 0; pitch <= 7; pitch += 7) {
        way.pitch = pitch;
        v_rig_set(r, &way, V_LAYERS);
        try_bands(r, 0xff, true);
        try_bands(r, 0xfe, true);
        try_bands(r, 0xff, false);
    }
    way = v_standard_way(&r->s);
    way.depth_object = !way.own_queue;
    if (way.depth_object) {
        v_rig_set(r, &way, V_LAYERS);
        try_bands(r, 0xff, true);
        try_bands(r, 0xfe, true);
        try_bands(r, 0xff, false);
    }
}

/* ---- shapes and contents */
void check_frame_shapes(v_run *run) {
    static const struct {
        uint32_t width, height, slices, longest, tiles;
    } shapes[] = {{1, 1, 1, 1, 1},   {1, 1, 9, 4, 2},  {17, 1, 6, 6, 3},  {1, 13, 6, 2, 1},   {3, 2, 1, 1, 1},
                  {33, 31, 2, 1, 1}, {65, 5, 3, 3, 5}, {2, 63, 17, 5, 2}, {128, 3, 40, 40, 7}};
    v_rig *r = v_rig_open(run);
    for (size_t i = 0; i < sizeof shapes / sizeof *shapes; i++) {
        stage_way way = v_sized(v_standard_way(&r->s), shapes[i].width, shapes[i].height, shapes[i].slices);
        char what[64];
        way.longest = shapes[i].longest;
        way.tiles_x = shapes[i].tiles;
        if (i % 2) way.extra_w = way.extra_h = way.extra_pitch = 0;
        (void)snprintf(what, sizeof what, "%u x %u x %u", way.width, way.height, way.slices);
        const v_map map = frame_of(r, &way, V_LAYERS);
        v_map_check_depths(run, &map, way.slices, what);
    }
}

void check_frame_contents(v_run *run) {
    v_rig *r = v_rig_standard(run);
    for (uint32_t turn = 0; turn < V_KINDS + run->level; turn++) {
        const v_kind kind = turn < V_KINDS ? (v_kind)turn : V_NOISE;
        v_rig_fill(r, kind);
        if (turn % 2) v_volume_narrow(&r->volume);
        if (turn % 2) v_stage_fill(&r->stage, &r->volume);
        v_where(run, "a frame of a %s volume", v_kind_name(kind));
        (void)v_rig_frame(r, NULL, 0);
    }
}

/* ---- confidence */
static const sv_ext_confidence *confidence_of(v_rig *r) {
    const sv_plugin *p = r->s.plugin;
    v_where(r->s.run, "get_extension(\"" SV_EXT_CONFIDENCE "\")");
    const sv_ext_confidence *ext = p->get_extension(p, SV_EXT_CONFIDENCE);
    if (!ext) v_skip(r->s.run, "the plugin has no " SV_EXT_CONFIDENCE);
    V_EXPECT(r->s.run, ext->read && SV_HAS(ext, offered) && ext->offered && SV_HAS(ext, write) && ext->write,
             "a function of " SV_EXT_CONFIDENCE " is NULL or missing");
    return ext;
}

/* Activates with values until the plugin offers a confidence; the defaults first, then every value of every
 * enum that only activate reads. */
static bool find_offer(v_rig *r, const sv_ext_confidence *ext, const v_params *params) {
    const sv_plugin *p = r->s.plugin;
    if (ext->offered(p)) return true;
    for (uint32_t i = 0; i < params->count; i++) {
        const sv_param_info *info = &params->info[i];
        if (info->type != SV_PARAM_ENUM || !(info->flags & SV_PARAM_REACTIVATE)) continue;
        for (uint32_t n = 0; n < v_param_values(info); n++) {
            stage_way way = v_standard_way(&r->s);
            way.fixed[0] = (sv_param_value){info->id, 0, info->min_value + n * info->step};
            if (!v_param_has(&r->s, info, way.fixed[0].value)) continue;
            way.fixed_count = 1;
            v_rig_again(r, &way);
            if (ext->offered(p)) return true;
        }
    }
    return false;
}

static void try_confidence(v_rig *r, const sv_ext_confidence *ext, v_kind kind) {
    enum { GUARD = 16 };
    v_run *run = r->s.run;
    const rule_sink to = v_sink(run);
    const sv_plugin *p = r->s.plugin;
    const size_t rays = (size_t)r->stage.format.width * r->stage.format.height;
    float *room = v_memory(run, (rays + 2 * GUARD) * sizeof *room), *map = room + GUARD;
    float *read = v_memory(run, rays * sizeof *read);
    v_rig_fill(r, kind);
    const v_map frame = v_rig_frame(r, NULL, 0);
    for (size_t i = 0; i < rays + 2 * GUARD; i++) room[i] = -7.0f;
    v_where(run, "confidence write");
    sv_status status = ext->write(p, map, NULL, 0);
    V_EXPECT(run, status == SV_OK, "confidence write: %s: %s", v_status(status), p->last_error(p));
    if (r->stage.device.queue) (void)clFinish(r->stage.device.queue);
    rule_confidence(&to, map, r->stage.format.width, r->stage.format.height, "confidence write");
    for (size_t i = 0; i < GUARD; i++)
        V_EXPECT(run, room[i] == -7.0f && map[rays + i] == -7.0f, "confidence write writes beside its map");
    v_where(run, "confidence read");
    status = ext->read(p, read, NULL);
    V_EXPECT(run, status == SV_OK, "confidence read: %s: %s", v_status(status), p->last_error(p));
    V_EXPECT(run, memcmp(read, map, rays * sizeof *map) == 0,
             "confidence read and write give different maps");
    for (size_t i = 0; i < rays; i++)
        V_EXPECT(run, frame.outcome != SV_NO_SURFACE || map[i] == 0.0f,
                 "the outcome is SV_NO_SURFACE, and a confidence is %g", (double)map[i]);
}

void check_confidence(v_run *run) {
    static v_params params;
    float one = 0.0f;
    v_rig *r = v_rig_standard(run);
    v_params_read(&r->s, &params);
    const sv_ext_confidence *ext = confidence_of(r);
    if (!find_offer(r, ext, &params)) v_skip(run, "no method of the plugin gives a confidence");
    const sv_plugin *p = r->s.plugin;
    v_where(run, "confidence before the first frame");
    V_EXPECT(run, ext->write(p, &one, NULL, 0) == SV_ERR_STATE && ext->read(p, &one, NULL) == SV_ERR_STATE,
             "a confidence is given before the first frame");
    try_confidence(r, ext, V_LAYERS);
    V_EXPECT(run, ext->write(p, NULL, NULL, 0) < 0, "confidence write into nothing succeeds");
    try_confidence(r, ext, V_NOISE);
    try_confidence(r, ext, V_BLACK);
}
