/* SPDX-License-Identifier: MIT */
/* Runs a loop over independent blocks on several threads. */
#ifndef HS_THREADS_H
#define HS_THREADS_H

#include <stdint.h>

/* Called once for every block 0 .. blocks - 1, on any thread, in any order. */
typedef void (*hs_block_fn)(void *context, uint32_t block);

/* Returns when all blocks are done. Threads that cannot be started are done without: the blocks all run. */
void hs_scene_parallel(uint32_t threads, uint32_t blocks, hs_block_fn fn, void *context);

/* `wanted`, or the number of processors if it is 0; at most HS_SCENE_MAX_THREADS. */
#define HS_SCENE_MAX_THREADS 64u
uint32_t hs_scene_thread_count(uint32_t wanted);

#endif
