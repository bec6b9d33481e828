/* SPDX-License-Identifier: MIT */
/* Spline, second part: the matrix in the null space of P^T, its Cholesky factor, and the coefficients. */
#ifndef SV_METHOD_SPLINE_CLH
#include "spline/spline.clh"
#endif

/* One point per work item: its row of K V T + lambda V T. */
__kernel void spline_kvt(uint stride, float lambda, __global real *restrict vectors,
                         __global const real *restrict frame, __global const uint *restrict info) {
    const uint i = (uint)get_global_id(0), n = info[INFO_POINTS];
    if (i >= n) return;
    __global const real *v = vectors + VECTOR_V * stride;
    const real x = vectors[VECTOR_X * stride + i], y = vectors[VECTOR_Y * stride + i];
    real8 sums[3] = {(real8)(0), (real8)(0), (real8)(0)};
    for (uint j = 0; j < n; j += 8) { /* V is 0 behind the last point */
        const real8 phi = spline_row8(vectors, frame, stride, x, y, j);
        for (uint c = 0; c < 3; c++) sums[c] += phi * vload8(0, v + c * stride + j);
    }
    for (uint c = 0; c < 3; c++) {
        real sum = 0;
        for (uint b = 0; b <= c; b++)
            sum += (sum8(sums[b]) + lambda * v[b * stride + i]) * frame[FRAME_T + 3 * b + c];
        vectors[(VECTOR_KVT + c) * stride + i] = sum;
    }
}

/* Applies Q^T = I - V T^T V^T to a vector over the points. */
static void apply_qt(__global const real *v, __global const real *frame, uint stride, uint n,
                     __global const real *from, __global real *to) {
    real dots[3], factors[3];
    for (uint c = 0; c < 3; c++) {
        dots[c] = 0;
        for (uint i = 0; i < n; i++) dots[c] += v[c * stride + i] * from[i];
    }
    for (uint c = 0; c < 3; c++) {
        factors[c] = 0;
        for (uint b = 0; b <= c; b++) factors[c] += frame[FRAME_T + 3 * b + c] * dots[b];
    }
    for (uint i = 0; i < n; i++)
        to[i] = from[i] - (v[i] * factors[0] + v[stride + i] * factors[1] + v[2 * stride + i] * factors[2]);
}

/* One work item: K V T - V S / 2 with S = T^T V^T K V T, and Q^T z; see spline_matrix. */
__kernel void spline_middle(uint stride, __global real *restrict vectors, __global const real *restrict frame,
                            __global const uint *restrict info) {
    const uint n = info[INFO_POINTS];
    if (n == 0) return;
    __global const real *v = vectors + VECTOR_V * stride;
    __global real *kvt = vectors + VECTOR_KVT * stride;
    real dots[9], s[9];
    for (uint a = 0; a < 3; a++)
        for (uint b = 0; b < 3; b++) {
            real sum = 0;
            for (uint i = 0; i < n; i++) sum += v[a * stride + i] * kvt[b * stride + i];
            dots[3 * a + b] = sum;
        }
    for (uint a = 0; a < 3; a++)
        for (uint b = 0; b < 3; b++) {
            s[3 * a + b] = 0;
            for (uint k = 0; k <= a; k++) s[3 * a + b] += frame[FRAME_T + 3 * k + a] * dots[3 * k + b];
        }
    for (uint b = 0; b < 3; b++)
        for (uint i = 0; i < n; i++) {
            real sum = 0;
            for (uint a = 0; a < 3; a++) sum += v[a * stride + i] * s[3 * a + b];
            kvt[b * stride + i] -= (real)0.5 * sum;
        }
    for (uint z = 0; z < 2; z++)
        apply_qt(v, frame, stride, n, vectors + (VECTOR_NEAR + z) * stride,
                 vectors + (VECTOR_QZ + z) * stride);
}

/*
 * One row per work item, of the lower triangle of Q2^T (K + lambda I) Q2 = K - V X^T - X V^T (+ lambda on the
 * diagonal), X as spline_middle left it; the last two rows are the right-hand sides, so that the
 * factorisation does their forward substitution, too. Rows and columns count from the rank on.
 */
__kernel void spline_matrix(uint stride, float lambda, __global const real *restrict vectors,
                            __global const real *restrict frame, __global real *restrict matrix,
                            __global const uint *restrict info) {
    const uint rank = info[INFO_RANK], n = info[INFO_POINTS], size = n - rank;
    const uint row = (uint)get_global_id(0);
    if (n == 0 || row >= size + 2) return;
    __global real *out = matrix + (size_t)row * stride;
    if (row >= size) {
        for (uint j = 0; j < size; j++) out[j] = vectors[(VECTOR_QZ + row - size) * stride + rank + j];
        return;
    }
    const uint i = row + rank;
    __global const real *v = vectors + VECTOR_V * stride, *x = vectors + VECTOR_KVT * stride;
    for (uint j = 0; j <= row; j += 8) {
        real8 a = spline_row8(vectors, frame, stride, vectors[VECTOR_X * stride + i],
                              vectors[VECTOR_Y * stride + i], j + rank);
        for (uint c = 0; c < 3; c++)
            a -= v[c * stride + i] * vload8(0, x + c * stride + j + rank) +
                 x[c * stride + i] * vload8(0, v + c * stride + j + rank);
        vstore8(a, 0, out + j);
    }
    out[row] += lambda;
}

/* One work item: the factor of panel `number`'s diagonal block. A pivot that is too small leaves
 * its unknown out. */
__kernel void spline_diagonal(uint stride, uint number, __global real *restrict matrix,
                              __global real *restrict frame, __global const uint *restrict info) {
    const uint size = info[INFO_POINTS] - info[INFO_RANK];
    const uint first = number * SV_SPLINE_PANEL, end = min(first + SV_SPLINE_PANEL, size);
    if (info[INFO_POINTS] == 0 || first >= size) return;
    if (number == 0) {
        real largest = 0;
        for (uint i = 0; i < size; i++) largest = fmax(largest, matrix[(size_t)i * stride + i]);
        frame[FRAME_PIVOT] = largest * size * REAL_EPSILON;
    }
    for (uint j = first; j < end; j++) {
        __global real *row_j = matrix + (size_t)j * stride;
        real pivot = row_j[j];
        for (uint k = first; k < j; k++) pivot -= row_j[k] * row_j[k];
        const bool usable = pivot > frame[FRAME_PIVOT];
        row_j[j] = usable ? sqrt(pivot) : (real)INFINITY;
        for (uint i = j + 1; i < end; i++) {
            __global real *row_i = matrix + (size_t)i * stride;
            real sum = row_i[j];
            for (uint k = first; k < j; k++) sum -= row_i[k] * row_j[k];
            row_i[j] = usable ? sum / row_j[j] : 0;
        }
    }
}

/* One row below the panel per work item: its part of the factor, stored transposed in `panel`, too. */
__kernel void spline_below(uint stride, uint number, __global real *restrict matrix,
                           __global real *restrict panel, __global const uint *restrict info) {
    const uint size = info[INFO_POINTS] - info[INFO_RANK];
    const uint first = number * SV_SPLINE_PANEL, end = min(first + SV_SPLINE_PANEL, size);
    const uint row = end + (uint)get_global_id(0);
    if (info[INFO_POINTS] == 0 || first >= size || row >= size + 2) return;
    __global real *mine = matrix + (size_t)row * stride;
    for (uint j = first; j < end; j++) {
        __global const real *row_j = matrix + (size_t)j * stride;
        real sum = mine[j];
        for (uint k = first; k < j; k++) sum -= mine[k] * row_j[k];
        mine[j] = sum / row_j[j];
        panel[(size_t)(j - first) * stride + row] = mine[j];
    }
}

/* SV_SPLINE_TILE rows by SV_SPLINE_SPAN columns behind the panel per work item: minus panel
 * times its transpose. */
__kernel void spline_trailing(uint stride, uint number, __global real *restrict matrix,
                              __global const real *restrict panel, __global const uint *restrict info) {
    const uint size = info[INFO_POINTS] - info[INFO_RANK];
    const uint first = (number + 1) * SV_SPLINE_PANEL;
    const uint row = first + (uint)get_global_id(1) * SV_SPLINE_TILE;
    const uint left = first + (uint)get_global_id(0) * SV_SPLINE_SPAN;
    const uint right = min(left + SV_SPLINE_SPAN, min(row + SV_SPLINE_TILE, size));
    if (info[INFO_POINTS] == 0 || first >= size || row >= size + 2) return;
    for (uint column = left; column < right; column += 8) {
        real8 sums[SV_SPLINE_TILE];
        for (uint r = 0; r < SV_SPLINE_TILE; r++)
            sums[r] = vload8(0, matrix + (size_t)(row + r) * stride + column);
        for (uint k = 0; k < SV_SPLINE_PANEL; k++) {
            const real8 across = vload8(0, panel + (size_t)k * stride + column);
            const real8 down = -vload8(0, panel + (size_t)k * stride + row);
            sums[0] = fma((real8)(down.s0), across, sums[0]);
            sums[1] = fma((real8)(down.s1), across, sums[1]);
            sums[2] = fma((real8)(down.s2), across, sums[2]);
            sums[3] = fma((real8)(down.s3), across, sums[3]);
            sums[4] = fma((real8)(down.s4), across, sums[4]);
            sums[5] = fma((real8)(down.s5), across, sums[5]);
            sums[6] = fma((real8)(down.s6), across, sums[6]);
            sums[7] = fma((real8)(down.s7), across, sums[7]);
        }
        for (uint r = 0; r < SV_SPLINE_TILE; r++)
            vstore8(sums[r], 0, matrix + (size_t)(row + r) * stride + column);
    }
}

/* Two work items, one per right-hand side: back substitution, then w = Q [0 g]. */
__kernel void spline_back(uint stride, __global real *restrict matrix, __global real *restrict vectors,
                          __global const real *restrict frame, __global const uint *restrict info) {
    const uint rank = info[INFO_RANK], n = info[INFO_POINTS], size = n - rank;
    if (n == 0) return;
    __global real *g = matrix + (size_t)(size + get_global_id(0)) * stride;
    for (uint j = size; j-- > 0;) {
        __global const real *row = matrix + (size_t)j * stride;
        g[j] /= row[j]; /* 0 where the unknown was left out */
        for (uint i = 0; i < j; i++) g[i] -= row[i] * g[j];
    }
    __global const real *v = vectors + VECTOR_V * stride;
    real dots[3], factors[3];
    for (uint c = 0; c < 3; c++) {
        dots[c] = 0;
        for (uint i = 0; i < size; i++) dots[c] += v[c * stride + rank + i] * g[i];
    }
    for (uint c = 0; c < 3; c++) {
        factors[c] = 0;
        for (uint b = c; b < 3; b++) factors[c] += frame[FRAME_T + 3 * c + b] * dots[b];
    }
    __global real *w = vectors + (VECTOR_W + get_global_id(0)) * stride;
    for (uint i = 0; i < n; i++)
        w[i] = (i < rank ? 0 : g[i - rank]) -
               (v[i] * factors[0] + v[stride + i] * factors[1] + v[2 * stride + i] * factors[2]);
    for (uint i = n; i < n + 8; i++) w[i] = 0; /* so that sums may run on to a whole vector */
}

/* One point per work item: z - (K + lambda I) w for both right-hand sides. */
__kernel void spline_rest(uint stride, float lambda, __global real *restrict vectors,
                          __global const real *restrict frame, __global const uint *restrict info) {
    const uint i = (uint)get_global_id(0), n = info[INFO_POINTS];
    if (i >= n) return;
    real8 near = (real8)(0), far = (real8)(0);
    for (uint j = 0; j < n; j += 8) {
        const real8 phi = spline_row8(vectors, frame, stride, vectors[VECTOR_X * stride + i],
                                      vectors[VECTOR_Y * stride + i], j);
        near += phi * vload8(0, vectors + VECTOR_W * stride + j);
        far += phi * vload8(0, vectors + (VECTOR_W + 1) * stride + j);
    }
    const real sums[2] = {sum8(near), sum8(far)};
    for (uint z = 0; z < 2; z++)
        vectors[(VECTOR_REST + z) * stride + i] =
            vectors[(VECTOR_NEAR + z) * stride + i] - sums[z] - lambda * vectors[(VECTOR_W + z) * stride + i];
}

/* One work item: the plane, R a = Q1^T rest. Q^T rest goes where Q^T z was. */
__kernel void spline_plane(uint stride, __global real *restrict vectors, __global real *restrict frame,
                           __global const uint *restrict info) {
    const uint rank = info[INFO_RANK], n = info[INFO_POINTS];
    if (n == 0) return;
    for (uint z = 0; z < 2; z++) {
        __global real *rest = vectors + (VECTOR_REST + z) * stride;
        __global real *turned = vectors + (VECTOR_QZ + z) * stride;
        __global real *plane = frame + FRAME_PLANE + 3 * z;
        apply_qt(vectors + VECTOR_V * stride, frame, stride, n, rest, turned);
        real solved[3] = {0, 0, 0};
        for (uint r = rank; r-- > 0;) {
            real sum = turned[r];
            for (uint c = r + 1; c < rank; c++) sum -= frame[FRAME_R + 3 * r + c] * solved[c];
            solved[r] = sum / frame[FRAME_R + 3 * r + r];
        }
        for (uint c = 0; c < 3; c++) plane[c] = solved[c];
    }
}
