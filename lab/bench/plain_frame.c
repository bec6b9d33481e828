/* SPDX-License-Identifier: MIT */
#include "bench/bench.h"
#include "bench/plain.h"
#include "smartvis_plugin.h"

#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

/* ---------------------------------------------------------------------------------------- ray profiles -- */
/*
 * Ray profiles in plain C. Positions are 8-bit and relative to a group of slices, so that the loops over x
 * have 8-bit lanes only; the compiler vectorises them (gcc -fopt-info-vec says so) and keeps a block's state
 * in registers from slice to slice, because its arrays are local and of constant length.
 *
 * A volume that fits the cache is walked in groups as long as 8 bits allow. Of a larger one, 16 slices at a
 * time are walked in all rows before the next 16, each row fetching the next: 64 bytes from each of hundreds
 * of slices is a poor way to read memory.
 */

/* Rays that are walked together. */
enum { PLAIN_BLOCK = 64 };

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

/* Keeps the position of the last crossing. */
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

/* Profiles of rows y0 .. y1 - 1. Returns their largest intensity. */
static uint8_t profile_rows(const plain_volume *v, uint8_t fluid_level, uint32_t y0, uint32_t y1,
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

/* ----------------------------------------------------------------------------------------------- frame -- */
/* A whole frame in plain C on two threads: each has half of the rows, and they meet after every step. */

enum { PASS_SETS = 2 };

/* What one thread writes alone. */
typedef struct {
    uint32_t *rows; /* of the mean filter */
    uint32_t points;
    uint32_t unfilled[PASS_SETS]; /* after even and after odd passes */
    uint8_t maximum;
    char apart[64]; /* the threads' results share no cache line */
} worker;

struct plain_frame {
    bench_barrier barrier;
    plain_settings settings;
    plain_rays rays;
    plain_maps maps;
    worker workers[BENCH_THREADS];
    const plain_volume *volume; /* of the frame under way */
    float *depth;
    uint8_t *status;
};

/* Status and first weight of `count` rays. Returns the initial points. */
static uint32_t mark_points(size_t count, uint8_t level, const uint8_t *restrict maximum,
                            const uint16_t *restrict entry, const uint16_t *restrict exit,
                            uint8_t *restrict status, uint32_t *restrict weight) {
    uint32_t points = 0;
    for (size_t i = 0; i < count; i++) {
        const uint8_t code = entry[i] > exit[i] ? SV_POINT_INITIAL : SV_POINT_EMPTY;
        const uint32_t bone = maximum[i] > level;
        status[i] = bone ? code : SV_POINT_NONE;
        weight[i] = bone * PLAIN_INITIAL;
        points += bone;
    }
    return points;
}

static uint32_t find_points(plain_frame *f, uint8_t level, uint32_t y0, uint32_t y1) {
    const plain_rays *rays = &f->rays;
    uint32_t *const *sums = f->maps.sums[0];
    const size_t width = f->maps.width;
    uint32_t points = 0;
    for (uint32_t y = y0; y < y1; y++) {
        const size_t ray = y * rays->stride, at = y * width;
        points += mark_points(width, level, rays->maximum + ray, rays->max_entry + ray, rays->max_exit + ray,
                              f->status + at, sums[PLAIN_WEIGHT] + at);
        plain_weigh_points(width, f->maps.fraction, f->status + at, rays->max_exit + ray,
                           sums[PLAIN_NEAR] + at);
        plain_weigh_points(width, f->maps.fraction, f->status + at, rays->max_entry + ray,
                           sums[PLAIN_FAR] + at);
    }
    return points;
}

static uint8_t bone_level(const plain_frame *f) {
    uint8_t maximum = 0;
    for (unsigned t = 0; t < BENCH_THREADS; t++)
        if (f->workers[t].maximum > maximum) maximum = f->workers[t].maximum;
    const uint8_t drop = f->settings.bone_drop;
    const uint8_t level = maximum > drop ? (uint8_t)(maximum - drop) : 0;
    return level > f->settings.fluid_level ? level : f->settings.fluid_level;
}

static uint32_t unfilled_after(const plain_frame *f, uint32_t pass) {
    return f->workers[0].unfilled[pass % PASS_SETS] + f->workers[1].unfilled[pass % PASS_SETS];
}

static void frame_job(void *context, unsigned thread) {
    plain_frame *f = context;
    const plain_volume *v = f->volume;
    const uint32_t y0 = v->height * thread / BENCH_THREADS, y1 = v->height * (thread + 1) / BENCH_THREADS;
    const size_t from = (size_t)y0 * v->width, count = (size_t)(y1 - y0) * v->width;
    worker *mine = &f->workers[thread];
    mine->maximum = profile_rows(v, f->settings.fluid_level, y0, y1, &f->rays);
    bench_barrier_wait(&f->barrier);
    mine->points = find_points(f, bone_level(f), y0, y1);
    bench_barrier_wait(&f->barrier);
    if (f->workers[0].points + f->workers[1].points == 0) {
        memset(f->depth + from, 0, count * sizeof *f->depth);
        return;
    }
    uint32_t pass = 0;
    do {
        mine->unfilled[pass % PASS_SETS] = plain_mean(&f->maps, pass, y0, y1, mine->rows);
        bench_barrier_wait(&f->barrier);
    } while (unfilled_after(f, pass++) > 0);
    plain_blend(count, f->settings.q, f->maps.surface[PLAIN_NEAR] + from, f->maps.surface[PLAIN_FAR] + from,
                f->depth + from);
}

bool plain_frame_run(plain_frame *f, const plain_volume *volume, float *depth, uint8_t *status, double *ms,
                     hs_error *err) {
    f->volume = volume;
    f->depth = depth;
    f->status = status;
    f->maps.status = status;
    return bench_two_run(frame_job, f, ms, err);
}

static void *zeroed(size_t count, size_t size, bool *ok) {
    void *memory = calloc(count, size);
    *ok = *ok && memory;
    return memory;
}

static bool allocate(plain_frame *f) {
    const size_t count = (size_t)f->maps.width * f->maps.height;
    bool ok = true;
    f->rays.stride = (f->maps.width + PLAIN_BLOCK - 1) / PLAIN_BLOCK * PLAIN_BLOCK;
    const size_t rays = f->rays.stride * f->maps.height;
    f->rays.maximum = zeroed(rays, sizeof(uint8_t), &ok);
    f->rays.tissue = zeroed(rays, sizeof(uint8_t), &ok);
    uint16_t **const words[] = {&f->rays.entry, &f->rays.exit, &f->rays.max_entry, &f->rays.max_exit};
    for (int i = 0; i < 4; i++) *words[i] = zeroed(rays, sizeof(uint16_t), &ok);
    for (unsigned set = 0; set < 2; set++) {
        f->maps.surface[set] = zeroed(count, sizeof(float), &ok);
        for (unsigned p = 0; p < PLAIN_PLANES; p++)
            f->maps.sums[set][p] = zeroed(count, sizeof(uint32_t), &ok);
    }
    for (unsigned t = 0; t < BENCH_THREADS; t++)
        f->workers[t].rows = zeroed(plain_mean_row_values(f->maps.width, f->maps.k), sizeof(uint32_t), &ok);
    return ok;
}

plain_frame *plain_frame_create(uint32_t width, uint32_t height, uint32_t slices,
                                const plain_settings *settings, hs_error *err) {
    const uint32_t fraction = plain_fraction(slices, settings->k);
    if (fraction < PLAIN_MIN_FRACTION) {
        (void)hs_fail(err, HS_ERR_USAGE, "plain C: %u x %u x %u with k = %u is out of its range", width,
                      height, slices, settings->k);
        return NULL;
    }
    plain_frame *f = calloc(1, sizeof *f);
    if (f) {
        f->settings = *settings;
        f->maps.width = width;
        f->maps.height = height;
        f->maps.k = settings->k;
        f->maps.fraction = fraction;
        if (allocate(f)) return f;
    }
    plain_frame_destroy(f);
    (void)hs_fail(err, HS_ERR_MEMORY, "plain C: no memory for a frame of %u x %u", width, height);
    return NULL;
}

void plain_frame_destroy(plain_frame *f) {
    if (!f) return;
    free(f->rays.maximum);
    free(f->rays.tissue);
    free(f->rays.entry);
    free(f->rays.exit);
    free(f->rays.max_entry);
    free(f->rays.max_exit);
    for (unsigned set = 0; set < 2; set++) {
        free(f->maps.surface[set]);
        for (unsigned p = 0; p < PLAIN_PLANES; p++) free(f->maps.sums[set][p]);
    }
    for (unsigned t = 0; t < BENCH_THREADS; t++) free(f->workers[t].rows);
    free(f);
}
