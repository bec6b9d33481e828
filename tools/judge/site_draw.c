/* SPDX-License-Identifier: MIT */
#include "judge/site_draw.h"

#include "base/paths.h"
#include "loop/view.h"
#include "show/loop_pictures.h"
#include "show/picture_map.h"

#include <limits.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

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

bool site_draw(const site_pen *pen, const wall_case *c, const char *folder, site_drawn *out, hs_error *err) {
    hs_volume full = {0}, truth = {0};
    *out = (site_drawn){0};
    const bool ok = make_volume(c, c->full, &full, err) && make_volume(c, c->clean, &truth, err) &&
                    draw(pen, c, &full, &truth, folder, out, err);
    hs_volume_free(&full);
    hs_volume_free(&truth);
    return ok;
}
