/* SPDX-License-Identifier: MIT */
/* By cairo, whose context a canvas is. */
#include "picture/canvas.h"

#include <cairo.h>
#include <fontconfig/fontconfig.h>

static cairo_t *context(hs_canvas *on) {
    return (cairo_t *)on;
}

hs_canvas *hs_draw_begin(hs_picture *picture) {
    /* CAIRO_FORMAT_RGB24 is 0x00RRGGBB in the host's byte order, rows of width * 4
     * bytes: the picture's own format. */
    cairo_surface_t *surface = cairo_image_surface_create_for_data(
        (unsigned char *)picture->pixels, CAIRO_FORMAT_RGB24, (int)picture->width, (int)picture->height,
        (int)picture->width * 4);
    cairo_t *cr = cairo_create(surface);
    cairo_surface_destroy(surface); /* the context keeps it */
    cairo_select_font_face(cr, "DejaVu Sans", CAIRO_FONT_SLANT_NORMAL, CAIRO_FONT_WEIGHT_NORMAL);
    /* Unhinted advances, so that a text's width goes with its size; gray edges, so that letters have no
     * colour. */
    cairo_font_options_t *options = cairo_font_options_create();
    cairo_font_options_set_hint_metrics(options, CAIRO_HINT_METRICS_OFF);
    cairo_font_options_set_antialias(options, CAIRO_ANTIALIAS_GRAY);
    cairo_set_font_options(cr, options);
    cairo_font_options_destroy(options);
    return (hs_canvas *)cr;
}

bool hs_draw_end(hs_canvas *on, hs_error *err) {
    cairo_t *cr = context(on);
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

/* The colour of what is drawn next. */
static void set_colour(cairo_t *cr, uint32_t colour) {
    cairo_set_source_rgb(cr, (colour >> 16 & 255) / 255.0, (colour >> 8 & 255) / 255.0,
                         (colour & 255) / 255.0);
}

void hs_draw_box(hs_canvas *on, double x, double y, double width, double height, uint32_t colour) {
    set_colour(context(on), colour);
    cairo_rectangle(context(on), x, y, width, height);
    cairo_fill(context(on));
}

void hs_canvas_size(hs_canvas *on, double size) {
    cairo_set_font_size(context(on), size);
}

double hs_canvas_width(hs_canvas *on, const char *text) {
    cairo_text_extents_t extents;
    cairo_text_extents(context(on), text, &extents);
    return extents.x_advance;
}

void hs_canvas_text(hs_canvas *on, double x, double y, uint32_t colour, const char *text) {
    set_colour(context(on), colour);
    cairo_move_to(context(on), x, y);
    cairo_show_text(context(on), text);
}

void hs_picture_finish(void) {
    cairo_debug_reset_static_data();
    FcFini();
}
