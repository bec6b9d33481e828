/* SPDX-License-Identifier: MIT */
#include "picture/picture_draw.h"

#include "core/text.h"
#include "picture/picture.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

enum { TEXT_BYTES = 1024 };

/* Takes whole characters from the end until the text and an ellipsis fit. */
static void cut_to_width(hs_canvas *on, char text[TEXT_BYTES], double max_width) {
    static const char ellipsis[] = "\xe2\x80\xa6";
    size_t n = strlen(text);
    while (n > 0 && hs_canvas_width(on, text) > max_width + 0.5) { /* half a pixel does not show */
        if (n >= 3 && memcmp(text + n - 3, ellipsis, 3) == 0) n -= 3;
        do {
            if (n > 0) n--;
        } while (n > 0 && ((unsigned char)text[n] & 0xc0) == 0x80);
        memcpy(text + n, ellipsis, sizeof ellipsis);
        if (n == 0) return;
        n += 3;
    }
}

void hs_draw_text(hs_canvas *on, double x, double y, double size, uint32_t colour, hs_align align,
                  double max_width, const char *text) {
    char clean[TEXT_BYTES];
    (void)hs_text_escape(clean, sizeof clean, text, 0); /* nothing is drawn after one invalid byte */
    hs_canvas_size(on, size);
    double width = hs_canvas_width(on, clean);
    if (max_width > 0.0 && width > max_width) {
        hs_canvas_size(on, size * fmax(0.75, max_width / width));
        cut_to_width(on, clean, max_width);
        width = hs_canvas_width(on, clean);
    }
    hs_canvas_text(on,
                   align == HS_ALIGN_LEFT    ? x
                   : align == HS_ALIGN_RIGHT ? x - width
                                             : x - width / 2,
                   y, colour, clean);
}

uint32_t hs_draw_line_count(const char *text) {
    if (!text || !*text) return 0;
    uint32_t count = 1;
    for (; *text; text++) count += *text == '\n';
    return count;
}

void hs_draw_lines(hs_canvas *on, double x, double y, double step, double size, uint32_t colour,
                   double max_width, const char *text) {
    while (text && *text) {
        const size_t n = strcspn(text, "\n");
        char line[TEXT_BYTES];
        (void)snprintf(line, sizeof line, "%.*s", (int)(n < TEXT_BYTES ? n : TEXT_BYTES - 1), text);
        hs_draw_text(on, x, y, size, colour, HS_ALIGN_LEFT, max_width, line);
        text += n + (text[n] == '\n');
        y += step;
    }
}

double hs_tick_step(double range, unsigned max_ticks) {
    const double smallest = range / max_ticks;
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
static void draw_bar_end(hs_canvas *on, const hs_colour_bar *bar, double y, double value, double step,
                         const char *word) {
    char number[32], text[96];
    format_value(number, value, step / 10.0);
    (void)snprintf(text, sizeof text, word ? "%s (%s)" : "%s", number, word);
    hs_draw_text(on, bar->x + 42, y + 6, 18, HS_COLOUR_TEXT, HS_ALIGN_LEFT, bar->max_width - 42, text);
}

void hs_draw_colour_bar(hs_canvas *on, const hs_colour_bar *bar) {
    enum { BAR_WIDTH = 26, TICK = 6, CLEARANCE = 22 };
    const int rows = (int)bar->height;
    for (int row = 0; row < rows; row++) {
        const double up = rows > 1 && bar->high > bar->low ? 1.0 - row / (rows - 1.0) : 1.0;
        hs_draw_box(on, bar->x, bar->y + row, BAR_WIDTH, 1,
                    bar->colour(bar->t_low + (1.0 - bar->t_low) * up));
    }
    hs_draw_text(on, bar->x, bar->y - 16, 19, HS_COLOUR_TEXT, HS_ALIGN_LEFT, bar->max_width, bar->heading);
    const double range = bar->high - bar->low;
    if (!(range > 0.0)) {
        draw_bar_end(on, bar, bar->y, bar->high, 1.0, NULL);
        return;
    }
    const double step = hs_tick_step(range, 6);
    draw_bar_end(on, bar, bar->y, bar->high, step, bar->high_word);
    draw_bar_end(on, bar, bar->y + bar->height, bar->low, step, bar->low_word);
    for (double i = ceil(bar->low / step); i * step <= bar->high; i += 1.0) {
        const double y = bar->y + bar->height * (bar->high - i * step) / range;
        hs_draw_box(on, bar->x + BAR_WIDTH, y - 0.5, TICK, 1, HS_COLOUR_FAINT_TEXT);
        /* The numbers at the ends have their own place. */
        if (y - bar->y < CLEARANCE || bar->y + bar->height - y < CLEARANCE) continue;
        char number[32];
        format_value(number, i * step, step);
        hs_draw_text(on, bar->x + 42, y + 6, 17, HS_COLOUR_FAINT_TEXT, HS_ALIGN_LEFT, bar->max_width - 42,
                     number);
    }
}

bool hs_picture_text(hs_picture *picture, double x, double y, double size, uint32_t colour, hs_align align,
                     double max_width, const char *text, hs_error *err) {
    hs_canvas *on = hs_draw_begin(picture);
    hs_draw_text(on, x, y, size, colour, align, max_width, text);
    return hs_draw_end(on, err);
}

enum {
    GAP = 16,
    TITLE_SIZE = 24,
    TITLE_BAND = 44,
    CAPTION_SIZE = 18,
    CAPTION_BAND = 30,
    FACT_SIZE = 15,
    FACT_STEP = 23
};

bool hs_picture_panel(hs_picture *out, const hs_panel_item *items, uint32_t count, uint32_t cell,
                      const hs_caption *caption, hs_error *err) {
    if (cell == 0) cell = 512;
    const uint32_t facts = hs_draw_line_count(caption->footer);
    const uint32_t top = (caption->title ? TITLE_BAND : GAP / 2) + CAPTION_BAND;
    const uint32_t width = count * (cell + GAP) + GAP;
    if (!hs_picture_init(out, width, top + cell + GAP + facts * FACT_STEP, HS_COLOUR_BACKGROUND, err))
        return false;

    for (uint32_t i = 0; i < count; i++)
        hs_picture_blit(out, (int32_t)(GAP + i * (cell + GAP)), (int32_t)top, cell, cell, &items[i].image,
                        HS_SCALE_SMOOTH);
    hs_canvas *on = hs_draw_begin(out);
    if (caption->title)
        hs_draw_text(on, GAP, TITLE_BAND - 12, TITLE_SIZE, HS_COLOUR_TEXT, HS_ALIGN_LEFT, width - 2.0 * GAP,
                     caption->title);
    for (uint32_t i = 0; i < count; i++)
        if (items[i].caption)
            hs_draw_text(on, GAP + i * (cell + GAP) + cell / 2.0, top - 9.0, CAPTION_SIZE, HS_COLOUR_TEXT,
                         HS_ALIGN_CENTRE, cell, items[i].caption);
    hs_draw_lines(on, GAP, top + cell + FACT_STEP, FACT_STEP, FACT_SIZE, HS_COLOUR_FAINT_TEXT,
                  width - 2.0 * GAP, caption->footer);
    if (hs_draw_end(on, err)) return true;
    hs_picture_free(out);
    return false;
}
