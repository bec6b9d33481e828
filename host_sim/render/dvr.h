/* SPDX-License-Identifier: MIT */
/*
 * The host's direct volume renderer: orthographic, front to back, early ray termination, ghosting (spec 5).
 * What follows defines the thesis' look and the ends of rays; docs/rendering.md the lit one.
 *
 * SAMPLES. The box' depth is divided into S = round(depth_extent / finest spacing) source slices, 1 at least.
 * Sample n of a ray stands at (n + 0.5) * step slices from the front of the box, n = 0 .. steps - 1, with
 * steps = ceil(S / step - 0.5): with step 1 and the camera at 0, 0 these are the voxel centres. A depth in
 * steps is a (fractional) n: 0 is the first sample. A sample is trilinear between voxel centres; in the outer
 * half voxel the nearest voxel counts; outside the volume's box there is nothing. The box counts as a
 * thousandth of a voxel larger on every side, so that rounding never decides about a sample on its face.
 *
 * COMPOSITING (thesis Eq. 3.22 - 3.24). i: intensity 0 .. 1, A: opacity so far, C: colour so far.
 *
 *     a = clamp((i - T_L) / (T_H - T_L), 0, 1) * ghost(n)    of one slice of this tissue
 *
 *     a = 1 - (1 - a)^step                                   of one step: the picture hardly depends on it
 *
 *     C = C + (1 - A) * a * i * skin
 *
 *     A = A + (1 - A) * a                                    the ray ends where A >= termination
 *
 * CLIPPING (Eq. 3.25 with its signs put right). Depth d of the map, in low-resolution slices of M, is the box
 * depth (d + 0.5) / M, so in steps d_p = (d + 0.5) / M * S / step - 0.5.
 *
 *     w > 0:  ghost(n) = clamp((n - (d_p - s)) / w, 0, 1)
 *
 *     w = 0:  ghost(n) = n >= d_p - s ? 1 : 0                with a thousandth of a step of tolerance
 *
 * Where d <= 0, or is not finite, nothing is clipped: ghost(n) = 1.
 *
 * CONFIDENCE. Where a map says how sure the depth is, c in 0 .. 1, the window grows towards the viewer as c
 * falls, by g of its width w at most (g: ghost_doubt):
 *
 *     v = w * g * (1 - c)
 *
 *     ghost(n) = clamp((n - (d_p - s - v)) / (w + v), 0, 1)
 *
 * Its far end stays at d_p - s + w, so no sample is fainter than without the map: where nothing is sure less
 * is clipped, and what lies behind the window is drawn as ever. A hard cut (w = 0) stays one.
 */
#pragma once

#include "render/dvr_settings.h"
#include "render/scan_convert.h"

/* Samples of a ray that crosses the whole box, the value of `termination` on rays that never reach it. */
uint32_t hs_dvr_steps(const hs_dvr_settings *settings, const hs_device_volume *source,
                      const hs_camera *camera);

typedef struct hs_dvr hs_dvr;
/* NULL with HS_ERR_USAGE (a setting out of range, named), HS_ERR_DEVICE or HS_ERR_MEMORY. */
hs_dvr *hs_dvr_create(const hs_cl *cl, const hs_dvr_settings *settings, hs_error *err);
void hs_dvr_destroy(hs_dvr *dvr);

/* What a look needs of a volume beside its voxels is made at its first picture, and again after
 * hs_device_volume_replace; this makes it, and takes its memory, ahead of time. HS_ERR_DEVICE. */
bool hs_dvr_prepare(hs_dvr *dvr, const hs_device_volume *source, hs_error *err);

/*
 * Enqueues one picture; does not wait. `rgba` (a buffer of width * height * 4 bytes, may be NULL) receives
 * the picture on black, rows top to bottom. `termination` (a buffer of width * height floats, may be NULL)
 * receives the depth in steps from the front of the box at which each ray's opacity reached `termination`, or
 * the number of steps of a whole ray if it never did (spec 7). Those depths do not depend on the look.
 */
bool hs_dvr_render(hs_dvr *dvr, const hs_device_volume *source, const hs_camera *camera,
                   const hs_start_depths *depths, cl_mem rgba, cl_mem termination, cl_event *event,
                   hs_error *err);
