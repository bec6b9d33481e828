/* SPDX-License-Identifier: MIT */
#include "result/result_grid.h"

#include "base/threads.h"

#include <math.h>

static void volume_size(const hs_volume *volume, double count[3]) {
    count[0] = volume->nx;
    count[1] = volume->ny;
    count[2] = volume->nz;
}

void hs_result_grid_of(const hs_maps *maps, const hs_volume *volume, hs_result_grid *grid) {
    const hs_camera *c = &maps->camera;
    const double extent[3] = {c->extent, c->extent, c->depth_extent};
    const double pixels[3] = {maps->width, maps->height, maps->slices};
    double count[3], middle[3], first[3];
    volume_size(volume, count);
    for (int k = 0; k < 3; k++) {
        grid->spacing[k] = extent[k] / pixels[k];
        middle[k] = 0.5 * (count[k] - 1.0);
    }
    grid->pose = (hs_pose){.stated = volume->pose.stated};
    /* The box stands around the volume's middle; its first pixel, in volume mm from there: */
    for (int k = 0; k < 3; k++) {
        first[k] = 0;
        for (int a = 0; a < 3; a++) first[k] += c->rotation[k * 3 + a] * 0.5 * (grid->spacing[a] - extent[a]);
        first[k] = middle[k] + first[k] / volume->spacing[k];
    }
    hs_pose_world(&volume->pose, volume->spacing, first, grid->pose.origin);
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
            for (int k = 0; k < 3; k++)
                grid->pose.direction[i * 3 + j] += volume->pose.direction[i * 3 + k] * c->rotation[k * 3 + j];
}

void hs_result_to_map_of(const hs_maps *maps, const hs_volume *volume, hs_result_to_map *to_map) {
    const hs_camera *c = &maps->camera;
    const double extent[3] = {c->extent, c->extent, c->depth_extent};
    const double pixels[3] = {maps->width, maps->height, maps->slices};
    double count[3];
    volume_size(volume, count);
    for (int k = 0; k < 3; k++) {
        to_map->origin[k] = 0.5 * (pixels[k] - 1.0);
        for (int a = 0; a < 3; a++) {
            to_map->step[a][k] = c->rotation[a * 3 + k] * volume->spacing[a] * pixels[k] / extent[k];
            to_map->origin[k] -= to_map->step[a][k] * 0.5 * (count[a] - 1.0);
        }
    }
}

double hs_result_depth_at(const hs_maps *maps, double column, double row) {
    const double x = fmin(fmax(column, 0.0), maps->width - 1.0), y = fmin(fmax(row, 0.0), maps->height - 1.0);
    const uint32_t x0 = (uint32_t)x, y0 = (uint32_t)y;
    const uint32_t x1 = x0 + 1 < maps->width ? x0 + 1 : x0, y1 = y0 + 1 < maps->height ? y0 + 1 : y0;
    const double fx = x - x0, fy = y - y0;
    const float *near = maps->depth + (size_t)y0 * maps->width, *far = maps->depth + (size_t)y1 * maps->width;
    const double a = (double)near[x0] + fx * ((double)near[x1] - (double)near[x0]);
    const double b = (double)far[x0] + fx * ((double)far[x1] - (double)far[x0]);
    const double depth = a + fy * (b - a);
    return depth > 0.0 && isfinite(depth) ? depth : 0.0;
}

typedef struct {
    const hs_maps *maps;
    const hs_volume *volume;
    hs_result_to_map to_map;
    uint8_t *mask;
} masking;

static void mask_slice(void *context, uint32_t z) {
    const masking *m = context;
    const hs_result_to_map *t = &m->to_map;
    uint8_t *out = m->mask + (size_t)z * m->volume->nx * m->volume->ny;
    for (uint32_t y = 0; y < m->volume->ny; y++) {
        double row[3];
        for (int k = 0; k < 3; k++) row[k] = t->origin[k] + y * t->step[1][k] + z * t->step[2][k];
        for (uint32_t x = 0; x < m->volume->nx; x++) {
            const double depth =
                hs_result_depth_at(m->maps, row[0] + x * t->step[0][0], row[1] + x * t->step[0][1]);
            *out++ = depth == 0.0 || row[2] + x * t->step[0][2] >= depth;
        }
    }
}

void hs_result_mask(const hs_maps *maps, const hs_volume *volume,
                    uint8_t *mask) { /* NOLINT(readability-non-const-parameter) */
    masking m = {.maps = maps, .volume = volume, .mask = mask};
    hs_result_to_map_of(maps, volume, &m.to_map);
    hs_parallel(hs_thread_count(0), volume->nz, mask_slice, &m);
}
