/* SPDX-License-Identifier: MIT */
/*
 * Whether a plugin's map may be used: a plugin may hand over anything. A work item looks at one row; `wrong`,
 * zeroed before, receives the number of values that are not in low .. high (NaN included).
 */
__kernel void check_map(__global const float *map, int width, float low, float high, __global int *wrong) {
    __global const float *row = map + get_global_id(0) * (size_t)width;
    int count = 0;
    for (int x = 0; x < width; x++) count += !(row[x] >= low && row[x] <= high);
    if (count > 0) atomic_add(wrong, count);
}
