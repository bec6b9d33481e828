/* SPDX-License-Identifier: MIT */
/*
 * Maps in colour with a legend beside them: depth, signed values, shares. Maps are
 * row-major, rows top to bottom, as the camera sees them. Every function allocates *out (hs_picture_free it);
 * on failure it is zeroed. Any thread, on different pictures at once.
 */
#pragma once

#include "picture/picture_draw.h"

#define HS_COLOUR_NOTHING_A 0x6a6d72u /* "clips nothing": a hatch of two greys */
#define HS_COLOUR_NOTHING_B 0x4b4e53u

/* A depthmap (width * height float32, mm) in viridis with a colour bar over the depths that are there. A
 * depth <= 0 clips nothing: grey hatch, its share in the legend. NaN and infinities are drawn in
 * HS_COLOUR_INVALID and counted. */
bool hs_picture_depthmap(hs_picture *out, const float *depth, uint32_t width, uint32_t height,
                         const hs_caption *caption, hs_error *err);

/* Words of a signed map's legend. */
typedef struct {
    const char *quantity; /* "error" */
    const char *unit;     /* "steps" */
    const char *positive; /* what red means: "occluder left" */
    const char *negative; /* what blue means: "fetus cut" */
} hs_signed_words;

/* A signed map, blue - white - red over -limit .. limit, which is above 0. NaN: no
 * value, drawn in HS_COLOUR_NO_VALUE. */
bool hs_picture_signed(hs_picture *out, const float *value, uint32_t width, uint32_t height, float limit,
                       const hs_signed_words *words, const hs_caption *caption, hs_error *err);

/* Words of a share's legend. */
typedef struct {
    const char *quantity;   /* "confidence" */
    const char *high, *low; /* what 1 and 0 mean: "sure", "unsure" */
} hs_share_words;

/* A map of shares, 0 .. 1 in viridis. What is not in 0 .. 1 is drawn in HS_COLOUR_INVALID and counted. The
 * mean stands in the legend. */
bool hs_picture_share(hs_picture *out, const float *value, uint32_t width, uint32_t height,
                      const hs_share_words *words, const hs_caption *caption, hs_error *err);
