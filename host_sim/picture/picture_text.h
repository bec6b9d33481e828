/* SPDX-License-Identifier: MIT */
/* Text and lines on a picture, one at a time. */
#ifndef HS_PICTURE_TEXT_H
#define HS_PICTURE_TEXT_H

#include "picture/picture.h"

/* One line of UTF-8 in DejaVu Sans, `size` pixels high, standing on y. Wider than max_width (0: no limit) it
 * is set smaller, down to three quarters, then cut with an ellipsis. Bytes that are no UTF-8 (file names may
 * hold any) become '?'. */
bool hs_picture_text(hs_picture *picture, double x, double y, double size, uint32_t colour, hs_align align,
                     double max_width, const char *text, hs_error *err);

/* A straight line between two points; pixel centres are at halves. */
bool hs_picture_line(hs_picture *picture, double x0, double y0, double x1, double y1, double width,
                     uint32_t colour, hs_error *err);

/* Frees what cairo and fontconfig keep for the whole process (fonts), so that a leak checker finds nothing.
 * Once, at the end of the program, when no other thread draws. */
void hs_picture_finish(void);

#endif
