/* SPDX-License-Identifier: MIT */
#include "eval/eval_box.h"

#include <math.h>
#include <stdlib.h>

#define PLACES 12 /* along an edge: a quarter of a source voxel where three make an edge */

/* The value at a voxel index of the source; negative: not scanned there. */
static double value_at(const hs_volume *v, const double at[3]) {
    const double n[3] = {v->nx, v->ny, v->nz};
    double index[3];
    for (int k = 0; k < 3; k++) {
        if (at[k] < -0.5 || at[k] >= n[k] - 0.5) return -1.0;
        index[k] = floor(at[k] + 0.5);
    }
    const uint8_t voxel = v->voxels[((size_t)index[2] * v->ny + (size_t)index[1]) * v->nx + (size_t)index[0]];
    return voxel ? voxel : -1.0;
}

static double echo_at(const hs_volume *v, const double at[3]) {
    double place[3], index[3];
    for (int k = 0; k < 3; k++) place[k] = v->beams->corner[k] + (at[k] + 0.5) * v->spacing[k];
    return hs_beams_locate(v->beams, place, index) ? hs_beams_sample(v->beams, index) : -1.0;
}

/* The exact mean over a voxel's box; negative: less than half of it was scanned. */
static double exact_mean(const hs_volume *v, const hs_box_map *map, const hs_slab_layout *l,
                         const uint32_t voxel[3]) {
    const double size[3] = {l->width, l->height, l->slices};
    const double *const axis[3] = {map->du, map->dv, map->dw};
    double sum = 0.0;
    int scanned = 0;
    for (int i = 0; i < PLACES * PLACES * PLACES; i++) {
        const int step[3] = {i % PLACES, i / PLACES % PLACES, i / PLACES / PLACES};
        double at[3];
        for (int k = 0; k < 3; k++) {
            at[k] = map->origin[k];
            for (int a = 0; a < 3; a++) at[k] += axis[a][k] * (voxel[a] + (step[a] + 0.5) / PLACES) / size[a];
        }
        const double value = v->beams ? echo_at(v, at) : value_at(v, at);
        if (value < 0.0) continue;
        sum += value;
        scanned++;
    }
    return 2 * scanned < PLACES * PLACES * PLACES ? -1.0 : sum / scanned;
}

static int ascending(const void *a, const void *b) {
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

static void summarise(double *errors, size_t count, hs_box_error *out) {
    double sum = 0.0, squares = 0.0;
    out->voxels = count;
    if (count == 0) return;
    for (size_t i = 0; i < count; i++) {
        sum += errors[i];
        squares += errors[i] * errors[i];
    }
    qsort(errors, count, sizeof *errors, ascending);
    out->mean = sum / (double)count;
    out->rms = sqrt(squares / (double)count);
    out->p99 = errors[(count * 99 + 99) / 100 - 1];
}

bool hs_box_error_measure(const hs_volume *source, const hs_camera *camera, const hs_slab_layout *layout,
                          const uint8_t *voxels, uint32_t every, hs_box_error *out, hs_error *err) {
    const size_t total = (size_t)layout->width * layout->height * layout->slices;
    double *errors = malloc((total / every + 1) * sizeof *errors);
    hs_box_map map;
    size_t count = 0;
    *out = (hs_box_error){0};
    if (!errors) return hs_fail(err, HS_ERR_MEMORY, "box means: no memory for %zu voxels", total / every);
    hs_camera_box_map(camera, source, &map);
    for (size_t i = 0; i < total; i += every) {
        const uint32_t voxel[3] = {(uint32_t)(i % layout->width),
                                   (uint32_t)(i / layout->width % layout->height),
                                   (uint32_t)(i / layout->width / layout->height)};
        const double exact = exact_mean(source, &map, layout, voxel);
        if ((exact < 0.0) != (voxels[i] == 0))
            out->disputed++;
        else if (exact >= 0.0)
            errors[count++] = fabs(voxels[i] - exact);
    }
    summarise(errors, count, out);
    free(errors);
    return true;
}
