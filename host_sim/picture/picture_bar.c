/* SPDX-License-Identifier: MIT */
#include "picture/picture_bar.h"

#include "picture/picture_colour.h"
#include "picture/picture_draw.h"

#include <math.h>
#include <stdio.h>

double hs_tick_step(double range, unsigned most) {
    const double smallest = range / most;
    const double power = pow(10.0, floor(log10(smallest)));
    static const double steps[] = {1.0, 2.0, 5.0};
    for (int i = 0; i < 3; i++)
        if (steps[i] * power >= smallest * (1.0 - 1e-9)) return steps[i] * power;
    return 10.0 * power;
}

/* "12.5" with as many decimals as the step needs. */
static void format_value(char out[32], double value, double step) {
    const int decimals = step >= 1.0 ? 0 : (int)ceil(-log10(step) - 1e-9);
    (void)snprintf(out, 32, "%.*f", decimals < 9 ? decimals : 9, value);
}

/* An end of the bar: its number and word, in the text colour. */
static void draw_bar_end(cairo_t *cr, const hs_colour_bar *bar, double y, double value, double step,
                         const char *word) {
    char number[32], text[96];
    format_value(number, value, step / 10.0);
    (void)snprintf(text, sizeof text, word ? "%s (%s)" : "%s", number, word);
    hs_draw_text(cr, bar->x + 42, y + 5, 14, HS_COLOUR_TEXT, HS_ALIGN_LEFT, bar->max_width - 42, text);
}

void hs_draw_colour_bar(cairo_t *cr, const hs_colour_bar *bar) {
    enum { BAR_WIDTH = 26, TICK = 6, CLEARANCE = 17 };
    const int rows = (int)bar->height;
    for (int row = 0; row < rows; row++) {
        const double up = rows > 1 && bar->high > bar->low ? 1.0 - row / (rows - 1.0) : 1.0;
        hs_draw_box(cr, bar->x, bar->y + row, BAR_WIDTH, 1,
                    bar->colour(bar->t_low + (1.0 - bar->t_low) * up));
    }
    hs_draw_text(cr, bar->x, bar->y - 18, 15, HS_COLOUR_TEXT, HS_ALIGN_LEFT, bar->max_width, bar->heading);
    const double range = bar->high - bar->low;
    if (!(range > 0.0)) {
        draw_bar_end(cr, bar, bar->y, bar->high, 1.0, NULL);
        return;
    }
    const double step = hs_tick_step(range, 6);
    draw_bar_end(cr, bar, bar->y, bar->high, step, bar->high_word);
    draw_bar_end(cr, bar, bar->y + bar->height, bar->low, step, bar->low_word);
    for (double i = ceil(bar->low / step); i * step <= bar->high; i += 1.0) {
        const double y = bar->y + bar->height * (bar->high - i * step) / range;
        hs_draw_box(cr, bar->x + BAR_WIDTH, y - 0.5, TICK, 1, HS_COLOUR_FAINT_TEXT);
        /* The numbers at the ends have their own place. */
        if (y - bar->y < CLEARANCE || bar->y + bar->height - y < CLEARANCE) continue;
        char number[32];
        format_value(number, i * step, step);
        hs_draw_text(cr, bar->x + 42, y + 5, 13, HS_COLOUR_FAINT_TEXT, HS_ALIGN_LEFT, bar->max_width - 42,
                     number);
    }
}
