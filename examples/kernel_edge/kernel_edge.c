/* SPDX-License-Identifier: MIT */
/* A whole plugin with OpenCL kernels. It computes what first_edge.c does, slab by slab on the host's queue:
 * of every ray it keeps where the fluid begins and ends, and how much of it there was. */
#define CL_TARGET_OPENCL_VERSION 120
#include <CL/cl.h>

#include "smartvis/author_cl.h"

enum { Q = 1, LEVEL, GAP };
enum { FIND, PLACE, KERNELS };

/* ---- the method */
static const char source[] = SVA_SOURCE(
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
    });

/* ---- the plugin */
static sv_status activate(sva *a) {
    static const char *const kernels[KERNELS] = {"find", "place"};
    const sv_status status = sva_cl_open(a, source, kernels, KERNELS);
    return status == SV_OK ? sva_cl_rehearse(a) : status;
}

static sv_status find(sva *a, const sv_slab *slab) {
    const float level = (float)(255.0 * sva_value(a, LEVEL));
    const float gap = (float)(sva_value(a, GAP) / a->format.spacing_mm[2]);
    const sva_cl_arg args[] = {SVA_ARG(((sva_cl *)a->own)->rays), SVA_ARG(level), SVA_ARG(gap)};
    return sva_cl_slab(a, slab, FIND, args, 3);
}

static sv_status place(sva *a, float *depth) { /* NOLINT(readability-non-const-parameter) */
    const sva_cl *cl = a->own;
    const float q = (float)sva_value(a, Q);
    const sva_cl_arg args[] = {SVA_ARG(cl->rays), SVA_ARG(q), SVA_ARG(cl->depth), SVA_ARG(cl->points)};
    (void)depth; /* NULL: the map is on the device */
    return sva_cl_launch(a, PLACE, args, 4);
}

static const sva_param params[] = {
    SVA_PARAM(Q, SV_PARAM_FLOAT, SV_PARAM_PRIMARY | SV_PARAM_ADJUST, "q", "Surface position", "",
              "0: at the fetus; 1: at the tissue before it.", 0.0, 1.0, 0.25, 0.01),
    SVA_PARAM(LEVEL, SV_PARAM_FLOAT, 0, "level", "Fluid level", "", "Darker voxels are fluid.", 0.0, 1.0, 0.2,
              0.01),
    SVA_PARAM(GAP, SV_PARAM_FLOAT, 0, "gap", "Shortest gap", "mm", "Less fluid does not count.", 0.0, 50.0,
              4.0, 0.5)};

static const sv_descriptor descriptor =
    SVA_DESCRIPTOR_OF("org.smartvis.example.kernel_edge", "First edge, with kernels", "SmartVis examples",
                      "1.0.0", "The first edge from fluid to tissue on every ray.",
                      SV_FEATURE_SCANNED | SV_FEATURE_PADDING | SV_FEATURE_ADJUST,
                      SV_BIT(SV_CARRIER_HOST) | SV_BIT(SV_CARRIER_BUFFER), SV_QUEUE_OWN | SV_QUEUE_HOST);

static const sva_method method = {.descriptor = &descriptor,
                                  .params = params,
                                  .param_count = 3,
                                  .own_bytes = sizeof(sva_cl),
                                  .ray_bytes = sizeof(cl_uint3),
                                  .activate = activate,
                                  .deactivate = sva_cl_close,
                                  .begin = sva_cl_begin,
                                  .slab = find,
                                  .finish = place,
                                  .adjust = place,
                                  .output = sva_cl_output};
SVA_ENTRY(method);
