/* SPDX-License-Identifier: MIT */
#include "ref/ref_points.h"

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

/* The largest level that at least `wanted` rays exceed. */
static uint32_t level_of_fraction(const sv_ref_ray *rays, size_t count, uint32_t wanted) {
    for (uint32_t level = 254;; level--) {
        uint32_t above = 0;
        for (size_t i = 0; i < count; i++) above += rays[i].maximum > level;
        if (above >= wanted || level == 0) return level;
    }
}

/* T_B = maximum - delta: bone exceeds the largest level that is not above it. */
static uint32_t level_of_offset(const sv_ref_ray *rays, size_t count, double offset) {
    uint32_t maximum = 0;
    for (size_t i = 0; i < count; i++)
        if (rays[i].maximum > maximum) maximum = rays[i].maximum;
    const double level = floor(maximum - offset * 255.0 + SV_LEVEL_SLACK);
    return level < 0.0 ? 0 : (uint32_t)level;
}

uint32_t sv_ref_bone_level(const sv_ref_ray *rays, size_t count, const sv_ref_bone *bone) {
    uint32_t level = 0;
    switch (bone->bone_mode) {
    case SV_REF_ABSOLUTE:
        level = sv_grey_level(bone->bone_threshold, 1);
        break;
    case SV_REF_OFFSET:
        level = level_of_offset(rays, count, bone->bone_offset);
        break;
    default:
        level = level_of_fraction(rays, count, sv_rays_wanted(bone->bone_fraction, (uint32_t)count));
        break;
    }
    const uint32_t fluid = sv_grey_level(bone->fluid_threshold, 1);
    return level > fluid ? level : fluid; /* bone is tissue */
}

sv_ref_evidence sv_ref_gather_evidence(const sv_ref_ray *rays, size_t count, uint32_t level, double min_gap,
                                       uint32_t substeps) {
    sv_ref_evidence found = {0, 0};
    for (size_t i = 0; i < count; i++) {
        const double gap = rays[i].max_entry - rays[i].max_exit;
        const bool bone = rays[i].maximum > level;
        found.bone += bone;
        found.with_gap +=
            bone && gap > 0.0 && floor(gap * substeps + 0.5) >= sv_gap_samples(min_gap, substeps);
    }
    return found;
}

bool sv_ref_surface_wanted(uint32_t points, sv_ref_evidence found, double evidence) {
    const uint64_t thousandths = (uint64_t)(evidence * 1000.0 + 0.5);
    return points > 0 && (uint64_t)found.with_gap * 1000 >= found.bone * thousandths;
}

uint32_t sv_ref_points(const sv_ref_ray *rays, size_t count, const sv_ref_bone *bone, uint32_t level,
                       uint8_t *status, double *near_end, double *far_end) {
    uint32_t points = 0;
    for (size_t i = 0; i < count; i++) {
        const bool open = rays[i].max_entry > rays[i].max_exit;
        const bool point = rays[i].maximum > level && (open || !bone->drop_empty);
        status[i] = point ? (open ? 1 : 2) : 0;
        near_end[i] = point && open ? rays[i].max_exit : 0.0;
        far_end[i] = point && open ? rays[i].max_entry : 0.0;
        points += point;
    }
    return points;
}

void sv_ref_blend(const float *near_surface, const float *far_surface, size_t count, float q, float *depth) {
    for (size_t i = 0; i < count; i++) depth[i] = far_surface[i] + q * (near_surface[i] - far_surface[i]);
}
