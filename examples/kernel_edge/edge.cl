/* SPDX-License-Identifier: MIT */
/* What these kernels see: sva_cl_prelude in smartvis/author_device.h. */
/* ray: the fluid's slices are x .. y - 1, y is 0 without such an edge; z counts fluid since x */
kernel void find(SVA_SLAB, global uint3 *rays, float level, float gap) {
    const uint x = get_global_id(0), y = get_global_id(1);
    uint3 ray = rays[y * WIDTH + x];
    for (uint s = 0; s < count && ray.y == 0; s++) {
        const uchar voxel = SVA_VOXEL(x, y, s);
        if (!SVA_SCANNED(x, y, s, voxel)) continue;
        if (voxel < level)
            ray.z++;
        else if (ray.x > 0 && ray.z > 0 && ray.z >= gap)
            ray.y = first + s;
        else
            ray = (uint3)(first + s + 1, 0, 0);
    }
    rays[y * WIDTH + x] = ray;
}

kernel void place(global const uint3 *rays, float q, global float *depth, global uchar *points) {
    const uint x = get_global_id(0), y = get_global_id(1);
    float sorted[25];
    uint count = 0;
    for (uint v = max(y, 2u) - 2; v < min(y + 3, HEIGHT); v++)
        for (uint u = max(x, 2u) - 2; u < min(x + 3, WIDTH); u++) {
            const uint3 ray = rays[v * WIDTH + u];
            if (ray.y == 0) continue;
            const float d = (float)ray.y - 0.5f - q * (float)(ray.y - ray.x);
            uint n = count++;
            for (; n > 0 && sorted[n - 1] > d; n--) sorted[n] = sorted[n - 1];
            sorted[n] = d;
        }
    depth[y * WIDTH + x] = count > 0 ? sorted[count / 2] : SVA_NO_DEPTH;
    points[y * WIDTH + x] = rays[y * WIDTH + x].y > 0 ? 1 : 0;
}
