/* SPDX-License-Identifier: MIT */
/* A scene's ground truth as a picture, with what is made once for a volume and used for many cameras. */
#ifndef HS_TRUTH_PICTURE_H
#define HS_TRUTH_PICTURE_H

#include "loop/loop.h"
#include "loop/screen.h"

typedef struct hs_truth_picture hs_truth_picture;

/* Nothing is made yet. `loop` must have a source with a ground truth and outlive it.
 * NULL with HS_ERR_MEMORY. */
hs_truth_picture *hs_truth_picture_create(hs_loop *loop, hs_error *err);
void hs_truth_picture_destroy(hs_truth_picture *picture);

/* Enqueues the truth of frame `index` with the loop's window, in the screen's look, and waits for it. In the
 * lit look the truth is drawn as a result is, where the camera sees the scene's own rays: the frame's volume,
 * which must be on the device (hs_loop_bring), cut at the scene's surface, so that a cut is drawn as one.
 * HS_ERR_DEVICE or HS_ERR_MEMORY. */
bool hs_truth_picture_draw(hs_truth_picture *picture, hs_screen *screen, hs_look look, uint32_t index,
                           hs_error *err);

#endif
