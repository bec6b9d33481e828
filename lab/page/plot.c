/* SPDX-License-Identifier: MIT */
#include "page/plot.h"

#include "page/page_html.h"
#include "picture/picture.h"

#include <math.h>
#include <stdbool.h>
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

/* `anchor` is start, middle or end. */
static void hs_plot_text(FILE *out, double x, double y, const char *anchor, const char *text) {
    (void)fprintf(out, "<text x=\"%.1f\" y=\"%.1f\" text-anchor=\"%s\">", x, y, anchor);
    hs_page_escape(out, text);
    (void)fprintf(out, "</text>\n");
}

/* Text up the side of the drawing. */
static void turned_text(FILE *out, int x, const char *text) {
    (void)fprintf(out, "<g transform=\"translate(%d %.1f) rotate(-90)\">", x,
                  (HS_PLOT_TOP + HS_PLOT_BOTTOM) / 2.0);
    hs_plot_text(out, 0, 0, "middle", text);
    (void)fprintf(out, "</g>\n");
}

/* Label `index` below the x axis; a phone leaves out every other. */
static void hs_plot_tick(FILE *out, double x, uint32_t index, const char *text) {
    (void)fprintf(out, "<g%s>", index % 2 ? " class=\"odd\"" : "");
    hs_plot_text(out, x, HS_PLOT_BOTTOM + 16, "middle", text);
    (void)fprintf(out, "</g>\n");
}

/* Begins the figure: title, axis labels, font. */
static void hs_plot_begin(FILE *out, const char *title, const char *x_label, const char *y_label) {
    const double middle_x = (HS_PLOT_LEFT + HS_PLOT_RIGHT) / 2.0;
    (void)fprintf(out, "<svg class=\"plot\" viewBox=\"0 0 %d %d\" role=\"img\" aria-label=\"", HS_PLOT_WIDTH,
                  HS_PLOT_HEIGHT);
    hs_page_escape(out, title);
    (void)fprintf(out, "\" font-family=\"system-ui,sans-serif\" font-size=\"12\" fill=\"#1c2024\">\n<title>");
    hs_page_escape(out, title);
    (void)fprintf(out, "</title>\n<g class=\"title\" font-size=\"14\" font-weight=\"600\">");
    hs_plot_text(out, HS_PLOT_LEFT, HS_PLOT_TOP - 14, "start", title);
    (void)fprintf(out, "</g>\n");
    hs_plot_text(out, middle_x, HS_PLOT_HEIGHT - 12, "middle", x_label);
    turned_text(out, 16, y_label);
}

static void hs_plot_end(FILE *out) {
    (void)fprintf(out, "</svg>\n");
}

/* The y of a value on an axis from 0 to `top`. */
static double hs_plot_y(double value, double top) {
    return HS_PLOT_BOTTOM - (HS_PLOT_BOTTOM - HS_PLOT_TOP) * fmin(fmax(value / top, 0), 1);
}

/* 1, 2 or 5 times a power of ten: the least that makes six ticks at most. */
static double round_step(double largest) {
    const double smallest = largest / 6;
    const double power = pow(10, floor(log10(smallest)));
    for (int i = 0; i < 3; i++) {
        static const double factors[3] = {1, 2, 5};
        if (factors[i] * power >= smallest) return factors[i] * power;
    }
    return 10 * power;
}

/* A y axis from 0 with ticks at round values and grid lines; returns the value at the top. */
static double hs_plot_y_axis(FILE *out, double largest) {
    const double usable = isfinite(largest) && largest > 0 ? largest : 1;
    const double step = round_step(usable), top = ceil(usable / step - 1e-9) * step;
    for (int i = 0; i * step <= top * (1 + 1e-9); i++) {
        char text[32];
        const double y = hs_plot_y(i * step, top);
        (void)snprintf(text, sizeof text, "%.6g", i * step);
        (void)fprintf(out, "<path d=\"M%d %.1fH%d\" stroke=\"#d5d9de\"/>\n", HS_PLOT_LEFT, y, HS_PLOT_RIGHT);
        hs_plot_text(out, HS_PLOT_LEFT - 6, y + 4, "end", text);
    }
    return top;
}

/* Entry `index` of the legend on the right. */
static void hs_plot_legend(FILE *out, uint32_t index, uint32_t colour, const char *name) {
    const double y = HS_PLOT_TOP + 18.0 * index;
    (void)fprintf(out, "<rect x=\"%d\" y=\"%.1f\" width=\"11\" height=\"11\" fill=\"#%06x\"/>\n",
                  HS_PLOT_RIGHT + 12, y, colour);
    hs_plot_text(out, HS_PLOT_RIGHT + 28, y + 10, "start", name);
}

/* Colours that are told apart by most people, and by their lightness (after Okabe and Ito). */
static uint32_t hs_plot_colour(uint32_t index) {
    static const uint32_t colours[8] = {0x0072b2, 0xe69f00, 0x009e73, 0xd55e00,
                                        0x56b4e9, 0xcc79a7, 0x7a7a00, 0x333333};
    return colours[index % 8];
}

#define SCALE_CELLS 32 /* of a colour bar */

/* --------------------------------------------------------------------------------------------- heat -- */

/* Ends of the colours; logarithmic where the values span more than a decade, or one bad corner would leave
 * all the rest in one colour. */
typedef struct {
    double low, high;
    bool logarithmic;
} range;

#define MIN_LOG_END 1e-3 /* of a logarithmic scale */

/* 0 .. 1 along the colours, and back. */
static double colour_at(range r, double value) {
    if (r.logarithmic) return log(fmax(value, r.low) / r.low) / log(r.high / r.low);
    return (value - r.low) / (r.high - r.low);
}
static double value_at(range r, double t) {
    return r.logarithmic ? r.low * pow(r.high / r.low, t) : r.low + (r.high - r.low) * t;
}

static range range_of(const hs_plot_heat *plot) {
    range r = {INFINITY, -INFINITY, false};
    for (size_t i = 0; i < (size_t)plot->columns * plot->rows; i++) {
        if (isnan(plot->value[i])) continue;
        r.low = fmin(r.low, (double)plot->value[i]);
        r.high = fmax(r.high, (double)plot->value[i]);
    }
    if (!(r.high > r.low)) r.high = r.low + 1;
    r.logarithmic = r.low >= 0 && r.high > fmax(10 * r.low, MIN_LOG_END);
    if (r.logarithmic) r.low = fmax(r.low, MIN_LOG_END);
    return r;
}

static void colour_bar(FILE *out, range r, const char *label) {
    char text[32];
    const double height = HS_PLOT_BOTTOM - HS_PLOT_TOP, cell = height / SCALE_CELLS;
    for (int i = 0; i < SCALE_CELLS; i++)
        (void)fprintf(out, "<rect x=\"%d\" y=\"%.2f\" width=\"16\" height=\"%.2f\" fill=\"#%06x\"/>\n",
                      HS_PLOT_RIGHT + 22, HS_PLOT_BOTTOM - (i + 1) * cell, cell + 0.5,
                      hs_colour_viridis((i + 0.5) / SCALE_CELLS));
    for (int i = 0; i <= 4; i++) {
        (void)snprintf(text, sizeof text, "%.3g", value_at(r, i / 4.0));
        hs_plot_text(out, HS_PLOT_RIGHT + 44, HS_PLOT_BOTTOM - height * i / 4 + 4, "start", text);
    }
    turned_text(out, HS_PLOT_WIDTH - 14, label);
}

void hs_plot_heat_write(FILE *out, const hs_plot_heat *plot) {
    if (!out) return;
    const double w = (double)(HS_PLOT_RIGHT - HS_PLOT_LEFT) / plot->columns;
    const double h = (double)(HS_PLOT_BOTTOM - HS_PLOT_TOP) / plot->rows;
    const range r = range_of(plot);
    char text[32];
    hs_plot_begin(out, plot->title, plot->x_label, plot->y_label);
    for (uint32_t c = 0; c < plot->columns; c++) {
        const double x = HS_PLOT_LEFT + c * w;
        for (uint32_t i = 0; i < plot->rows; i++) {
            const double value = (double)plot->value[(size_t)c * plot->rows + i];
            if (isnan(value)) continue;
            /* Half a unit of overlap, so that no background shows between the cells. */
            (void)fprintf(
                out, "<rect x=\"%.2f\" y=\"%.2f\" width=\"%.2f\" height=\"%.2f\" fill=\"#%06x\"/>\n", x,
                HS_PLOT_BOTTOM - (i + 1) * h, w + 0.5, h + 0.5, hs_colour_viridis(colour_at(r, value)));
        }
        const uint32_t every = (plot->columns + 9) / 10;
        if (c % every != 0) continue;
        (void)snprintf(text, sizeof text, "%.2f", plot->x[c]);
        hs_plot_tick(out, x + w / 2, c / every, text);
    }
    for (uint32_t i = 0; i < plot->rows; i += (plot->rows + 7) / 8) {
        (void)snprintf(text, sizeof text, "%.6g", plot->y[i]);
        hs_plot_text(out, HS_PLOT_LEFT - 6, HS_PLOT_BOTTOM - (i + 0.5) * h + 4, "end", text);
    }
    if (plot->mark_column >= 0 && plot->mark_row >= 0)
        (void)fprintf(out,
                      "<rect x=\"%.2f\" y=\"%.2f\" width=\"%.2f\" height=\"%.2f\" fill=\"none\" "
                      "stroke=\"#fff\" stroke-width=\"2.5\"/>\n",
                      HS_PLOT_LEFT + plot->mark_column * w, HS_PLOT_BOTTOM - (plot->mark_row + 1) * h, w, h);
    colour_bar(out, r, plot->value_label);
    hs_plot_end(out);
}

/* --------------------------------------------------------------------------------------------- bars -- */

static void draw_group(FILE *out, const hs_plot_bars *plot, uint32_t group, double top) {
    const double w = (double)(HS_PLOT_RIGHT - HS_PLOT_LEFT) / plot->groups;
    const double x = HS_PLOT_LEFT + (group + 0.15) * w, bar = 0.7 * w / plot->series;
    for (uint32_t i = 0; i < plot->series; i++) {
        const double value = plot->value[group * plot->series + i];
        const double y = hs_plot_y(value, top);
        (void)fprintf(out,
                      "<rect x=\"%.2f\" y=\"%.2f\" width=\"%.2f\" height=\"%.2f\" fill=\"#%06x\">"
                      "<title>%.4g</title></rect>\n",
                      x + i * bar, y, bar, HS_PLOT_BOTTOM - y, hs_plot_colour(i), value);
    }
    hs_plot_tick(out, x + 0.35 * w, group, plot->group[group]);
}

void hs_plot_bars_write(FILE *out, const hs_plot_bars *plot) {
    double largest = 0;
    if (!out) return;
    for (uint32_t i = 0; i < plot->groups * plot->series; i++) largest = fmax(largest, plot->value[i]);
    hs_plot_begin(out, plot->title, "case", plot->y_label);
    const double top = hs_plot_y_axis(out, largest);
    for (uint32_t g = 0; g < plot->groups; g++) draw_group(out, plot, g, top);
    for (uint32_t i = 0; i < plot->series; i++) hs_plot_legend(out, i, hs_plot_colour(i), plot->name[i]);
    hs_plot_end(out);
}
