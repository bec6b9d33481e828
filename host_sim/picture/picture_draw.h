/* SPDX-License-Identifier: MIT */
/* Drawing on a picture: text, lines, boxes, colour bars, and pictures side by side with
 * captions. Colours are 0xRRGGBB. */
#pragma once

#include "picture/canvas.h"

#include <stdint.h>

/* One line of text, as hs_picture_text draws it. */
void hs_draw_text(hs_canvas *on, double x, double y, double size, uint32_t colour, hs_align align,
                  double max_width, const char *text);
/* Lines of text parted by '\n', the first standing on y, `step` pixels from one to the next. */
void hs_draw_lines(hs_canvas *on, double x, double y, double step, double size, uint32_t colour,
                   double max_width, const char *text);
/* Number of lines; 0 for NULL and "". */
uint32_t hs_draw_line_count(const char *text);

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
void hs_draw_colour_bar(hs_canvas *on, const hs_colour_bar *bar);

/* A step between ticks of 1, 2 or 5 times a power of ten that gives at most `max_ticks`
 * (>= 1) steps over `range` (> 0). */
double hs_tick_step(double range, unsigned max_ticks);

/* One line of UTF-8 in DejaVu Sans, `size` pixels high, standing on y. Wider than max_width (0: no limit) it
 * is set smaller, down to three quarters, then cut with an ellipsis. Bytes that are no UTF-8 (file names may
 * hold any) are written as \xNN. */
bool hs_picture_text(hs_picture *picture, double x, double y, double size, uint32_t colour, hs_align align,
                     double max_width, const char *text, hs_error *err);

/* One picture of a panel. */
typedef struct {
    const char *caption; /* above it; NULL for none */
    hs_image image;
} hs_panel_item;

/* Title and facts around a picture. NULL for none. */
typedef struct {
    const char *title;  /* one line above */
    const char *footer; /* below; '\n' parts lines */
} hs_caption;

/* Square images next to each other, `count` of them, each `cell` pixels wide (0: 512, so that three make
 * 1600) and scaled smoothly. Allocates *out (hs_picture_free it); on failure it is zeroed, with the errors of
 * hs_picture_init. */
bool hs_picture_panel(hs_picture *out, const hs_panel_item *items, uint32_t count, uint32_t cell,
                      const hs_caption *caption, hs_error *err);
