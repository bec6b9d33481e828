/* SPDX-License-Identifier: MIT */
#include "support/ref_scan_convert.h"

#include "support/ref_dvr.h"

#include <math.h>

static double ref_is_scanned(double value) {
    return value > 0.0 ? 1.0 : 0.0;
}

bool ref_grid(const hs_volume *volume, const hs_camera *camera, const hs_slab_layout *layout, int grid[3]) {
    const double edge[3] = {camera->extent / layout->width, camera->extent / layout->height,
                            camera->depth_extent / layout->slices};
    const double *s = volume->spacing;
    bool nearest = true;
    for (int a = 0; a < 3; a++) {
        double span = edge[a] / fmin(s[0], fmin(s[1], s[2]));
        grid[a] = (int)fmin(fmax(round(span / 1.5), span >= 1.5 * (1.0 - 1e-6) ? 2.0 : 1.0), 8.0);
        if (edge[a] / fmax(s[0], fmax(s[1], s[2])) < 2.0 * (1.0 - 1e-6)) nearest = false;
    }
    return nearest;
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

ref_lowres ref_convert_voxel(const hs_volume *volume, const hs_camera *camera, const hs_slab_layout *layout,
                             uint32_t x, uint32_t y, uint32_t z) {
    int grid[3];
    const bool nearest = ref_grid(volume, camera, layout, grid);
    const double total = (double)grid[0] * grid[1] * grid[2];
    ref_lowres out = {.margin = 1.0};
    double sum = 0.0, share = 0.0;
    for (int i = 0; i < (int)total; i++) {
        const double box[3] = {(x + (i % grid[0] + 0.5) / grid[0]) / layout->width,
                               (y + (i / grid[0] % grid[1] + 0.5) / grid[1]) / layout->height,
                               (z + (i / grid[0] / grid[1] + 0.5) / grid[2]) / layout->slices};
        double position[3];
        ref_position(volume, camera, box, position);
        if (nearest) {
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
    const double half = nearest ? 0.5 * total : 0.4995 * total;
    if (!nearest) out.margin = fmin(out.margin, fabs(share - half) / total);
    if (share < half || share == 0.0) return out;
    out.mean = sum / share;
    out.value = (int)fmin(fmax(floor(out.mean + 0.5), 1.0), 255.0);
    return out;
}
