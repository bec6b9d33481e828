/* SPDX-License-Identifier: MIT */
/*
 * The checking layer, smartvis_check.so: a plugin that loads another one, passes every call on, and holds
 * both sides to the rules of the header on the way (docs/check.md).
 *
 *   layer_say     settings, and the log
 *   layer_entry   the other library, create and destroy
 *   layer_pass    the calls, one after the other: judged, passed on, judged
 *   layer_extensions  the calls of extensions, in the same way
 *   layer_host    what the host did: a shadow of the instance by smartvis/author_checks.h, and OpenCL objects
 *   layer_watch   samples of voxels and ranges, before the plugin sees them and when the frame has run
 *   layer_results maps, status maps and statistics
 */
#pragma once

#include "core/system.h"
#include "record/rec.h"
#include "rules/call.h"
#include "rules/rules.h"
#include "smartvis/author.h"
#include "smartvis/confidence.h"
#include "smartvis/needs.h"
#include "smartvis/points.h"
#include "smartvis/timing.h"

#include <pthread.h>
#include <stdatomic.h>

typedef struct ly_watch ly_watch;

enum {
    LY_MANY_LINES = 1000, /* of the log in one call: what nobody reads */
    LY_MISTAKES = 256
};

typedef struct {
    uint64_t count, sum_ns, longest_ns;
} ly_times;

/* One instance of the other plugin. What the host holds is `api`. */
typedef struct {
    sv_plugin api;
    const sv_plugin *inner;
    const sv_host *outer; /* the host's */
    sv_host host;         /* what the plugin is given */
    bool silent;          /* SMARTVIS_CHECK=off: only recorded */
    bool stops;           /* SMARTVIS_CHECK=stop */
    rec *record;          /* NULL: none */
    uint64_t slow_ns;     /* SMARTVIS_CHECK_MS */
    sv_descriptor told;   /* the descriptor as it was at create */

    /* Used by any thread. */
    atomic_flag busy; /* a [control] or [frame] call is under way */
    /* Calls that came beside another one, in all and now; and how many of them are forgotten: with a
     * deactivate that none came beside, the state is known again. */
    atomic_uint came, beside, forgiven;
    atomic_uint lines; /* of the log, since a call began */
    atomic_uint seen[RULE_COUNT];
    rule_sink asked; /* of [any] calls */
    sv_ext_confidence
        confidence; /* what the host gets of an extension: the plugin's size, the layer's functions */
    sv_ext_needs needs;
    sv_ext_points points;
    sv_ext_timing timing;
    const sv_ext_confidence *inner_confidence; /* NULL: the plugin has none */
    const sv_ext_needs *inner_needs;
    const sv_ext_points *inner_points;
    const sv_ext_timing *inner_timing;

    /* Belongs to the call under way. */
    rule_sink called;
    pthread_t begun_by; /* the thread whose frame it is */
    bool found;         /* a rule was broken */
    rule_name owed;     /* the plugin's rule that asks for an error; RULE_COUNT: by the error */
    uint32_t mistakes[LY_MISTAKES], mistake_count; /* of the host that were foretold: hashes of why */
    sv_status stopped; /* what a call returns that was stopped, SV_OK if it was not */
    char reason[512];  /* for last_error, of a call that was stopped */

    /* Kept from call to call. */
    sva shadow; /* what the header says of the instance: state, format, values, next slice */
    sva_method method;
    rule_params *described;
    sva_param *params;
    double *values;                            /* three for each parameter */
    ly_watch *watch;                           /* NULL: inactive, or there was no memory */
    uint64_t last_time_ns, frame_index;        /* of the frame under way or the last one */
    bool told_trouble, told_record, has_frame; /* has_frame: an end of this activation succeeded */
    ly_times times[RC_CALLS];
} ly_instance;

/* -------------------------------------------------------------------------------------- layer_say -- */

extern char ly_folder[SYS_PATH]; /* the layer's own, with '/' */

/* Once, before the others are asked. */
void ly_read_settings(void);

/* A setting's value, UTF-8: of the environment, else of the file smartvis_check.conf beside the layer; or
 * NULL. */
enum { LY_VALUE = 2 * SYS_PATH };
const char *ly_setting(const char *name, char value[LY_VALUE]);

/* A setting that is a file: a relative path starts from the working folder, in the settings' file from the
 * layer's own. False if there is none. */
bool ly_path(const char *name, char *path, size_t bytes);

/* The first line of the settings' file that is neither a setting nor a comment (#), or NULL. */
const char *ly_wrong_line(void);

/* A line to the host's log, or to standard error if the host has none. Any thread. */
void ly_log(const ly_instance *i, int32_t severity, const char *format, ...)
    __attribute__((format(printf, 3, 4)));

/* Before a call that the host got wrong, once for each way and activation: a plugin that does not refuse it
 * may end the process, and then this is the last line. Nothing for SV_OK. */
void ly_foretell(ly_instance *i, const char *call, sv_status due, const char *why);

/* A question to the host that breaks no rule, once for each and activation. */
void ly_doubt(ly_instance *i, rule_name name, const char *call, const char *question);

/* Rule sinks: of the call under way, and of calls from any thread. */
void ly_broken(void *instance, rule_name name, const char *text);
void ly_broken_asking(void *instance, rule_name name, const char *text);

/* ------------------------------------------------------------------------------------- layer_pass -- */

/* Nanoseconds of CLOCK_MONOTONIC. */
uint64_t ly_now(void);

/* The layer's functions, in what the host holds. */
void ly_fill_calls(ly_instance *i);

static inline ly_instance *ly_of(const sv_plugin *plugin) {
    return (ly_instance *)(uintptr_t)plugin; /* api is the first member */
}

/* True if nobody knows the state: calls overlapped, now or since the activation. Whoever has looked at
 * something that another call may have changed asks behind it. */
static inline bool ly_is_lost(ly_instance *i) {
    return atomic_load(&i->came) != atomic_load(&i->forgiven);
}

/* Around every [control] and [frame] call. enter: false if another one is under way, which is told. */
bool ly_enter(ly_instance *i, const char *call);
void ly_leave(ly_instance *i, bool entered);

/* Behind a call of this name that returned `status`. */
void ly_check_reason(ly_instance *i, const char *call, sv_status status);

/* ------------------------------------------------------------------------------- layer_extensions -- */

/* The layer's tables, in the instance, and get_extension, in what the host holds. */
void ly_fill_extensions(ly_instance *i);

/* What needs must return for this, by the same checks. */
sv_status ly_due_needs(ly_instance *i, const sv_format *format, const sv_param_value *values, uint32_t count,
                       const sv_needs_device *device, const sv_needs *out);

/* ------------------------------------------------------------------------------------- layer_host -- */

/* What a host's call must return by the header: SV_OK, or the error that the plugin owes. Tells of what is
 * wrong. */
sv_status ly_due_host(ly_instance *i, const rc_call *c);

/* The plugin's rule that an error belongs to: the one it breaks if it returns none. */
rule_name ly_rule_of_refusal(const ly_instance *i, const rc_call *c, sv_status due);

/* Takes the call's outcome into the shadow. */
void ly_follow(ly_instance *i, const rc_call *c);

/* ------------------------------------------------------------------------------------ layer_watch -- */
/* With the host's queue the samples are taken by commands on it, in order with the plugin's, and judged at a
 * later call. */

/* Waits for what is under way. NULL is fine. */
void ly_watch_close(ly_watch *w);

/* Around the plugin's call: ranges and slabs are sampled before it, maps made NaN; compared and judged behind
 * it. */
void ly_watch_before(ly_instance *i, const rc_call *c);

/* With the plugin's own queue: `lent` names maps of the layer's with bands behind them, for the call itself,
 * and ly_results_back brings the host what was written. The host's own result where rows have a pitch, where
 * the struct is a later host's, and where nothing is watched. */
const sv_result *ly_results_lend(const ly_instance *i, const rc_call *c, sv_result *lent);
void ly_results_back(ly_instance *i, const rc_call *c, const sv_result *lent);
void ly_watch_after(ly_instance *i, const rc_call *c);

/* Judges what the queue has brought. `wait`: waits for it. */
void ly_watch_harvest(ly_instance *i, bool wait);
