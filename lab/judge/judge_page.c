/* SPDX-License-Identifier: MIT */
#include "judge/judge.h"

#include "base/paths.h"
#include "loop/view.h"
#include "page/page_html.h"
#include "picture/picture_draw.h"
#include "show/loop_pictures.h"
#include "show/picture_map.h"

#include <limits.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* -------------------------------------------------------------------------------------------- pictures -- */
/* A case in pictures, drawn by the host's scan loop with the plugin at work. */

/* What all pictures are drawn with. Borrowed. */
typedef struct {
    const hs_cl *cl;
    const hs_plugin *plugin;
    const hs_eval_values *values;
} site_pen;

/* What the plugin did. */
typedef struct {
    wall_score score; /* zeros without a truth */
    bool clipped, sure, truth_cut;
    char note[160]; /* why it is not clipped; "" if it is */
} site_drawn;

enum { PIXELS = 320 };                  /* of a picture's side */
static const float error_limit = 10.0f; /* slices of 128: where the colours end */

/* A volume as the host keeps it: 0 is what was not scanned, and nothing else. */
static bool make_volume(const wall_case *c, const uint8_t *voxels, hs_volume *out, hs_error *err) {
    const size_t plane = (size_t)c->nx * c->ny;
    if (!hs_volume_init(out, c->nx, c->ny, c->nz, err)) return false;
    memcpy(out->spacing, c->spacing_mm, sizeof out->spacing);
    (void)snprintf(out->name, sizeof out->name, "%s", c->name);
    for (size_t i = 0; i < plane; i++)
        for (size_t z = c->first[i]; z < c->end[i]; z++) {
            const uint8_t level = voxels[z * plane + i];
            out->voxels[z * plane + i] = level ? level : 1;
        }
    return true;
}

static bool draw_error(const wall_case *c, const hs_view *view, const char *folder, site_drawn *out,
                       hs_error *err) {
    static const hs_signed_words words = {
        .quantity = "error", .unit = "slices of 128", .positive = "occluder left", .negative = "fetus cut"};
    const hs_caption caption = {.title = "Error of every ray",
                                .footer = "end in the truth minus end in the result"};
    const size_t rays = (size_t)c->nx * c->ny;
    wall_calibration unused = {0};
    char path[PATH_MAX];
    hs_picture picture;
    float *error = malloc(rays * sizeof *error), *sure = calloc(rays, sizeof *sure);
    bool ok = (error && sure) || hs_fail(err, HS_ERR_MEMORY, "%s: no memory for %zu rays", c->name, rays);
    if (ok) {
        out->score = wall_judge(c, c->full, view->depth, sure, &unused);
        for (size_t i = 0; i < rays; i++)
            error[i] = c->label[i] ? 128.0f / (float)c->nz *
                                         (c->truth[i] - wall_ray_end(c, c->full, i, view->depth[i]))
                                   : NAN;
        ok = hs_picture_signed(&picture, error, c->nx, c->ny, error_limit, &words, &caption, err);
    }
    if (ok) {
        ok =
            hs_path_join(folder, "error.png", path, sizeof path, err) && hs_picture_save(&picture, path, err);
        hs_picture_free(&picture);
    }
    free(error);
    free(sure);
    return ok;
}

static bool draw_view(const wall_case *c, const hs_view *view, const char *folder, site_drawn *out,
                      hs_error *err) {
    char note[160];
    const char *said = hs_frame_note(&view->frame, "the plugin failed", note, sizeof note);
    out->clipped = view->frame.clipped;
    out->truth_cut = view->truth_cut;
    out->sure = view->sure != NULL && view->frame.clipped;
    (void)snprintf(out->note, sizeof out->note, "%s", said ? said : "");
    if (view->map_width != c->nx || view->map_height != c->ny)
        return hs_fail(err, HS_ERR_INPUT, "%s: %u x %u rays, expected a square image", c->name, c->nx, c->ny);
    return hs_loop_write_pictures(view, folder, c->name, said, PIXELS, err) &&
           draw_error(c, view, folder, out, err);
}

static bool draw(const site_pen *pen, const wall_case *c, const hs_volume *full, const hs_volume *truth,
                 const char *folder, site_drawn *out, hs_error *err) {
    const hs_volume *volumes[1] = {full}, *truths[1] = {truth};
    const hs_source source = {.volumes = volumes, .truths = truths, .count = 1};
    hs_loop_options options;
    hs_view view;
    hs_loop_defaults(&options);
    options.frames = 1;
    options.lowres = c->nx > c->ny ? c->nx : c->ny;
    options.dvr.width = options.dvr.height = PIXELS;
    hs_loop_for_pictures(&options, HS_LOOK_LIT);
    options.values = pen->values->at;
    options.value_count = pen->values->count;
    hs_loop *loop = hs_loop_create(pen->cl, &source, pen->plugin, &options, err);
    bool ok = loop && hs_loop_view(loop, 0, &view, err);
    if (ok) {
        ok = draw_view(c, &view, folder, out, err);
        hs_view_free(&view);
    }
    const hs_error *failure = loop ? hs_loop_plugin_error(loop) : NULL;
    if (ok && failure && failure->code != HS_OK) ok = hs_fail(err, failure->code, "%s", failure->text);
    hs_loop_destroy(loop);
    return ok;
}

/* Writes full.png, result.png, truth.png, slices.png, error.png and, with a confidence, confidence.png to a
 * folder that exists. */
static bool site_draw(const site_pen *pen, const wall_case *c, const char *folder, site_drawn *out,
                      hs_error *err) {
    hs_volume full = {0}, truth = {0};
    *out = (site_drawn){0};
    const bool ok = make_volume(c, c->full, &full, err) && make_volume(c, c->clean, &truth, err) &&
                    draw(pen, c, &full, &truth, folder, out, err);
    hs_volume_free(&full);
    hs_volume_free(&truth);
    return ok;
}

/* ------------------------------------------------------------------------------------------------ page -- */

/* The page under way. */
typedef struct {
    const site_page *what;
    site_pen pen;
    hs_page page;
    uint32_t folders; /* so far */
} book;

static void show(book *b, const char *folder, const char *file, bool photo, const char *name,
                 const char *caption) {
    char path[PATH_MAX], alt[300];
    (void)snprintf(alt, sizeof alt, "%s: %s", name, caption);
    if (!hs_path_join(folder, file, path, sizeof path, &b->page.error)) return;
    if (photo)
        hs_page_photo(&b->page, path, alt, caption);
    else
        hs_page_picture(&b->page, path, alt, caption);
}

static void put_case(book *b, const wall_case *c, const char *title, const char *folder,
                     const site_drawn *d) {
    char text[300];
    hs_page_heading(&b->page, 3, title);
    (void)snprintf(text, sizeof text, "Error %.2f slices of 128, %.1f %% of the fetus cut, %.1f %% left. %s",
                   d->score.error, 100.0 * d->score.cut, 100.0 * d->score.left, d->note);
    hs_page_text(&b->page, text);
    hs_page_row_begin(&b->page);
    show(b, folder, "full.png", true, c->name, "Full volume");
    show(b, folder, "result.png", true, c->name, d->clipped ? "Result" : "Result: not clipped");
    show(b, folder, "truth.png", true, c->name, hs_page_truth_caption(d->truth_cut));
    hs_page_row_end(&b->page);
    hs_page_row_begin(&b->page);
    show(b, folder, "slices.png", true, c->name, hs_page_slices_caption(d->clipped));
    hs_page_row_end(&b->page);
    hs_page_row_begin(&b->page);
    if (d->sure) show(b, folder, "confidence.png", false, c->name, "Confidence");
    show(b, folder, "error.png", false, c->name, "Error, at most 10 slices either way");
    hs_page_row_end(&b->page);
}

/* Draws a case into a folder of its own, and puts it on the page. */
static bool add_case(book *b, const wall_case *c, const char *title, hs_error *err) {
    char name[32], folder[PATH_MAX];
    site_drawn drawn;
    (void)snprintf(name, sizeof name, "case_%02u", b->folders++);
    if (!hs_path_join(b->what->out, name, folder, sizeof folder, err) || !hs_path_make_folder(folder, err) ||
        !site_draw(&b->pen, c, folder, &drawn, err))
        return false;
    put_case(b, c, title, folder, &drawn);
    return true;
}

static bool add_sites(book *b, hs_error *err) {
    const site_list *list = b->what->sites;
    for (uint32_t i = 0; i < list->count; i++) {
        hs_page_heading(&b->page, 2, list->set[i].title);
        for (uint32_t n = 0; n < list->set[i].count; n++)
            if (!add_case(b, &list->set[i].cases[n], list->set[i].cases[n].name, err)) return false;
    }
    return true;
}

/* The first case of every site where clipping can only do harm. */
static bool add_variants(book *b, hs_error *err) {
    const site_list *list = b->what->sites;
    hs_page_heading(&b->page, 2, "Nothing to remove, or something that only looks like it");
    for (uint32_t i = 0; i < list->count; i++)
        for (int kind = 0; list->set[i].count > 0 && kind < SITE_VARIANTS; kind++) {
            wall_case c;
            char title[300];
            if (!site_variant_make(&list->set[i].cases[0], (site_variant)kind, &c, err)) return false;
            (void)snprintf(title, sizeof title, "%s, %s: %s", list->set[i].title, c.name,
                           site_variant_name((site_variant)kind));
            const bool ok = add_case(b, &c, title, err);
            wall_case_free(&c);
            if (!ok) return false;
        }
    return true;
}

/* One side of a volume: as it is, and behind the occluders of the scene `real`. */
static bool add_view(book *b, const wall_case *whole, int view, hs_error *err) {
    wall_case turned = {0}, bare = {0}, occluded = {0};
    char title[200];
    bool ok = site_view_make(whole, view, SITE_FINE, &turned, err) &&
              site_bare_view_make(&turned, SITE_AS_IT_IS, &bare, err) &&
              add_case(b, &bare, turned.name, err) && site_occluded_make(&turned, &occluded, err);
    (void)snprintf(title, sizeof title, "%s behind occluders", turned.name);
    ok = ok && add_case(b, &occluded, title, err);
    wall_case_free(&turned);
    wall_case_free(&bare);
    wall_case_free(&occluded);
    return ok;
}

static bool add_volumes(book *b, hs_error *err) {
    static const int views[] = {0, 15, 30}; /* as it lies; from the side; from below */
    for (uint32_t i = 0; i < b->what->volume_count; i++) {
        wall_case whole;
        if (!wall_case_open(b->what->volumes[i], &whole, err)) return false;
        hs_page_heading(&b->page, 2, whole.name);
        bool ok = true;
        for (size_t k = 0; ok && k < sizeof views / sizeof *views; k++)
            ok = add_view(b, &whole, views[k], err);
        wall_case_free(&whole);
        if (!ok) return false;
    }
    return true;
}

static bool write_book(book *b, hs_error *err) {
    char path[PATH_MAX], text[400];
    if (!hs_path_make_folder(b->what->out, err) ||
        !hs_path_join(b->what->out, "index.html", path, sizeof path, err))
        return false;
    hs_page_open(&b->page, path, "SmartVis: surfaces");
    (void)snprintf(
        text, sizeof text,
        "Settings: %s. Error: mean over the labelled rays of the difference between their ends in the "
        "result and in the truth. Cut: fetus pixels that end more than 2 slices too deep. Left: labelled "
        "rays that end more than 2 slices too early.",
        b->what->settings);
    hs_page_text(&b->page, text);
    const bool drawn = add_sites(b, err) && add_variants(b, err) && add_volumes(b, err);
    hs_error closing = {0};
    const bool closed = hs_page_close(&b->page, &closing);
    if (drawn && !closed) return hs_fail(err, closing.code, "%s", closing.text);
    if (!drawn) (void)remove(path); /* half a page is none */
    return drawn;
}

/* The settings' texts, parted. */
static bool read_settings(const char *settings, const hs_plugin *plugin, hs_eval_values *out, hs_error *err) {
    char text[512], *rest = NULL;
    if (strlen(settings) >= sizeof text)
        return hs_fail(err, HS_ERR_USAGE, "'%.40s...': more than %zu characters", settings, sizeof text - 1);
    (void)strcpy(text, settings);
    for (const char *one = strtok_r(text, " ", &rest); one; one = strtok_r(NULL, " ", &rest))
        if (!hs_eval_values_parse(out, plugin, &one, 1, err)) return false;
    return true;
}

bool site_page_write(const site_page *what, hs_error *err) {
    book b = {.what = what};
    hs_cl cl = {0};
    hs_plugin plugin = {0};
    hs_eval_values values = {0};
    b.pen = (site_pen){&cl, &plugin, &values};
    const bool ok = hs_plugin_open(&plugin, what->plugin, NULL, SV_LOG_ERROR, err) &&
                    read_settings(what->settings, &plugin, &values, err) && hs_cl_open(&cl, err) &&
                    write_book(&b, err);
    if (plugin.instance) hs_plugin_close(&plugin);
    hs_cl_close(&cl);
    hs_picture_finish();
    if (ok) printf("The page is %s/index.html: %u cases\n", what->out, b.folders);
    return ok;
}
