/* SPDX-License-Identifier: MIT */
/* The children of this process that were not collected yet, and what those that ended have left behind. */
#pragma once

#include <stddef.h>
#include <sys/types.h>

/* fork for a child of which all descendants can be found: orphans of it stay below it, and come to this
 * process when it has ended. */
pid_t hs_child_fork(void);

/* A line of /proc about a process; "" if there is none. */
void hs_child_read_proc(long pid, const char *what, char *text, size_t bytes);

/* Ends what a child has left behind; it must have been collected. */
void hs_child_end_leftovers(pid_t pid);
