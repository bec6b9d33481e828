/* SPDX-License-Identifier: MIT */
#include "picture/picture_text.h"

#include "picture/picture_draw.h"

#include <fontconfig/fontconfig.h>

bool hs_picture_text(hs_picture *picture, double x, double y, double size, uint32_t colour, hs_align align,
                     double max_width, const char *text, hs_error *err) {
    cairo_t *cr = hs_draw_begin(picture);
    hs_draw_text(cr, x, y, size, colour, align, max_width, text);
    return hs_draw_end(cr, err);
}

bool hs_picture_line(hs_picture *picture, double x0, double y0, double x1, double y1, double width,
                     uint32_t colour, hs_error *err) {
    cairo_t *cr = hs_draw_begin(picture);
    hs_draw_colour(cr, colour);
    cairo_set_line_width(cr, width);
    cairo_move_to(cr, x0, y0);
    cairo_line_to(cr, x1, y1);
    cairo_stroke(cr);
    return hs_draw_end(cr, err);
}

void hs_picture_finish(void) {
    cairo_debug_reset_static_data();
    FcFini();
}
