/* SPDX-License-Identifier: MIT */
#include "loop/truth_surface.h"

#include <stdlib.h>

bool hs_truth_surface_fits(const hs_camera *camera) {
    for (int k = 0; k < 9; k++) {
        const double expected = k % 4 == 0 ? 1.0 : 0.0;
        if (camera->rotation[k] < expected || camera->rotation[k] > expected) return false;
    }
    return true;
}

/* The voxel of a column under the middle of pixel i of `side`; -1 beside the volume. */
static int64_t column_at(uint32_t i, uint32_t side, double extent, uint32_t count, double spacing) {
    const double at = ((i + 0.5) / side - 0.5) * extent / spacing + 0.5 * count;
    return at >= 0.0 && at < count ? (int64_t)at : -1;
}

/* Depth of the map: the box may be deeper than the volume, which lies in its middle. */
static void fill(const hs_scene_data *data, const hs_camera *camera, uint32_t side, float *map) {
    const hs_volume *v = &data->full;
    const double slice = v->spacing[2], front = 0.5 * (camera->depth_extent - v->nz * slice);
    for (uint32_t j = 0; j < side; j++)
        for (uint32_t i = 0; i < side; i++) {
            const int64_t x = column_at(i, side, camera->extent, v->nx, v->spacing[0]);
            const int64_t y = column_at(j, side, camera->extent, v->ny, v->spacing[1]);
            float *to = map + (size_t)j * side + i;
            *to = 0.0f;
            if (x < 0 || y < 0) continue;
            const double clip = (double)data->clip[(size_t)y * v->nx + (size_t)x];
            *to = (float)((front + (clip + 0.5) * slice) / camera->depth_extent * v->nz - 0.5);
        }
}

bool hs_truth_surface(const hs_cl *cl, const hs_scene_data *data, const hs_camera *camera,
                      hs_start_depths *out, hs_error *err) {
    const hs_volume *v = &data->full;
    const uint32_t side = v->nx > v->ny ? v->nx : v->ny;
    const size_t bytes = (size_t)side * side * sizeof(float);
    float *map = malloc(bytes);
    if (!map) return hs_fail(err, HS_ERR_MEMORY, "ground truth: no memory for %zu bytes", bytes);
    fill(data, camera, side, map);
    cl_int code;
    *out = (hs_start_depths){.width = side, .height = side, .slices = v->nz};
    out->depth = clCreateBuffer(cl->context, CL_MEM_READ_ONLY | CL_MEM_COPY_HOST_PTR, bytes, map, &code);
    free(map);
    return hs_cl_check(code, "clCreateBuffer (the truth's surface)", err);
}
