/* SPDX-License-Identifier: MIT */
#include "report/report_pictures_beside.h"

#include "picture/picture_colour.h"
#include "report/report_draw.h"

#include <stdlib.h>

/* The error of every ray at these values. The case's loop is replaced, and gone afterwards. */
static bool draw_errors(hs_eval_study *study, hs_eval_case *c, const hs_eval_values *values,
                        const char *folder, const char *name, hs_error *err) {
    hs_measures measures;
    sv_status outcome;
    float *error = calloc((size_t)c->table.width * c->table.height, sizeof *error);
    if (!error) return hs_fail(err, HS_ERR_MEMORY, "error picture: no memory");
    bool ok = hs_eval_case_replace(c, &study->cl, &study->plugin, values, err) &&
              hs_eval_case_direct(c, values, &measures, &outcome, err);
    if (ok) {
        hs_eval_error_picture(&c->table, c->termination, error);
        ok = hs_eval_save_errors(error, c->table.width, c->table.height, folder, name, err);
    }
    free(error);
    hs_eval_case_release(c);
    return ok;
}

/* Without a frame or a legend: the page has one legend for all. */
static bool save_confidence(const hs_view *view, const char *folder, hs_error *err) {
    const uint32_t side = HS_EVAL_PICTURE;
    hs_picture picture;
    if (!hs_picture_init(&picture, side, side, 0, err)) return false;
    for (uint32_t y = 0; y < side; y++)
        for (uint32_t x = 0; x < side; x++)
            picture.pixels[(size_t)y * side + x] =
                hs_colour_viridis((double)view->sure[(size_t)(y * view->map_height / side) * view->map_width +
                                                     x * view->map_width / side]);
    const bool ok = hs_eval_save_picture(&picture, folder, "beside_confidence.png", err);
    hs_picture_free(&picture);
    return ok;
}

/* The other method: its rendering and, where it gives a confidence, that and a rendering ghosted by it. */
static bool draw_other(hs_eval_study *study, uint32_t index, hs_eval_drawing *drawing, const char *folder,
                       hs_error *err) {
    hs_view view;
    if (!hs_eval_draw_result(drawing, folder, "beside_other.png", &view, err)) return false;
    bool ok = true;
    if (view.sure) {
        drawing->ghost = HS_EVAL_GHOST_SLICES * drawing->c->table.steps_per_slice;
        ok = save_confidence(&view, folder, err) &&
             hs_eval_draw_result(drawing, folder, "beside_ghost.png", NULL, err);
        study->beside.has_confidence[index] = ok;
    }
    hs_view_free(&view);
    return ok;
}

bool hs_eval_beside_pictures(hs_eval_study *study, uint32_t index, hs_eval_case *c, const char *folder,
                             hs_error *err) {
    const hs_eval_beside *b = &study->beside;
    if (!b->exists) return true;
    hs_eval_values first = b->first;
    if (b->knob.exists && !hs_eval_values_add(&first, b->knob.info.id, b->knob.value[b->best], err))
        return false;
    hs_eval_drawing drawing = {.options = study->options,
                               .cl = &study->cl,
                               .plugin = &study->plugin,
                               .c = c,
                               .values = &first,
                               .pixels = HS_EVAL_PICTURE};
    if (!draw_errors(study, c, &first, folder, "beside_knob_error.png", err) ||
        !hs_eval_draw_result(&drawing, folder, "beside_knob.png", NULL, err) ||
        !draw_errors(study, c, &b->other, folder, "beside_other_error.png", err))
        return false;
    drawing.values = &b->other;
    return draw_other(study, index, &drawing, folder, err);
}
