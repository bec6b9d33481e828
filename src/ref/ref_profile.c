/* SPDX-License-Identifier: MIT */
/* Ray profiles: Algorithm 4.1, lines 2-14, with the corrections of spec 3 and 9. */
#include "ref/ref_profile.h"

#include "quantise.h"

#include <math.h>

/* The walk along one ray. */
typedef struct {
    bool in_tissue; /* class of the last scanned sample */
    double entry, exit;
    double maximum;
    sv_ref_ray ray;
} walk;

/* One sample: `value` in grey levels (between two slices: not necessarily whole), at `depth` slices. */
static void walk_sample(walk *w, double value, double depth, double threshold) {
    const bool tissue = value > threshold;
    if (tissue && !w->in_tissue) w->entry = depth;
    if (!tissue && w->in_tissue) w->exit = depth;
    if (value > w->maximum) {
        w->maximum = value;
        w->ray.max_entry = w->entry;
        w->ray.max_exit = w->exit;
    }
    w->in_tissue = tissue;
}

static void walk_ray(const sv_ref_volume *v, size_t pixel, double threshold, uint32_t substeps,
                     sv_ref_ray *ray) {
    const size_t slice_size = (size_t)v->width * v->height;
    /* A ray starts as if in tissue: fluid at its first scanned voxel opens an interval there, tissue opens
     * none. */
    walk w = {.in_tissue = true};
    int before = -1; /* voxel of the slice before, -1 if there is none or it was not scanned */
    for (uint32_t z = 0; z < v->slices; z++) {
        const int voxel = v->voxels[z * slice_size + pixel];
        const bool scanned = sv_ref_scanned(v, pixel, z);
        for (uint32_t j = 1; scanned && before >= 0 && j < substeps; j++) {
            /* One division of whole numbers: on a plateau the sample must equal the voxels, or a rounding
             * error would make it a new maximum. */
            const uint32_t sum = (uint32_t)before * (substeps - j) + (uint32_t)voxel * j;
            walk_sample(&w, (double)sum / substeps, z - 1.0 + (double)j / substeps, threshold);
        }
        if (scanned) walk_sample(&w, voxel, z, threshold);
        before = scanned ? voxel : -1;
    }
    w.ray.maximum = (uint8_t)w.maximum; /* whole: a linear piece is largest at one of its ends, a voxel */
    *ray = w.ray;
}

void sv_ref_profile(const sv_ref_volume *volume, double fluid_threshold, uint32_t substeps,
                    sv_ref_ray *rays) {
    const double threshold = fluid_threshold * 255.0 + SV_LEVEL_SLACK;
    const size_t count = (size_t)volume->width * volume->height;
    for (size_t pixel = 0; pixel < count; pixel++) walk_ray(volume, pixel, threshold, substeps, &rays[pixel]);
}
