/* SPDX-License-Identifier: MIT */
#include "judge/site_flicker.h"

#include "judge/wall_flicker.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { SCENES = 4, FRAMES = 20, SEED = 401 };
static const char *const scenes[SCENES] = {"E01", "E03", "M02", "D01"};
static const double goal = 0.5; /* slices a frame */

/* As wall_flicker_of asks for it; user: an open session. */
static bool depth_of(void *user, const wall_case *c, float *depth, hs_error *err) {
    surf_session *s = user;
    const surf_volume v = site_volume(c);
    if (!surf_session_frame(s, &v, err)) return false;
    memcpy(depth, s->depth, (size_t)c->nx * c->ny * sizeof *depth);
    return true;
}

static bool make_frames(const char *scene, site_set *out, hs_error *err) {
    *out = (site_set){.cases = calloc(FRAMES, sizeof *out->cases)};
    if (!out->cases) return hs_fail(err, HS_ERR_MEMORY, "%s: no memory for %d frames", scene, FRAMES);
    for (uint32_t n = 0; n < FRAMES; n++) {
        if (!wall_case_make(scene, SEED, 0, n, &out->cases[n], err)) return false;
        out->count++;
    }
    return true;
}

static void free_frames(site_set *frames) {
    for (uint32_t n = 0; n < frames->count; n++) wall_case_free(&frames->cases[n]);
    free(frames->cases);
}

/* The flicker and the error of one method. */
static bool judge(const site_set *frames, const char *plugin, const site_method *m, wall_flicker *flicker,
                  site_score *score, hs_error *err) {
    surf_session s;
    double q;
    if (!surf_session_open(&s, plugin, m->settings, err)) return false;
    const bool ok = site_judge(&s, frames, m->best_q, score, &q, NULL, err) &&
                    wall_flicker_of(frames->cases, frames->count, depth_of, &s, flicker, err);
    surf_session_close(&s);
    return ok;
}

/* Adds every method's flicker beyond the truth's to `sum`. */
static bool print_sequence(const site_set *frames, const char *name, const site_methods *methods,
                           double sum[SITE_MAX_METHODS], hs_error *err) {
    for (uint32_t i = 0; i < methods->count; i++) {
        site_score score;
        wall_flicker f;
        if (!judge(frames, methods->plugin, &methods->method[i], &f, &score, err)) return false;
        if (i == 0) printf("  %s, %u frames: the truth moves by %.2f\n", name, frames->count, f.truth);
        printf("    %-28s %+5.2f   error %5.2f\n", methods->method[i].settings, f.result - f.truth,
               site_score_mean(&score).error);
        sum[i] += f.result - f.truth;
    }
    (void)fflush(stdout);
    return true;
}

static bool print_scenes(const site_methods *methods, hs_error *err) {
    double sum[SITE_MAX_METHODS] = {0};
    for (int k = 0; k < SCENES; k++) {
        site_set frames;
        const bool ok =
            make_frames(scenes[k], &frames, err) && print_sequence(&frames, scenes[k], methods, sum, err);
        free_frames(&frames);
        if (!ok) return false;
    }
    for (uint32_t i = 0; i < methods->count; i++)
        printf("  mean of %d: %-28s %+5.2f%s\n", SCENES, methods->method[i].settings, sum[i] / SCENES,
               sum[i] <= goal * SCENES ? "" : "  above the goal");
    return true;
}

bool site_flicker(const site_list *list, const site_methods *methods, hs_error *err) {
    printf("Flicker: move of the rendered ends from frame to frame beyond the truth's, slices of 128 (goal "
           "%.1f); error\n",
           goal);
    double sum[SITE_MAX_METHODS] = {0};
    bool given = false, ok = true;
    for (uint32_t i = 0; ok && i < list->count; i++) {
        if (!site_is_files(&list->set[i])) continue;
        given = true;
        ok = print_sequence(&list->set[i], list->set[i].title, methods, sum, err);
    }
    ok = ok && (given || print_scenes(methods, err));
    printf("\n");
    return ok;
}
