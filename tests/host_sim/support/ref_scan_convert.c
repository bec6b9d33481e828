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
    const ref_way way = shortest >= 2.7 ? REF_HALVED : shortest >= 1.5 ? REF_NEAREST : REF_TRILINEAR;
    for (int a = 0; a < 3; a++) {
        const double span = edge[a] / finest;
        const double wish = round(way == REF_HALVED ? span / 3.0 : span / 1.5);
        const double fewest = way != REF_HALVED && span >= 1.5 * (1.0 - 1e-6) ? 2.0 : 1.0;
        grid[a] = (int)fmin(fmax(wish, fewest), way == REF_HALVED ? 6.0 : 8.0);
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

/* The mean of the voxels that a halved voxel stands for; 1 if some of them were not scanned, 0 if none
 * was. */
static double ref_marked(const hs_volume *v, const int64_t at[3]) {
    const int64_t n[3] = {v->nx, v->ny, v->nz};
    double sum = 0.0;
    int scanned = 0;
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
    return scanned == 8 ? fmax(floor(sum / 8.0 + 0.5), 2.0) : scanned > 0 ? 1.0 : 0.0;
}

static double ref_round(double value) {
    return floor(value * 256.0 + 0.5) / 256.0;
}

static double ref_between(double a, double b, double f) {
    return a + f * (b - a);
}

typedef enum { REF_WHOLE, REF_PARTLY, REF_EMPTY } ref_kind;

/* Where a position lies among the halved voxels: the one before it, the next, and the way between. False
 * outside the volume. */
static bool ref_halved_place(const hs_volume *v, const double position[3], int64_t low[3], int64_t high[3],
                             double f[3], double *margin) {
    const int64_t n[3] = {v->nx, v->ny, v->nz};
    bool inside = true;
    for (int k = 0; k < 3; k++) {
        const double far = (double)n[k] - 0.5;
        const int64_t last = (n[k] + 1) / 2 - 1;
        *margin = fmin(*margin, fmin(fabs(position[k] + 0.5), fabs(far - position[k])));
        inside = inside && position[k] >= -0.5 && position[k] <= far;
        const double parts = 256.0 * fmin(fmax(0.5 * (position[k] - 0.5), 0.0), (double)last);
        const double rounded = floor(parts + 0.5);
        low[k] = (int64_t)fmin(floor(rounded / 256.0), fmax((double)last - 1.0, 0.0));
        high[k] = low[k] < last ? low[k] + 1 : last;
        f[k] = rounded / 256.0 - (double)low[k];
        *margin = fmin(*margin, 0.05 * fabs(parts - floor(parts) - 0.5));
    }
    return inside;
}

/* A sample of the halved volume, and what it lies between. */
static ref_kind ref_halved(const hs_volume *volume, const double position[3], double *value, double *margin) {
    int64_t low[3], high[3];
    double f[3], slice[2];
    bool whole = true, empty = true;
    if (!ref_halved_place(volume, position, low, high, f, margin)) return REF_EMPTY;
    for (int z = 0; z < 2; z++) {
        double v[4];
        for (int i = 0; i < 4; i++) {
            const int64_t at[3] = {i % 2 ? high[0] : low[0], i / 2 ? high[1] : low[1], z ? high[2] : low[2]};
            v[i] = ref_marked(volume, at);
            whole = whole && v[i] >= 2.0;
            empty = empty && v[i] <= 0.0;
        }
        slice[z] = ref_round(ref_between(ref_between(v[0], v[1], f[0]), ref_between(v[2], v[3], f[0]), f[1]));
    }
    *value = ref_round(ref_between(slice[0], slice[1], f[2]));
    return whole ? REF_WHOLE : empty ? REF_EMPTY : REF_PARTLY;
}

/* What samples come to. */
typedef struct {
    double sum, share;
} ref_sum;

/* All samples of a voxel, and what they lie between. */
static ref_kind ref_gather(const hs_volume *volume, const hs_camera *camera, const hs_slab_layout *layout,
                           ref_way way, const int grid[3], const uint32_t voxel[3], ref_sum *out,
                           double *margin) {
    int kinds[3] = {0};
    *out = (ref_sum){0.0, 0.0};
    for (int i = 0; i < grid[0] * grid[1] * grid[2]; i++) {
        const double box[3] = {(voxel[0] + (i % grid[0] + 0.5) / grid[0]) / layout->width,
                               (voxel[1] + (i / grid[0] % grid[1] + 0.5) / grid[1]) / layout->height,
                               (voxel[2] + (i / grid[0] / grid[1] + 0.5) / grid[2]) / layout->slices};
        double position[3], value = 0.0;
        ref_position(volume, camera, box, position);
        if (way == REF_TRILINEAR) {
            if (!ref_inside(volume, position, margin)) continue;
            out->sum += ref_trilinear(volume, position, NULL);
            out->share += ref_trilinear(volume, position, ref_is_scanned);
            continue;
        }
        if (way == REF_HALVED)
            kinds[ref_halved(volume, position, &value, margin)]++;
        else
            value = ref_nearest(volume, position, margin);
        out->sum += fmax(value, 0.0);
        out->share += value > 0.0;
    }
    return kinds[REF_PARTLY] || (kinds[REF_WHOLE] && kinds[REF_EMPTY]) ? REF_PARTLY
           : kinds[REF_EMPTY]                                          ? REF_EMPTY
                                                                       : REF_WHOLE;
}

ref_lowres ref_convert_voxel(const hs_volume *volume, const hs_camera *camera, const hs_slab_layout *layout,
                             uint32_t x, uint32_t y, uint32_t z) {
    const uint32_t voxel[3] = {x, y, z};
    int grid[3];
    ref_sum s;
    const ref_way way = ref_grid(volume, camera, layout, grid);
    ref_lowres out = {.margin = 1.0};
    const ref_kind kind = ref_gather(volume, camera, layout, way, grid, voxel, &s, &out.margin);
    if (kind == REF_EMPTY) return out;
    if (kind == REF_PARTLY) {
        for (int k = 0; k < 3; k++) grid[k] *= 2;
        (void)ref_gather(volume, camera, layout, REF_NEAREST, grid, voxel, &s, &out.margin);
    }
    const double total = (double)grid[0] * grid[1] * grid[2];
    /* Trilinear shares are rounded, so "half" has a tolerance there; counts are exact. */
    const double half = way != REF_TRILINEAR ? 0.5 * total : 0.4995 * total;
    if (way == REF_TRILINEAR) out.margin = fmin(out.margin, fabs(s.share - half) / total);
    if (s.share < half || s.share == 0.0) return out;
    out.mean = s.sum / s.share;
    out.value = (int)fmin(fmax(floor(out.mean + 0.5), 1.0), 255.0);
    return out;
}
