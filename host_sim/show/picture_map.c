/* SPDX-License-Identifier: MIT */
#include "show/picture_map.h"

#include "picture/picture.h"
#include "picture/picture_draw.h"
#include "smartvis_plugin.h"

#include <inttypes.h>
#include <math.h>
#include <stdio.h>

enum {
    MARGIN = 16,
    TITLE_BAND = 44,
    LEGEND_WIDTH = 330,
    SWATCH = 18,
    ROW_STEP = 30,
    FACT_STEP = 26,
    BAR_MARGIN = 30,
    TARGET = 768,    /* pixels the longer side of a small map is drawn on, about */
    LARGEST = 1280,  /* pixels a large map is reduced to */
    MIN_HEIGHT = 420 /* the legend needs it */
};

/* A map's place in its picture. */
typedef struct {
    uint32_t map_width, map_height; /* entries */
    uint32_t x, y, width, height;   /* pixels the map covers */
    uint32_t legend_x, legend_bottom;
} layout;

/* Whole pixels per entry where they fit, so that every entry is drawn equally large. */
static void scale_map(layout *l) {
    const uint32_t longest = l->map_width > l->map_height ? l->map_width : l->map_height;
    if (longest <= LARGEST) {
        const uint32_t nearest = (TARGET + longest / 2) / longest;
        const uint32_t scale = nearest > 1 ? nearest : 1;
        l->width = l->map_width * scale;
        l->height = l->map_height * scale;
        return;
    }
    const double shrink = (double)LARGEST / longest;
    l->width = (uint32_t)fmax(1.0, l->map_width * shrink);
    l->height = (uint32_t)fmax(1.0, l->map_height * shrink);
}

/* Makes an empty picture with room for the map and its legend. */
static bool begin_map(hs_picture *out, layout *l, uint32_t width, uint32_t height, const hs_caption *caption,
                      hs_error *err) {
    *out = (hs_picture){0};
    if (width == 0 || height == 0)
        return hs_fail(err, HS_ERR_INPUT,
                       "picture: map is %" PRIu32 " x %" PRIu32 ", expected 1 x 1 at least", width, height);
    *l = (layout){.map_width = width, .map_height = height, .x = MARGIN};
    scale_map(l);
    l->y = caption->title ? TITLE_BAND : MARGIN;
    const uint32_t body = l->height > MIN_HEIGHT ? l->height : MIN_HEIGHT;
    l->legend_x = l->x + l->width + 24;
    l->legend_bottom = l->y + body;
    return hs_picture_init(out, l->legend_x + LEGEND_WIDTH + MARGIN,
                           l->y + body + MARGIN + FACT_STEP * hs_draw_line_count(caption->footer),
                           HS_COLOUR_BACKGROUND, err);
}

/* Title and footer; ends the drawing. On failure frees the picture. */
static bool end_map(hs_picture *out, hs_canvas *on, const layout *l, const hs_caption *caption,
                    hs_error *err) {
    const double width = out->width - 2.0 * MARGIN;
    if (caption->title)
        hs_draw_text(on, MARGIN, TITLE_BAND - 14, 24, HS_COLOUR_TEXT, HS_ALIGN_LEFT, width, caption->title);
    hs_draw_lines(on, MARGIN, l->legend_bottom + FACT_STEP, FACT_STEP, 18, HS_COLOUR_FAINT_TEXT, width,
                  caption->footer);
    if (hs_draw_end(on, err)) return true;
    hs_picture_free(out);
    return false;
}

/* The hatch of two greys that stands for "clips nothing". */
static uint32_t hatch(uint32_t x, uint32_t y) {
    return (x + y) / 5 % 2 ? HS_COLOUR_NOTHING_A : HS_COLOUR_NOTHING_B;
}

/* One line of a legend: a square and a text. */
static void draw_entry(hs_canvas *on, const layout *l, double y, uint32_t colour, bool hatched,
                       const char *text) {
    if (hatched) {
        for (uint32_t j = 0; j < SWATCH; j++)
            for (uint32_t i = 0; i < SWATCH; i++) hs_draw_box(on, l->legend_x + i, y + j, 1, 1, hatch(i, j));
    } else {
        hs_draw_box(on, l->legend_x, y, SWATCH, SWATCH, colour);
    }
    hs_draw_text(on, l->legend_x + SWATCH + 10.0, y + SWATCH - 2.0, 18, HS_COLOUR_TEXT, HS_ALIGN_LEFT,
                 LEGEND_WIDTH - SWATCH - 10.0, text);
}

/* Entry of the map under a pixel of its picture. */
static size_t entry_at(const layout *l, uint32_t i, uint32_t j) {
    const uint32_t x = (uint32_t)((uint64_t)i * l->map_width / l->width);
    const uint32_t y = (uint32_t)((uint64_t)j * l->map_height / l->height);
    return (size_t)y * l->map_width + x;
}

static uint32_t *pixel_at(hs_picture *out, const layout *l, uint32_t i, uint32_t j) {
    return &out->pixels[(size_t)(l->y + j) * out->width + l->x + i];
}

static double percent(size_t part, size_t whole) {
    return 100.0 * (double)part / (double)whole;
}

/* The ends of a depth colour bar, mm. */
typedef struct {
    float low, high;
} depth_range;

/* That of the depths that clip. */
static depth_range find_range(const float *depth, size_t count) {
    depth_range range = {INFINITY, -INFINITY};
    for (size_t i = 0; i < count; i++) {
        if (!isfinite(depth[i]) || depth[i] <= 0.0f) continue;
        range.low = fminf(range.low, depth[i]);
        range.high = fmaxf(range.high, depth[i]);
    }
    return range;
}

/* A depth's place in the range, which is not empty. */
static uint32_t depth_colour(float depth, depth_range range) {
    const double span = (double)range.high - range.low;
    return hs_colour_viridis(span > 0.0 ? ((double)depth - range.low) / span : 1.0);
}

/* Draws the bar in the legend's column above `rows` entries. Returns where the first entry starts. */
static double draw_bar(hs_canvas *on, const layout *l, hs_colour_bar *bar, uint32_t rows) {
    const double room = (double)l->legend_bottom - l->y - rows * (double)ROW_STEP - 2.0 * BAR_MARGIN;
    bar->x = l->legend_x;
    bar->y = (double)l->y + BAR_MARGIN;
    bar->height = fmin(room, 420.0);
    bar->max_width = LEGEND_WIDTH;
    hs_draw_colour_bar(on, bar);
    return bar->y + bar->height + BAR_MARGIN;
}

/* The bar of depths; words stand in its place if there is no depth. */
static double draw_depth_bar(hs_canvas *on, const layout *l, depth_range range) {
    if (range.low > range.high) {
        hs_draw_text(on, l->legend_x, l->y + 14.0, 19, HS_COLOUR_TEXT, HS_ALIGN_LEFT, LEGEND_WIDTH,
                     "no ray is clipped");
        return (double)l->y + BAR_MARGIN;
    }
    hs_colour_bar bar = {.low = range.low,
                         .high = range.high,
                         .colour = hs_colour_viridis,
                         .heading = "depth [mm]",
                         .high_word = "far",
                         .low_word = "near"};
    return draw_bar(on, l, &bar, 2);
}

bool hs_picture_depthmap(hs_picture *out, const float *depth, uint32_t width, uint32_t height,
                         const hs_caption *caption, hs_error *err) {
    layout l;
    if (!begin_map(out, &l, width, height, caption, err)) return false;
    const size_t count = (size_t)width * height;
    const depth_range range = find_range(depth, count);
    size_t nothing = 0, invalid = 0;
    for (size_t i = 0; i < count; i++) {
        if (!isfinite(depth[i]))
            invalid++;
        else if (depth[i] <= 0.0f)
            nothing++;
    }
    for (uint32_t j = 0; j < l.height; j++) {
        for (uint32_t i = 0; i < l.width; i++) {
            const float d = depth[entry_at(&l, i, j)];
            *pixel_at(out, &l, i, j) = !isfinite(d) ? HS_COLOUR_INVALID
                                       : d <= 0.0f  ? hatch(i, j)
                                                    : depth_colour(d, range);
        }
    }
    hs_canvas *on = hs_draw_begin(out);
    char text[96];
    const double y = draw_depth_bar(on, &l, range);
    (void)snprintf(text, sizeof text, "clips nothing: %.1f %%", percent(nothing, count));
    draw_entry(on, &l, y, 0, true, text);
    if (invalid > 0) {
        (void)snprintf(text, sizeof text, "not a number: %zu", invalid);
        draw_entry(on, &l, y + ROW_STEP, HS_COLOUR_INVALID, false, text);
    }
    return end_map(out, on, &l, caption, err);
}

bool hs_picture_signed(hs_picture *out, const float *value, uint32_t width, uint32_t height, float limit,
                       const hs_signed_words *words, const hs_caption *caption, hs_error *err) {
    layout l;
    if (!begin_map(out, &l, width, height, caption, err)) return false;
    const size_t count = (size_t)width * height;
    size_t valid = 0;
    for (size_t i = 0; i < count; i++) valid += isnan(value[i]) ? 0 : 1;
    for (uint32_t j = 0; j < l.height; j++) {
        for (uint32_t i = 0; i < l.width; i++) {
            const float v = value[entry_at(&l, i, j)];
            *pixel_at(out, &l, i, j) = isnan(v) ? HS_COLOUR_NO_VALUE : hs_colour_diverging((double)v / limit);
        }
    }
    hs_canvas *on = hs_draw_begin(out);
    char heading[96], text[96];
    (void)snprintf(heading, sizeof heading, "%s [%s]", words->quantity, words->unit);
    hs_colour_bar bar = {.low = -limit,
                         .high = limit,
                         .colour = hs_colour_diverging,
                         .t_low = -1.0,
                         .heading = heading,
                         .high_word = words->positive,
                         .low_word = words->negative};
    const double y = draw_bar(on, &l, &bar, 1);
    (void)snprintf(text, sizeof text, "no value: %.1f %%", percent(count - valid, count));
    draw_entry(on, &l, y, HS_COLOUR_NO_VALUE, false, text);
    return end_map(out, on, &l, caption, err);
}

bool hs_picture_share(hs_picture *out, const float *value, uint32_t width, uint32_t height,
                      const hs_share_words *words, const hs_caption *caption, hs_error *err) {
    layout l;
    if (!begin_map(out, &l, width, height, caption, err)) return false;
    const size_t count = (size_t)width * height;
    double sum = 0;
    size_t valid = 0;
    for (size_t i = 0; i < count; i++) {
        if (!(value[i] >= 0.0f && value[i] <= 1.0f)) continue;
        sum += (double)value[i];
        valid++;
    }
    for (uint32_t j = 0; j < l.height; j++) {
        for (uint32_t i = 0; i < l.width; i++) {
            const float v = value[entry_at(&l, i, j)];
            *pixel_at(out, &l, i, j) =
                v >= 0.0f && v <= 1.0f ? hs_colour_viridis((double)v) : HS_COLOUR_INVALID;
        }
    }
    hs_canvas *on = hs_draw_begin(out);
    char text[96];
    hs_colour_bar bar = {.high = 1.0,
                         .colour = hs_colour_viridis,
                         .heading = words->quantity,
                         .high_word = words->high,
                         .low_word = words->low};
    const double y = draw_bar(on, &l, &bar, 2);
    (void)snprintf(text, sizeof text, "mean: %.2f", valid > 0 ? sum / (double)valid : 0.0);
    hs_draw_text(on, l.legend_x, y + 14.0, 19, HS_COLOUR_TEXT, HS_ALIGN_LEFT, LEGEND_WIDTH, text);
    if (valid < count) {
        (void)snprintf(text, sizeof text, "not in 0 .. 1: %zu", count - valid);
        draw_entry(on, &l, y + ROW_STEP, HS_COLOUR_INVALID, false, text);
    }
    return end_map(out, on, &l, caption, err);
}
