/* SPDX-License-Identifier: MIT */
/* A whole frame in plain C on two threads: each has half of the rows, and they meet after every step. */
#include "bench/plain_frame.h"

#include "bench/plain_mean.h"
#include "bench/plain_profile.h"
#include "bench/plain_surface.h"
#include "smartvis_plugin.h"

#include <stdlib.h>
#include <string.h>

enum { PASS_SETS = 2 };

/* One thread's own. */
typedef struct {
    uint32_t *rows; /* of the mean filter */
    uint32_t points;
    uint32_t unfilled[PASS_SETS]; /* after even and after odd passes */
    uint8_t maximum;
    char apart[64]; /* the threads' results share no cache line */
} worker;

struct plain_frame {
    bench_team *team;
    plain_settings settings;
    plain_rays rays;
    plain_maps maps;
    worker workers[BENCH_THREADS];
    uint32_t passes;
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
    mine->maximum = plain_profile(v, f->settings.fluid_level, y0, y1, &f->rays);
    bench_team_barrier(f->team);
    mine->points = find_points(f, bone_level(f), y0, y1);
    bench_team_barrier(f->team);
    if (f->workers[0].points + f->workers[1].points == 0) {
        memset(f->depth + from, 0, count * sizeof *f->depth);
        if (thread == 0) f->passes = 0;
        return;
    }
    uint32_t pass = 0;
    do {
        mine->unfilled[pass % PASS_SETS] = plain_mean(&f->maps, pass, y0, y1, mine->rows);
        bench_team_barrier(f->team);
    } while (unfilled_after(f, pass++) > 0);
    if (thread == 0) f->passes = pass;
    plain_blend(count, f->settings.q, f->maps.surface[PLAIN_NEAR] + from, f->maps.surface[PLAIN_FAR] + from,
                f->depth + from);
}

uint32_t plain_frame_run(plain_frame *f, const plain_volume *volume, float *depth, uint8_t *status) {
    f->volume = volume;
    f->depth = depth;
    f->status = status;
    f->maps.status = status;
    bench_team_run(f->team, frame_job, f);
    return f->passes;
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

plain_frame *plain_frame_create(bench_team *team, uint32_t width, uint32_t height, uint32_t slices,
                                const plain_settings *settings, hs_error *err) {
    const uint32_t fraction = plain_fraction(slices, settings->k);
    if (fraction < PLAIN_MIN_FRACTION) {
        (void)hs_fail(err, HS_ERR_USAGE, "plain C: %u x %u x %u with k = %u is out of its range", width,
                      height, slices, settings->k);
        return NULL;
    }
    plain_frame *f = calloc(1, sizeof *f);
    if (f) {
        f->team = team;
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
