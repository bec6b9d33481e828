/* SPDX-License-Identifier: MIT */
#include "guarded/guard_link.h"

#include "core/progress.h"
#include "core/system.h"
#include "core/text.h"

#include <errno.h>
#include <inttypes.h>
#include <stdio.h>
#include <string.h>

#define OUTPUT_KIB  64u /* of a frame's log and prints that are shown */
#define EXTRA_CALLS 8u  /* of a message, beside one a slab: begin, end, the queue, extensions */

/* ------------------------------------------------------------------------------------------- memory -- */

/* As large as it can get. */
static size_t block_bytes(void) {
    return hs_guard_map_offset(HS_GUARD_MAPS, (size_t)HS_GUARD_MAX_AXIS * HS_GUARD_MAX_AXIS);
}

bool hs_guard_link_create(hs_guard *guard, hs_error *err) {
    guard->block_shared = sys_shared_new(block_bytes());
    guard->slabs_shared = sys_shared_new(0);
    guard->slabs_reader = guard->slabs_shared < 0 ? -1 : sys_shared_reader(guard->slabs_shared);
    guard->block = sys_shared_map(guard->block_shared, block_bytes(), true);
    if (guard->slabs_reader < 0 || !guard->block ||
        !sys_shared_use(guard->block, hs_guard_block_bytes(), true))
        return hs_fail(err, HS_ERR_MEMORY, "guard: no shared memory: %s", strerror(errno));
    guard->block->magic = HS_GUARD_MAGIC;
    return true;
}

void hs_guard_link_destroy(hs_guard *guard) {
    hs_guard_end_child(guard);
    sys_shared_unmap(guard->block, block_bytes());
    sys_shared_unmap(guard->slabs, guard->slabs_bytes);
    sys_shared_close(guard->block_shared);
    sys_shared_close(guard->slabs_shared);
    sys_shared_close(guard->slabs_reader);
}

void *hs_guard_map_of(const hs_guard *guard, hs_guard_map map) {
    return (uint8_t *)guard->block + hs_guard_map_offset(map, guard->pixels);
}

/* ----------------------------------------------------------------------------------------- messages -- */

sv_status hs_guard_refuse(hs_guard *guard, sv_status status, const char *call, const char *reason) {
    (void)snprintf(guard->call, sizeof guard->call, "%s", call);
    (void)snprintf(guard->last_error, sizeof guard->last_error, "%s", reason);
    return status;
}

/* The call that the block names, copied and ended. */
static void note_call(hs_guard *guard) {
    memcpy(guard->call, guard->block->call, sizeof guard->block->call);
    guard->call[sizeof guard->block->call] = '\0';
}

/* What a child prints is shown up to a budget, which each frame has anew. */
static void tell_dropped(hs_guard *guard) {
    char path[sizeof guard->path];
    const uint64_t dropped = hs_child_dropped(&guard->child);
    if (dropped == 0) return;
    (void)hs_text_escape(path, sizeof path, guard->path, 0);
    (void)fprintf(stderr, "\n%s: %" PRIu64 " more bytes of its output were dropped (a frame has %u KiB)\n",
                  path, dropped, OUTPUT_KIB);
}

void hs_guard_end_child(hs_guard *guard) {
    if (guard->child.process) hs_child_kill(&guard->child, HS_CHILD_GONE, 0);
    tell_dropped(guard);
    hs_child_close(&guard->child);
}

/* The child has ended: how, and in which call. */
static sv_status report_end(hs_guard *guard) {
    char how[128];
    const uint32_t step = guard->block->step, steps = guard->block->steps;
    hs_child_tell(&guard->child.end, how, sizeof how);
    note_call(guard);
    if (guard->call[0] == '\0')
        (void)snprintf(guard->last_error, sizeof guard->last_error, "%s between two calls", how);
    else if (steps > 0)
        (void)snprintf(guard->last_error, sizeof guard->last_error, "%s in %s %u of %u", how, guard->call,
                       step, steps);
    else
        (void)snprintf(guard->last_error, sizeof guard->last_error, "%s in %s", how, guard->call);
    (void)hs_fail(&guard->ended, HS_ERR_PLUGIN, "%s: %.900s", guard->path, guard->last_error);
    hs_guard_end_child(guard);
    guard->lost_frame = true;
    return SV_ERR_INTERNAL;
}

/* Seconds until the call under way has had its time. What the child says of its begin counts only if it can
 * be: it lies behind the order. */
static double seconds_left(const hs_guard *guard, double ordered, double limit) {
    const double now = hs_now();
    const double since = (double)atomic_load(&guard->block->since_ns) * 1e-9;
    const double calls = (double)guard->slab_count + EXTRA_CALLS;
    const double call = (since > ordered && since < now ? since : ordered) + limit - now;
    const double whole = ordered + calls * limit - now;
    return call < whole ? call : whole;
}

/* Waits for the reply. False: the child has ended, or was ended. */
static bool await(hs_guard *guard, hs_guard_order order, double limit, hs_guard_reply *reply) {
    const double ordered = hs_now();
    for (;;) {
        const double left = seconds_left(guard, ordered, limit);
        const hs_child_news news = hs_child_wait(&guard->child, left > 0 ? left : 0);
        if (news == HS_CHILD_ENDED) return false;
        if (news == HS_CHILD_MESSAGE) {
            if (hs_child_receive(guard->child.channel, reply, sizeof *reply) && reply->op == order.op &&
                reply->number == order.number)
                return true;
            hs_child_kill(&guard->child, HS_CHILD_SILENT, 0);
            return false;
        }
        if (seconds_left(guard, ordered, limit) > 0) continue; /* the next call has begun meanwhile */
        hs_child_kill(&guard->child, HS_CHILD_LATE, limit);
        return false;
    }
}

/* Takes the plugin's reason over from the block. */
static void note_error(hs_guard *guard) {
    memcpy(guard->last_error, guard->block->last_error, sizeof guard->last_error);
    guard->last_error[sizeof guard->last_error - 1] = '\0';
}

sv_status hs_guard_ask(hs_guard *guard, hs_guard_op op, double limit) {
    const hs_guard_order order = {.op = op, .number = ++guard->number};
    hs_guard_reply reply;
    if (!guard->child.process)
        return hs_guard_refuse(guard, SV_ERR_STATE, "guard", "the plugin has no process");
    if (op <= HS_GUARD_ADJUST) tell_dropped(guard);
    guard->block->slab_count = guard->slab_count;
    guard->block->call[0] = '\0';
    guard->block->step = guard->block->steps = 0;
    atomic_store(&guard->block->since_ns, 0);
    if (!hs_child_send(guard->child.channel, &order, sizeof order)) hs_child_wait_end(&guard->child, limit);
    if (!await(guard, order, limit, &reply)) return report_end(guard);
    note_call(guard);
    guard->last_error[0] = '\0';
    if (reply.status != SV_OK) note_error(guard);
    return reply.status;
}

/* ------------------------------------------------------------------------------- start and restart -- */

bool hs_guard_start(hs_guard *guard, hs_error *err) {
    const hs_child_limits limits = {.memory_bytes = guard->options.memory_bytes,
                                    .said_bytes = (uint64_t)OUTPUT_KIB << 10};
    const intptr_t passed[] = {guard->block_shared, guard->slabs_reader};
    char name[] = "host_sim", command[] = HS_GUARD_COMMAND;
    char *const argv[] = {name, command, NULL};
    if (!hs_child_start(&guard->child, &limits, hs_guard_program(), argv, passed, 2, err)) return false;
    hs_guard_block *block = guard->block;
    (void)snprintf(block->path, sizeof block->path, "%s", guard->path);
    (void)snprintf(block->id, sizeof block->id, "%s", guard->id);
    block->has_id = guard->has_id;
    block->log_level = guard->log_level;
    guard->slab_count = 0;
    block->error.code = HS_OK;
    const sv_status status = hs_guard_ask(guard, HS_GUARD_OPEN, guard->options.setup_s);
    if (status == SV_OK) return true;
    if (!guard->child.process) return hs_fail(err, HS_ERR_PLUGIN, "%s: %s", guard->path, guard->last_error);
    hs_guard_end_child(guard);
    if (guard->last_error[0] == '\0')
        return hs_fail(err, HS_ERR_PLUGIN, "%s: its process refuses it without a reason", guard->path);
    return hs_fail(err, HS_ERR_PLUGIN, "%s", guard->last_error); /* names the path itself */
}

sv_status hs_guard_activate(hs_guard *guard) {
    hs_guard_block *block = guard->block;
    if (!sys_shared_use(block, hs_guard_map_offset(HS_GUARD_MAPS, guard->pixels), true))
        return hs_guard_refuse(guard, SV_ERR_NO_MEMORY, "activate", "no shared memory for the maps");
    block->format = guard->format;
    block->format.values = NULL;
    block->way = guard->way;
    block->slabs_bytes = guard->slabs_bytes;
    guard->slab_count = 0;
    memcpy(block->values, guard->values, guard->format.value_count * sizeof *guard->values);
    const sv_status status = hs_guard_ask(guard, HS_GUARD_ACTIVATE, guard->options.setup_s);
    guard->offered = hs_status_is_success(status) && block->offered != 0;
    return status;
}

bool hs_guard_revive(hs_guard *guard) {
    hs_error err = {0};
    if (guard->child.process) return true;
    if (guard->restarts >= guard->options.restarts) {
        (void)snprintf(guard->last_error, sizeof guard->last_error,
                       "ended %u times, and is not started any more", guard->restarts + 1u);
        return false;
    }
    guard->restarts++;
    if (!hs_guard_start(guard, &err)) {
        (void)snprintf(guard->last_error, sizeof guard->last_error, "could not be started anew: %.900s",
                       err.text);
        return false;
    }
    if (!guard->active || hs_status_is_success(hs_guard_activate(guard))) return true;
    hs_guard_end_child(guard);
    return false;
}

/* As much of a report as the reader has room for; the size stays the reader's. */
static void give(void *out, uint32_t size, const void *report, size_t bytes) {
    memcpy((char *)out + sizeof size, (const char *)report + sizeof size,
           (size < bytes ? size : bytes) - sizeof size);
}

/* What follows a frame comes with its message if it did so last time, and by a message of its own if not. */
static bool follow(hs_guard *guard, uint32_t what) {
    guard->habit |= what;
    if (guard->settled & what) return true;
    if (!guard->child.process) return false;
    guard->block->follow = what;
    (void)hs_guard_ask(guard, HS_GUARD_FOLLOW, guard->options.frame_s);
    if (!guard->child.process) return false;
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
        memcpy(map, hs_guard_map_of(guard, HS_GUARD_CONFIDENCE_MAP), guard->pixels * sizeof *map);
    else
        note_error(guard);
    return status;
}

static sv_status confidence_read(const sv_plugin *plugin, float *map, sv_confidence_report *out) {
    hs_guard *guard = hs_guard_of(plugin);
    const sv_status status = hs_guard_ask(guard, HS_GUARD_READ_CONFIDENCE, guard->options.frame_s);
    if (status != SV_OK) return status;
    const sv_confidence_report report = guard->block->confidence_report;
    if (map) memcpy(map, hs_guard_map_of(guard, HS_GUARD_CONFIDENCE_MAP), guard->pixels * sizeof *map);
    if (out) give(out, out->size, &report, sizeof report);
    guard->settled &= ~(uint32_t)HS_GUARD_CONFIDENCE;
    return SV_OK;
}

/* -------------------------------------------------------------------------------------------- timing -- */

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

/* --------------------------------------------------------------------------------------------- needs -- */

static sv_status needs_of(const sv_plugin *plugin, const sv_format *format, const sv_param_value *values,
                          uint32_t count, const sv_needs_device *device, sv_needs *out) {
    hs_guard *guard = hs_guard_of(plugin);
    hs_guard_needs *needs = &guard->block->needs;
    if (!guard->child.process) return hs_guard_refuse(guard, SV_ERR_STATE, "needs", "there is no process");
    if (format->value_count > HS_GUARD_MAX_VALUES || count > HS_GUARD_MAX_VALUES)
        return hs_guard_refuse(guard, SV_ERR_ARGUMENT, "needs", "more values than the guard takes");
    needs->format = *format;
    needs->format.values = NULL;
    needs->format.context = NULL;
    needs->format.device = NULL;
    needs->format.queue = NULL;
    needs->value_count = count;
    if (format->value_count) memcpy(needs->fixed, format->values, format->value_count * sizeof *needs->fixed);
    if (count) memcpy(needs->values, values, count * sizeof *needs->values);
    needs->device = *device;
    const sv_status status = hs_guard_ask(guard, HS_GUARD_NEEDS, guard->options.frame_s);
    const sv_needs told = needs->out;
    if (status == SV_OK) give(out, out->size, &told, sizeof told);
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
    static const sv_ext_needs needs = {.size = sizeof needs, .of = needs_of};
    const struct {
        const char *id;
        uint32_t bit;
        const void *table;
    } known[] = {{SV_EXT_TIMING, HS_GUARD_HAS_TIMING, &timing},
                 {SV_EXT_POINTS, HS_GUARD_HAS_POINTS, &points},
                 {SV_EXT_CONFIDENCE, HS_GUARD_HAS_CONFIDENCE, &confidence},
                 {SV_EXT_NEEDS, HS_GUARD_HAS_NEEDS, &needs}};
    const uint32_t has = hs_guard_of(plugin)->facts.extensions;
    for (size_t i = 0; i < sizeof known / sizeof *known; i++)
        if (strcmp(id, known[i].id) == 0) return has & known[i].bit ? known[i].table : NULL;
    return NULL;
}
