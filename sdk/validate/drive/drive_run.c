/* SPDX-License-Identifier: MIT */
/* One check under way: what it was asked for, and what it reports. */
#include "core/progress.h"
#include "validate/drive/drive.h"

#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>

static void note(v_run *run, v_verdict verdict, const char *format, va_list args) {
    run->report->verdict = verdict;
    (void)vsnprintf(run->report->text, sizeof run->report->text, format, args);
}

void v_fail(v_run *run, const char *format, ...) {
    va_list args;
    va_start(args, format);
    note(run, V_FAIL, format, args);
    va_end(args);
    longjmp(run->escape, 1);
}

static void broken(void *context, rule_name name, const char *text) {
    (void)name;
    v_fail(context, "%s", text);
}

rule_sink v_sink(v_run *run) {
    return (rule_sink){broken, run};
}

void v_skip(v_run *run, const char *format, ...) {
    va_list args;
    va_start(args, format);
    note(run, V_SKIP, format, args);
    va_end(args);
    longjmp(run->escape, 1);
}

void v_no_device(v_run *run, const char *why) {
    run->report->no_device = true;
    v_skip(run, "%s", why);
}

void v_warn(v_run *run, const char *format, ...) {
    va_list args;
    if (run->report->verdict == V_WARN) return;
    va_start(args, format);
    note(run, V_WARN, format, args);
    va_end(args);
}

void v_note(v_run *run, const char *format, ...) {
    va_list args;
    if (run->report->verdict != V_PASS) return;
    va_start(args, format);
    note(run, V_PASS, format, args);
    va_end(args);
}

static void where(v_run *run, const char *format, va_list args) {
    const char *change = run->watch ? v_watch_change(run->watch) : NULL;
    if (change) {
        run->watch = NULL;
        v_fail(run, "the plugin %s; last call: %s", change, run->report->where);
    }
    (void)vsnprintf(run->report->where, sizeof run->report->where, format, args);
}

void v_where(v_run *run, const char *format, ...) {
    va_list args;
    atomic_store(&run->report->since_ns, 0);
    run->report->values[0] = '\0';
    va_start(args, format);
    where(run, format, args);
    va_end(args);
}

void v_where_frame(v_run *run, const char *format, ...) {
    va_list args;
    va_start(args, format);
    where(run, format, args);
    va_end(args);
    atomic_store(&run->report->since_ns, (uint64_t)(hs_now() * 1e9));
}

void v_random_begin(v_run *run, const char *name) {
    run->random = run->seed * 0x9e3779b97f4a7c15u + 0x2545f4914f6cdd1du;
    for (; *name; name++) run->random = (run->random ^ (unsigned char)*name) * 0x100000001b3u;
    if (run->random == 0) run->random = 1;
}

/* xorshift64*: its high bits are good. */
static uint32_t next(v_run *run) {
    run->random ^= run->random >> 12;
    run->random ^= run->random << 25;
    run->random ^= run->random >> 27;
    return (uint32_t)(run->random * 0x2545f4914f6cdd1du >> 32);
}

uint32_t v_random(v_run *run, uint32_t below) {
    return (uint32_t)((uint64_t)next(run) * below >> 32);
}

double v_random_unit(v_run *run) {
    return (double)next(run) / (double)UINT32_MAX;
}

/* What a check has taken. Several threads may take some. */
typedef struct block {
    struct block *before;
    max_align_t memory[];
} block;
static block *last;
static pthread_mutex_t lock = PTHREAD_MUTEX_INITIALIZER;

void *v_memory(v_run *run, size_t bytes) {
    block *b = calloc(1, sizeof *b + bytes + 1);
    V_EXPECT(run, b, "no memory for %zu bytes: the check could not be made", bytes);
    (void)pthread_mutex_lock(&lock);
    b->before = last;
    last = b;
    (void)pthread_mutex_unlock(&lock);
    return b->memory;
}

void v_memory_end(void) {
    while (last) {
        block *b = last;
        last = b->before;
        free(b);
    }
}
