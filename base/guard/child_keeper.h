/* SPDX-License-Identifier: MIT */
/*
 * A child on Linux is two processes: a keeper, which the parent has started, and the worker, which it has
 * started itself and in which the code runs. However the parent ends, its end of the line between them
 * closes, and the keeper ends the worker with all that this one has started. Otherwise it ends as the worker
 * did.
 */
#pragma once

#include <stdint.h>
#include <sys/types.h>

/* The worker's id, which the keeper tells on the line; 0: not yet. */
pid_t hs_child_worker(int line);
