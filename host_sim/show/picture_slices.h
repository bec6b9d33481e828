/* SPDX-License-Identifier: MIT */
/* Slices through a frame's volume with the clipping surface drawn in, beside its rendering. */
#pragma once

#include "loop/view.h"
#include "picture/picture_draw.h"
#include "render/camera.h"

#define HS_SLICE_LINE 0xffd23fu /* the clipping surface */
#define HS_SLICE_BAND 0xff8a5cu /* where it may lie, too, laid over the tissue */

/* A slice: x and depth; depth and y; x and y. */
typedef enum { HS_SLICE_ACROSS, HS_SLICE_ALONG, HS_SLICE_AT_DEPTH, HS_SLICE_PLANES } hs_slice_plane;

/* What is cut. Everything is borrowed. Places in the box are 0 .. 1: u right, v down, w away. */
typedef struct {
    const hs_volume *volume;
    const hs_maps *maps;    /* cropped or not */
    double at[3];           /* where the slices lie */
    double low[3], side[3]; /* the squares: where they begin, and what of the box they span */
    double band_mm; /* the band's half width where nothing is sure, on either side of the line; 0: none */
    double
        thick_mm; /* a pixel is the mean over so much, half of it on either side of the slice; 0: one voxel */
    const hs_crop *crop; /* what lies outside is as beside the box; NULL: nothing does */
} hs_slice_scene;

/* What becomes of a pixel. */
enum { HS_SLICE_UNSCANNED, HS_SLICE_KEPT, HS_SLICE_REMOVED };

/* Fills `cell` * `cell` RGBA pixels, and HS_SLICE_* for each of them. What lies beside the box has
 * HS_COLOUR_BACKGROUND. The line runs between what is removed and what is kept, and neither it nor the band
 * is drawn where nothing was scanned. Any thread. */
void hs_slice_fill(const hs_slice_scene *scene, hs_slice_plane plane, uint32_t cell, uint8_t *rgba,
                   uint8_t *state);

/*
 * Four squares side by side, each `cell` pixels wide (0: 512): the result; the slice across (x and depth) and
 * the one along (depth and y) through the middle of the picture; and the slice at the median depth of the
 * clipping surface, or in the middle of the box where nothing is clipped. All in the camera's axes, with
 * scales in millimetres. What the plugin removes is dimmed, and its edge is a line. Allocates *out
 * (hs_picture_free it); zeroed on failure, with HS_ERR_MEMORY, HS_ERR_INPUT or HS_ERR_FAILED.
 */
bool hs_picture_slices(hs_picture *out, const hs_view *view, uint32_t cell, const hs_caption *caption,
                       hs_error *err);

/* The median depth of the clipping surface in millimetres from the front of the box, over the rays it clips;
 * negative if it clips none. */
double hs_view_clip_depth(const hs_view *view);
