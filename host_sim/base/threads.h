/* SPDX-License-Identifier: MIT */
/* Runs a loop over independent blocks on several threads. */
#ifndef HS_THREADS_H
#define HS_THREADS_H

#include <stdint.h>

/* Called once for every block 0 .. blocks - 1, on any thread, in any order. */
typedef void (*hs_block_fn)(void *context, uint32_t block);

#define HS_MAX_THREADS 64u

/* Calls fn for all blocks and returns when they are done. `threads` is at most HS_MAX_THREADS, the calling
 * one included. If a thread cannot be started, the others do its blocks. */
void hs_parallel(uint32_t threads, uint32_t blocks, hs_block_fn fn, void *context);

/* `wanted`, or the number of processors if it is 0; at most HS_MAX_THREADS. */
uint32_t hs_thread_count(uint32_t wanted);

#endif
