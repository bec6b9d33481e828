/* SPDX-License-Identifier: MIT */
/* Frames: the calls one by one or all together, and what came out. */
#include "validate/drive/drive.h"

#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

void v_map_check_depths(v_run *run, const v_map *map, uint32_t slices, const char *what) {
    const rule_sink to = v_sink(run);
    const rule_map judged = {
        .width = map->width, .height = map->height, .slices = slices, .depth = map->depth};
    rule_depths(&to, &judged, what);
}

const char *v_map_difference(const v_map *a, const v_map *b) {
    static _Thread_local char texts[2][160];
    static _Thread_local uint32_t turn;
    char *text = texts[turn++ % 2];
    for (uint32_t i = 0; i < a->width * a->height; i++) {
        const bool same = memcmp(&a->depth[i], &b->depth[i], sizeof *a->depth) == 0;
        if (same && a->status[i] == b->status[i]) continue;
        (void)snprintf(text, sizeof texts[0], "%s of ray (%u, %u) is %.9g and %.9g",
                       same ? "the status" : "the depth", i % a->width, i / a->width,
                       same ? a->status[i] : (double)a->depth[i], same ? b->status[i] : (double)b->depth[i]);
        return text;
    }
    if (a->outcome == b->outcome) return NULL;
    (void)snprintf(text, sizeof texts[0], "the outcome is %s and %s", v_status(a->outcome),
                   v_status(b->outcome));
    return text;
}

void v_map_expect(v_run *run, const v_map *wanted, const v_map *map, const char *format, ...) {
    const char *difference = v_map_difference(wanted, map);
    char text[256];
    va_list arguments;
    va_start(arguments, format);
    (void)vsnprintf(text, sizeof text, format, arguments);
    va_end(arguments);
    V_EXPECT(run, !difference, "%s: %s", text, difference);
}

static v_run *run_of(const stage *st) {
    return st->data;
}

/* ---- single calls */
void v_activate(v_subject *s, const sv_plugin *p, const stage *st) {
    v_where(s->run, "activate (%u x %u x %u)", st->format.width, st->format.height, st->format.slices);
    const sv_status status = p->activate(p, &st->format);
    V_EXPECT(s->run, status == SV_OK, "activate (%u x %u x %u): %s: %s", st->format.width, st->format.height,
             st->format.slices, v_status(status), p->last_error(p));
}

void v_deactivate(v_subject *s, const sv_plugin *p) {
    v_where(s->run, "deactivate");
    p->deactivate(p);
}

static void add_values(v_run *run, const sv_param_value *values, uint32_t count) {
    v_report *report = run->report;
    const v_params *known = run->params;
    size_t used = strlen(report->values);
    for (uint32_t i = 0; values && i < count && used < sizeof report->values; i++) {
        char id[24];
        const char *key = id;
        (void)snprintf(id, sizeof id, "parameter %u", values[i].id);
        for (uint32_t n = 0; known && n < known->count; n++)
            if (known->info[n].id == values[i].id) key = known->info[n].key;
        used += (size_t)snprintf(report->values + used, sizeof report->values - used, "%s%.60s = %g",
                                 used ? ", " : "", key, values[i].value);
    }
}

/* The frame's values, for a call that does not come back. */
static void tell_values(const stage *st, const sv_param_value *values, uint32_t count) {
    v_run *run = run_of(st);
    char *said = run->report->values;
    said[0] = '\0';
    add_values(run, st->way.fixed, st->way.fixed_count);
    add_values(run, values, count);
    if (!said[0]) (void)snprintf(said, sizeof run->report->values, "the defaults");
}

/* The call is over: what comes next is the check's own. */
static sv_status came_back(const stage *st, sv_status status) {
    atomic_store(&run_of(st)->report->since_ns, 0);
    return status;
}

sv_status v_begin(const sv_plugin *p, stage *st, const sv_param_value *values, uint32_t count) {
    const sv_frame frame = stage_frame(st, values, count);
    tell_values(st, values, count);
    v_where_frame(run_of(st), "begin");
    return came_back(st, p->begin(p, &frame));
}

sv_status v_slab(const sv_plugin *p, stage *st, uint32_t n) {
    const sv_slab slab = stage_slab(st, n);
    v_where_frame(run_of(st), "slab (slices %u to %u)", slab.first_slice,
                  slab.first_slice + slab.slice_count - 1);
    return came_back(st, p->slab(p, &slab));
}

sv_status v_end(const sv_plugin *p, stage *st) {
    const sv_result result = stage_result(st);
    stage_poison(st, STAGE_POISON);
    v_where_frame(run_of(st), "end");
    return came_back(st, p->end(p, &result));
}

sv_status v_adjust(const sv_plugin *p, stage *st, const sv_param_value *values, uint32_t count) {
    const sv_result result = stage_result(st);
    stage_poison(st, STAGE_POISON);
    tell_values(st, values, count);
    v_where_frame(run_of(st), "adjust");
    return came_back(st, p->adjust(p, values, count, &result));
}

static void finish(stage *st) {
    if (!st->device.queue) return;
    v_where_frame(run_of(st), "the host's clFinish after end");
    const cl_int code = clFinish(st->device.queue);
    (void)came_back(st, SV_OK);
    V_EXPECT(run_of(st), code == CL_SUCCESS, "clFinish after end: OpenCL error %d", (int)code);
}

v_map v_collect(stage *st, sv_status returned) {
    const size_t rays = (size_t)st->format.width * st->format.height, row = st->format.width * sizeof(float);
    const sv_result r = stage_result(st);
    finish(st);
    v_map out = {.width = st->format.width,
                 .height = st->format.height,
                 .depth = v_memory(run_of(st), rays * sizeof(float)),
                 .status = v_memory(run_of(st), rays),
                 .returned = returned};
    memcpy(out.status, r.status, rays);
    memcpy(&out.stats, r.stats, sizeof out.stats);
    out.outcome = returned >= 0 && st->device.queue ? out.stats.outcome : returned;
    for (uint32_t y = 0; y < st->format.height && !r.depth_object; y++)
        memcpy(out.depth + (size_t)y * st->format.width, (const uint8_t *)r.depth + y * st->row_bytes, row);
    if (!r.depth_object) return out;
    const cl_int code = clEnqueueReadBuffer(st->device.queue, r.depth_object, CL_TRUE, r.depth_offset,
                                            rays * sizeof(float), out.depth, 0, NULL, NULL);
    V_EXPECT(run_of(st), code == CL_SUCCESS, "the map's buffer cannot be read: OpenCL error %d", (int)code);
    return out;
}

/* ---- whole frames */
sv_status v_feed(const sv_plugin *p, stage *st, const sv_param_value *values, uint32_t count) {
    sv_status status = v_begin(p, st, values, count);
    for (uint32_t n = 0; n < st->slab_count && status >= 0; n++) status = v_slab(p, st, n);
    return status;
}

sv_status v_try_frame(const sv_plugin *p, stage *st, const sv_param_value *values, uint32_t count,
                      v_map *out) {
    sv_status status = v_feed(p, st, values, count);
    if (status >= 0) status = v_end(p, st);
    if (status < 0)
        finish(st);
    else
        *out = v_collect(st, status);
    return status;
}

v_map v_frame(v_subject *s, const sv_plugin *p, stage *st, const sv_param_value *values, uint32_t count) {
    v_map out;
    const sv_status status = v_try_frame(p, st, values, count, &out);
    V_EXPECT(s->run, status >= 0, "%s of a good frame (%u x %u x %u): %s: %s", s->run->report->where,
             st->format.width, st->format.height, st->format.slices, v_status(status), p->last_error(p));
    return out;
}

/* ---- all together */
v_rig *v_rig_open(v_run *run) {
    run->rig = v_memory(run, sizeof *run->rig);
    v_open(run, &run->rig->s);
    return run->rig;
}

v_rig *v_rig_open_bare(v_run *run) {
    run->rig = v_memory(run, sizeof *run->rig);
    v_open_bare(run, &run->rig->s);
    return run->rig;
}

void v_rig_again(v_rig *r, const stage_way *way) {
    if (r->stage.data) v_rig_drop(r);
    if (!way->own_queue && !r->device.context) v_device_open(r->s.run, &r->device);
    v_stage_make(r->s.run, &r->stage, way, &r->device);
    v_stage_fill(&r->stage, &r->volume);
    v_activate(&r->s, r->s.plugin, &r->stage);
}

void v_rig_set(v_rig *r, const stage_way *way, v_kind kind) {
    v_volume_make(r->s.run, &r->volume, kind, way->width, way->height, way->slices);
    v_rig_again(r, way);
}

void v_rig_fill(v_rig *r, v_kind kind) {
    const stage_way *way = &r->stage.way;
    v_volume_make(r->s.run, &r->volume, kind, way->width, way->height, way->slices);
    v_stage_fill(&r->stage, &r->volume);
}

void v_rig_drop(v_rig *r) {
    v_deactivate(&r->s, r->s.plugin);
    stage_free(&r->stage);
}

void v_rig_close(v_rig *r) {
    if (!r) return;
    if (r->stage.data) v_rig_drop(r);
    r->s.run->rig = NULL;
    v_close(&r->s);
    v_device_close(&r->device);
}

v_rig *v_rig_standard(v_run *run) {
    v_rig *r = v_rig_open(run);
    const stage_way way = v_standard_way(&r->s);
    v_rig_set(r, &way, V_LAYERS);
    return r;
}

v_rig *v_rig_good(v_run *run) {
    v_rig *r = v_rig_standard(run);
    r->good = v_rig_frame(r, NULL, 0);
    return r;
}

v_map v_rig_frame(v_rig *r, const sv_param_value *values, uint32_t count) {
    return v_frame(&r->s, r->s.plugin, &r->stage, values, count);
}

void v_rig_expect(v_rig *r, const v_map *wanted, const char *format, ...) {
    char text[256];
    v_map map;
    va_list arguments;
    va_start(arguments, format);
    (void)vsnprintf(text, sizeof text, format, arguments);
    va_end(arguments);
    const sv_status status = v_try_frame(r->s.plugin, &r->stage, NULL, 0, &map);
    V_EXPECT(r->s.run, status >= 0, "%s: %s: %s: %s", text, r->s.run->report->where, v_status(status),
             r->s.plugin->last_error(r->s.plugin));
    v_map_expect(r->s.run, wanted, &map, "%s", text);
}
