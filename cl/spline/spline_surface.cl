/* SPDX-License-Identifier: MIT */
/* Spline, last part: its values at the pixels, or at the nodes of a coarse grid and linear in between. */
#ifndef SV_METHOD_SPLINE_CLH
#include "spline/spline.clh"
#endif

/* One node per work item. Nodes stand `step` pixels apart, from (0, 0); 1: every pixel. */
__kernel void spline_nodes(uint stride, uint nodes_x, uint pitch, ulong plane, float step_x, float step_y,
                           __global const real *restrict vectors, __global const real *restrict frame,
                           __global const uint *restrict info, uint planes, __global float *restrict out) {
    const uint nx = (uint)get_global_id(0), ny = (uint)get_global_id(1), n = info[INFO_POINTS];
    if (n == 0 || nx >= nodes_x) return;
    const real x = (real)nx * step_x, y = (real)ny * step_y;
    real8 near = (real8)(0), far = (real8)(0);
    for (uint j = 0; j < n; j += 8) {
        const real8 phi = spline_row8(vectors, frame, stride, x, y, j);
        near += phi * vload8(0, vectors + VECTOR_W * stride + j);
        far += phi * vload8(0, vectors + (VECTOR_W + 1) * stride + j);
    }
    const real sums[2] = {sum8(near), sum8(far)};
    for (uint z = 0; z < planes; z++) {
        __global const real *a = frame + FRAME_PLANE + 3 * z;
        const real plane_value = a[0] + a[1] * plane_term(frame, 1, x, y) + a[2] * plane_term(frame, 2, x, y);
        out[z * plane + (size_t)ny * pitch + nx] = (float)(sums[z] + plane_value);
    }
}

/* One pixel per work item: linear between the four nodes around it. */
__kernel void spline_between(uint width, uint padded_width, uint height, uint grid, uint planes,
                             __global const float *restrict nodes, __global float *restrict surfaces,
                             __global const uint *restrict record) {
    const uint x = (uint)get_global_id(0), y = (uint)get_global_id(1);
    if (x >= width || !surface_wanted(record)) return;
    const float tx = width > 1 ? (float)x * (float)grid / (float)(width - 1) : 0.0f;
    const float ty = height > 1 ? (float)y * (float)grid / (float)(height - 1) : 0.0f;
    const uint u = min((uint)tx, grid - 1), v = min((uint)ty, grid - 1), pitch = grid + 1;
    const float fx = tx - (float)u, fy = ty - (float)v;
    for (uint z = 0; z < planes; z++) {
        __global const float *at = nodes + z * pitch * pitch + v * pitch + u;
        const float above = at[0] + fx * (at[1] - at[0]);
        const float below = at[pitch] + fx * (at[pitch + 1] - at[pitch]);
        surfaces[z * (size_t)padded_width * height + (size_t)y * padded_width + x] =
            above + fy * (below - above);
    }
}
