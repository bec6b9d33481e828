/* SPDX-License-Identifier: MIT */
/* The lit look's definition (docs/rendering.md) in scalar double precision: one ray, one sample after the
 * other, no skipping. Written from the words; it shares nothing with the kernels but the settings. */
#ifndef REF_LIT_H
#define REF_LIT_H

#include "support/ref_dvr.h"
#include "support/ref_lit_volume.h"

/* A pixel's red, green and blue, 0 .. 255, not rounded. */
void ref_lit_pixel(const hs_volume *volume, const ref_lit_volume *lit, const hs_camera *camera,
                   const hs_dvr_settings *s, const ref_depthmap *map, uint32_t x, uint32_t y, double rgb[3]);

#endif
