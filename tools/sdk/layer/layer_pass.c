/* SPDX-License-Identifier: MIT */
/* Every call of an instance: judged, passed on, judged again. */
#include "layer/layer.h"

#include "smartvis/lookup.h"

#include <fenv.h>
#include <locale.h>
#include <time.h>

static ly_instance *of(const sv_plugin *plugin) {
    return (ly_instance *)(uintptr_t)plugin; /* api is the first member */
}

uint64_t ly_now(void) {
    struct timespec t;
    (void)clock_gettime(CLOCK_MONOTONIC, &t);
    return (uint64_t)t.tv_sec * 1000000000u + (uint64_t)t.tv_nsec;
}

/* ---- one call */
static sv_status forward(const sv_plugin *p, const rc_call *c) {
    switch (c->kind) {
    case RC_ACTIVATE:
        return p->activate(p, c->format);
    case RC_BEGIN:
        return p->begin(p, c->frame);
    case RC_SLAB:
        return p->slab(p, c->slab);
    case RC_END:
        return p->end(p, c->result);
    case RC_ADJUST:
        return p->adjust(p, c->values, c->value_count, c->result);
    default:
        p->deactivate(p);
        return SV_OK;
    }
}

static bool is_frames(rc_kind kind) {
    return kind >= RC_BEGIN;
}

/* By what the header says of every call's return. `due` is the error that the plugin owes, and why. */
static void judge_status(ly_instance *i, const rc_call *c, sv_status due, const char *why) {
    const rule_sink *to = &i->called;
    const char *call = ly_call_names[c->kind], *name = sv_lookup_status(c->status);
    const bool delivers = c->kind == RC_END || c->kind == RC_ADJUST;
    RULE_EXPECT(to, RULE_frame_outcome, name && (delivers || c->status <= SV_OK), "%s: returns %s (%d)", call,
                name ? name : "a status that nobody knows", (int)c->status);
    if (c->kind == RC_DEACTIVATE || atomic_load(&i->lost)) return;
    RULE_EXPECT(to, ly_rule_of_refusal(i, c, due), due == SV_OK || c->status < SV_OK,
                "%s: returns %s, and %s was due: %s", call, name, sv_lookup_status(due), why);
    RULE_EXPECT(to, ly_rule_of_refusal(i, c, c->status),
                due != SV_OK || (c->status != SV_ERR_STATE && c->status != SV_ERR_SIZE &&
                                 c->status != SV_ERR_SLAB_ORDER && c->status != SV_ERR_SLAB_MISSING),
                "%s: returns %s for a call that the header allows", call, name);
}

static void judge_reason(ly_instance *i, const rc_call *c) {
    const rule_sink *to = &i->called;
    if (c->kind == RC_DEACTIVATE) return;
    const char *call = ly_call_names[c->kind], *reason = i->inner->last_error(i->inner);
    RULE_EXPECT(to, RULE_reasons, reason, "%s: last_error is NULL", call);
    RULE_EXPECT(to, RULE_reasons, c->status >= SV_OK || reason[0], "%s: returns %s, and last_error is empty",
                call, sv_lookup_status(c->status));
    RULE_EXPECT(to, RULE_reasons, c->status != SV_OK || !reason[0],
                "%s: returns SV_OK, and last_error is \"%.100s\"", call, reason);
}

enum { LOCALE_BYTES = 256 };
static void judge_process(ly_instance *i, const rc_call *c, int rounding, const char *locale) {
    const rule_sink *to = &i->called;
    const char *call = ly_call_names[c->kind];
    RULE_EXPECT(to, RULE_frame_path_time, !is_frames(c->kind) || c->took_ns <= i->slow_ns,
                "%s: took %.1f ms, SMARTVIS_CHECK_MS is %.1f", call, (double)c->took_ns * 1e-6,
                (double)i->slow_ns * 1e-6);
    RULE_EXPECT(to, RULE_process_untouched, rounding == fegetround(),
                "%s: leaves the rounding mode %d behind, it was %d", call, fegetround(), rounding);
    RULE_EXPECT(to, RULE_process_untouched,
                !locale || strncmp(locale, setlocale(LC_ALL, NULL), LOCALE_BYTES - 1) == 0,
                "%s: changes the locale to %.100s", call, setlocale(LC_ALL, NULL));
    if (is_frames(c->kind)) return;
    RULE_EXPECT(to, RULE_descriptor_constant, memcmp(&i->told, i->inner->descriptor, sizeof i->told) == 0,
                "%s: the descriptor is not what it was at create", call);
}

/* The call itself, with all that is looked at around it. */
static void make_call(ly_instance *i, rc_call *c, sv_status due) {
    char why[sizeof i->shadow.reason], locale[LOCALE_BYTES];
    const bool control = !is_frames(c->kind);
    const int rounding = fegetround();
    (void)snprintf(why, sizeof why, "%s", i->shadow.reason);
    if (control) (void)snprintf(locale, sizeof locale, "%s", setlocale(LC_ALL, NULL));
    c->start_ns = ly_now();
    if (i->record) rec_before(i->record, c);
    ly_watch_before(i, c);
    const uint64_t handed_on = ly_now();
    c->status = forward(i->inner, c);
    c->took_ns = ly_now() - handed_on;
    if (i->record) rec_after(i->record, c); /* what the plugin wrote, before the layer mends it */
    ly_watch_after(i, c);
    if (i->record && rec_why(i->record)[0] && !i->told_record && i->outer->log)
        i->outer->log(i->outer, SV_LOG_WARNING, rec_why(i->record));
    i->told_record = i->record && rec_why(i->record)[0];
    judge_status(i, c, due, why);
    judge_reason(i, c);
    judge_process(i, c, rounding, control ? locale : NULL);
    ly_times *t = &i->times[c->kind];
    t->count++;
    t->sum_ns += c->took_ns;
    if (c->took_ns > t->longest_ns) t->longest_ns = c->took_ns;
}

/* False if another call of the instance is under way. What is not atomic is that one's. */
static bool enter(ly_instance *i, const char *call) {
    if (!atomic_flag_test_and_set(&i->busy)) return true;
    atomic_store(&i->lost, true);
    rule_tell(&i->asked, RULE_host_threads, "%s: comes while another call of this instance is under way",
              call);
    return false;
}

static void leave(ly_instance *i, bool entered) {
    if (entered) atomic_flag_clear(&i->busy);
}

static void tell_times(ly_instance *i) {
    char text[400];
    size_t used = 0;
    for (int k = RC_ACTIVATE; k < RC_CALLS; k++) {
        const ly_times *t = &i->times[k];
        if (t->count == 0 || k == RC_DEACTIVATE) continue;
        used += (size_t)snprintf(text + used, sizeof text - used, "%s%s %.3f (%.3f)", used ? ", " : "",
                                 ly_call_names[k], (double)t->sum_ns * 1e-6 / (double)t->count,
                                 (double)t->longest_ns * 1e-6);
    }
    if (used)
        ly_log(i, SV_LOG_INFO, "%llu frames; milliseconds of a call, mean (longest): %s",
               (unsigned long long)i->times[RC_END].count, text);
    memset(i->times, 0, sizeof i->times);
}

/* What activate took is given back, before the host and in a recording. */
static void undo_activate(ly_instance *i) {
    rc_call c = {.kind = RC_DEACTIVATE, .plugin = i->inner, .sound = true};
    make_call(i, &c, SV_OK);
}

static sv_status pass(ly_instance *i, rc_call *c) {
    if (!enter(i, ly_call_names[c->kind]))
        return i->stops && c->kind != RC_DEACTIVATE ? SV_ERR_STATE : forward(i->inner, c);
    i->found = false;
    i->stopped = SV_OK;
    ly_watch_harvest(i, c->kind == RC_DEACTIVATE);
    const bool lost = atomic_load(&i->lost);
    const sv_status due = lost ? SV_OK : ly_judge_host(i, c);
    c->plugin = i->inner;
    c->sound = due == SV_OK && !lost;
    if (i->stopped == SV_OK || c->kind == RC_DEACTIVATE) make_call(i, c, due);
    if (i->stopped != SV_OK) {
        if (c->kind == RC_ACTIVATE && c->start_ns > 0 && c->status >= SV_OK) undo_activate(i);
        c->status = i->stopped = due != SV_OK ? due : i->stopped;
    }
    ly_follow(i, c);
    if (c->kind == RC_DEACTIVATE) tell_times(i);
    const sv_status status = c->status;
    leave(i, true);
    return status;
}

/* ---- [control] and [frame] */
static sv_status SV_CALL ly_activate(const sv_plugin *plugin, const sv_format *format) {
    return pass(of(plugin), &(rc_call){.kind = RC_ACTIVATE, .format = format});
}

static void SV_CALL ly_deactivate(const sv_plugin *plugin) {
    (void)pass(of(plugin), &(rc_call){.kind = RC_DEACTIVATE});
}

static sv_status SV_CALL ly_begin(const sv_plugin *plugin, const sv_frame *frame) {
    return pass(of(plugin), &(rc_call){.kind = RC_BEGIN, .frame = frame});
}

static sv_status SV_CALL ly_slab(const sv_plugin *plugin, const sv_slab *slab) {
    return pass(of(plugin), &(rc_call){.kind = RC_SLAB, .slab = slab});
}

static sv_status SV_CALL ly_end(const sv_plugin *plugin, const sv_result *result) {
    return pass(of(plugin), &(rc_call){.kind = RC_END, .result = result});
}

static sv_status SV_CALL ly_adjust(const sv_plugin *plugin, const sv_param_value *values, uint32_t count,
                                   const sv_result *result) {
    return pass(of(plugin),
                &(rc_call){.kind = RC_ADJUST, .values = values, .value_count = count, .result = result});
}

static const char *SV_CALL ly_last_error(const sv_plugin *plugin) {
    const ly_instance *i = of(plugin);
    return i->stopped != SV_OK ? i->reason : i->inner->last_error(i->inner);
}

/* ---- [any] */
static uint32_t SV_CALL ly_param_count(const sv_plugin *plugin) {
    return of(plugin)->inner->param_count(of(plugin)->inner);
}

/* The plugin writes into memory of the layer's, so that what it writes behind is seen. */
static sv_status SV_CALL ly_param_info(const sv_plugin *plugin, uint32_t index, sv_param_info *out) {
    struct {
        sv_param_info info;
        uint8_t behind[64];
    } room;
    ly_instance *i = of(plugin);
    if (!out || out->size != sizeof *out) return i->inner->param_info(i->inner, index, out);
    memset(&room, 0x5a, sizeof room);
    room.info = *out;
    const sv_status status = i->inner->param_info(i->inner, index, &room.info);
    size_t behind = 0;
    while (behind < sizeof room.behind && room.behind[behind] == 0x5a) behind++;
    *out = room.info;
    if (behind < sizeof room.behind)
        rule_tell(&i->asked, RULE_param_info_calls, "param_info: writes behind the %u bytes of its struct",
                  (unsigned)sizeof *out);
    if (status >= SV_OK && index >= i->inner->param_count(i->inner))
        rule_tell(&i->asked, RULE_param_info_calls,
                  "param_info: index is %u, param_count is %u, and it returns SV_OK", index,
                  i->inner->param_count(i->inner));
    return status;
}

static sv_status SV_CALL ly_param_text(const sv_plugin *plugin, uint32_t id, double value, char *out,
                                       uint32_t bytes) {
    enum { MAX_BYTES = 256, BEHIND = 64 };
    char room[MAX_BYTES + BEHIND];
    ly_instance *i = of(plugin);
    if (!out || bytes == 0 || bytes > MAX_BYTES) return i->inner->param_text(i->inner, id, value, out, bytes);
    memset(room, 0x5a, sizeof room);
    const sv_status status = i->inner->param_text(i->inner, id, value, room, bytes);
    size_t behind = bytes;
    while (behind < bytes + BEHIND && room[behind] == 0x5a) behind++;
    if (behind < bytes + BEHIND)
        rule_tell(&i->asked, RULE_param_text, "param_text: id is %u, and it writes behind the %u bytes", id,
                  bytes);
    const bool ends = memchr(room, '\0', bytes) != NULL;
    if (status >= SV_OK && !ends)
        rule_tell(&i->asked, RULE_param_text, "param_text: id is %u, and no NUL is in the %u bytes", id,
                  bytes);
    if (status >= SV_OK || ends) memcpy(out, room, bytes);
    return status;
}

/* ---- extensions: their functions are given the plugin's own instance */
/* Their calls are [control] or [frame], too. */
#define PASS_ON(plugin, name, type, expression)                                                              \
    ly_instance *i = of(plugin);                                                                             \
    const bool entered = enter(i, name);                                                                     \
    const type result = expression;                                                                          \
    leave(i, entered)

static sv_status SV_CALL ly_confidence_read(const sv_plugin *plugin, float *map, sv_confidence_report *out) {
    PASS_ON(plugin, "confidence read", sv_status, i->inner_confidence->read(i->inner, map, out));
    if (result == SV_OK && map && entered)
        judge_confidence(&i->asked, map, i->shadow.format.width, i->shadow.format.height, "confidence read");
    return result;
}

static uint32_t SV_CALL ly_confidence_offered(const sv_plugin *plugin) {
    PASS_ON(plugin, "confidence offered", uint32_t, i->inner_confidence->offered(i->inner));
    return result;
}

static sv_status SV_CALL ly_confidence_write(const sv_plugin *plugin, float *map, struct _cl_mem *object,
                                             uint64_t offset) {
    PASS_ON(plugin, "confidence write", sv_status, i->inner_confidence->write(i->inner, map, object, offset));
    if (result == SV_OK && map && entered && !i->shadow.format.queue)
        judge_confidence(&i->asked, map, i->shadow.format.width, i->shadow.format.height, "confidence write");
    return result;
}

static sv_status SV_CALL ly_needs_of(const sv_plugin *plugin, const sv_format *format,
                                     const sv_param_value *values, uint32_t count,
                                     const sv_needs_device *device, sv_needs *out) {
    PASS_ON(plugin, "needs of", sv_status, i->inner_needs->of(i->inner, format, values, count, device, out));
    return result;
}

static sv_status SV_CALL ly_points_write(const sv_plugin *plugin, sv_points_report *out) {
    PASS_ON(plugin, "points write", sv_status, i->inner_points->write(i->inner, out));
    return result;
}

static sv_status SV_CALL ly_spline_report(const sv_plugin *plugin, sv_spline_report *out) {
    PASS_ON(plugin, "spline report", sv_status, i->inner_spline->report(i->inner, out));
    return result;
}

static sv_status SV_CALL ly_timing_enable(const sv_plugin *plugin, uint32_t on) {
    PASS_ON(plugin, "timing enable", sv_status, i->inner_timing->enable(i->inner, on));
    return result;
}

static sv_status SV_CALL ly_timing_stage_times(const sv_plugin *plugin, sv_stage_times *out) {
    PASS_ON(plugin, "timing stage_times", sv_status, i->inner_timing->stage_times(i->inner, out));
    return result;
}

/* True if the descriptor names the extension. */
static bool is_announced(const ly_instance *i, const char *id) {
    const char *const *known = i->inner->descriptor->extensions;
    for (; known && *known; known++)
        if (strcmp(*known, id) == 0) return true;
    return false;
}

static const void *SV_CALL ly_get_extension(const sv_plugin *plugin, const char *id) {
    ly_instance *i = of(plugin);
    const void *table = i->inner->get_extension(i->inner, id);
    if (!table || !id) return NULL;
    if (!is_announced(i, id)) {
        rule_tell(&i->asked, RULE_extensions,
                  "get_extension: there is a table for \"%.60s\", which the descriptor does not name", id);
        return NULL;
    }
    if (strcmp(id, SV_EXT_CONFIDENCE) == 0) return &i->confidence;
    if (strcmp(id, SV_EXT_NEEDS) == 0) return &i->needs;
    if (strcmp(id, SV_EXT_POINTS) == 0) return &i->points;
    if (strcmp(id, SV_EXT_SPLINE) == 0) return &i->spline;
    if (strcmp(id, SV_EXT_TIMING) == 0) return &i->timing;
    ly_log(i, SV_LOG_INFO, "get_extension: the layer does not know \"%.60s\" and leaves it out", id);
    return NULL;
}

/* The plugin's table of an extension, and a copy in `own` for the host, of the plugin's size at most. */
static const void *find_table(const ly_instance *i, const char *id, void *own, uint32_t bytes) {
    const uint32_t *table = is_announced(i, id) ? i->inner->get_extension(i->inner, id) : NULL;
    if (table) *(uint32_t *)own = *table < bytes ? *table : bytes;
    return table;
}

static void fill_extensions(ly_instance *i) {
    i->confidence = (sv_ext_confidence){0, 0, ly_confidence_read, ly_confidence_offered, ly_confidence_write};
    i->needs = (sv_ext_needs){0, 0, ly_needs_of};
    i->points = (sv_ext_points){0, 0, ly_points_write};
    i->spline = (sv_ext_spline){0, 0, ly_spline_report};
    i->timing = (sv_ext_timing){0, 0, ly_timing_enable, ly_timing_stage_times};
    i->inner_confidence = find_table(i, SV_EXT_CONFIDENCE, &i->confidence, sizeof i->confidence);
    i->inner_needs = find_table(i, SV_EXT_NEEDS, &i->needs, sizeof i->needs);
    i->inner_points = find_table(i, SV_EXT_POINTS, &i->points, sizeof i->points);
    i->inner_spline = find_table(i, SV_EXT_SPLINE, &i->spline, sizeof i->spline);
    i->inner_timing = find_table(i, SV_EXT_TIMING, &i->timing, sizeof i->timing);
}

void ly_fill_calls(ly_instance *i) {
    i->api.activate = ly_activate;
    i->api.deactivate = ly_deactivate;
    i->api.begin = ly_begin;
    i->api.slab = ly_slab;
    i->api.end = ly_end;
    i->api.adjust = ly_adjust;
    i->api.param_count = ly_param_count;
    i->api.param_info = ly_param_info;
    i->api.param_text = ly_param_text;
    i->api.last_error = ly_last_error;
    i->api.get_extension = ly_get_extension;
    fill_extensions(i);
}
