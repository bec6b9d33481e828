/* SPDX-License-Identifier: MIT */
/*
 * A child process for code that may do anything: crash, leave, hang, take all memory. It is watched, it can
 * be ended with all that it started, and how it ended is a value and a sentence. It protects from mistakes,
 * not from attacks: the code runs with the user's rights.
 *
 * The child has a process group of its own, dies with its parent, leaves no core dump and reads nothing from
 * the terminal. What it has started ends with it, in whatever session: this process and the child are
 * subreapers, so orphans come to one of them. Parent and child talk through a channel, a socket that keeps
 * messages apart (SOCK_SEQPACKET).
 */
#ifndef HS_CHILD_H
#define HS_CHILD_H

#include "base/error.h"

#include <stddef.h>
#include <stdint.h>
#include <sys/types.h>

/* What a child may take; 0 is no limit. */
typedef struct {
    uint64_t memory_bytes; /* memory of its own that it has touched (shared mappings do not count) */
    uint64_t said_bytes;   /* of its output that are shown until hs_child_dropped; with hs_child_exec only */
} hs_child_limits;

typedef enum {
    HS_CHILD_RUNS = 0,
    HS_CHILD_LEFT,    /* it ended by itself, or something in it called exit: `number` is the exit code */
    HS_CHILD_CRASHED, /* a signal ended it: `number` */
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
    pid_t pid;   /* 0: none, or it ended */
    int channel; /* the parent's end; valid while there is a child and until hs_child_close */
    int output;  /* what it prints comes out here; -1: nothing more */
    uint64_t said;
    hs_child_limits limits;
    hs_child_end end;
} hs_child;

/* Runs `work` in a fork of this process, which must have one thread and must not have touched OpenCL. The
 * child ends by _exit with what `work` returns: no exit handlers, no flush of what the parent had buffered.
 * HS_ERR_MEMORY. */
bool hs_child_fork(hs_child *child, const hs_child_limits *limits, int (*work)(int channel, void *context),
                   void *context, hs_error *err);

#define HS_CHILD_CHANNEL    3  /* the channel's descriptor in a program that hs_child_exec started */
#define HS_CHILD_MAX_PASSED 8u /* descriptors that can be handed to it */

/* Starts a program, from a process of any kind. Of the parent's descriptors it has standard input (empty),
 * output and error (both shown on the parent's standard error while it waits), the channel (3) and the
 * `passed` ones (4, 5, ...). `argv` ends with NULL. HS_ERR_MEMORY (no process), HS_ERR_INPUT (the program
 * cannot be run). */
bool hs_child_exec(hs_child *child, const hs_child_limits *limits, const char *program, char *const argv[],
                   const int *passed, uint32_t passed_count, hs_error *err);

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

/* Bytes of its output beyond the limit, which nobody saw, since the last call. The limit holds anew. */
uint64_t hs_child_dropped(hs_child *child);

/* Kills the child and everything that it has started, and notes why. How it ended before counts more: a
 * child that has crashed was not late. `seconds` is for HS_CHILD_LATE. */
void hs_child_kill(hs_child *child, hs_child_fate why, double seconds);

/* Kills the child if there still is one and closes the channel. Safe on a zeroed struct; zeroes it. */
void hs_child_close(hs_child *child);

/* One whole message through a channel, from either side. `bytes` is its exact length. False if the other side
 * has gone, or (receive) the message has another length; receive waits for one. */
bool hs_child_send(int channel, const void *message, size_t bytes);
bool hs_child_receive(int channel, void *message, size_t bytes);

/* "crashed: SIGSEGV", "aborted", "left by exit(0)", "ran out of time (2.0 s)", "took more than 1024 MiB". */
void hs_child_tell(const hs_child_end *end, char *out, size_t bytes);

#endif
