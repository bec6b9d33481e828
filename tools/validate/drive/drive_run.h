/* SPDX-License-Identifier: MIT */
/* One check under way: what it was asked for, and what it reports. */
#ifndef DRIVE_RUN_H
#define DRIVE_RUN_H

#include <setjmp.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

typedef enum {
    V_PASS,
    V_WARN, /* it holds, and something is not as it should be */
    V_SKIP, /* not tried: the text says why */
    V_FAIL,
    V_CRASH, /* the process ended before the check did */
    V_TIMEOUT
} v_verdict;

/* What a check leaves behind. It lies in memory that the validator shares with the check's process, so it is
 * still there when that has crashed. */
typedef struct {
    v_verdict verdict;
    bool finished;
    char text[700];  /* what was found; "" if there is nothing to say */
    char where[200]; /* the call that is under way */
} v_report;

typedef struct {
    const char *path; /* of the library */
    const char *id;   /* of the plugin; NULL: the library's first */
    uint64_t seed;
    uint32_t level; /* 1 .. 10: how much is tried */
    bool verbose;   /* what the plugin logs goes to standard error */
    v_report *report;
    uint64_t random; /* state of v_random */
    jmp_buf escape;  /* where v_fail and v_skip go */
} v_run;

/* Notes the finding and ends the check. */
_Noreturn void v_fail(v_run *run, const char *format, ...) __attribute__((format(printf, 2, 3)));
_Noreturn void v_skip(v_run *run, const char *format, ...) __attribute__((format(printf, 2, 3)));

/* Notes the finding, the first one only, and goes on. */
void v_warn(v_run *run, const char *format, ...) __attribute__((format(printf, 2, 3)));

/* Says what a passed check has tried. */
void v_note(v_run *run, const char *format, ...) __attribute__((format(printf, 2, 3)));

/* Fails unless `holds`. */
#define V_EXPECT(run, holds, ...)                                                                            \
    do {                                                                                                     \
        if (!(holds)) v_fail(run, __VA_ARGS__);                                                              \
    } while (0)

/* The call that comes next: what a crash or a hang is told with. */
void v_where(v_run *run, const char *format, ...) __attribute__((format(printf, 2, 3)));

/* Random numbers from the seed and the check's name: the same for the same command. */
void v_random_begin(v_run *run, const char *name);
uint32_t v_random(v_run *run, uint32_t below); /* 0 .. below - 1; `below` at least 1 */
double v_random_unit(v_run *run);              /* 0 .. 1, both ends possible */

/* `bytes` of memory, all zero. Fails the check if there are none. */
void *v_memory(v_run *run, size_t bytes);

#endif
