/* SPDX-License-Identifier: MIT */
/* Drawing on a picture through cairo: text, lines of text, boxes. Colours are 0xRRGGBB. */
#ifndef HS_PICTURE_DRAW_H
#define HS_PICTURE_DRAW_H

#include "picture/picture.h"

#include <cairo.h>

/* A context that draws on the picture's pixels. Never NULL (cairo reports trouble at the end). */
cairo_t *hs_draw_begin(hs_picture *picture);
/* Finishes; false with HS_ERR_MEMORY or HS_ERR_FAILED if anything that was drawn failed. */
bool hs_draw_end(cairo_t *cr, hs_error *err);

/* The colour of what is drawn next. */
void hs_draw_colour(cairo_t *cr, uint32_t colour);
/* One line of text, as hs_picture_text draws it. */
void hs_draw_text(cairo_t *cr, double x, double y, double size, uint32_t colour, hs_align align,
                  double max_width, const char *text);
/* Lines of text parted by '\n', the first standing on y, `step` pixels from one to the next. */
void hs_draw_lines(cairo_t *cr, double x, double y, double step, double size, uint32_t colour,
                   double max_width, const char *text);
/* Number of lines; 0 for NULL and "". */
uint32_t hs_draw_line_count(const char *text);
/* A filled rectangle. */
void hs_draw_box(cairo_t *cr, double x, double y, double width, double height, uint32_t colour);

#endif
