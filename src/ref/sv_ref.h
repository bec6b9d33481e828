/* SPDX-License-Identifier: MIT */
/*
 * The scalar definition of every stage, written from the specification and free of OpenCL. Tests hold the
 * kernels to it, and the plugin's self-test asks the device for an answer that is computed here.
 *
 * Two kinds: float64 definitions (what is meant), and the fixed-point form of the mean filter (what the
 * kernels compute, to the bit). Nothing here is fast, and nothing allocates but where it says so.
 */
#ifndef SV_REF_H
#define SV_REF_H

#include "quantise.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* A whole camera-aligned volume: voxel (x, y, z) at voxels[(z * height + y) * width + x]. */
typedef struct {
    const uint8_t *voxels;
    uint32_t width, height, slices;
    int32_t padding; /* voxels of this value were not scanned; -1: all were */
} sv_ref_volume;

/* ---- ray profile (spec 3; thesis Algorithm 4.1, lines 2-14)
 * -------------------------------------------------- */

/* What is known of a ray at its end. Depths in slices. */
typedef struct {
    uint8_t maximum;  /* largest intensity */
    double max_entry; /* entry into tissue that was current at the (first) maximum: far end d_f of the
                         interval */
    double max_exit;  /* exit from tissue that was current there: near end d_n */
} sv_ref_ray;

/* rays: width * height, row by row. `substeps` samples per slice (1 .. 4), linear in between. */
void sv_ref_profile(const sv_ref_volume *volume, double fluid_threshold, uint32_t substeps, sv_ref_ray *rays);

/* ---- bone threshold and initial points (spec 3; lines 15-22)
 * ------------------------------------------------- */

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
 * `min_gap` slices. A frame has a surface only if it has a point and sure >= evidence * bone, `evidence` in
 * whole thousandths. */
typedef struct {
    uint32_t bone, sure;
} sv_ref_evidence;
sv_ref_evidence sv_ref_gather_evidence(const sv_ref_ray *rays, size_t count, uint32_t level, double min_gap,
                                       uint32_t substeps);
bool sv_ref_surface_wanted(uint32_t points, sv_ref_evidence found, double evidence);

/* Per ray: status (0 none, 1 initial point, 2 initial point with an empty interval) and both interval ends in
 * slices (0 where there is none). Returns the number of points. */
uint32_t sv_ref_points(const sv_ref_ray *rays, size_t count, const sv_ref_bone *bone, uint32_t level,
                       uint8_t *status, double *near_end, double *far_end);

/* ---- mean filter (spec 4; thesis Eq. 3.18-3.21, Algorithm 4.3)
 * ------------------------------------------------ */

typedef struct {
    uint32_t passes;   /* iterations done */
    uint32_t unfilled; /* pixels still without a value; they are 0 in the result */
} sv_ref_fill;

/* float64 definition. `status` != 0 marks initial points; depth in, surface out (may not overlap). False if
 * memory runs out. No initial point: zeros, 0 passes. Ends when every pixel is filled or a pass fills none.
 */
bool sv_ref_mean(const uint8_t *status, const double *depth, uint32_t width, uint32_t height, uint32_t k,
                 double omega, double *surface, sv_ref_fill *fill);

/* The kernels' fixed-point mean filter for both ends at once, to the bit. Positions in samples (substeps per
 * slice); only pixels with status != 0 are read. Surfaces in float32 slices. False if memory runs out. */
bool sv_ref_mean_fixed(const uint8_t *status, const uint32_t *near_position, const uint32_t *far_position,
                       uint32_t width, uint32_t height, uint32_t k, double omega, uint32_t substeps,
                       sv_fixed format, float *near_surface, float *far_surface, sv_ref_fill *fill);

/* ---- the knob (spec 4): S(q) = S_f + q (S_n - S_f)
 * ------------------------------------------------------------ */
void sv_ref_blend(const float *near_surface, const float *far_surface, size_t count, float q, float *depth);

#endif
