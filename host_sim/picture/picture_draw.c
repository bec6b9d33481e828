/* SPDX-License-Identifier: MIT */
#include "picture/picture_draw.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

enum { TEXT_BYTES = 1024 };

cairo_t *hs_draw_begin(hs_picture *picture) {
    /* CAIRO_FORMAT_RGB24 is 0x00RRGGBB in the host's byte order, rows of width * 4
     * bytes: the picture's own format. */
    cairo_surface_t *surface = cairo_image_surface_create_for_data(
        (unsigned char *)picture->pixels, CAIRO_FORMAT_RGB24, (int)picture->width, (int)picture->height,
        (int)picture->width * 4);
    cairo_t *cr = cairo_create(surface);
    cairo_surface_destroy(surface); /* the context keeps it */
    cairo_select_font_face(cr, "DejaVu Sans", CAIRO_FONT_SLANT_NORMAL, CAIRO_FONT_WEIGHT_NORMAL);
    /* Unhinted advances, so that a text's width goes with its size; gray edges, so
     * that letters have no colour. */
    cairo_font_options_t *options = cairo_font_options_create();
    cairo_font_options_set_hint_metrics(options, CAIRO_HINT_METRICS_OFF);
    cairo_font_options_set_antialias(options, CAIRO_ANTIALIAS_GRAY);
    cairo_set_font_options(cr, options);
    cairo_font_options_destroy(options);
    return cr;
}

bool hs_draw_end(cairo_t *cr, hs_error *err) {
    cairo_surface_t *surface = cairo_get_target(cr);
    cairo_surface_flush(surface);
    /* The top byte is unused to cairo, and left at 0 or 255 as it happens; in a picture it is 0. */
    uint32_t *pixels = (uint32_t *)(void *)cairo_image_surface_get_data(surface);
    const size_t count =
        (size_t)cairo_image_surface_get_width(surface) * (size_t)cairo_image_surface_get_height(surface);
    for (size_t i = 0; pixels && i < count; i++) pixels[i] &= 0xffffff;
    const cairo_status_t status = cairo_status(cr);
    cairo_destroy(cr);
    if (status == CAIRO_STATUS_SUCCESS) return true;
    return hs_fail(err, status == CAIRO_STATUS_NO_MEMORY ? HS_ERR_MEMORY : HS_ERR_FAILED,
                   "picture: cairo: %s", cairo_status_to_string(status));
}

void hs_draw_colour(cairo_t *cr, uint32_t colour) {
    cairo_set_source_rgb(cr, (colour >> 16 & 255) / 255.0, (colour >> 8 & 255) / 255.0,
                         (colour & 255) / 255.0);
}

/* Bytes of the UTF-8 sequence at s, 0 if there is none (RFC 3629: no overlong forms, no surrogates). */
static size_t utf8_length(const char *s) {
    const unsigned char *u = (const unsigned char *)s;
    if (u[0] < 0x80) return 1;
    const size_t n = u[0] >= 0xf0 ? 4 : u[0] >= 0xe0 ? 3 : 2;
    if (u[0] < 0xc2 || u[0] > 0xf4) return 0;
    for (size_t i = 1; i < n; i++)
        if ((u[i] & 0xc0) != 0x80) return 0;
    const bool overlong = (u[0] == 0xe0 && u[1] < 0xa0) || (u[0] == 0xf0 && u[1] < 0x90);
    const bool beyond = (u[0] == 0xed && u[1] > 0x9f) || (u[0] == 0xf4 && u[1] > 0x8f);
    return overlong || beyond ? 0 : n;
}

/* Copies what cairo can show: cairo refuses to draw anything more after one invalid byte. */
static void clean_text(const char *text, char out[TEXT_BYTES]) {
    size_t at = 0;
    while (*text && at + 4 < TEXT_BYTES) {
        const size_t n = utf8_length(text);
        if (n == 0 || (n == 1 && (unsigned char)*text < 0x20) || *text == 0x7f) {
            out[at++] = '?';
            text++;
            continue;
        }
        memcpy(out + at, text, n);
        at += n;
        text += n;
    }
    out[at] = '\0';
}

static double text_width(cairo_t *cr, const char *text) {
    cairo_text_extents_t extents;
    cairo_text_extents(cr, text, &extents);
    return extents.x_advance;
}

/* Takes whole characters from the end until the text and an ellipsis fit. */
static void cut_to_width(cairo_t *cr, char text[TEXT_BYTES], double max_width) {
    static const char ellipsis[] = "\xe2\x80\xa6";
    size_t n = strlen(text);
    while (n > 0 && text_width(cr, text) > max_width + 0.5) { /* half a pixel does not show */
        if (n >= 3 && memcmp(text + n - 3, ellipsis, 3) == 0) n -= 3;
        do {
            if (n > 0) n--;
        } while (n > 0 && ((unsigned char)text[n] & 0xc0) == 0x80);
        memcpy(text + n, ellipsis, sizeof ellipsis);
        if (n == 0) return;
        n += 3;
    }
}

void hs_draw_text(cairo_t *cr, double x, double y, double size, uint32_t colour, hs_align align,
                  double max_width, const char *text) {
    char clean[TEXT_BYTES];
    clean_text(text, clean);
    cairo_set_font_size(cr, size);
    double width = text_width(cr, clean);
    if (max_width > 0.0 && width > max_width) {
        cairo_set_font_size(cr, size * fmax(0.75, max_width / width));
        cut_to_width(cr, clean, max_width);
        width = text_width(cr, clean);
    }
    hs_draw_colour(cr, colour);
    cairo_move_to(cr, align == HS_ALIGN_LEFT ? x : align == HS_ALIGN_RIGHT ? x - width : x - width / 2, y);
    cairo_show_text(cr, clean);
}

uint32_t hs_draw_line_count(const char *text) {
    if (!text || !*text) return 0;
    uint32_t count = 1;
    for (; *text; text++) count += *text == '\n';
    return count;
}

void hs_draw_lines(cairo_t *cr, double x, double y, double step, double size, uint32_t colour,
                   double max_width, const char *text) {
    while (text && *text) {
        const size_t n = strcspn(text, "\n");
        char line[TEXT_BYTES];
        (void)snprintf(line, sizeof line, "%.*s", (int)(n < TEXT_BYTES ? n : TEXT_BYTES - 1), text);
        hs_draw_text(cr, x, y, size, colour, HS_ALIGN_LEFT, max_width, line);
        text += n + (text[n] == '\n');
        y += step;
    }
}

void hs_draw_box(cairo_t *cr, double x, double y, double width, double height, uint32_t colour) {
    hs_draw_colour(cr, colour);
    cairo_rectangle(cr, x, y, width, height);
    cairo_fill(cr);
}
