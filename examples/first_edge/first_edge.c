/* SPDX-License-Identifier: MIT */
/* A whole plugin. On every ray it takes the first edge from fluid to tissue behind the first tissue for the
 * fetus. The surface lies in the fluid before it, and is the median of what 5 x 5 rays say. */
#include "smartvis/author.h"

enum { Q = 1, LEVEL, GAP };

typedef struct {
    uint16_t near, far; /* the fluid's slices are near .. far - 1; far is 0 if the ray has no such edge */
} edge;

/* ---- the method */
static sv_status place(sva *a, float *depth) {
    const edge *edges = a->rays;
    const uint32_t width = a->format.width, height = a->format.height;
    const float q = (float)sva_value(a, Q);
    for (uint32_t i = 0; i < width * height; i++) {
        float sorted[25];
        uint32_t count = 0;
        for (uint32_t k = 0; k < 25; k++) {
            const uint32_t x = i % width + k % 5 - 2, y = i / width + k / 5 - 2; /* -1 is a large number */
            if (x >= width || y >= height || edges[y * width + x].far == 0) continue;
            const edge e = edges[y * width + x];
            const float d = (float)e.far - 0.5f - q * (float)(e.far - e.near);
            uint32_t n = count++;
            for (; n > 0 && sorted[n - 1] > d; n--) sorted[n] = sorted[n - 1];
            sorted[n] = d;
        }
        depth[i] = count > 0 ? sorted[count / 2] : SVA_NO_DEPTH;
        a->points[i] = edges[i].far > 0 ? SV_POINT_INITIAL : SV_POINT_NONE;
    }
    return SV_OK;
}

static sv_status find(sva *a, float *depth) {
    const float level = (float)(255.0 * sva_value(a, LEVEL));
    const float gap = (float)(sva_value(a, GAP) / a->format.spacing_mm[2]);
    for (uint32_t i = 0; i < sva_rays(a); i++) {
        const uint32_t x = i % a->format.width, y = i / a->format.width;
        edge *e = (edge *)a->rays + i;
        uint32_t fluid = 0;
        for (uint32_t z = 0; z < a->format.slices && e->far == 0; z++) {
            const uint8_t voxel = sva_voxel(a, x, y, z);
            if (!sva_scanned(a, x, y, z, voxel)) continue;
            if (voxel < level) {
                fluid++;
            } else if (e->near > 0 && fluid > 0 && (float)fluid >= gap) {
                e->far = (uint16_t)z;
            } else {
                e->near = (uint16_t)(z + 1);
                fluid = 0;
            }
        }
    }
    return place(a, depth);
}

/* ---- the plugin */
static const sva_param params[] = {
    SVA_PARAM(Q, SV_PARAM_FLOAT, SV_PARAM_PRIMARY | SV_PARAM_ADJUST, "q", "Surface position", "",
              "0: at the fetus; 1: at the tissue before it.", 0.0, 1.0, 0.25, 0.01),
    SVA_PARAM(LEVEL, SV_PARAM_FLOAT, 0, "level", "Fluid level", "", "Darker voxels are fluid.", 0.0, 1.0, 0.2,
              0.01),
    SVA_PARAM(GAP, SV_PARAM_FLOAT, 0, "gap", "Shortest gap", "mm", "Less fluid does not count.", 0.0, 50.0,
              4.0, 0.5)};

static const sv_descriptor descriptor =
    SVA_DESCRIPTOR("org.smartvis.example.first_edge", "First edge", "SmartVis examples", "1.0.0",
                   "The first edge from fluid to tissue on every ray.",
                   SV_FEATURE_SCANNED | SV_FEATURE_PADDING | SV_FEATURE_ADJUST);

static const sva_method method = {.descriptor = &descriptor,
                                  .params = params,
                                  .param_count = 3,
                                  .ray_bytes = sizeof(edge),
                                  .finish = find,
                                  .adjust = place};
SVA_ENTRY(method);
