/* SPDX-License-Identifier: MIT */
#include "report/report_pictures.h"

#include "base/paths.h"
#include "eval/eval_study.h"
#include "render/camera_mark.h"
#include "report/report_draw.h"
#include "report/report_pictures_beside.h"
#include "show/loop_pictures.h"
#include "show/picture_map.h"

#include <limits.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#define TURNED 192u /* of the slider's pictures: there are many */

static bool save_error(const hs_eval_case *c, const char *folder, const char *name, hs_error *err) {
    static const hs_signed_words words = {
        .quantity = "error", .unit = "steps", .positive = "occluder left", .negative = "fetus cut"};
    char title[128];
    float *error = calloc((size_t)c->table.width * c->table.height, sizeof *error);
    if (!error) return hs_fail(err, HS_ERR_MEMORY, "error picture: no memory");
    hs_eval_error_picture(&c->table, c->termination, error);
    (void)snprintf(title, sizeof title, "%s: error per ray", name);
    const hs_caption caption = {.title = title,
                                .footer = "Termination depth of the ground truth minus that of the result"};
    hs_picture picture;
    bool ok = hs_picture_signed(&picture, error, c->table.width, c->table.height, HS_EVAL_ERROR_LIMIT, &words,
                                &caption, err);
    if (ok) {
        ok = hs_eval_save_picture(&picture, folder, "error.png", err);
        hs_picture_free(&picture);
    }
    ok = ok && hs_eval_save_errors(error, c->table.width, c->table.height, folder, "error_rays.png", err);
    free(error);
    return ok;
}

/* The slider's pictures, from one frame. */
static bool save_turns(const hs_eval_study *study, hs_loop *loop, hs_eval_result *r, const char *folder,
                       hs_error *err) {
    hs_frame frame;
    hs_eval_knob knob;
    hs_eval_knob_spread(&knob, &study->plugin, HS_EVAL_TURNS);
    if (!knob.exists || knob.count < 2) return true;
    const double shown = study->plan.knob.value[r->common.knob];
    if (!hs_loop_frame(loop, HS_SETTING_SMARTVIS, 0, &frame, err)) return false;
    uint8_t *rgba = malloc((size_t)TURNED * TURNED * 4);
    bool ok = rgba || hs_fail(err, HS_ERR_MEMORY, "knob: no memory for a picture");
    for (uint32_t i = 0; ok && i < knob.count; i++) {
        char name[32];
        (void)snprintf(name, sizeof name, "knob_%u.png", i);
        ok = hs_loop_turn(loop, 0, &knob.info, knob.value[i], rgba, err) &&
             hs_eval_save_rgba(rgba, TURNED, folder, name, err);
        r->turn[i] = knob.value[i];
        if (fabs(knob.value[i] - shown) < fabs(r->turn[r->turned] - shown)) r->turned = i;
    }
    r->turns = ok ? knob.count : 0;
    free(rgba);
    return ok;
}

static hs_eval_drawing drawing_of(const hs_eval_study *study, const hs_eval_case *c,
                                  const hs_eval_values *values, uint32_t pixels) {
    return (hs_eval_drawing){.options = study->options,
                             .cl = &study->cl,
                             .plugin = &study->plugin,
                             .c = c,
                             .values = values,
                             .pixels = pixels};
}

static bool draw_turns(hs_eval_study *study, uint32_t index, const hs_eval_case *c,
                       const hs_eval_values *values, const char *folder, hs_error *err) {
    const hs_eval_drawing drawing = drawing_of(study, c, values, TURNED);
    hs_loop *loop = hs_eval_draw_loop(&drawing, err);
    const bool ok = loop && save_turns(study, loop, &study->result[index], folder, err);
    hs_loop_destroy(loop);
    return ok;
}

static bool draw(hs_eval_study *study, uint32_t index, const hs_eval_case *c, const hs_eval_values *values,
                 const char *folder, hs_error *err) {
    hs_view view;
    char note[160], title[200];
    const hs_eval_drawing drawing = drawing_of(study, c, values, HS_EVAL_PICTURE);
    hs_loop *loop = hs_eval_draw_loop(&drawing, err);
    bool clipped = false, ok = loop && hs_loop_view(loop, 0, &view, err);
    if (ok) {
        const char *said = hs_frame_note(&view.frame, "the plugin failed", note, sizeof note);
        hs_camera_title(study->space[index].name, &view.camera, view.volume, title, sizeof title);
        ok = hs_loop_write_pictures(&view, folder, title, said, HS_EVAL_PICTURE, err);
        clipped = view.frame.clipped;
        hs_view_free(&view);
    }
    hs_loop_destroy(loop);
    /* Without a surface there is nothing to turn. */
    return ok && (!clipped || draw_turns(study, index, c, values, folder, err));
}

static bool work(hs_eval_study *study, uint32_t index, hs_eval_case *c, const char *folder, hs_error *err) {
    hs_eval_result *r = &study->result[index];
    hs_eval_values values;
    if (!hs_eval_study_values(study, r->common, &values, err) ||
        !hs_eval_case_direct(c, &values, &r->shown, &r->shown_outcome, err) ||
        !save_error(c, folder, study->space[index].name, err) || !hs_eval_speed_curves(study, index, c, err))
        return false;
    hs_eval_case_release(c); /* a plugin's instance serves one loop at a time */
    return draw(study, index, c, &values, folder, err) &&
           hs_eval_speed_settings(study, index, c, &values, err) &&
           hs_eval_beside_pictures(study, index, c, folder, err);
}

bool hs_eval_study_pictures(hs_eval_study *study, uint32_t index, hs_error *err) {
    char folder[PATH_MAX];
    hs_eval_case c;
    if (!hs_path_join(study->options->out, study->space[index].name, folder, sizeof folder, err) ||
        !hs_path_make_folder(folder, err) || !hs_eval_study_case(study, index, &c, err))
        return false;
    const bool ok = work(study, index, &c, folder, err);
    hs_eval_case_close(&c);
    return ok;
}
