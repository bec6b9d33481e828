/* Pictures of both methods of one case, each at its one setting for all cases. */
#include "hs_eval_draw.h"

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
    hs_loop_destroy(c->loop);
    c->loop = NULL;
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

/* The rendering, and the confidence if `with_confidence` and there is one. */
static bool draw(hs_eval_study *study, uint32_t index, const hs_eval_case *c, const hs_eval_values *values,
                 const char *folder, const char *name, bool with_confidence, hs_error *err) {
    hs_view view;
    hs_loop *loop = hs_eval_draw_loop(study, c, values, HS_EVAL_PICTURE, err);
    bool ok = loop && hs_loop_view(loop, 0, &view, err);
    if (ok) {
        ok = hs_eval_save_rgba(view.result, HS_EVAL_PICTURE, folder, name, err);
        if (ok && with_confidence && view.sure) {
            ok = save_confidence(&view, folder, err);
            study->beside.has_confidence[index] = ok;
        }
        hs_view_free(&view);
    }
    hs_loop_destroy(loop);
    return ok;
}

bool hs_eval_beside_pictures(hs_eval_study *study, uint32_t index, hs_eval_case *c, const char *folder,
                             hs_error *err) {
    const hs_eval_beside *b = &study->beside;
    if (!b->exists) return true;
    hs_eval_values first = b->first;
    if (b->knob.exists && !hs_eval_values_add(&first, b->knob.info.id, b->knob.value[b->best], err))
        return false;
    return draw_errors(study, c, &first, folder, "beside_knob_error.png", err) &&
           draw(study, index, c, &first, folder, "beside_knob.png", false, err) &&
           draw_errors(study, c, &b->other, folder, "beside_other_error.png", err) &&
           draw(study, index, c, &b->other, folder, "beside_other.png", true, err);
}
