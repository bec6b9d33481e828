/* SPDX-License-Identifier: MIT */
#include "support/ref_dvr.h"

#include <math.h>

void ref_position(const hs_volume *volume, const hs_camera *camera, const double box[3], double out[3]) {
    const double count[3] = {volume->nx, volume->ny, volume->nz};
    const double mm[3] = {(box[0] - 0.5) * camera->extent, (box[1] - 0.5) * camera->extent,
                          (box[2] - 0.5) * camera->depth_extent};
    for (int k = 0; k < 3; k++) {
        double from_centre = 0.0;
        for (int axis = 0; axis < 3; axis++) from_centre += camera->rotation[k * 3 + axis] * mm[axis];
        out[k] = (0.5 * count[k] * volume->spacing[k] + from_centre) / volume->spacing[k] - 0.5;
    }
}

double ref_voxel(const hs_volume *volume, int64_t x, int64_t y, int64_t z) {
    return volume->voxels[((size_t)z * volume->ny + (size_t)y) * volume->nx + (size_t)x];
}

double ref_linear(const uint8_t *data, const uint32_t n[3], const double position[3],
                  double (*weight)(double)) {
    uint32_t corner[2][3];
    double fraction[3], sum = 0.0;
    for (int k = 0; k < 3; k++) {
        const double p = fmin(fmax(position[k], 0.0), n[k] - 1.0);
        corner[0][k] = (uint32_t)p;
        corner[1][k] = corner[0][k] + 1 < n[k] ? corner[0][k] + 1 : corner[0][k];
        fraction[k] = p - floor(p);
    }
    for (int i = 0; i < 8; i++) {
        const int b[3] = {i & 1, i >> 1 & 1, i >> 2 & 1};
        double share = 1.0;
        for (int k = 0; k < 3; k++) share *= b[k] ? fraction[k] : 1.0 - fraction[k];
        const double value =
            data[((size_t)corner[b[2]][2] * n[1] + corner[b[1]][1]) * n[0] + corner[b[0]][0]];
        sum += share * (weight ? weight(value) : value);
    }
    return sum;
}

double ref_trilinear(const hs_volume *volume, const double position[3], double (*weight)(double)) {
    return ref_linear(volume->voxels, (const uint32_t[]){volume->nx, volume->ny, volume->nz}, position,
                      weight);
}

bool ref_inside(const hs_volume *volume, const double position[3], double *margin) {
    const double count[3] = {volume->nx, volume->ny, volume->nz};
    bool inside = true;
    for (int k = 0; k < 3; k++) {
        double low = position[k] + 0.501, high = count[k] - 1.0 + 0.501 - position[k];
        inside = inside && low >= 0.0 && high >= 0.0;
        *margin = fmin(*margin, fmin(fabs(low), fabs(high)));
    }
    return inside;
}

double ref_map_value(const ref_depthmap *map, const float *values, double u, double v) {
    const double x = fmin(fmax(u * map->width - 0.5, 0.0), map->width - 1.0);
    const double y = fmin(fmax(v * map->height - 0.5, 0.0), map->height - 1.0);
    const uint32_t x0 = (uint32_t)x, y0 = (uint32_t)y;
    const uint32_t x1 = x0 + 1 < map->width ? x0 + 1 : x0, y1 = y0 + 1 < map->height ? y0 + 1 : y0;
    const double fx = x - x0, fy = y - y0;
    const double top =
        (1.0 - fx) * (double)values[y0 * map->width + x0] + fx * (double)values[y0 * map->width + x1];
    const double low =
        (1.0 - fx) * (double)values[y1 * map->width + x0] + fx * (double)values[y1 * map->width + x1];
    return (1.0 - fy) * top + fy * low;
}

/* The depth under a pixel. One that is unknown clips nothing, and makes all beside it so: it times 0 is no
 * number. */
static double ref_depth(const ref_depthmap *map, double u, double v) {
    const double depth = ref_map_value(map, map->depth, u, v);
    return isfinite(depth) ? depth : 0.0;
}

/* Eq. 3.25 as corrected, and with a window that grows towards the viewer where the confidence is low: the
 * opacity factor of sample n where the surface is at d_p steps. */
static double ref_ghost(const hs_dvr_settings *s, double surface, double confidence, double n,
                        double *margin) {
    double rise = surface - (double)s->ghost_offset, width = (double)s->ghost_width;
    double growth = width * (double)s->ghost_doubt * (1.0 - confidence);
    if (width > 0.0) return fmin(fmax((n - (rise - growth)) / (width + growth), 0.0), 1.0);
    *margin = fmin(*margin, fabs(n - (rise - 1e-3))); /* a sample on the surface is drawn */
    return n >= rise - 1e-3 ? 1.0 : 0.0;
}

ref_pixel ref_dvr_pixel(const hs_volume *volume, const hs_camera *camera, const hs_dvr_settings *s,
                        const ref_depthmap *map, uint32_t x, uint32_t y) {
    const double finest = fmin(volume->spacing[0], fmin(volume->spacing[1], volume->spacing[2]));
    const double slices = fmax(1.0, round(camera->depth_extent / finest)), step = (double)s->step;
    const double steps = fmax(1.0, ceil(slices / step - 0.5));
    const double u = (x + 0.5) / s->width, v = (y + 0.5) / s->height;
    ref_pixel pixel = {.termination = steps, .margin = 1.0};
    double depth = map->depth ? ref_depth(map, u, v) : 0.0;
    if (depth != 0.0) pixel.margin = fmin(pixel.margin, fabs(depth));
    double surface = (depth + 0.5) / (map->depth ? map->slices : 1.0) * slices / step - 0.5;
    double confidence = map->confidence ? ref_map_value(map, map->confidence, u, v) : 1.0;
    double opacity = 0.0, light = 0.0;
    for (double n = 0.0; n < steps; n += 1.0) {
        double position[3], face = 1.0, decision = 1.0;
        const double box[3] = {u, v, (n + 0.5) * step / slices};
        ref_position(volume, camera, box, position);
        bool inside = ref_inside(volume, position, &face);
        double value = inside ? ref_trilinear(volume, position, NULL) : 0.0;
        pixel.margin = fmin(pixel.margin, face);
        if (!inside) continue;
        double alpha = (value / 255.0 - (double)s->threshold_low) /
                       ((double)s->threshold_high - (double)s->threshold_low);
        alpha = fmin(fmax(alpha, 0.0), 1.0);
        if (depth > 0.0) alpha *= ref_ghost(s, surface, confidence, n, &decision);
        alpha = 1.0 - pow(1.0 - alpha, step);
        light += (1.0 - opacity) * alpha * value;
        opacity += (1.0 - opacity) * alpha;
        if (alpha > 0.0) decision = fmin(decision, fabs(opacity - (double)s->termination));
        pixel.margin = fmin(pixel.margin, decision);
        if (opacity < (double)s->termination) continue;
        pixel.termination = n;
        break;
    }
    for (int c = 0; c < 3; c++) pixel.rgb[c] = fmin(light * (double)s->skin[c], 255.0);
    return pixel;
}
