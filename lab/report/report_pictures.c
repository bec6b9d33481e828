/* SPDX-License-Identifier: MIT */
#include "report/report.h"

#include "core/paths.h"
#include "core/system.h"
#include "loop/clipper.h"
#include "picture/picture.h"
#include "render/camera.h"
#include "show/loop_pictures.h"
#include "show/picture_map.h"

#include <ctype.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

/* --------------------------------------------------------------------------------------------- drawing -- */

#define HS_EVAL_PICTURE 256u  /* pixels per side on the page */
#define ERROR_LIMIT     40.0f /* steps: where the colours of the error picture end */

/* A loop over a case's volume. The case's own loop must be gone: a plugin's instance serves one at a time. */
typedef struct {
    const hs_eval_options *options; /* how pictures look */
    const hs_cl *cl;
    const hs_plugin *plugin;
    const hs_eval_case *c;
    const hs_eval_values *values;
    uint32_t pixels; /* of the picture's sides */
} hs_eval_drawing;

static bool hs_eval_save_picture(const hs_picture *picture, const char *folder, const char *name,
                                 hs_error *err) {
    char path[SYS_PATH];
    return hs_path_join(folder, name, path, sizeof path, err) && hs_picture_save(picture, path, err);
}

/* A square picture of four bytes a pixel. */
static bool hs_eval_save_rgba(const uint8_t *rgba, uint32_t side, const char *folder, const char *name,
                              hs_error *err) {
    const hs_image image = {.data = rgba, .width = side, .height = side};
    hs_picture picture;
    if (!hs_picture_init(&picture, side, side, 0, err)) return false;
    hs_picture_blit(&picture, 0, 0, side, side, &image, HS_SCALE_NEAREST);
    const bool ok = hs_eval_save_picture(&picture, folder, name, err);
    hs_picture_free(&picture);
    return ok;
}

static hs_loop *hs_eval_draw_loop(const hs_eval_drawing *d, hs_error *err) {
    hs_loop_options options;
    hs_loop_defaults(&options);
    options.frames = 1;
    options.lowres = d->c->table.width;
    options.dvr.width = options.dvr.height = d->pixels;
    hs_loop_for_pictures(&options, d->options->look);
    for (int i = 0; i < 2; i++) options.dvr.light[i] = d->options->light[i];
    options.values = d->values->at;
    options.value_count = d->values->count;
    return hs_loop_create(d->cl, &d->c->from.source, d->plugin, &options, err);
}

/* The rendering as a square picture of HS_EVAL_PICTURE pixels; `view` may be NULL, else the caller frees
 * it. */
static bool hs_eval_draw_result(const hs_eval_drawing *drawing, const char *folder, const char *name,
                                hs_view *view, hs_error *err) {
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

/* ------------------------------------------------------------------------------------------ comparison -- */

bool hs_eval_compare_folder(const hs_eval_comparison *x, uint32_t index, char *out, size_t bytes,
                            hs_error *err) {
    char name[sizeof x->name[0]];
    (void)snprintf(name, sizeof name, "%s", x->name[index]); /* of a file: any characters */
    for (char *p = name; *p; p++)
        if (!isalnum((unsigned char)*p) && *p != '-') *p = '_';
    return hs_path_join(x->options->out, name, out, bytes, err);
}

void hs_eval_compare_file(uint32_t method, char *out, size_t bytes) {
    (void)snprintf(out, bytes, "method_%u.png", method + 1);
}

/* The first method's view has the full volume and the ground truth, too. */
static bool draw_method(hs_eval_comparison *x, uint32_t index, uint32_t method, const hs_eval_case *c,
                        const char *folder, hs_error *err) {
    const hs_eval_drawing drawing = {.options = x->options,
                                     .cl = &x->cl,
                                     .plugin = &x->method[method].plugin,
                                     .c = c,
                                     .values = &x->method[method].values,
                                     .pixels = HS_EVAL_PICTURE};
    char file[32];
    hs_view view;
    hs_eval_compare_file(method, file, sizeof file);
    if (!hs_eval_draw_result(&drawing, folder, file, &view, err)) return false;
    x->truth_cut[index] = view.truth_cut;
    const bool ok = method > 0 || (hs_eval_save_rgba(view.full, HS_EVAL_PICTURE, folder, "full.png", err) &&
                                   hs_eval_save_rgba(view.truth, HS_EVAL_PICTURE, folder, "truth.png", err));
    hs_view_free(&view);
    return ok;
}

bool hs_eval_compare_pictures(hs_eval_comparison *x, uint32_t index, hs_eval_case *c, hs_error *err) {
    char folder[SYS_PATH];
    hs_eval_case_release(c);
    bool ok =
        hs_eval_compare_folder(x, index, folder, sizeof folder, err) && hs_path_make_folder(folder, err);
    for (uint32_t m = 0; ok && m < x->count; m++) ok = draw_method(x, index, m, c, folder, err);
    return ok;
}

/* ------------------------------------------------------------------------------------------------ case -- */

#define TURNED 192u /* of the slider's pictures: there are many */

/* The error of every ray, of the frame that was measured the direct way. */
static bool save_error(const hs_eval_case *c, const char *folder, const char *file, const char *name,
                       hs_error *err) {
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
    bool ok = hs_picture_signed(&picture, error, c->table.width, c->table.height, ERROR_LIMIT, &words,
                                &caption, err);
    if (ok) {
        ok = hs_eval_save_picture(&picture, folder, file, err);
        hs_picture_free(&picture);
    }
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
    bool ok = rgba || hs_fail(err, HS_ERR_MEMORY, "positions: no memory for a picture");
    for (uint32_t i = 0; ok && i < knob.count; i++) {
        char name[32];
        (void)snprintf(name, sizeof name, "position_%u.png", i);
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

/* The plugin at the common setting: "common.png", "common_error.png", and the positions of its knob. The
 * case's loop is gone afterwards. */
static bool draw_common(hs_eval_study *study, uint32_t index, hs_eval_case *c, const char *folder,
                        hs_error *err) {
    hs_eval_result *r = &study->result[index];
    hs_eval_values values;
    if (!hs_eval_study_values(study, r->common, &values, err) ||
        !hs_eval_case_direct(c, &values, &r->shown, &r->shown_outcome, err) ||
        !save_error(c, folder, "common_error.png", study->space[index].name, err))
        return false;
    hs_eval_case_release(c); /* a plugin's instance serves one loop at a time */
    const hs_eval_drawing drawing = drawing_of(study, c, &values, HS_EVAL_PICTURE);
    if (!hs_eval_draw_result(&drawing, folder, "common.png", NULL, err)) return false;
    /* Without a surface there is nothing to turn. */
    if (hs_outcome_clips(r->shown_outcome)) {
        const hs_eval_drawing turned = drawing_of(study, c, &values, TURNED);
        hs_loop *loop = hs_eval_draw_loop(&turned, err);
        const bool ok = loop && save_turns(study, loop, r, folder, err);
        hs_loop_destroy(loop);
        if (!ok) return false;
    }
    return hs_eval_speed_settings(study, index, c, &values, err);
}

/* The plugin as it is: the pictures of `host_sim run`, and "error.png". */
static bool draw_plain(hs_eval_study *study, uint32_t index, hs_eval_case *c, const char *folder,
                       hs_error *err) {
    hs_eval_result *r = &study->result[index];
    const hs_eval_values *values = &study->plain.values;
    const char *name = study->space[index].name;
    char title[200];
    hs_measures measures;
    sv_status outcome;
    hs_view view;
    if (!hs_eval_case_replace(c, &study->cl, &study->plugin, values, err) ||
        !hs_eval_case_direct(c, values, &measures, &outcome, err) ||
        !save_error(c, folder, "error.png", name, err))
        return false;
    hs_eval_case_release(c);
    const hs_eval_drawing drawing = drawing_of(study, c, values, HS_EVAL_PICTURE);
    hs_loop *loop = hs_eval_draw_loop(&drawing, err);
    bool ok = loop && hs_loop_view(loop, 0, &view, err);
    if (ok) {
        const char *said = hs_frame_note(&view.maps.frame, "the plugin failed", r->note, sizeof r->note);
        if (!said) r->note[0] = '\0';
        hs_camera_title(name, &view.maps.camera, view.volume, title, sizeof title);
        ok = hs_loop_write_pictures(&view, folder, title, said, HS_EVAL_PICTURE, err);
        r->sure = view.maps.confidence != NULL;
        r->truth_cut = view.truth_cut;
        hs_view_free(&view);
    }
    hs_loop_destroy(loop);
    return ok;
}

/* What an expert left of the volume, drawn as the truth is: "reference.png". It takes the truth's place, so
 * it comes last. */
static bool draw_reference(hs_eval_study *study, uint32_t index, hs_eval_case *c, const char *folder,
                           hs_error *err) {
    hs_view view;
    study->result[index].has_reference = c->from.given_reference.voxels != NULL;
    if (!study->result[index].has_reference) return true;
    if (!hs_source_set_truth(&c->from.source, &c->from.given_reference, err)) return false;
    const hs_eval_drawing drawing = drawing_of(study, c, &study->plain.values, HS_EVAL_PICTURE);
    hs_loop *loop = hs_eval_draw_loop(&drawing, err);
    bool ok = loop && hs_loop_view(loop, 0, &view, err);
    if (ok) {
        ok = hs_eval_save_rgba(view.truth, HS_EVAL_PICTURE, folder, "reference.png", err);
        hs_view_free(&view);
    }
    hs_loop_destroy(loop);
    return ok;
}

bool hs_eval_study_pictures(hs_eval_study *study, uint32_t index, hs_error *err) {
    char folder[SYS_PATH];
    hs_eval_case c;
    if (!hs_path_join(study->options->out, study->space[index].name, folder, sizeof folder, err) ||
        !hs_path_make_folder(folder, err) || !hs_eval_study_case(study, index, &c, err))
        return false;
    const bool ok = draw_common(study, index, &c, folder, err) && draw_plain(study, index, &c, folder, err) &&
                    draw_reference(study, index, &c, folder, err);
    hs_eval_case_close(&c);
    return ok;
}
