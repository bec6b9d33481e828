/* SPDX-License-Identifier: MIT */
#include "show/slice_pixels.h"

#include "picture/picture_colour.h"

#include <math.h>

#define DIMMED     0.4 /* of what is removed */
#define BAND_SHARE 0.4 /* of the band's colour in a pixel of it */

/* Which of the box' axes run right and down, and which one the slice stands on. */
static const int right_axis[HS_SLICE_PLANES] = {0, 2, 0}, down_axis[HS_SLICE_PLANES] = {2, 1, 1};

/* The place (a, b) of a slice's square, both 0 .. 1. */
static void box_of(const hs_slice_scene *s, hs_slice_plane p, double a, double b, double box[3]) {
    const int right = right_axis[p], down = down_axis[p];
    for (int k = 0; k < 3; k++) box[k] = s->at[k];
    box[right] = s->low[right] + a * s->side[right];
    box[down] = s->low[down] + b * s->side[down];
}

/* The nearest voxel; 0 outside the volume. */
static uint8_t voxel_at(const hs_slice_scene *s, const hs_box_map *map, const double box[3]) {
    const hs_volume *v = s->volume;
    const uint32_t n[3] = {v->nx, v->ny, v->nz};
    size_t at[3];
    for (int k = 0; k < 3; k++) {
        const double i = map->origin[k] + box[0] * map->du[k] + box[1] * map->dv[k] + box[2] * map->dw[k];
        if (!(i >= -0.5 && i < n[k] - 0.5)) return 0;
        at[k] = (size_t)(i + 0.5);
    }
    return v->voxels[(at[2] * v->ny + at[1]) * v->nx + at[0]];
}

/* A map of the low-resolution volume at a place of the box: bilinear, as the renderer has it. */
static double map_at(const hs_slice_scene *s, const float *map, double u, double v) {
    const double x = fmin(fmax(u * s->map_width - 0.5, 0.0), s->map_width - 1.0);
    const double y = fmin(fmax(v * s->map_height - 0.5, 0.0), s->map_height - 1.0);
    const uint32_t x0 = (uint32_t)x, y0 = (uint32_t)y;
    const uint32_t x1 = x0 + 1 < s->map_width ? x0 + 1 : x0, y1 = y0 + 1 < s->map_height ? y0 + 1 : y0;
    const float *top = map + (size_t)y0 * s->map_width;
    const float *low = map + (size_t)y1 * s->map_width;
    const double fx = x - x0, fy = y - y0;
    const double a = (double)top[x0] + fx * ((double)top[x1] - (double)top[x0]);
    const double b = (double)low[x0] + fx * ((double)low[x1] - (double)low[x0]);
    return a + fy * (b - a);
}

/* Where a ray of the box starts, 0 .. 1 of its depth; negative where nothing is clipped. */
static double start_at(const hs_slice_scene *s, double u, double v) {
    const double depth = map_at(s, s->depth, u, v);
    return depth > 0.0 && isfinite(depth) ? (depth + 0.5) / s->slices : -1.0;
}

static void set_pixel(uint8_t *rgba, uint32_t colour) {
    for (int c = 0; c < 3; c++) rgba[c] = (uint8_t)(colour >> (16 - 8 * c));
}

static bool is_in_band(const hs_slice_scene *s, const double box[3], double start) {
    if (!s->sure || !(s->band_mm > 0.0) || start < 0.0) return false;
    const double reach = s->band_mm * (1.0 - map_at(s, s->sure, box[0], box[1])) / s->camera.depth_extent;
    return fabs(box[2] - start) < reach;
}

static uint32_t mixed(uint32_t level, uint32_t colour, double share) {
    uint32_t out = 0;
    for (unsigned shift = 0; shift < 24; shift += 8)
        out |= (uint32_t)(level * (1.0 - share) + (colour >> shift & 255u) * share) << shift;
    return out;
}

/* One pixel; true if it is removed. */
static bool fill_pixel(const hs_slice_scene *s, const hs_box_map *map, const double box[3], uint8_t *rgba) {
    for (int k = 0; k < 3; k++)
        if (box[k] < 0.0 || box[k] > 1.0) {
            set_pixel(rgba, HS_COLOUR_BACKGROUND);
            return false;
        }
    const double start = start_at(s, box[0], box[1]);
    const bool removed = box[2] < start;
    const uint32_t level = (uint32_t)(voxel_at(s, map, box) * (removed ? DIMMED : 1.0));
    set_pixel(rgba, is_in_band(s, box, start) ? mixed(level, HS_SLICE_BAND, BAND_SHARE) : level * 0x010101u);
    return removed;
}

/* The line runs where a pixel is removed and a neighbour is not; two pixels wide. */
static void draw_line(uint32_t n, uint8_t *rgba, const bool *removed) {
    for (uint32_t j = 1; j + 1 < n; j++)
        for (uint32_t i = 1; i + 1 < n; i++) {
            const size_t at = (size_t)j * n + i;
            if (!removed[at] || (removed[at - 1] && removed[at + 1] && removed[at - n] && removed[at + n]))
                continue;
            for (int k = 0; k < 4; k++)
                set_pixel(rgba + 4 * (at + (size_t)(k & 1) + (size_t)(k >> 1) * n), HS_SLICE_LINE);
        }
}

void hs_slice_fill(const hs_slice_scene *scene, hs_slice_plane plane, uint32_t cell, uint8_t *rgba,
                   bool *removed) {
    hs_box_map map;
    hs_camera_box_map(&scene->camera, scene->volume, &map);
    for (uint32_t j = 0; j < cell; j++)
        for (uint32_t i = 0; i < cell; i++) {
            double box[3];
            const size_t at = (size_t)j * cell + i;
            box_of(scene, plane, (i + 0.5) / cell, (j + 0.5) / cell, box);
            removed[at] = fill_pixel(scene, &map, box, rgba + 4 * at);
        }
    draw_line(cell, rgba, removed);
}
