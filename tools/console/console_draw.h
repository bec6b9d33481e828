/* SPDX-License-Identifier: MIT */
/* The views of a stage as pictures. */
#ifndef HS_CONSOLE_DRAW_H
#define HS_CONSOLE_DRAW_H

#include "console/console_stage.h"
#include "picture/picture.h"

/* What a page has of a view. */
typedef struct {
    bool sent;
    uint32_t size;
    uint64_t scene_epoch, clip_epoch;
    double cross[3];
} hs_console_sent;

/* True if the stage can draw the view at all: a truth needs a scene, the other result a second lane. */
bool hs_console_can_draw(const hs_console_stage *stage, hs_console_view view);

/* True if the view looks otherwise than what was sent; notes it as sent. */
bool hs_console_is_stale(const hs_console_stage *stage, hs_console_view view, hs_console_sent *sent);

/* Draws a view at the screen's size. Allocates *out (hs_picture_free); zeroed on failure: HS_ERR_DEVICE,
 * HS_ERR_MEMORY or those of the source. */
bool hs_console_draw(hs_console_stage *stage, hs_console_view view, hs_picture *out, hs_error *err);

#endif
