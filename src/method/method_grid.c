/* SPDX-License-Identifier: MIT */
#include "method/method_grid.h"

#include "device/queue.h"
#include "grid/grid_shared.h"
#include "kernels_grid.h"

#include <math.h>

enum {
    K_SUMS,
    K_MEANS,
    K_ENTER,
    K_WEIGHTS,
    K_SMOOTH,
    K_RESIDUAL,
    K_RESTRICT,
    K_PROLONG,
    K_DOT,
    K_SCALAR,
    K_ADVANCE,
    K_ADD,
    K_TURN,
    K_LEAVE
};
const char *const sv_grid_kernels[] = {
    "grid_sums",     "grid_means",    "grid_enter",   "grid_weights", "grid_smooth",
    "grid_residual", "grid_restrict", "grid_prolong", "grid_dot",     "grid_scalar",
    "grid_advance",  "grid_add",      "grid_turn",    "grid_leave",   NULL};

/* Over all levels: data weights; z and a second map for smoothing; the right-hand sides of a cycle (level 0:
 * r); direction (for the start: the levels' own right-hand sides); solution. Then the rows' parts of dot
 * products, with the scalars behind them. */
enum { WEIGHTS, Z, SPARE, R, DIRECTION, SOLUTION, PARTIAL, SCALARS };
enum { SCALAR_COUNT = 4 };

/* What a solve hands down. */
typedef struct {
    const sv_map *m;
    sv_method_state *s;
    uint32_t planes;
    const sv_grid_energy *energy;
} solver;

/* A grid that is twice as coarse bends a quarter as stiffly (the sum of squared second differences falls by
 * 16, and a pixel stands for 4). */
static sv_grid_level level_of(const solver *v, uint32_t n) {
    const sv_levels *l = &v->s->levels;
    const float spacing = (float)v->m->spacing;
    return (sv_grid_level){.width = l->width[n],
                           .height = l->height[n],
                           .offset = l->offset[n],
                           .pixels = l->pixels,
                           .tension = v->energy->tension,
                           .bending = ldexpf(v->energy->bending, -2 * (int)n) / (spacing * spacing)};
}

sv_source sv_grid_source(void) {
    return (sv_source){sv_kernels_grid, sv_kernels_grid_size};
}

uint32_t sv_grid_commands(const sv_config *config) {
    (void)config;
    return (SV_MAX_SOLVER_STEPS + SV_MAX_LEVELS) * (8 + 7 * SV_MAX_LEVELS) + SV_MAX_LEVELS + 6;
}

sv_status sv_grid_buffers(const sv_map *m, sv_method_state *s) {
    s->levels = sv_levels_make(m->width, m->height);
    const size_t real = m->doubles ? sizeof(cl_double) : sizeof(cl_float);
    const size_t all = (size_t)s->levels.pixels * real;
    const size_t bytes[] = {[WEIGHTS] = all,
                            [Z] = 2 * all,
                            [SPARE] = 2 * all,
                            [R] = 2 * all,
                            [DIRECTION] = 2 * all,
                            [SOLUTION] = 2 * all,
                            [PARTIAL] = 3 * (size_t)m->height * real,
                            [SCALARS] = (size_t)2 * SCALAR_COUNT * real};
    return sv_buffers_make(m->queue, bytes, sizeof bytes / sizeof *bytes, s->buffer);
}

static sv_launch begin(const solver *v, int kernel, uint32_t level) {
    sv_launch l = sv_launch_begin(v->m->queue, v->s->kernels.kernel[kernel], sv_grid_kernels[kernel]);
    const sv_grid_level g = level_of(v, level);
    sv_launch_arg(&l, sizeof g, &g);
    return l;
}

/* The last argument of every kernel, and the launch over a level's pixels. */
static sv_status over_pixels(const solver *v, sv_launch *l, uint32_t level) {
    sv_launch_buffer(l, v->m->record);
    return sv_launch_pixels(l, v->s->levels.width[level], v->s->levels.height[level], SV_STAGE_RECONSTRUCT);
}

/* The same, 8 pixels of a row per work item. */
static sv_status over_rows(const solver *v, sv_launch *l, uint32_t level) {
    sv_launch_buffer(l, v->m->record);
    return sv_launch_grid(l, (v->s->levels.width[level] + 7) / 8, v->s->levels.height[level],
                          SV_STAGE_RECONSTRUCT);
}

static void buffers(const solver *v, sv_launch *l, const int *which) {
    for (; *which >= 0; which++) sv_launch_buffer(l, v->s->buffer[*which]);
}
#define BUFFERS(v, l, ...) buffers(v, l, (const int[]){__VA_ARGS__, -1})

static void second_level(const solver *v, sv_launch *l, uint32_t level) {
    const sv_grid_level g = level_of(v, level);
    sv_launch_arg(l, sizeof g, &g);
}

/* The mean depth of the points. */
static sv_status means(const solver *v) {
    sv_launch l = begin(v, K_SUMS, 0);
    sv_launch_uint(&l, v->m->padded_width);
    sv_launch_buffer(&l, v->m->points);
    BUFFERS(v, &l, PARTIAL);
    sv_launch_buffer(&l, v->m->record);
    const sv_status status = sv_launch_items(&l, v->m->height, SV_STAGE_RECONSTRUCT);
    if (status != SV_OK) return status;
    l = begin(v, K_MEANS, 0);
    BUFFERS(v, &l, PARTIAL, SCALARS);
    sv_launch_buffer(&l, v->m->record);
    return sv_launch_items(&l, 1, SV_STAGE_RECONSTRUCT);
}

/* Data weights and right-hand sides on all levels. */
static sv_status enter(const solver *v) {
    const float weight = (float)v->m->values.of[SV_PARAM_DATA_WEIGHT];
    sv_launch l = begin(v, K_ENTER, 0);
    sv_launch_uint(&l, v->m->padded_width);
    sv_launch_arg(&l, sizeof weight, &weight);
    sv_launch_uint(&l, v->planes);
    sv_launch_buffer(&l, v->m->points);
    BUFFERS(v, &l, SCALARS, WEIGHTS, DIRECTION);
    sv_status status = over_pixels(v, &l, 0);
    for (uint32_t n = 0; status == SV_OK && n + 1 < v->s->levels.count; n++) {
        l = begin(v, K_WEIGHTS, n);
        second_level(v, &l, n + 1);
        sv_launch_uint(&l, v->planes);
        BUFFERS(v, &l, WEIGHTS, DIRECTION);
        status = over_pixels(v, &l, n + 1);
    }
    return status;
}

static sv_status smooth(const solver *v, uint32_t level, float omega, bool zero, int b, int from, int to) {
    sv_launch l = begin(v, K_SMOOTH, level);
    sv_launch_uint(&l, v->planes);
    sv_launch_arg(&l, sizeof omega, &omega);
    sv_launch_uint(&l, zero);
    BUFFERS(v, &l, WEIGHTS, b, from, to);
    return over_rows(v, &l, level);
}

/* to = b - A from; without `with_b`: A from. */
static sv_status residual(const solver *v, uint32_t level, bool with_b, int b, int from, int to) {
    sv_launch l = begin(v, K_RESIDUAL, level);
    sv_launch_uint(&l, v->planes);
    sv_launch_uint(&l, with_b);
    BUFFERS(v, &l, WEIGHTS, b, from, to);
    return over_rows(v, &l, level);
}

/* Down one level: two smoothing steps from 0, and the rest becomes the coarser right-hand side. */
static sv_status descend(const solver *v, uint32_t level) {
    sv_status status = smooth(v, level, v->energy->omega[0], true, R, SPARE, SPARE);
    if (status == SV_OK) status = smooth(v, level, v->energy->omega[1], false, R, SPARE, Z);
    if (status == SV_OK) status = residual(v, level, true, R, Z, SPARE);
    if (status != SV_OK) return status;
    sv_launch l = begin(v, K_RESTRICT, level);
    second_level(v, &l, level + 1);
    sv_launch_uint(&l, v->planes);
    BUFFERS(v, &l, SPARE, R);
    return over_pixels(v, &l, level + 1);
}

/* Values of the next coarser level, in place of the level's own or added to them. */
static sv_status prolong(const solver *v, uint32_t level, bool add, int map) {
    sv_launch l = begin(v, K_PROLONG, level);
    second_level(v, &l, level + 1);
    sv_launch_uint(&l, v->planes);
    sv_launch_uint(&l, add);
    BUFFERS(v, &l, map);
    return over_pixels(v, &l, level);
}

/* Up again: the correction, and the smoothing steps in reverse order, which keeps the cycle symmetric. */
static sv_status ascend(const solver *v, uint32_t level) {
    sv_status status = prolong(v, level, true, Z);
    if (status == SV_OK) status = smooth(v, level, v->energy->omega[1], false, R, Z, SPARE);
    return status == SV_OK ? smooth(v, level, v->energy->omega[0], false, R, SPARE, Z) : status;
}

/* z = the V-cycle applied to r, from a level on. */
static sv_status cycle(const solver *v, uint32_t first) {
    const uint32_t last = v->s->levels.count - 1;
    sv_status status = SV_OK;
    for (uint32_t n = first; status == SV_OK && n < last; n++) status = descend(v, n);
    /* One pixel is left: a full step solves it. */
    if (status == SV_OK) status = smooth(v, last, 1.0f, true, R, SPARE, Z);
    for (uint32_t n = last; status == SV_OK && n-- > first;) status = ascend(v, n);
    return status;
}

/* Where the iteration starts: every level, the coarsest first, takes the coarser one's surface and improves
 * it by one cycle; the map itself only takes it, and the iteration goes on from there. */
static sv_status start(const solver *v) {
    uint32_t n = v->s->levels.count - 1;
    sv_status status = smooth(v, n, 1.0f, true, DIRECTION, SPARE, SOLUTION);
    while (status == SV_OK && n-- > 0) {
        status = prolong(v, n, false, SOLUTION);
        if (status == SV_OK) status = residual(v, n, true, DIRECTION, SOLUTION, R);
        if (n == 0 || status != SV_OK) continue;
        status = cycle(v, n);
        if (status != SV_OK) return status;
        sv_launch l = begin(v, K_ADD, n);
        sv_launch_uint(&l, v->planes);
        BUFFERS(v, &l, Z, SOLUTION);
        status = over_pixels(v, &l, n);
    }
    return status;
}

/* A dot product of two maps, and what follows from it. `beta`: as in grid_scalar. */
static sv_status scalar(const solver *v, uint32_t beta, int a, int b) {
    sv_launch l = begin(v, K_DOT, 0);
    sv_launch_uint(&l, v->planes);
    BUFFERS(v, &l, a, b, PARTIAL);
    sv_launch_buffer(&l, v->m->record);
    const sv_status status = sv_launch_items(&l, v->m->height, SV_STAGE_RECONSTRUCT);
    if (status != SV_OK) return status;
    l = begin(v, K_SCALAR, 0);
    sv_launch_uint(&l, v->planes);
    sv_launch_uint(&l, beta);
    BUFFERS(v, &l, PARTIAL, SCALARS);
    sv_launch_buffer(&l, v->m->record);
    return sv_launch_items(&l, 1, SV_STAGE_RECONSTRUCT);
}

/* The next direction: z = M r, p = z + beta p. */
static sv_status turn(const solver *v, bool first) {
    sv_status status = cycle(v, 0);
    if (status == SV_OK) status = scalar(v, first ? 2 : 1, R, Z);
    if (status != SV_OK) return status;
    sv_launch l = begin(v, K_TURN, 0);
    sv_launch_uint(&l, v->planes);
    BUFFERS(v, &l, SCALARS, Z, DIRECTION);
    return over_pixels(v, &l, 0);
}

/* A step along it: S += alpha p, r -= alpha A p. */
static sv_status advance(const solver *v) {
    sv_status status = residual(v, 0, false, R, DIRECTION, SPARE);
    if (status == SV_OK) status = scalar(v, 0, DIRECTION, SPARE);
    if (status != SV_OK) return status;
    sv_launch l = begin(v, K_ADVANCE, 0);
    sv_launch_uint(&l, v->planes);
    BUFFERS(v, &l, SCALARS, DIRECTION, SPARE, SOLUTION, R);
    return over_pixels(v, &l, 0);
}

uint32_t sv_grid_steps(const sv_map *m, const sv_grid_energy *energy) {
    const uint32_t wanted = (uint32_t)m->values.of[SV_PARAM_SOLVER_STEPS];
    return wanted ? wanted : energy->steps;
}

/* Conjugate gradients to the steps' end: float64 within a thousandth of a slice, float32
 * within a hundredth. */
double sv_grid_bound(const sv_map *m) {
    return m->doubles ? 1e-3 : 1e-2;
}

sv_status sv_grid_solve(const sv_map *m, sv_method_state *s, uint32_t planes, const sv_grid_energy *energy) {
    const solver v = {m, s, planes, energy};
    const uint32_t steps = sv_grid_steps(m, energy);
    sv_status status = means(&v);
    if (status == SV_OK) status = enter(&v);
    if (status == SV_OK) status = start(&v);
    for (uint32_t n = 0; status == SV_OK && n < steps; n++) {
        status = turn(&v, n == 0);
        if (status == SV_OK) status = advance(&v);
    }
    if (status != SV_OK) return status;
    sv_launch l = begin(&v, K_LEAVE, 0);
    sv_launch_uint(&l, m->padded_width);
    sv_launch_uint(&l, planes);
    BUFFERS(&v, &l, SCALARS, SOLUTION);
    sv_launch_buffer(&l, m->surfaces);
    return over_pixels(&v, &l, 0);
}
