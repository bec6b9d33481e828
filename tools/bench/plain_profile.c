/* SPDX-License-Identifier: MIT */
/*
 * Ray profiles in plain C. Positions are 8-bit and relative to a group of slices, so that the loops over x
 * have 8-bit lanes only; the compiler vectorises them (gcc -fopt-info-vec says so) and keeps a block's state
 * in registers from slice to slice, because its arrays are local and of constant length.
 *
 * A volume that fits the cache is walked in groups as long as 8 bits allow. Of a larger one, 16 slices at a
 * time are walked in all rows before the next 16, each row fetching the next: 64 bytes from each of hundreds
 * of slices is a poor way to read memory.
 */
#include "bench/plain_profile.h"

#include <stdbool.h>

#include <string.h>

enum { BLOCK = PLAIN_BLOCK, CACHED_GROUP = 254, STREAMED_GROUP = 16 };
#define CACHE_BYTES (16u << 20)

/* `yes` where the mask is 255, `no` where it is 0. gcc 12 makes four times faster code of this than of ?:
 * (masked stores and loads from memory are slow on some CPUs). */
static inline uint8_t choose(uint8_t mask, uint8_t yes, uint8_t no) {
    return (uint8_t)((yes & mask) | (no & ~mask));
}

/* One slice for a block of rays. Positions: 0 for "not since the group began". tissue: 255 or 0. */
static inline void profile_slice(const uint8_t *restrict voxels, uint8_t level, uint8_t position,
                                 uint8_t *restrict maximum, uint8_t *restrict tissue, uint8_t *restrict entry,
                                 uint8_t *restrict exit, uint8_t *restrict max_entry,
                                 uint8_t *restrict max_exit) {
    for (uint32_t x = 0; x < BLOCK; x++) {
        const uint8_t is_tissue = voxels[x] > level ? 255 : 0;
        const uint8_t larger = voxels[x] > maximum[x] ? 255 : 0;
        entry[x] = choose((uint8_t)(is_tissue & ~tissue[x]), position, entry[x]);
        exit[x] = choose((uint8_t)(tissue[x] & ~is_tissue), position, exit[x]);
        maximum[x] = voxels[x] > maximum[x] ? voxels[x] : maximum[x];
        max_entry[x] = choose(larger, entry[x], max_entry[x]);
        max_exit[x] = choose(larger, exit[x], max_exit[x]);
        tissue[x] = is_tissue;
    }
}

/* What was current at the maximum, for a block whose maximum the group may have raised; `last` is the last
 * crossing before the group. A relative position of 1 is slice base + 1. */
static inline void merge_maximum(const uint8_t *restrict maximum, const uint8_t *restrict before,
                                 const uint8_t *restrict relative, const uint16_t *restrict last,
                                 uint16_t base, uint16_t *restrict at_maximum) {
    for (uint32_t x = 0; x < BLOCK; x++) {
        const uint16_t position = relative[x] ? (uint16_t)(relative[x] + base) : last[x];
        at_maximum[x] = maximum[x] > before[x] ? position : at_maximum[x];
    }
}

/* The last crossing itself. */
static inline void merge_last(const uint8_t *restrict relative, uint16_t base, uint16_t *restrict last) {
    for (uint32_t x = 0; x < BLOCK; x++) {
        const uint16_t position = (uint16_t)(relative[x] + base);
        last[x] = relative[x] ? position : last[x];
    }
}

/* Slices first .. first + count - 1 of the rays from (x, y); their state is at `at`. `ahead`: fetch the next
 * row's voxels from memory meanwhile. */
static void profile_block(const plain_volume *v, uint8_t level, size_t x, size_t y, uint32_t first,
                          uint32_t count, bool ahead, const plain_rays *rays, size_t at) {
    const uint16_t base = (uint16_t)(first - 1u);
    uint8_t maximum[BLOCK], before[BLOCK], tissue[BLOCK];
    uint8_t entry[BLOCK] = {0}, exit[BLOCK] = {0}, max_entry[BLOCK] = {0}, max_exit[BLOCK] = {0};
    memcpy(maximum, rays->maximum + at, BLOCK);
    memcpy(before, maximum, BLOCK);
    memcpy(tissue, rays->tissue + at, BLOCK);
    if (ahead) /* the same columns one row below: 64 bytes a slice are no stream the hardware would foresee */
        for (uint32_t i = 0; i < count; i++) __builtin_prefetch(v->slice[first + i] + (y + 1) * v->pitch + x);
    for (uint32_t i = 0; i < count; i++)
        profile_slice(v->slice[first + i] + y * v->pitch + x, level, (uint8_t)(i + 1), maximum, tissue, entry,
                      exit, max_entry, max_exit);
    merge_maximum(maximum, before, max_entry, rays->entry + at, base, rays->max_entry + at);
    merge_maximum(maximum, before, max_exit, rays->exit + at, base, rays->max_exit + at);
    merge_last(entry, base, rays->entry + at);
    merge_last(exit, base, rays->exit + at);
    memcpy(rays->maximum + at, maximum, BLOCK);
    memcpy(rays->tissue + at, tissue, BLOCK);
}

static uint8_t row_maximum(const uint8_t *maximum, uint32_t width) {
    uint8_t largest = 0;
    for (uint32_t x = 0; x < width; x++) largest = maximum[x] > largest ? maximum[x] : largest;
    return largest;
}

static void clear_rays(const plain_rays *rays, size_t at, size_t count) {
    memset(rays->maximum + at, 0, count);
    memset(rays->tissue + at, 255, count); /* a ray starts as if in tissue */
    uint16_t *const words[] = {rays->entry, rays->exit, rays->max_entry, rays->max_exit};
    for (int i = 0; i < 4; i++) memset(words[i] + at, 0, count * sizeof(uint16_t));
}

uint8_t plain_profile(const plain_volume *v, uint8_t fluid_level, uint32_t y0, uint32_t y1,
                      const plain_rays *rays) {
    const bool cached = (uint64_t)v->width * v->height * v->slices <= CACHE_BYTES;
    const uint32_t group = cached ? CACHED_GROUP : STREAMED_GROUP;
    uint8_t largest = 0;
    clear_rays(rays, y0 * rays->stride, (y1 - y0) * rays->stride);
    for (uint32_t first = 0; first < v->slices; first += group) {
        const uint32_t count = v->slices - first < group ? v->slices - first : group;
        for (uint32_t y = y0; y < y1; y++)
            for (uint32_t x = 0; x < v->width; x += BLOCK)
                profile_block(v, fluid_level, x, y, first, count, !cached, rays, y * rays->stride + x);
    }
    for (uint32_t y = y0; y < y1; y++) {
        const uint8_t row = row_maximum(rays->maximum + y * rays->stride, v->width);
        if (row > largest) largest = row;
    }
    return largest;
}
