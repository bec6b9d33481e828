/* SPDX-License-Identifier: MIT */
#include "bench/methods_map.h"

#include "base/output_file.h"
#include "bench/bench.h"
#include "ref/ref_points.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { ALIGN = 4096, NO_SCAN_PADDING = -1 };

static bool allocate(methods_map *map, uint32_t n, hs_error *err) {
    const size_t rays = (size_t)n * n;
    *map = (methods_map){.n = n, .bytes = (rays * METHODS_SLICES + ALIGN - 1) / ALIGN * ALIGN};
    map->voxels = aligned_alloc(ALIGN, map->bytes);
    map->status = calloc(rays, 1);
    map->near_end = calloc(rays, sizeof *map->near_end);
    map->far_end = calloc(rays, sizeof *map->far_end);
    if (map->voxels && map->status && map->near_end && map->far_end) return true;
    methods_map_free(map);
    return hs_fail(err, HS_ERR_MEMORY, "initial points: no memory for %u x %u rays", n, n);
}

void methods_map_free(methods_map *map) {
    free(map->voxels);
    free(map->status);
    free(map->near_end);
    free(map->far_end);
    *map = (methods_map){0};
}

/* Status and ends of the volume's rays, by the definition of the ray profile with the plugin's defaults. */
static bool find_points(methods_map *map, hs_error *err) {
    const size_t rays = (size_t)map->n * map->n;
    const sv_ref_volume volume = {map->voxels, map->n, map->n, METHODS_SLICES, NO_SCAN_PADDING, NULL};
    const sv_ref_bone bone = {.fluid_threshold = (BENCH_FLUID_LEVEL + 0.5) / 255.0,
                              .bone_mode = SV_REF_OFFSET,
                              .bone_offset = 0.24};
    sv_ref_ray *ray = malloc(rays * sizeof *ray);
    double *ends = malloc(2 * rays * sizeof *ends);
    if (ray && ends) {
        sv_ref_profile(&volume, bone.fluid_threshold, 1, ray);
        map->points = sv_ref_points(ray, rays, &bone, sv_ref_bone_level(ray, rays, &bone), map->status, ends,
                                    ends + rays);
        for (size_t i = 0; i < rays; i++) { /* one sample a slice: ends are whole */
            map->near_end[i] = (uint16_t)ends[i];
            map->far_end[i] = (uint16_t)ends[rays + i];
        }
    }
    const bool ok = ray && ends;
    free(ray);
    free(ends);
    if (!ok) methods_map_free(map);
    return ok || hs_fail(err, HS_ERR_MEMORY, "initial points: no memory for %zu rays", rays);
}

bool methods_map_bones(methods_map *map, uint32_t n, hs_error *err) {
    if (!allocate(map, n, err)) return false;
    uint8_t *slice[METHODS_SLICES];
    for (size_t z = 0; z < METHODS_SLICES; z++) slice[z] = map->voxels + z * n * n;
    if (bench_volume_fill(n, METHODS_SLICES, slice, n, err)) return find_points(map, err);
    methods_map_free(map);
    return false;
}

/* Ray i: tissue, fluid between two wavy layers, and bone behind. */
static void put_point(methods_map *map, size_t i) {
    const size_t rays = (size_t)map->n * map->n;
    const size_t x = i % map->n, y = i / map->n;
    const double u = (double)x / map->n, v = (double)y / map->n;
    const size_t near_end = (size_t)(14.0 + 5.0 * sin(9.0 * u) + 4.0 * cos(7.0 * v));
    const size_t far_end = (size_t)(40.0 + 9.0 * sin(8.0 * u + 1.0) * cos(6.0 * v));
    for (size_t z = near_end; z < far_end; z++) map->voxels[z * rays + i] = 0;
    for (size_t z = far_end; z < METHODS_SLICES; z++) map->voxels[z * rays + i] = 255;
}

bool methods_map_scattered(methods_map *map, uint32_t n, uint32_t count, hs_error *err) {
    if (!allocate(map, n, err)) return false;
    const size_t rays = (size_t)n * n;
    memset(map->voxels, 100, map->bytes);
    uint32_t random = 2654435761u;
    for (uint32_t found = 0; found < count;) {
        random ^= random << 13; /* xorshift */
        random ^= random >> 17;
        random ^= random << 5;
        const size_t i = random % rays;
        if (map->status[i]) continue;
        map->status[i] = 1; /* taken; find_points will set it for good */
        put_point(map, i);
        found++;
    }
    return find_points(map, err);
}

bool methods_map_write(const methods_map *map, const char *path, hs_error *err) {
    hs_output_file output = {0};
    if (!hs_output_open(&output, path, err)) return false;
    for (size_t i = 0; i < (size_t)map->n * map->n; i++)
        if (map->status[i])
            (void)fprintf(output.file, "%zu %zu %u %u\n", i % map->n, i / map->n, map->near_end[i],
                          map->far_end[i]);
    return hs_output_commit(&output, err);
}
