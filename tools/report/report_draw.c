/* SPDX-License-Identifier: MIT */
#include "report/report_draw.h"

#include "base/paths.h"
#include "picture/picture_colour.h"

#include <limits.h>
#include <math.h>

bool hs_eval_save_picture(const hs_picture *picture, const char *folder, const char *name, hs_error *err) {
    char path[PATH_MAX];
    return hs_path_join(folder, name, path, sizeof path, err) && hs_picture_save(picture, path, err);
}

bool hs_eval_save_errors(const float *error, uint32_t width, uint32_t height, const char *folder,
                         const char *name, hs_error *err) {
    const uint32_t side = HS_EVAL_PICTURE;
    hs_picture picture;
    if (!hs_picture_init(&picture, side, side, HS_COLOUR_NO_VALUE, err)) return false;
    for (uint32_t y = 0; y < side; y++) {
        for (uint32_t x = 0; x < side; x++) {
            const float e = error[(size_t)(y * height / side) * width + x * width / side];
            if (!isnan(e))
                picture.pixels[(size_t)y * side + x] = hs_colour_diverging((double)(e / HS_EVAL_ERROR_LIMIT));
        }
    }
    const bool ok = hs_eval_save_picture(&picture, folder, name, err);
    hs_picture_free(&picture);
    return ok;
}

bool hs_eval_save_rgba(const uint8_t *rgba, uint32_t side, const char *folder, const char *name,
                       hs_error *err) {
    const hs_image image = {.data = rgba, .width = side, .height = side, .channels = 4};
    hs_picture picture;
    if (!hs_picture_init(&picture, side, side, 0, err)) return false;
    hs_picture_blit(&picture, 0, 0, side, side, &image, HS_SCALE_NEAREST);
    const bool ok = hs_eval_save_picture(&picture, folder, name, err);
    hs_picture_free(&picture);
    return ok;
}

hs_loop *hs_eval_draw_loop(const hs_eval_drawing *d, hs_error *err) {
    hs_loop_options options;
    hs_loop_defaults(&options);
    options.frames = 1;
    options.lowres = d->c->table.width;
    options.dvr.width = options.dvr.height = d->pixels;
    hs_loop_for_pictures(&options, d->options->look);
    for (int i = 0; i < 2; i++) options.dvr.light[i] = d->options->light[i];
    options.dvr.ghost_offset = options.dvr.ghost_width = d->ghost;
    options.values = d->values->at;
    options.value_count = d->values->count;
    return hs_loop_create(d->cl, &d->c->from.source, d->plugin, &options, err);
}

bool hs_eval_draw_result(const hs_eval_drawing *drawing, const char *folder, const char *name, hs_view *view,
                         hs_error *err) {
    hs_view own;
    hs_loop *loop = hs_eval_draw_loop(drawing, err);
    bool ok = loop && hs_loop_view(loop, 0, &own, err);
    hs_loop_destroy(loop);
    if (!ok) return false;
    ok = hs_eval_save_rgba(own.result, drawing->pixels, folder, name, err);
    if (ok && view)
        *view = own;
    else
        hs_view_free(&own);
    return ok;
}
