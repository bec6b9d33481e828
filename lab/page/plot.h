/* SPDX-License-Identifier: MIT */
/* Figures as inline SVG: axes with units, a legend, a title that a screen reader says. Texts are escaped.
 * Without a stream nothing is written. */
#pragma once

#include <stdint.h>
#include <stdio.h>

/* A value per cell of a grid, in viridis; NAN cells stay empty. Values >= 0 that span more than a decade have
 * a logarithmic scale. */
typedef struct {
    const char *title, *x_label, *y_label, *value_label;
    uint32_t columns, rows;        /* >= 1 each */
    const double *x, *y;           /* what the columns (left to right) and rows (bottom to top) stand for */
    const float *value;            /* value[column * rows + row] */
    int32_t mark_column, mark_row; /* the cell with a white square; negative: none */
} hs_plot_heat;
void hs_plot_heat_write(FILE *out, const hs_plot_heat *plot);

/* Bars in groups, side by side. */
typedef struct {
    const char *title, *y_label;
    uint32_t groups, series;  /* 1 .. 8 series */
    const char *const *group; /* names below the axis */
    const char *const *name;  /* of the series, in the legend */
    const double *value;      /* value[group * series + i], >= 0 */
} hs_plot_bars;
void hs_plot_bars_write(FILE *out, const hs_plot_bars *plot);
