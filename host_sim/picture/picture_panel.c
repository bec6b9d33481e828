/* SPDX-License-Identifier: MIT */
#include "picture/picture_panel.h"

#include "picture/picture_colour.h"
#include "picture/picture_draw.h"

#include <inttypes.h>

enum {
    GAP = 16,
    TITLE_SIZE = 24,
    TITLE_BAND = 44,
    CAPTION_SIZE = 18,
    CAPTION_BAND = 30,
    FACT_SIZE = 15,
    FACT_STEP = 23
};

static bool check_items(const hs_panel_item *items, uint32_t count, hs_error *err) {
    if (count < 1 || count > 8)
        return hs_fail(err, HS_ERR_INPUT, "panel: %" PRIu32 " pictures, expected 1 .. 8", count);
    const hs_image *first = &items[0].image;
    for (uint32_t i = 0; i < count; i++) {
        const hs_image *image = &items[i].image;
        if (!image->data || image->width == 0 || image->height == 0 ||
            (image->channels != 1 && image->channels != 4))
            return hs_fail(err, HS_ERR_INPUT,
                           "panel: picture %" PRIu32 " is %" PRIu32 " x %" PRIu32 " with %" PRIu32
                           " channels",
                           i, image->width, image->height, image->channels);
        if (image->width != first->width || image->height != first->height)
            return hs_fail(err, HS_ERR_INPUT,
                           "panel: picture %" PRIu32 " is %" PRIu32 " x %" PRIu32 ", expected %" PRIu32
                           " x %" PRIu32,
                           i, image->width, image->height, first->width, first->height);
    }
    return true;
}

bool hs_picture_panel(hs_picture *out, const hs_panel_item *items, uint32_t count, uint32_t cell,
                      const hs_caption *caption, hs_error *err) {
    *out = (hs_picture){0};
    if (!check_items(items, count, err)) return false;
    if (cell == 0) cell = 512;
    if (cell > HS_PICTURE_MAX_AXIS)
        return hs_fail(err, HS_ERR_INPUT, "panel: a picture is %" PRIu32 " pixels wide, expected at most %u",
                       cell, HS_PICTURE_MAX_AXIS);
    const uint64_t aspect_height =
        ((uint64_t)cell * items[0].image.height + items[0].image.width / 2) / items[0].image.width;
    const uint32_t cell_height = aspect_height < 1                     ? 1
                                 : aspect_height > HS_PICTURE_MAX_AXIS ? HS_PICTURE_MAX_AXIS
                                                                       : (uint32_t)aspect_height;
    const uint32_t facts = hs_draw_line_count(caption->footer);
    const uint32_t top = (caption->title ? TITLE_BAND : GAP / 2) + CAPTION_BAND;
    const uint32_t width = count * (cell + GAP) + GAP;
    if (!hs_picture_init(out, width, top + cell_height + GAP + facts * FACT_STEP, HS_COLOUR_BACKGROUND, err))
        return false;

    for (uint32_t i = 0; i < count; i++)
        hs_picture_blit(out, (int32_t)(GAP + i * (cell + GAP)), (int32_t)top, cell, cell_height,
                        &items[i].image, HS_SCALE_SMOOTH);
    cairo_t *cr = hs_draw_begin(out);
    if (caption->title)
        hs_draw_text(cr, GAP, TITLE_BAND - 12, TITLE_SIZE, HS_COLOUR_TEXT, HS_ALIGN_LEFT, width - 2.0 * GAP,
                     caption->title);
    for (uint32_t i = 0; i < count; i++)
        if (items[i].caption)
            hs_draw_text(cr, GAP + i * (cell + GAP) + cell / 2.0, top - 9.0, CAPTION_SIZE, HS_COLOUR_TEXT,
                         HS_ALIGN_CENTRE, cell, items[i].caption);
    hs_draw_lines(cr, GAP, top + cell_height + FACT_STEP, FACT_STEP, FACT_SIZE, HS_COLOUR_FAINT_TEXT,
                  width - 2.0 * GAP, caption->footer);
    if (hs_draw_end(cr, err)) return true;
    hs_picture_free(out);
    return false;
}
