/* SPDX-License-Identifier: MIT */
/* The kernels of the base (wrong_opencl.c). */
/* ray: the fluid's slices are x .. y - 1, y is 0 without such an edge; z counts fluid since x */
kernel void find(SVA_SLAB, global uint3 *rays, float level, uint gap, uint step) {
    const uint x = get_global_id(0), y = get_global_id(1);
    uint3 ray = rays[y * WIDTH + x];
    for (uint s = 0; s < count && ray.y == 0; s += step) {
        const uchar voxel = SVA_VOXEL(x, y, s);
        if (!SVA_SCANNED(x, y, s, voxel)) continue;
        if (voxel < level)
            ray.z++;
        else if (ray.z >= gap)
            ray.y = first + s;
        else
            ray = (uint3)(first + s + 1, 0, 0);
    }
    rays[y * WIDTH + x] = ray;
}

kernel void place(global const uint3 *rays, float q, global float *depth, global uchar *points) {
    const uint i = get_global_id(1) * WIDTH + get_global_id(0);
    const uint3 ray = rays[i];
    depth[i] = ray.y ? (float)ray.y - 0.5f - q * (float)(ray.y - ray.x) : SVA_NO_DEPTH;
    points[i] = ray.y ? 1 : 0;
}
