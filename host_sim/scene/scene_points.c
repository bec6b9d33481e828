/* SPDX-License-Identifier: MIT */
#include "scene/scene.h"

#include <stdlib.h>
#include <string.h>

#define FACTOR      3u  /* source voxels to a low-resolution voxel, per axis */
#define FLUID_LEVEL 40  /* T_L = 40.5 / 255 */
#define BONE_BELOW  61u /* 0.24 * 255 */

/* What one ray came to. Depths in low-resolution slices. */
typedef struct {
    uint8_t maximum;
    uint32_t near_end, far_end;
} ray;

/* The mean of the scanned voxels of a low-resolution voxel; 0 if less than half were scanned. */
static uint8_t low_voxel(const hs_volume *v, uint32_t x, uint32_t y, uint32_t z) {
    uint32_t sum = 0, count = 0;
    for (uint32_t k = 0; k < FACTOR; k++)
        for (uint32_t j = 0; j < FACTOR; j++)
            for (uint32_t i = 0; i < FACTOR; i++) {
                size_t row = ((size_t)z * FACTOR + k) * v->ny + (size_t)y * FACTOR + j;
                uint8_t voxel = v->voxels[row * v->nx + (size_t)x * FACTOR + i];
                sum += voxel;
                count += voxel != 0;
            }
    return (uint8_t)(2 * count >= FACTOR * FACTOR * FACTOR ? (sum + count / 2) / count : 0);
}

static ray walk(const hs_volume *v, uint32_t x, uint32_t y) {
    ray r = {0, 0, 0};
    uint32_t entry = 0, leave = 0;
    bool tissue = false, started = false;
    for (uint32_t z = 0; z < v->nz / FACTOR; z++) {
        uint8_t voxel = low_voxel(v, x, y, z);
        if (voxel == 0) continue;
        bool above = voxel > FLUID_LEVEL;
        if (above && !tissue) entry = started ? z : 0;
        if (!above && tissue) leave = z;
        tissue = above;
        started = true;
        if (voxel > r.maximum) r = (ray){voxel, leave, entry};
    }
    return r;
}

static uint8_t judge(const hs_scene_data *data, const ray *r, uint32_t x, uint32_t y) {
    size_t pixel = ((size_t)y * FACTOR + 1) * data->full.nx + (size_t)x * FACTOR + 1;
    if (data->label[pixel] == HS_LABEL_NEITHER) return HS_POINT_WRONG;
    const float factor = FACTOR;
    float low = 0.5f * ((float)r->near_end + (float)r->far_end), depth = (low + 0.5f) * factor - 0.5f;
    bool right = depth >= data->near_end[pixel] - factor && depth <= data->far_end[pixel] + factor;
    return right ? HS_POINT_RIGHT : HS_POINT_WRONG;
}

bool hs_scene_points_find(const hs_scene_data *data, hs_scene_points *out, hs_error *err) {
    const hs_volume *v = &data->full;
    memset(out, 0, sizeof *out);
    out->width = v->nx / FACTOR;
    out->height = v->ny / FACTOR;
    size_t count = (size_t)out->width * out->height;
    ray *rays = malloc((count ? count : 1) * sizeof *rays);
    out->kind = calloc(count ? count : 1, 1);
    if (!rays || !out->kind) {
        free(rays);
        hs_scene_points_free(out);
        return hs_fail(err, HS_ERR_MEMORY, "%s: no memory for %zu rays", v->name, count);
    }
    for (size_t i = 0; i < count; i++) {
        rays[i] = walk(v, (uint32_t)(i % out->width), (uint32_t)(i / out->width));
        if (rays[i].maximum > out->maximum) out->maximum = rays[i].maximum;
    }
    for (size_t i = 0; i < count; i++) {
        if (rays[i].maximum <= FLUID_LEVEL || rays[i].maximum + BONE_BELOW <= out->maximum) continue;
        out->kind[i] = judge(data, &rays[i], (uint32_t)(i % out->width), (uint32_t)(i / out->width));
        out->right += out->kind[i] == HS_POINT_RIGHT;
        out->wrong += out->kind[i] == HS_POINT_WRONG;
    }
    free(rays);
    return true;
}

void hs_scene_points_free(hs_scene_points *points) {
    free(points->kind);
    memset(points, 0, sizeof *points);
}
