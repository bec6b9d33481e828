/* SPDX-License-Identifier: MIT */
/* The steps of the multigrid-preconditioned conjugate gradients; see cl/grid/grid.clh. */
#ifndef SV_METHOD_GRID_CLH
#include "grid/grid.clh"
#endif

/* Numbers of the iteration, per plane. */
#define SCALAR_RZ    0 /* r . z */
#define SCALAR_ALPHA 1
#define SCALAR_BETA  2
#define SCALAR_MEAN  3 /* of the initial depths: the iteration sees what differs from it */
#define SCALAR_COUNT 4

/* This work item's pixel; false outside, or if the frame has no point. */
#define GRID_PIXEL(level)                                                                                    \
    const int x = (int)get_global_id(0), y = (int)get_global_id(1);                                          \
    if (x >= (int)(level).width || !surface_wanted(record)) return;                                          \
    const size_t i = (level).offset + (size_t)y * (level).width + x

/* This work item's pixels: `count` of them from (x, y) on, 8 but at a row's end. */
#define GRID_ROW8(level)                                                                                     \
    const int x = (int)get_global_id(0) * 8, y = (int)get_global_id(1);                                      \
    if (!surface_wanted(record)) return;                                                                     \
    const int count = min(8, (int)(level).width - x);                                                        \
    const size_t i = (level).offset + (size_t)y * (level).width + x

/* One row per work item: count of its points and sums of their depths, 3 values a row. */
__kernel void grid_sums(sv_grid_level level, uint padded_width, __global const float *maps,
                        __global real *partial, __global const uint *record) {
    if (!surface_wanted(record)) return;
    __global const float *near = maps + get_global_id(0) * padded_width;
    __global const float *far = near + (size_t)padded_width * level.height;
    real count = 0, sum_near = 0, sum_far = 0;
    for (uint x = 0; x < level.width; x++) {
        if (isinf(near[x])) continue;
        count += 1;
        sum_near += near[x];
        sum_far += far[x];
    }
    __global real *mine = partial + 3 * get_global_id(0);
    mine[0] = count;
    mine[1] = sum_near;
    mine[2] = sum_far;
}

/* One work item: the mean depths. */
__kernel void grid_means(sv_grid_level level, __global const real *partial, __global real *scalars,
                         __global const uint *record) {
    if (!surface_wanted(record)) return;
    real sums[3] = {0, 0, 0};
    for (uint y = 0; y < level.height; y++)
        for (uint n = 0; n < 3; n++) sums[n] += partial[3 * y + n];
    for (uint p = 0; p < 2; p++) scalars[p * SCALAR_COUNT + SCALAR_MEAN] = sums[1 + p] / sums[0];
}

/* Data weights, and the right-hand side for depths less their mean: then rounding errors scale with how much
 * the depths differ, not with how deep they are. */
__kernel void grid_enter(sv_grid_level level, uint padded_width, float weight, uint planes,
                         __global const float *maps, __global const real *scalars, __global real *weights,
                         __global real *b, __global const uint *record) {
    GRID_PIXEL(level);
    const size_t from = (size_t)y * padded_width + x, plane = (size_t)padded_width * level.height;
    const bool point = !isinf(maps[from]);
    weights[i] = point ? (real)weight * (real)maps[2 * plane + from] : 0;
    for (uint p = 0; p < planes; p++) {
        const real mean = scalars[p * SCALAR_COUNT + SCALAR_MEAN];
        b[p * (size_t)level.pixels + i] = point ? weights[i] * ((real)maps[p * plane + from] - mean) : 0;
    }
}

/*
 * A coarser level's data weights and right-hand side: those of the fine pixels, shared out as their depths
 * are. A point would then hold each of its coarse pixels where it is, though it only knows their mean; so the
 * weight stops where it is a few times as stiff as the surface. Only the start and the preconditioner see
 * this: the equations that are solved do not change.
 */
#define GRID_MOST_WEIGHT 3
__kernel void grid_weights(sv_grid_level fine, sv_grid_level coarse, uint planes, __global real *weights,
                           __global real *b, __global const uint *record) {
    GRID_PIXEL(coarse);
    const real most = GRID_MOST_WEIGHT * (4 * coarse.tension + 20 * coarse.bending);
    const real sum = grid_gather(&fine, &coarse, weights + fine.offset, x, y);
    weights[i] = fmin(sum, most);
    for (uint p = 0; p < planes; p++) {
        __global real *s = b + p * (size_t)coarse.pixels;
        s[i] = sum > 0 ? grid_gather(&fine, &coarse, s + fine.offset, x, y) * (weights[i] / sum) : 0;
    }
}

/* to = from + scale (b - A from), scale = omega / diagonal; for one pixel. */
static real grid_relax(const sv_grid_level *l, float omega, __global const real *weights,
                       __global const real *b, __global const real *from, int x, int y, size_t i) {
    const real scale = omega / (grid_diagonal(l, x, y) + weights[i]);
    const real applied = grid_apply(l, from + l->offset, x, y) + weights[i] * from[i];
    return from[i] + scale * (b[i] - applied);
}

/*
 * A smoothing step, 8 pixels of a row per work item: to = from + omega (b - A from) / diagonal. From 0
 * (`zero`) nothing need be applied.
 */
__kernel void grid_smooth(sv_grid_level level, uint planes, float omega, uint zero,
                          __global const real *weights, __global const real *b, __global const real *from,
                          __global real *to, __global const uint *record) {
    GRID_ROW8(level);
    const real inner = 4 * level.tension + 20 * level.bending;
    for (uint p = 0; p < planes; p++) {
        const size_t at = p * (size_t)level.pixels;
        if (grid_inside8(&level, x, y)) {
            const real8 weight = vload8(0, weights + i), right = vload8(0, b + at + i);
            const real8 scale = (real8)(omega) / (inner + weight);
            real8 result = scale * right;
            if (!zero) {
                const real8 now = vload8(0, from + at + i);
                const real8 applied = grid_apply8(&level, from + at, i) + weight * now;
                result = now + scale * (right - applied);
            }
            vstore8(result, 0, to + at + i);
            continue;
        }
        for (int n = 0; n < count; n++)
            to[at + i + n] = zero ? omega / (grid_diagonal(&level, x + n, y) + weights[i + n]) * b[at + i + n]
                                  : grid_relax(&level, omega, weights, b + at, from + at, x + n, y, i + n);
    }
}

/* 8 pixels of a row per work item: to = b - A from; without `b`: to = A from. */
__kernel void grid_residual(sv_grid_level level, uint planes, uint with_b, __global const real *weights,
                            __global const real *b, __global const real *from, __global real *to,
                            __global const uint *record) {
    GRID_ROW8(level);
    for (uint p = 0; p < planes; p++) {
        const size_t at = p * (size_t)level.pixels;
        if (grid_inside8(&level, x, y)) {
            const real8 applied =
                grid_apply8(&level, from + at, i) + vload8(0, weights + i) * vload8(0, from + at + i);
            vstore8(with_b ? vload8(0, b + at + i) - applied : applied, 0, to + at + i);
            continue;
        }
        for (int n = 0; n < count; n++) {
            const real applied =
                grid_apply(&level, from + at + level.offset, x + n, y) + weights[i + n] * from[at + i + n];
            to[at + i + n] = with_b ? b[at + i + n] - applied : applied;
        }
    }
}

__kernel void grid_restrict(sv_grid_level fine, sv_grid_level coarse, uint planes,
                            __global const real *residual, __global real *b, __global const uint *record) {
    GRID_PIXEL(coarse);
    for (uint p = 0; p < planes; p++) {
        const size_t at = p * (size_t)fine.pixels;
        b[at + i] = grid_gather(&fine, &coarse, residual + at + fine.offset, x, y);
    }
}

/* The coarse level, linear between its pixels, in place of the fine one, or added to it. */
__kernel void grid_prolong(sv_grid_level fine, sv_grid_level coarse, uint planes, uint add, __global real *s,
                           __global const uint *record) {
    GRID_PIXEL(fine);
    const uint u0 = x / 2, u1 = grid_parent(x, coarse.width);
    const uint v0 = y / 2, v1 = grid_parent(y, coarse.height);
    for (uint p = 0; p < planes; p++) {
        const size_t at = p * (size_t)fine.pixels;
        __global const real *c = s + at + coarse.offset;
        const real near_row = (real)0.75 * c[v0 * coarse.width + u0] + (real)0.25 * c[v0 * coarse.width + u1];
        const real next_row = (real)0.75 * c[v1 * coarse.width + u0] + (real)0.25 * c[v1 * coarse.width + u1];
        const real between = (real)0.75 * near_row + (real)0.25 * next_row;
        s[at + i] = add ? s[at + i] + between : between;
    }
}

/* One row per work item: its part of a . b, per plane. */
__kernel void grid_dot(sv_grid_level level, uint planes, __global const real *a, __global const real *b,
                       __global real *partial, __global const uint *record) {
    if (!surface_wanted(record)) return;
    const size_t row = get_global_id(0) * level.width;
    for (uint p = 0; p < planes; p++) {
        real sum = 0;
        for (uint x = 0; x < level.width; x++)
            sum += a[p * (size_t)level.pixels + row + x] * b[p * (size_t)level.pixels + row + x];
        partial[p * level.height + get_global_id(0)] = sum;
    }
}

/* One work item: the step length (alpha, from p . A p) or the new direction's share of the old (beta, from
 * r . z). */
__kernel void grid_scalar(sv_grid_level level, uint planes, uint beta, __global const real *partial,
                          __global real *scalars, __global const uint *record) {
    if (!surface_wanted(record)) return;
    for (uint p = 0; p < planes; p++) {
        __global real *s = scalars + p * SCALAR_COUNT;
        real sum = 0;
        for (uint y = 0; y < level.height; y++) sum += partial[p * level.height + y];
        if (beta == 0) {
            s[SCALAR_ALPHA] = sum > 0 ? s[SCALAR_RZ] / sum : 0; /* 0: solved to the last bit */
        } else {
            s[SCALAR_BETA] =
                beta == 1 && s[SCALAR_RZ] > 0 ? sum / s[SCALAR_RZ] : 0; /* 2: the first direction */
            s[SCALAR_RZ] = sum;
        }
    }
}

/* S += alpha p, r -= alpha A p. */
__kernel void grid_advance(sv_grid_level level, uint planes, __global const real *scalars,
                           __global const real *direction, __global const real *applied,
                           __global real *solution, __global real *r, __global const uint *record) {
    GRID_PIXEL(level);
    for (uint p = 0; p < planes; p++) {
        const size_t at = p * (size_t)level.pixels + i;
        const real alpha = scalars[p * SCALAR_COUNT + SCALAR_ALPHA];
        solution[at] += alpha * direction[at];
        r[at] -= alpha * applied[at];
    }
}

/* S += z. */
__kernel void grid_add(sv_grid_level level, uint planes, __global const real *z, __global real *solution,
                       __global const uint *record) {
    GRID_PIXEL(level);
    for (uint p = 0; p < planes; p++)
        solution[p * (size_t)level.pixels + i] += z[p * (size_t)level.pixels + i];
}

/* p = z + beta p. */
__kernel void grid_turn(sv_grid_level level, uint planes, __global const real *scalars,
                        __global const real *z, __global real *direction, __global const uint *record) {
    GRID_PIXEL(level);
    for (uint p = 0; p < planes; p++) {
        const size_t at = p * (size_t)level.pixels + i;
        const real beta = scalars[p * SCALAR_COUNT + SCALAR_BETA];
        direction[at] = beta == 0 ? z[at] : z[at] + beta * direction[at];
    }
}

__kernel void grid_leave(sv_grid_level level, uint padded_width, uint planes, __global const real *scalars,
                         __global const real *solution, __global float *surfaces,
                         __global const uint *record) {
    GRID_PIXEL(level);
    for (uint p = 0; p < planes; p++)
        surfaces[p * (size_t)padded_width * level.height + (size_t)y * padded_width + x] =
            (float)(solution[p * (size_t)level.pixels + i] + scalars[p * SCALAR_COUNT + SCALAR_MEAN]);
}
