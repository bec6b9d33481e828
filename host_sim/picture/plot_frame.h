/* SPDX-License-Identifier: MIT */
/* What the figures share: the frame, its axes and their labels. */
#ifndef HS_PLOT_FRAME_H
#define HS_PLOT_FRAME_H

#include <stdint.h>
#include <stdio.h>

enum {
    HS_PLOT_WIDTH = 720,
    HS_PLOT_HEIGHT = 360,
    HS_PLOT_LEFT = 64, /* of the drawing area */
    HS_PLOT_TOP = 34,
    HS_PLOT_RIGHT = 590,
    HS_PLOT_BOTTOM = 306
};

/* Begins the figure: title, axis labels, font. */
void hs_plot_begin(FILE *out, const char *title, const char *x_label, const char *y_label);
void hs_plot_end(FILE *out);

/* Text with the characters that markup needs replaced; `anchor` is start, middle or end. */
void hs_plot_text(FILE *out, double x, double y, const char *anchor, const char *text);

/* A y axis from 0 with ticks at round values and grid lines; returns the value at the top. */
double hs_plot_y_axis(FILE *out, double largest);

/* The y of a value on an axis from 0 to `top`. */
double hs_plot_y(double value, double top);

/* Entry `index` of the legend on the right. */
void hs_plot_legend(FILE *out, uint32_t index, uint32_t colour, const char *name);

/* Colours that are told apart by most people, and by their lightness (after Okabe and Ito). */
uint32_t hs_plot_colour(uint32_t index);

#endif
