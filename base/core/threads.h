/* SPDX-License-Identifier: MIT */
/* Runs a loop over independent blocks on several threads. */
#pragma once

#include "core/error.h"

#include <stdint.h>

/* Called once for every block 0 .. blocks - 1, on any thread, in any order. */
typedef void (*hs_block_fn)(void *context, uint32_t block);

#define HS_MAX_THREADS 64u

/* Calls fn for all blocks and returns when they are done. `threads` is at most HS_MAX_THREADS, the calling
 * one included. If a thread cannot be started, the others do its blocks. */
void hs_parallel(uint32_t threads, uint32_t blocks, hs_block_fn fn, void *context);

/* The same for blocks that may fail; `err` is the block's own until it returns. From the first failure on
 * blocks behind it may be left out, so that the failure told is always that of the first block that fails;
 * with one thread the blocks come in order, and none follows it. */
typedef bool (*hs_block_try_fn)(void *context, uint32_t block, hs_error *err);
bool hs_parallel_try(uint32_t threads, uint32_t blocks, hs_block_try_fn fn, void *context, hs_error *err);

/* `wanted`, or the number of processors if it is 0; at most HS_MAX_THREADS. */
uint32_t hs_thread_count(uint32_t wanted);
