/* SPDX-License-Identifier: MIT */
/* Every call of an instance: judged, passed on, judged again. */
#include "layer/layer.h"

#include "smartvis/lookup.h"

#include <fenv.h>
#include <locale.h>
#include <time.h>

uint64_t ly_now(void) {
    struct timespec t;
    (void)clock_gettime(CLOCK_MONOTONIC, &t);
    return (uint64_t)t.tv_sec * 1000000000u + (uint64_t)t.tv_nsec;
}

/* ---- one call */
static sv_status forward(const sv_plugin *p, const rc_call *c, const sv_result *result) {
    switch (c->kind) {
    case RC_ACTIVATE:
        return p->activate(p, c->format);
    case RC_BEGIN:
        return p->begin(p, c->frame);
    case RC_SLAB:
        return p->slab(p, c->slab);
    case RC_END:
        return p->end(p, result);
    case RC_ADJUST:
        return p->adjust(p, c->values, c->value_count, result);
    default:
        p->deactivate(p);
        return SV_OK;
    }
}

static bool is_frames(rc_kind kind) {
    return kind >= RC_BEGIN;
}

/* By what the header says of every call's return. `due` is the error that the plugin owes, and why. */
static void check_status(ly_instance *i, const rc_call *c, sv_status due, const char *why) {
    const rule_sink *to = &i->called;
    const char *call = rc_names[c->kind], *name = sv_lookup_status(c->status);
    const bool delivers = c->kind == RC_END || c->kind == RC_ADJUST;
    RULE_EXPECT(to, RULE_frame_outcome, name && (delivers || c->status <= SV_OK), "%s: returns %s (%d)", call,
                name ? name : "a status that nobody knows", (int)c->status);
    if (c->kind == RC_DEACTIVATE || ly_is_lost(i)) return;
    RULE_EXPECT(to, ly_rule_of_refusal(i, c, due), due == SV_OK || c->status < SV_OK,
                "%s: returns %s, and %s was due: %s", call, name, sv_lookup_status(due), why);
    RULE_EXPECT(to, ly_rule_of_refusal(i, c, c->status),
                due != SV_OK || (c->status != SV_ERR_STATE && c->status != SV_ERR_SIZE &&
                                 c->status != SV_ERR_SLAB_ORDER && c->status != SV_ERR_SLAB_MISSING),
                "%s: returns %s for a call that the header allows", call, name);
}

void ly_check_reason(ly_instance *i, const char *call, sv_status status) {
    const rule_sink *to = &i->called;
    const char *reason = i->inner->last_error(i->inner);
    RULE_EXPECT(to, RULE_reasons, reason, "%s: last_error is NULL", call);
    const bool empty = !reason[0];
    if (ly_is_lost(i)) return; /* it may be another call's */
    RULE_EXPECT(to, RULE_reasons, status >= SV_OK || !empty, "%s: returns %s, and last_error is empty", call,
                sv_lookup_status(status));
    RULE_EXPECT(to, RULE_reasons, status != SV_OK || empty, "%s: returns SV_OK, and last_error is \"%.100s\"",
                call, reason);
}

/* A function of its own: a call that takes too long hides no other rule that it breaks. */
static void check_time(ly_instance *i, const rc_call *c) {
    RULE_EXPECT(&i->called, RULE_frame_path_time,
                !is_frames(c->kind) || c->took_ns <= i->slow_ns || ly_is_lost(i),
                "%s: took %.1f ms, SMARTVIS_CHECK_MS is %.1f", rc_names[c->kind], (double)c->took_ns * 1e-6,
                (double)i->slow_ns * 1e-6);
}

enum { LOCALE_BYTES = 256 };
static void check_process(ly_instance *i, const rc_call *c, int rounding, const char *locale) {
    const rule_sink *to = &i->called;
    const char *call = rc_names[c->kind];
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
    const char *call = rc_names[c->kind];
    const bool control = !is_frames(c->kind);
    const int rounding = fegetround();
    (void)snprintf(why, sizeof why, "%s", i->shadow.reason);
    if (control) (void)snprintf(locale, sizeof locale, "%s", setlocale(LC_ALL, NULL));
    c->start_ns = ly_now();
    if (i->record) rec_before(i->record, c);
    ly_watch_before(i, c);
    sv_result lent;
    const sv_result *result = ly_results_lend(i, c, &lent);
    const uint64_t handed_on = ly_now();
    c->status = forward(i->inner, c, result);
    c->took_ns = ly_now() - handed_on;
    if (result == &lent) ly_results_back(i, c, &lent);
    if (i->record) rec_after(i->record, c); /* what the plugin wrote, before the layer mends it */
    ly_watch_after(i, c);
    if (i->record && rec_why(i->record)[0] && !i->told_record && i->outer->log)
        i->outer->log(i->outer, SV_LOG_WARNING, rec_why(i->record));
    i->told_record = i->record && rec_why(i->record)[0];
    check_status(i, c, due, why);
    if (c->kind != RC_DEACTIVATE) ly_check_reason(i, call, c->status);
    check_time(i, c);
    check_process(i, c, rounding, control ? locale : NULL);
    ly_times *t = &i->times[c->kind];
    t->count++;
    t->sum_ns += c->took_ns;
    if (c->took_ns > t->longest_ns) t->longest_ns = c->took_ns;
}

/* What is not atomic is the other call's. */
bool ly_enter(ly_instance *i, const char *call) {
    atomic_store(&i->lines, 0);
    if (!atomic_flag_test_and_set(&i->busy)) {
        i->found = false;
        i->stopped = SV_OK;
        return true;
    }
    atomic_fetch_add(&i->beside, 1); /* in this order: pass looks at both */
    atomic_fetch_add(&i->came, 1);
    rule_tell(&i->asked, RULE_host_threads, "%s: comes while another call of this instance is under way",
              call);
    return false;
}

void ly_leave(ly_instance *i, bool entered) {
    if (entered)
        atomic_flag_clear(&i->busy);
    else
        atomic_fetch_sub(&i->beside, 1);
}

static void tell_times(ly_instance *i) {
    char text[400];
    size_t used = 0;
    for (int k = RC_ACTIVATE; k < RC_CALLS; k++) {
        const ly_times *t = &i->times[k];
        if (t->count == 0 || k == RC_DEACTIVATE) continue;
        used += (size_t)snprintf(text + used, sizeof text - used, "%s%s %.3f (%.3f)", used ? ", " : "",
                                 rc_names[k], (double)t->sum_ns * 1e-6 / (double)t->count,
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

/* Where calls of several threads overlap, they follow each other, too, and a frame may get another's slabs.
 */
static bool is_anothers_frame(ly_instance *i, const rc_call *c) {
    if (c->kind == RC_BEGIN) i->begun_by = pthread_self();
    if (!is_frames(c->kind) || !ly_is_lost(i) || pthread_equal(i->begun_by, pthread_self())) return false;
    rule_tell(&i->called, RULE_host_threads, "%s: calls overlap, and another thread began the frame",
              rc_names[c->kind]);
    return true;
}

static sv_status pass(ly_instance *i, rc_call *c) {
    if (!ly_enter(i, rc_names[c->kind])) { /* of two maps neither would be right */
        ly_leave(i, false);
        return SV_ERR_STATE;
    }
    if (is_anothers_frame(i, c)) {
        ly_leave(i, true);
        return SV_ERR_STATE;
    }
    const uint32_t came = atomic_load(&i->came);
    const bool alone = atomic_load(&i->beside) == 0;
    ly_watch_harvest(i, c->kind == RC_DEACTIVATE);
    const bool lost = ly_is_lost(i);
    const sv_status due = lost ? SV_OK : ly_due_host(i, c);
    c->plugin = i->inner;
    c->sound = due == SV_OK && !lost;
    if (due != SV_OK && i->stopped == SV_OK) ly_foretell(i, rc_names[c->kind], due, i->shadow.reason);
    if (i->stopped == SV_OK || c->kind == RC_DEACTIVATE) make_call(i, c, due);
    if (i->stopped != SV_OK) {
        if (c->kind == RC_ACTIVATE && c->start_ns > 0 && c->status >= SV_OK) undo_activate(i);
        c->status = i->stopped = due != SV_OK ? due : i->stopped;
    }
    ly_follow(i, c);
    if (c->kind == RC_DEACTIVATE && alone) atomic_store(&i->forgiven, came);
    if (c->kind == RC_DEACTIVATE) tell_times(i);
    const sv_status status = c->status;
    ly_leave(i, true);
    return status;
}

/* ---- [control] and [frame] */
static sv_status SV_CALL ly_activate(const sv_plugin *plugin, const sv_format *format) {
    return pass(ly_of(plugin), &(rc_call){.kind = RC_ACTIVATE, .format = format});
}

static void SV_CALL ly_deactivate(const sv_plugin *plugin) {
    (void)pass(ly_of(plugin), &(rc_call){.kind = RC_DEACTIVATE});
}

static sv_status SV_CALL ly_begin(const sv_plugin *plugin, const sv_frame *frame) {
    return pass(ly_of(plugin), &(rc_call){.kind = RC_BEGIN, .frame = frame});
}

static sv_status SV_CALL ly_slab(const sv_plugin *plugin, const sv_slab *slab) {
    return pass(ly_of(plugin), &(rc_call){.kind = RC_SLAB, .slab = slab});
}

static sv_status SV_CALL ly_end(const sv_plugin *plugin, const sv_result *result) {
    return pass(ly_of(plugin), &(rc_call){.kind = RC_END, .result = result});
}

static sv_status SV_CALL ly_adjust(const sv_plugin *plugin, const sv_param_value *values, uint32_t count,
                                   const sv_result *result) {
    return pass(ly_of(plugin),
                &(rc_call){.kind = RC_ADJUST, .values = values, .value_count = count, .result = result});
}

static const char *SV_CALL ly_last_error(const sv_plugin *plugin) {
    const ly_instance *i = ly_of(plugin);
    return i->stopped != SV_OK ? i->reason : i->inner->last_error(i->inner);
}

/* ---- [any] */
static uint32_t SV_CALL ly_param_count(const sv_plugin *plugin) {
    return ly_of(plugin)->inner->param_count(ly_of(plugin)->inner);
}

/* The plugin writes into memory of the layer's, so that what it writes behind is seen. */
static sv_status SV_CALL ly_param_info(const sv_plugin *plugin, uint32_t index, sv_param_info *out) {
    struct {
        sv_param_info info;
        uint8_t behind[64];
    } room;
    ly_instance *i = ly_of(plugin);
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
    ly_instance *i = ly_of(plugin);
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
}
