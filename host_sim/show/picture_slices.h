/* SPDX-License-Identifier: MIT */
/* Slices through a frame's volume with the clipping surface drawn in, beside its rendering. */
#ifndef HS_PICTURE_SLICES_H
#define HS_PICTURE_SLICES_H

#include "loop/view.h"
#include "picture/picture_panel.h"

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

#endif
