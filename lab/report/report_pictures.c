/* SPDX-License-Identifier: MIT */
#include "report/report.h"

#include "base/paths.h"
#include "picture/picture.h"
#include "render/camera.h"
#include "show/loop_pictures.h"
#include "show/picture_map.h"

#include <ctype.h>
#include <limits.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

/* --------------------------------------------------------------------------------------------- drawing -- */

#define HS_EVAL_PICTURE 256u /* pixels per side on the page */

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
    char path[PATH_MAX];
    return hs_path_join(folder, name, path, sizeof path, err) && hs_picture_save(picture, path, err);
}

/* The errors alone, in the legend's colours: the page sets them beside the renderings. */
static bool hs_eval_save_errors(const float *error, uint32_t width, uint32_t height, const char *folder,
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

/* A square picture of four bytes a pixel. */
static bool hs_eval_save_rgba(const uint8_t *rgba, uint32_t side, const char *folder, const char *name,
                              hs_error *err) {
    const hs_image image = {.data = rgba, .width = side, .height = side, .channels = 4};
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

/* ------------------------------------------------------------------------------------------- as it is -- */
/* The plugin at the settings that the user left it: "plain.png", "plain_error.png", "plain_confidence.png".
 */

/* The error of every ray. The case's loop is replaced, and gone afterwards. */
static bool draw_errors(hs_eval_study *study, hs_eval_case *c, const char *folder, hs_error *err) {
    const hs_eval_values *values = &study->plain.values;
    hs_measures measures;
    sv_status outcome;
    float *error = calloc((size_t)c->table.width * c->table.height, sizeof *error);
    if (!error) return hs_fail(err, HS_ERR_MEMORY, "error picture: no memory");
    bool ok = hs_eval_case_replace(c, &study->cl, &study->plugin, values, err) &&
              hs_eval_case_direct(c, values, &measures, &outcome, err);
    if (ok) {
        hs_eval_error_picture(&c->table, c->termination, error);
        ok = hs_eval_save_errors(error, c->table.width, c->table.height, folder, "plain_error.png", err);
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
    const bool ok = hs_eval_save_picture(&picture, folder, "plain_confidence.png", err);
    hs_picture_free(&picture);
    return ok;
}

/* The case's loop is replaced, and gone afterwards. */
static bool draw_plain(hs_eval_study *study, uint32_t index, hs_eval_case *c, const char *folder,
                       hs_error *err) {
    hs_eval_result *r = &study->result[index];
    const hs_eval_drawing drawing = {.options = study->options,
                                     .cl = &study->cl,
                                     .plugin = &study->plugin,
                                     .c = c,
                                     .values = &study->plain.values,
                                     .pixels = HS_EVAL_PICTURE};
    hs_view view;
    if (!draw_errors(study, c, folder, err) ||
        !hs_eval_draw_result(&drawing, folder, "plain.png", &view, err))
        return false;
    if (!hs_frame_note(&view.frame, "the plugin failed", r->note, sizeof r->note)) r->note[0] = '\0';
    r->sure = view.sure != NULL;
    const bool ok = !r->sure || save_confidence(&view, folder, err);
    hs_view_free(&view);
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
    char folder[PATH_MAX];
    hs_eval_case_release(c);
    bool ok =
        hs_eval_compare_folder(x, index, folder, sizeof folder, err) && hs_path_make_folder(folder, err);
    for (uint32_t m = 0; ok && m < x->count; m++) ok = draw_method(x, index, m, c, folder, err);
    return ok;
}

/* ------------------------------------------------------------------------------------------------ case -- */

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
        study->result[index].truth_cut = view.truth_cut;
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
           hs_eval_speed_settings(study, index, c, &values, err) && draw_plain(study, index, c, folder, err);
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
