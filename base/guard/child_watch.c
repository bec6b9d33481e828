/* SPDX-License-Identifier: MIT */
#include "guard/child.h"

#include "core/progress.h"
#include "guard/child_system.h"

#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define LOOK_EVERY_MS 20 /* between two looks at the child's memory: too short to fill the machine */

/* ----------------------------------------------------------------------------------------- starting -- */

bool hs_child_start(hs_child *child, const hs_child_limits *limits, const char *program, char *const argv[],
                    const intptr_t *passed, uint32_t passed_count, hs_error *err) {
    uint32_t argc = 1;
    *child = (hs_child){.limits = *limits, .output = -1};
    if (passed_count > HS_CHILD_MAX_PASSED)
        return hs_fail(err, HS_ERR_MEMORY, "child process: %u handles, at most %u", passed_count,
                       HS_CHILD_MAX_PASSED);
    while (argv[argc - 1]) argc++;
    char **all = calloc(argc + 1u, sizeof *all);
    if (!all) return hs_fail(err, HS_ERR_MEMORY, "child process: no memory");
    memcpy(all, argv, (argc - 1u) * sizeof *all);
    const bool ok = hs_process_start(child, program, all, argc, passed, passed_count, err);
    free(all);
    if (!ok) *child = (hs_child){0};
    return ok;
}

bool hs_child_again(hs_child *child, const hs_child_limits *limits, const intptr_t *passed,
                    uint32_t passed_count, hs_error *err) {
    return hs_child_start(child, limits, NULL, hs_child_arguments(), passed, passed_count, err);
}

/* ------------------------------------------------------------------------------------ what it prints -- */

/* Shows what has come, up to the limit. A pipe holds less than is read here, so all that was printed before
 * a message is shown before it is taken. */
static void show_output(hs_child *child) {
    char text[16384];
    for (int i = 0; child->output >= 0 && i < 16; i++) {
        const ptrdiff_t got = hs_process_read(child, text, sizeof text);
        if (got <= 0) return;
        const uint64_t limit = child->limits.said_bytes ? child->limits.said_bytes : UINT64_MAX;
        const uint64_t room = limit > child->said ? limit - child->said : 0;
        (void)fwrite(text, 1, room < (size_t)got ? (size_t)room : (size_t)got, stderr);
        child->said += (uint64_t)got;
    }
}

uint64_t hs_child_dropped(hs_child *child) {
    const uint64_t said = child->said, limit = child->limits.said_bytes;
    child->said = 0;
    return limit && said > limit ? said - limit : 0;
}

/* ----------------------------------------------------------------------------------------- watching -- */

/* Notes how the child ended, if it has. If it ended in its own way while it was being killed, that counts. */
static bool has_ended(hs_child *child, bool waits) {
    hs_child_end end = {0};
    bool killed = false;
    if (!child->process) return true;
    if (!hs_process_collect(child, waits, &end, &killed)) return false;
    child->process = 0;
    show_output(child); /* its last words */
    if (!killed || child->end.fate == HS_CHILD_RUNS) child->end = end;
    return true;
}

/* True if the child has ended, or has been ended for its memory. */
static bool look(hs_child *child) {
    show_output(child);
    if (has_ended(child, false)) return true;
    const uint64_t limit = child->limits.memory_bytes;
    if (limit == 0 || hs_process_memory(child) <= limit) return false;
    hs_child_kill(child, HS_CHILD_GREEDY, 0);
    return true;
}

static int slice_ms(double seconds) {
    const double ms = seconds * 1e3;
    return ms <= 0 ? 0 : ms < LOOK_EVERY_MS ? (int)ms + 1 : LOOK_EVERY_MS;
}

/* After the other end of the channel was closed: the child is about to end, or is ended. */
static void wait_or_kill(hs_child *child) {
    for (int pause_ms = 1; pause_ms < 200; pause_ms *= 2) {
        if (has_ended(child, false)) return;
        hs_process_pause(child, pause_ms);
    }
    hs_child_kill(child, HS_CHILD_SILENT, 0);
}

hs_child_news hs_child_wait(hs_child *child, double seconds) {
    const double until = hs_now() + seconds;
    while (child->process) {
        if (hs_process_stirs(child, slice_ms(until - hs_now()))) {
            const bool message = hs_process_has_message(child);
            show_output(child);
            if (message) return HS_CHILD_MESSAGE;
            wait_or_kill(child);
        } else if (!look(child) && hs_now() >= until) {
            return HS_CHILD_NOTHING;
        }
    }
    /* Its last words count: it may have ended after them. */
    return child->end.fate == HS_CHILD_LEFT && hs_process_has_message(child) ? HS_CHILD_MESSAGE
                                                                             : HS_CHILD_ENDED;
}

void hs_child_wait_end(hs_child *child, double seconds) {
    hs_child_wait_watched(child, seconds, NULL, NULL);
}

void hs_child_wait_watched(hs_child *child, double seconds, double (*late)(const void *context),
                           const void *context) {
    const double until = hs_now() + seconds;
    int pause_ms = 1; /* most children end at once */
    while (!look(child)) {
        const double left = until - hs_now(), allowed = late ? late(context) : 0.0;
        if (left <= 0 || allowed > 0) {
            hs_child_kill(child, HS_CHILD_LATE, allowed > 0 ? allowed : seconds);
            return;
        }
        const int slice = slice_ms(left);
        hs_process_pause(child, pause_ms < slice ? pause_ms : slice);
        if (pause_ms < LOOK_EVERY_MS) pause_ms *= 2;
    }
}

void hs_child_kill(hs_child *child, hs_child_fate why, double seconds) {
    if (has_ended(child, false)) return;
    child->end = (hs_child_end){.fate = why, .seconds = seconds, .memory_bytes = child->limits.memory_bytes};
    hs_process_kill(child);
    while (!has_ended(child, true)) {
    }
}

void hs_child_close(hs_child *child) {
    if (child->process) hs_child_kill(child, HS_CHILD_GONE, 0);
    if (child->end.fate != HS_CHILD_RUNS) hs_process_close(child); /* else there never was one */
    *child = (hs_child){0};
}

void hs_child_tell(const hs_child_end *end, char *out, size_t bytes) {
    switch (end->fate) {
    case HS_CHILD_RUNS:
        (void)snprintf(out, bytes, "runs");
        return;
    case HS_CHILD_LEFT:
        (void)snprintf(out, bytes, "left by exit(%d)", end->number);
        return;
    case HS_CHILD_CRASHED:
        hs_process_tell_crash(end->number, out, bytes);
        return;
    case HS_CHILD_LATE:
        (void)snprintf(out, bytes, "ran out of time (%.1f s)", end->seconds);
        return;
    case HS_CHILD_GREEDY:
        (void)snprintf(out, bytes, "took more than %" PRIu64 " MiB", end->memory_bytes >> 20);
        return;
    case HS_CHILD_SILENT:
        (void)snprintf(out, bytes, "closed or misused its channel");
        return;
    case HS_CHILD_GONE:
        (void)snprintf(out, bytes, "was ended");
        return;
    }
}
