/* SPDX-License-Identifier: MIT */
/* What child_watch.c asks of the system: child_posix.c and child_windows.c. */
#pragma once

#include "guard/child.h"

/* The channel, the system's own (Windows: what is rung with a message; Linux: the keeper's line), and what is
 * passed. */
#define HS_CHILD_HANDLES (HS_CHILD_MAX_PASSED + 2u)

/* The argument by which a child finds its handles. */
void hs_child_mark(char *out, size_t bytes, const intptr_t *list, uint32_t count);

/* The arguments that hs_child_take has seen. */
char **hs_child_arguments(void);

/* In a child: handle n of these. */
intptr_t hs_child_handle(uint32_t n);

/* True if this process could have been handed that as its channel. */
bool hs_child_is_channel(intptr_t handle);

/* In a child, before it does anything else. */
void hs_child_settle(intptr_t handle);

/* Fills in process, channel, output, job and bell. argv[argc - 1] is free for the mark. */
bool hs_process_start(hs_child *child, const char *program, char **argv, uint32_t argc,
                      const intptr_t *passed, uint32_t passed_count, hs_error *err);

/* Collects a child that has ended, with all that it has started, and tells how: LEFT or CRASHED. *killed: by
 * hs_process_kill, or by somebody else like that. False: it runs. */
bool hs_process_collect(hs_child *child, bool waits, hs_child_end *end, bool *killed);
void hs_process_kill(hs_child *child);
void hs_process_close(hs_child *child);

/* Waits up to `ms` for a message or output. True: there is a message, or the channel was closed. */
bool hs_process_stirs(hs_child *child, int ms);
bool hs_process_has_message(const hs_child *child);

/* Lets `ms` pass, or less if the child ends. */
void hs_process_pause(const hs_child *child, int ms);

/* Some of its output; 0: there will be no more, -1: not now. */
ptrdiff_t hs_process_read(hs_child *child, char *text, size_t bytes);

/* Bytes of memory that the child shares with nobody; 0 if the system does not tell. */
uint64_t hs_process_memory(hs_child *child);

/* "crashed: SIGSEGV". */
void hs_process_tell_crash(int number, char *out, size_t bytes);
