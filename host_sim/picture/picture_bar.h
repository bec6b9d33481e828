/* SPDX-License-Identifier: MIT */
/* A colour bar with ticks, drawn through cairo. */
#ifndef HS_PICTURE_BAR_H
#define HS_PICTURE_BAR_H

#include <cairo.h>
#include <stdint.h>

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

/* A step between ticks of 1, 2 or 5 times a power of ten that gives at most `most`
 * (>= 1) steps over `range` (> 0). */
double hs_tick_step(double range, unsigned most);

#endif
