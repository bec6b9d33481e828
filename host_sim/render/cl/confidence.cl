/* SPDX-License-Identifier: MIT */
/*
 * Whether a confidence map may be used: a plugin may hand over anything. A work item looks at one row;
 * `wrong`, zeroed before, receives the number of values that are not in 0 .. 1 (NaN included).
 */
__kernel void check_confidence(__global const float *map, int width, __global int *wrong) {
    __global const float *row = map + get_global_id(0) * (size_t)width;
    int count = 0;
    for (int x = 0; x < width; x++) count += !(row[x] >= 0.0f && row[x] <= 1.0f);
    if (count > 0) atomic_add(wrong, count);
}
