/* SPDX-License-Identifier: MIT */
#include "support/ref_scan_convert.h"

#include "support/ref_dvr.h"

#include <math.h>

static double ref_is_scanned(double value) {
    return value > 0.0 ? 1.0 : 0.0;
}

ref_way ref_grid(const hs_volume *volume, const hs_camera *camera, const hs_slab_layout *layout,
                 int grid[3]) {
    const double edge[3] = {camera->extent / layout->width, camera->extent / layout->height,
                            camera->depth_extent / layout->slices};
    const double *s = volume->spacing, finest = fmin(s[0], fmin(s[1], s[2]));
    const double shortest =
        fmin(edge[0], fmin(edge[1], edge[2])) / fmax(s[0], fmax(s[1], s[2])) * (1.0 + 1e-6);
    const ref_way way = shortest >= 2.7 ? REF_HALVED : shortest >= 2.0 ? REF_NEAREST : REF_TRILINEAR;
    for (int a = 0; a < 3; a++) {
        const double span = edge[a] / finest;
        const double wish = round(way == REF_HALVED ? span / 3.0 : span / 1.5);
        const double least = way != REF_HALVED && span >= 1.5 * (1.0 - 1e-6) ? 2.0 : 1.0;
        grid[a] = (int)fmin(fmax(wish, least), 8.0);
    }
    return way;
}

/* The nearest voxel's value, or -1 outside the volume. */
static double ref_nearest(const hs_volume *volume, const double position[3], double *margin) {
    const int64_t count[3] = {volume->nx, volume->ny, volume->nz};
    int64_t index[3];
    for (int k = 0; k < 3; k++) {
        double shifted = position[k] + 0.5;
        index[k] = (int64_t)floor(shifted);
        *margin = fmin(*margin, fabs(shifted - round(shifted)));
        if (index[k] < 0 || index[k] >= count[k]) return -1.0;
    }
    return ref_voxel(volume, index[0], index[1], index[2]);
}

/* The mean of the scanned of the voxels that a halved voxel stands for. */
static double ref_halved_voxel(const hs_volume *v, const int64_t at[3]) {
    const int64_t n[3] = {v->nx, v->ny, v->nz};
    double sum = 0.0, scanned = 0.0;
    for (int i = 0; i < 8; i++) {
        int64_t index[3];
        for (int k = 0; k < 3; k++) {
            index[k] = 2 * at[k] + (i >> k & 1);
            if (index[k] >= n[k]) index[k] = n[k] - 1;
        }
        const double value = ref_voxel(v, index[0], index[1], index[2]);
        sum += value;
        scanned += value > 0.0;
    }
    return scanned < 4.0 ? 0.0 : floor(sum / scanned + 0.5);
}

static double ref_round(double value) {
    return floor(value * 256.0 + 0.5) / 256.0;
}

static double ref_between(double a, double b, double f) {
    return a + f * (b - a);
}

/* Where a position lies among the halved voxels: the one before it, the next, and the way between. False
 * outside the volume. */
static bool ref_halved_place(const hs_volume *v, const double position[3], int64_t low[3], int64_t high[3],
                             double f[3], double *margin) {
    const int64_t n[3] = {v->nx, v->ny, v->nz};
    for (int k = 0; k < 3; k++) {
        const double far = (double)n[k] - 0.5;
        *margin = fmin(*margin, fmin(fabs(position[k] + 0.5), fabs(far - position[k])));
        if (position[k] < -0.5 || position[k] > far) return false;
        const int64_t last = (n[k] + 1) / 2 - 1;
        const double p = fmin(fmax(0.5 * (position[k] - 0.5), 0.0), (double)last);
        low[k] = (int64_t)floor(p);
        high[k] = low[k] < last ? low[k] + 1 : last;
        f[k] = ref_round(p - (double)low[k]);
        const double parts = (p - (double)low[k]) * 256.0;
        *margin = fmin(*margin, 0.05 * fabs(parts - floor(parts) - 0.5));
    }
    return true;
}

/* A sample of the halved volume and its scanned share; false outside the volume. */
static bool ref_halved(const hs_volume *volume, const double position[3], double out[2], double *margin) {
    int64_t low[3], high[3];
    double f[3], slice[2][2];
    if (!ref_halved_place(volume, position, low, high, f, margin)) return false;
    for (int z = 0; z < 2; z++) {
        double v[4][2];
        for (int i = 0; i < 4; i++) {
            const int64_t at[3] = {i % 2 ? high[0] : low[0], i / 2 ? high[1] : low[1], z ? high[2] : low[2]};
            v[i][0] = ref_halved_voxel(volume, at);
            v[i][1] = ref_is_scanned(v[i][0]);
        }
        for (int what = 0; what < 2; what++)
            slice[z][what] = ref_round(ref_between(ref_between(v[0][what], v[1][what], f[0]),
                                                   ref_between(v[2][what], v[3][what], f[0]), f[1]));
    }
    for (int what = 0; what < 2; what++)
        out[what] = ref_round(ref_between(slice[0][what], slice[1][what], f[2]));
    return true;
}

ref_lowres ref_convert_voxel(const hs_volume *volume, const hs_camera *camera, const hs_slab_layout *layout,
                             uint32_t x, uint32_t y, uint32_t z) {
    int grid[3];
    const ref_way way = ref_grid(volume, camera, layout, grid);
    const double total = (double)grid[0] * grid[1] * grid[2];
    ref_lowres out = {.margin = 1.0};
    double sum = 0.0, share = 0.0;
    for (int i = 0; i < (int)total; i++) {
        const double box[3] = {(x + (i % grid[0] + 0.5) / grid[0]) / layout->width,
                               (y + (i / grid[0] % grid[1] + 0.5) / grid[1]) / layout->height,
                               (z + (i / grid[0] / grid[1] + 0.5) / grid[2]) / layout->slices};
        double position[3], sample[2];
        ref_position(volume, camera, box, position);
        if (way == REF_HALVED) {
            if (!ref_halved(volume, position, sample, &out.margin)) continue;
            sum += sample[0];
            share += sample[1];
        } else if (way == REF_NEAREST) {
            double value = ref_nearest(volume, position, &out.margin);
            if (value > 0.0) {
                sum += value;
                share += 1.0;
            }
        } else if (ref_inside(volume, position, &out.margin)) {
            sum += ref_trilinear(volume, position, NULL);
            share += ref_trilinear(volume, position, ref_is_scanned);
        }
    }
    /* Trilinear shares are rounded, so "half" has a tolerance there; counts are exact. */
    const double half = way != REF_TRILINEAR ? 0.5 * total : 0.4995 * total;
    if (way == REF_TRILINEAR) out.margin = fmin(out.margin, fabs(share - half) / total);
    if (share < half || share == 0.0) return out;
    out.mean = sum / share;
    out.value = (int)fmin(fmax(floor(out.mean + 0.5), 1.0), 255.0);
    return out;
}
