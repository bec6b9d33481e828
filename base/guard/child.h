/* SPDX-License-Identifier: MIT */
/*
 * A child process for code that may do anything: crash, leave, hang, take all memory. It is watched, it can
 * be ended with all that it started, and how it ended is a value and a sentence. It protects from mistakes,
 * not from attacks: the code runs with the user's rights.
 *
 * The child is a program with arguments, most often this program once more; one that calls hs_child_take. It
 * dies with its parent, whatever ends that, leaves no core dump and reads nothing from the terminal. What it
 * has started ends with it: on Linux in whatever session (child_keeper.h), on Windows by a job. Parent and
 * child talk through a channel that keeps messages apart.
 */
#pragma once

#include "core/error.h"

#include <stddef.h>
#include <stdint.h>

/* Where its standard output and error go. */
typedef enum {
    HS_CHILD_SHOWN,     /* to the parent's standard error, while that waits */
    HS_CHILD_INHERITED, /* where the parent's go */
    HS_CHILD_DISCARDED
} hs_child_output;

/* What a child may take; 0 is no limit. */
typedef struct {
    uint64_t memory_bytes; /* memory of its own that it has touched (shared mappings do not count) */
    uint64_t said_bytes;   /* of its output that are shown until hs_child_dropped */
    hs_child_output output;
} hs_child_limits;

typedef enum {
    HS_CHILD_RUNS = 0,
    HS_CHILD_LEFT,    /* it ended by itself, or something in it called exit: `number` is the exit code */
    HS_CHILD_CRASHED, /* a signal, or Windows' exception, ended it: `number` */
    HS_CHILD_LATE,    /* it was ended because its time was over */
    HS_CHILD_GREEDY,  /* it was ended because it took too much memory */
    HS_CHILD_SILENT,  /* it was ended because it closed its channel or wrote nonsense into it */
    HS_CHILD_GONE     /* it was ended because nobody needed it any more */
} hs_child_fate;

/* How a child ended. */
typedef struct {
    hs_child_fate fate;
    int number;
    double seconds;        /* HS_CHILD_LATE: the time it had */
    uint64_t memory_bytes; /* HS_CHILD_GREEDY: the limit */
} hs_child_end;

/* Owned by the caller; its functions are called from one thread, the one that started it. Zeroed: there is
 * none. */
typedef struct {
    intptr_t process;   /* 0: none, or it ended; on Linux its id */
    intptr_t channel;   /* the parent's end; valid while there is a child and until hs_child_close */
    intptr_t output;    /* what it prints comes out here; -1: nothing more */
    intptr_t job, bell; /* the system's own */
    uint64_t said;
    hs_child_limits limits;
    hs_child_end end;
} hs_child;

#define HS_CHILD_MAX_PASSED 8u /* handles that can be handed to a child */

/* Starts a program; NULL: this one. Of the parent it has standard input (empty), output and error, and what
 * is `passed`: descriptors, on Windows handles that can be inherited. A last argument tells it where these
 * are. `argv` ends with NULL. HS_ERR_MEMORY (no process), HS_ERR_INPUT (the program cannot be run). */
bool hs_child_start(hs_child *child, const hs_child_limits *limits, const char *program, char *const argv[],
                    const intptr_t *passed, uint32_t passed_count, hs_error *err);

/* This program again, with the arguments that hs_child_take has seen. */
bool hs_child_again(hs_child *child, const hs_child_limits *limits, const intptr_t *passed,
                    uint32_t passed_count, hs_error *err);

/* First in main, of programs that can be a child: takes the last argument away, if it is that of a child.
 * True: it was. */
bool hs_child_take(int *argc, char **argv);

/* In a child: its channel (0), and what was passed (1, 2, ...); -1: nothing. */
intptr_t hs_child_passed(uint32_t n);

/* True in a process that hs_child_take has found to be a child. */
bool hs_child_is_one(void);

/* In a child, after foreign code has run: a copy of it that came back from a fork ends, and without its
 * channel it waits to be ended. */
void hs_child_look_around(void);

/* Ends this process, and nothing is done on the way: no exit handlers, no flush. */
_Noreturn void hs_child_leave(int code);

/* What waiting came to. */
typedef enum {
    HS_CHILD_MESSAGE, /* the channel has one */
    HS_CHILD_NOTHING, /* not within that time */
    HS_CHILD_ENDED    /* see hs_child.end; no message is left */
} hs_child_news;

/* Waits for a message for up to `seconds`, and watches the limits. A child that takes too much memory, or
 * closes its channel and goes on, is ended. */
hs_child_news hs_child_wait(hs_child *child, double seconds);

/* Waits until the child has ended, and ends it as HS_CHILD_LATE after `seconds`. Messages stay where they
 * are. */
void hs_child_wait_end(hs_child *child, double seconds);

/* The same, and `late` is asked now and then: the seconds that a part of its work was allowed and has taken
 * longer than, 0 as long as it has not. */
void hs_child_wait_watched(hs_child *child, double seconds, double (*late)(const void *context),
                           const void *context);

/* Bytes of its output beyond the limit, which nobody saw, since the last call. The limit holds anew. */
uint64_t hs_child_dropped(hs_child *child);

/* Kills the child and everything that it has started, and notes why. How it ended before counts more: a
 * child that has crashed was not late. `seconds` is for HS_CHILD_LATE. */
void hs_child_kill(hs_child *child, hs_child_fate why, double seconds);

/* Kills the child if there still is one and closes the channel. Safe on a zeroed struct; zeroes it. */
void hs_child_close(hs_child *child);

/* One whole message through a channel, from either side. `bytes` is its exact length. False if the other side
 * has gone, or (receive) the message has another length; receive waits for one. */
bool hs_child_send(intptr_t channel, const void *message, size_t bytes);
bool hs_child_receive(intptr_t channel, void *message, size_t bytes);

/* "crashed: SIGSEGV", "aborted", "left by exit(0)", "ran out of time (2.0 s)", "took more than 1024 MiB". */
void hs_child_tell(const hs_child_end *end, char *out, size_t bytes);
