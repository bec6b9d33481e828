/* SPDX-License-Identifier: MIT */
/* Spline, first part: the list of points, merged on a grid if wanted (Algorithm 4.2), and the reflections. */
#ifndef SV_METHOD_SPLINE_CLH
#include "spline/spline.clh"
#endif

/* First pixel of a cell when `side` pixels are split into `grid` cells. */
static uint cell_start(uint cell, uint side, uint grid) {
    return (uint)(((ulong)cell * side + grid - 1) / grid);
}

/* One cell per work item: count, sums of x, y, near and far depth of its initial points. */
__kernel void spline_cells(uint width, uint padded_width, uint height, uint grid,
                           __global const float *restrict maps, __global real *restrict cells,
                           __global const uint *restrict record) {
    if (!surface_wanted(record)) return;
    const uint cell_x = (uint)get_global_id(0) % grid, cell_y = (uint)get_global_id(0) / grid;
    real count = 0, x_sum = 0, y_sum = 0, near_sum = 0, far_sum = 0;
    for (uint y = cell_start(cell_y, height, grid); y < cell_start(cell_y + 1, height, grid); y++)
        for (uint x = cell_start(cell_x, width, grid); x < cell_start(cell_x + 1, width, grid); x++) {
            const size_t i = (size_t)y * padded_width + x;
            if (isinf(maps[i])) continue;
            count += 1;
            x_sum += x;
            y_sum += y;
            near_sum += maps[i];
            far_sum += maps[(size_t)padded_width * height + i];
        }
    __global real *mine = cells + get_global_id(0) * 5;
    mine[0] = count;
    mine[1] = x_sum;
    mine[2] = y_sum;
    mine[3] = near_sum;
    mine[4] = far_sum;
}

static void put_point(__global real *vectors, uint stride, uint n, real x, real y, real near, real far) {
    vectors[VECTOR_X * stride + n] = x;
    vectors[VECTOR_Y * stride + n] = y;
    vectors[VECTOR_NEAR * stride + n] = near;
    vectors[VECTOR_FAR * stride + n] = far;
}

/* One work item: the points one by one if `merge` is 0 and they fit, else the means of the cells. */
__kernel void spline_list(uint width, uint padded_width, uint height, uint merge, uint grid, uint capacity,
                          uint stride, __global const float *restrict maps,
                          __global const real *restrict cells, __global real *restrict vectors,
                          __global uint *restrict info, __global const uint *restrict record) {
    info[INFO_POINTS] = info[INFO_RANK] = 0;
    if (!surface_wanted(record)) return;
    const bool all = merge == 0 && record[SV_REC_POINTS] <= capacity;
    uint n = 0;
    for (uint y = 0; all && y < height; y++)
        for (uint x = 0; x < width; x++) {
            const size_t i = (size_t)y * padded_width + x;
            if (isinf(maps[i]) || n == capacity) continue;
            put_point(vectors, stride, n++, x, y, maps[i], maps[(size_t)padded_width * height + i]);
        }
    for (uint c = 0; !all && c < grid * grid; c++) {
        __global const real *cell = cells + 5 * c;
        const real count = cell[0];
        if (count == 0 || n == capacity) continue;
        put_point(vectors, stride, n++, cell[1] / count, cell[2] / count, cell[3] / count, cell[4] / count);
    }
    info[INFO_POINTS] = n;
}

/* Means, scale and main axis of the points. */
static void spline_centre(__global const real *vectors, uint stride, uint n, __global real *frame) {
    __global const real *x = vectors + VECTOR_X * stride, *y = vectors + VECTOR_Y * stride;
    real mean_x = 0, mean_y = 0, scale = 0, xx = 0, xy = 0, yy = 0;
    for (uint i = 0; i < n; i++) {
        mean_x += x[i] / n;
        mean_y += y[i] / n;
    }
    for (uint i = 0; i < n; i++) {
        const real dx = x[i] - mean_x, dy = y[i] - mean_y;
        scale = fmax(scale, fmax(fabs(dx), fabs(dy)));
        xx += dx * dx;
        xy += dx * dy;
        yy += dy * dy;
    }
    const real angle = (real)0.5 * atan2(2 * xy, xx - yy);
    frame[FRAME_MEAN] = mean_x;
    frame[FRAME_MEAN + 1] = mean_y;
    frame[FRAME_MEAN + 2] = scale > 0 ? scale : 1;
    frame[FRAME_AXIS] = cos(angle);
    frame[FRAME_AXIS + 1] = sin(angle);
}

/* Squared norm of rows k .. n - 1 of a column. */
static real tail_norm(__global const real *column, uint k, uint n) {
    real sum = 0;
    for (uint i = k; i < n; i++) sum += column[i] * column[i];
    return sum;
}

/* Reflection k of column v: v becomes its vector (v[0 .. k - 1] = 0); returns tau, and the diagonal of R. */
static real reflection(__global real *v, uint k, uint n, real norm2, real *diagonal) {
    const real head = v[k], norm = sqrt(norm2);
    *diagonal = head > 0 ? -norm : norm;
    for (uint i = 0; i < k; i++) v[i] = 0;
    v[k] = head - *diagonal;
    return 2 / (norm2 - head * head + v[k] * v[k]);
}

static real spline_dot(__global const real *a, __global const real *b, uint n) {
    real sum = 0;
    for (uint i = 0; i < n; i++) sum += a[i] * b[i];
    return sum;
}

/* The last column of T for reflection k (compact WY form of the product of reflections). */
static void extend_t(__global real *frame, __global const real *v, uint stride, uint k, uint n, real tau) {
    __global real *t = frame + FRAME_T;
    real dots[3];
    for (uint a = 0; a < k; a++) dots[a] = spline_dot(v + a * stride, v + k * stride, n);
    for (uint a = 0; a < k; a++) {
        real sum = 0;
        for (uint b = a; b < k; b++) sum += t[3 * a + b] * dots[b];
        t[3 * a + k] = -tau * sum;
    }
    t[3 * k + k] = tau;
}

/* Applies reflection k to columns k + 1 .. 2, and keeps their row k, which is R's. */
static void reflect_rest(__global real *v, __global real *frame, uint stride, uint k, uint n, real tau) {
    for (uint c = k + 1; c < 3; c++) {
        const real factor = tau * spline_dot(v + k * stride, v + c * stride, n);
        for (uint i = k; i < n; i++) v[c * stride + i] -= factor * v[k * stride + i];
        frame[FRAME_R + 3 * k + c] = v[c * stride + k];
    }
}

/* One work item: Householder QR of P. */
__kernel void spline_frame(uint stride, __global real *restrict vectors, __global real *restrict frame,
                           __global uint *restrict info) {
    const uint n = info[INFO_POINTS];
    if (n == 0) return;
    for (uint i = 0; i < SV_SPLINE_FRAME_WORDS; i++) frame[i] = 0;
    spline_centre(vectors, stride, n, frame);
    __global real *v = vectors + VECTOR_V * stride;
    for (uint c = 0; c < 3; c++)
        for (uint i = 0; i < n; i++)
            v[c * stride + i] =
                plane_term(frame, c, vectors[VECTOR_X * stride + i], vectors[VECTOR_Y * stride + i]);
    uint rank = 0;
    for (; rank < 3 && rank < n; rank++) {
        const real norm2 = tail_norm(v + rank * stride, rank, n);
        if (norm2 <= (real)n * (64 * REAL_EPSILON) * (64 * REAL_EPSILON)) break; /* collinear */
        real diagonal;
        const real tau = reflection(v + rank * stride, rank, n, norm2, &diagonal);
        frame[FRAME_R + 3 * rank + rank] = diagonal;
        extend_t(frame, v, stride, rank, n, tau);
        reflect_rest(v, frame, stride, rank, n, tau);
    }
    for (uint c = 0; c < 3; c++) /* sums run on to a whole vector */
        for (uint i = c < rank ? n : 0; i < n + 8; i++) v[c * stride + i] = 0;
    info[INFO_RANK] = rank;
}
