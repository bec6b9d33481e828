/* SPDX-License-Identifier: MIT */
/* Drawing on a picture through cairo. Internal to the hs_picture files. */
#ifndef HS_PICTURE_DRAW_H
#define HS_PICTURE_DRAW_H

#include "picture/picture.h"

#include <cairo.h>

/* A context that draws on the picture's pixels. Never NULL (cairo reports trouble at the end). */
cairo_t *hs_draw_begin(hs_picture *picture);
/* Finishes; false with HS_ERR_MEMORY or HS_ERR_FAILED if anything that was drawn failed. */
bool hs_draw_end(cairo_t *cr, hs_error *err);

void hs_draw_colour(cairo_t *cr, uint32_t colour);
/* As hs_picture_text. */
void hs_draw_text(cairo_t *cr, double x, double y, double size, uint32_t colour, hs_align align,
                  double max_width, const char *text);
/* Lines of text parted by '\n', the first standing on y, `step` pixels from one to the next. */
void hs_draw_lines(cairo_t *cr, double x, double y, double step, double size, uint32_t colour,
                   double max_width, const char *text);
/* Number of lines; 0 for NULL and "". */
uint32_t hs_draw_line_count(const char *text);
/* A filled rectangle. */
void hs_draw_box(cairo_t *cr, double x, double y, double width, double height, uint32_t colour);

/* A vertical colour bar with ticks, numbers, its ends and a heading. */
typedef struct {
    double x, y, height; /* of the bar, pixels */
    double low, high;    /* values at the lower and the upper end, low <= high */
    uint32_t (*colour)(double t);
    double t_low;                     /* what `colour` takes at the lower end (0, or -1); 1 at the upper */
    const char *heading;              /* "depth [slices]" */
    const char *high_word, *low_word; /* beside the numbers at the ends: "far", "near"; NULL for none */
    double max_width;                 /* pixels for bar and numbers */
} hs_colour_bar;
void hs_draw_colour_bar(cairo_t *cr, const hs_colour_bar *bar);

/* A step between ticks of 1, 2 or 5 times a power of ten that gives at most `most` (>= 1) steps over `range`
 * (> 0). */
double hs_tick_step(double range, unsigned most);

#endif
