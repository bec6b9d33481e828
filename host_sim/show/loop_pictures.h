/* SPDX-License-Identifier: MIT */
/* The scan loop's pictures in one folder (thesis, Figure 4.2). */
#pragma once

#include "loop/loop.h"
#include "loop/view.h"

/*
 * Writes, from one view:
 *   result.png, full.png, truth.png   the pictures alone (truth: scenes only)
 *   panel.png                         the same side by side
 *   slices.png                        the result beside three slices with the clipping surface drawn in
 *   depthmap.png                      the clipping depthmap in false colour, with a legend
 *   confidence.png                    the plugin's confidence, if it gave one
 * `title` names source and plugin. `note` (may be NULL) is what hs_frame_note says; `cell` is the width
 * of a picture in panel.png in pixels, 0: 512.
 */
bool hs_loop_write_pictures(const hs_view *view, const char *folder, const char *title, const char *note,
                            uint32_t cell, hs_error *err);

/* Of these result.png, which needs no more than hs_loop_view_result; full.png; and all others. */
bool hs_loop_write_result(const hs_view *view, const char *folder, hs_error *err);
bool hs_loop_write_full(const hs_view *view, const char *folder, hs_error *err);
bool hs_loop_write_rest(const hs_view *view, const char *folder, const char *title, const char *note,
                        uint32_t cell, hs_error *err);

/* What a person must know of a frame beside its picture: that it is not clipped and why (`failure`, what the
 * plugin failed with), or how many rays are not. NULL if there is nothing to say, else `out`. */
const char *hs_frame_note(const hs_frame *frame, const char *failure, char *out, size_t bytes);
