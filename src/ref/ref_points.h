/* SPDX-License-Identifier: MIT */
/* From rays to initial points (spec 3; thesis Algorithm 4.1). */
#pragma once

#include "ref/ref_volume.h"

#include <stdbool.h>
#include <stddef.h>

/* ---- ray profiles (lines 2-14) */

/* What is known of a ray at its end. Depths in slices. */
typedef struct {
    uint8_t maximum;  /* largest intensity */
    double max_entry; /* entry into tissue current at the (first) maximum: far end d_f of the interval */
    double max_exit;  /* exit from tissue current there: near end d_n */
} sv_ref_ray;

/* rays: width * height, row by row. `substeps` samples per slice (1 .. 4), linear in between. */
void sv_ref_profile(const sv_ref_volume *volume, double fluid_threshold, uint32_t substeps, sv_ref_ray *rays);

/* ---- bone threshold and initial points (lines 15-22) */

enum { SV_REF_ABSOLUTE = 0, SV_REF_OFFSET = 1, SV_REF_FRACTION = 2 };

typedef struct {
    double fluid_threshold; /* T_L, 0..1 */
    int bone_mode;          /* SV_REF_* */
    double bone_threshold;  /* T_B, absolute mode */
    double bone_offset;     /* delta, offset mode: T_B = maximum of the volume - delta */
    double bone_fraction;   /* fraction mode: share of rays that must qualify at least */
    bool drop_empty;        /* rays with an empty interval give no point */
} sv_ref_bone;

/* Grey level above which a ray's maximum is bone. Never below T_L. */
uint32_t sv_ref_bone_level(const sv_ref_ray *rays, size_t count, const sv_ref_bone *bone);

/* Evidence of a gap: bone rays (maximum above `level`), and those among them whose interval has at least
 * `min_gap` slices. A frame has a surface only if it has a point and with_gap >= evidence * bone, `evidence`
 * in whole thousandths. */
typedef struct {
    uint32_t bone, with_gap;
} sv_ref_evidence;
sv_ref_evidence sv_ref_gather_evidence(const sv_ref_ray *rays, size_t count, uint32_t level, double min_gap,
                                       uint32_t substeps);
bool sv_ref_surface_wanted(uint32_t points, sv_ref_evidence found, double evidence);

/* Per ray: status (0 none, 1 initial point, 2 initial point with an empty interval) and both interval ends in
 * slices (0 where there is none). Returns the number of points. */
uint32_t sv_ref_points(const sv_ref_ray *rays, size_t count, const sv_ref_bone *bone, uint32_t level,
                       uint8_t *status, double *near_end, double *far_end);

/* The knob (spec 4): S(q) = S_f + q (S_n - S_f), in float32. */
void sv_ref_blend(const float *near_surface, const float *far_surface, size_t count, float q, float *depth);
