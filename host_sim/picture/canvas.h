/* SPDX-License-Identifier: MIT */
/* What draws text and boxes on a picture: cairo, or Windows itself. Colours are 0xRRGGBB, places pixels. */
#pragma once

#include "picture/picture.h"

typedef struct hs_canvas hs_canvas;

/* Draws on the picture's pixels. Never NULL: trouble is reported at the end. */
hs_canvas *hs_draw_begin(hs_picture *picture);
/* Finishes; false with HS_ERR_MEMORY or HS_ERR_FAILED if anything that was drawn failed. */
bool hs_draw_end(hs_canvas *on, hs_error *err);

/* A filled rectangle. */
void hs_draw_box(hs_canvas *on, double x, double y, double width, double height, uint32_t colour);

/* The size of the texts that follow, a text's width, and a text that stands on y, of valid UTF-8. */
void hs_canvas_size(hs_canvas *on, double size);
double hs_canvas_width(hs_canvas *on, const char *text);
void hs_canvas_text(hs_canvas *on, double x, double y, uint32_t colour, const char *text);

/* Frees what is kept for the whole process (fonts), so that a leak checker finds nothing. Once, at the end of
 * the program, when no other thread draws. */
void hs_picture_finish(void);
