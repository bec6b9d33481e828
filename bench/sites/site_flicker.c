/* SPDX-License-Identifier: MIT */
#include "sites/site_flicker.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { SCENES = 4, FRAMES = 20, SEED = 401 };
static const char *const scenes[SCENES] = {"E01", "E03", "M02", "D01"};
static const double goal = 0.5; /* slices a frame */

/* Ends of all rays in the frame before and in this one. */
typedef struct {
    float *ends[2];
    const uint8_t *label[2];
    size_t rays;
} pair;

/* Mean move of the rays that are labelled in both frames. */
static double move(const pair *p) {
    double sum = 0.0, count = 0.0;
    for (size_t i = 0; i < p->rays; i++) {
        if (p->label[0][i] == 0 || p->label[1][i] == 0) continue;
        sum += fabs((double)(p->ends[1][i] - p->ends[0][i]));
        count += 1.0;
    }
    return count > 0.0 ? sum / count : 0.0;
}

static double truth_moves(const site_set *frames) {
    double sum = 0.0;
    for (uint32_t n = 1; n < frames->count; n++) {
        const wall_case *a = &frames->cases[n - 1], *b = &frames->cases[n];
        const pair p = {{a->truth, b->truth}, {a->label, b->label}, (size_t)a->nx * a->ny};
        sum += 128.0 / a->nz * move(&p) / (frames->count - 1);
    }
    return sum;
}

/* Mean move of the rendered ends a frame. */
static bool result_moves(surf_session *s, const site_set *frames, double *out, hs_error *err) {
    const size_t rays = (size_t)frames->cases[0].nx * frames->cases[0].ny;
    float *ends = malloc(2 * rays * sizeof *ends);
    if (!ends) return hs_fail(err, HS_ERR_MEMORY, "flicker: no memory for %zu rays", rays);
    bool ok = true;
    *out = 0.0;
    for (uint32_t n = 0; ok && n < frames->count; n++) {
        const wall_case *c = &frames->cases[n];
        const surf_volume v = site_volume(c);
        memcpy(ends, ends + rays, rays * sizeof *ends);
        ok = surf_session_frame(s, &v, err);
        for (size_t i = 0; ok && i < rays; i++) ends[rays + i] = wall_end(c, c->full, i, s->depth[i]);
        if (!ok || n == 0) continue;
        const pair p = {{ends, ends + rays}, {frames->cases[n - 1].label, c->label}, rays};
        *out += 128.0 / c->nz * move(&p) / (frames->count - 1);
    }
    free(ends);
    return ok;
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
static bool judge(const site_set *frames, const char *plugin, const site_method *m, double *moves,
                  site_score *score, hs_error *err) {
    surf_session s;
    double q;
    if (!surf_session_open(&s, plugin, m->settings, err)) return false;
    const bool ok =
        site_judge(&s, frames, m->best_q, score, &q, NULL, err) && result_moves(&s, frames, moves, err);
    surf_session_close(&s);
    return ok;
}

/* Adds every method's flicker beyond the truth's to `sum`. */
static bool print_sequence(const site_set *frames, const char *name, const site_methods *methods,
                           double sum[SITE_MAX_METHODS], hs_error *err) {
    const double true_moves = truth_moves(frames);
    printf("  %s, %u frames: the truth moves by %.2f\n", name, frames->count, true_moves);
    for (uint32_t i = 0; i < methods->count; i++) {
        site_score score;
        double moves = 0.0;
        if (!judge(frames, methods->plugin, &methods->method[i], &moves, &score, err)) return false;
        printf("    %-28s %+5.2f   error %5.2f\n", methods->method[i].settings, moves - true_moves,
               site_score_mean(&score).error);
        sum[i] += moves - true_moves;
    }
    (void)fflush(stdout);
    return true;
}

/* The frames' rays must be the same. */
static bool print_files(const site_set *set, const site_methods *methods, hs_error *err) {
    double unused[SITE_MAX_METHODS] = {0};
    for (uint32_t n = 1; n < set->count; n++)
        if (set->cases[n].nx != set->cases[0].nx || set->cases[n].ny != set->cases[0].ny)
            return hs_fail(err, HS_ERR_INPUT, "%s: %u x %u rays, the first frame has %u x %u",
                           set->cases[n].name, set->cases[n].nx, set->cases[n].ny, set->cases[0].nx,
                           set->cases[0].ny);
    if (set->count < 2) return hs_fail(err, HS_ERR_USAGE, "flicker: a sequence of %u frame", set->count);
    return print_sequence(set, set->title, methods, unused, err);
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
    bool given = false, ok = true;
    for (uint32_t i = 0; ok && i < list->count; i++) {
        if (!site_is_files(&list->set[i])) continue;
        given = true;
        ok = print_files(&list->set[i], methods, err);
    }
    ok = ok && (given || print_scenes(methods, err));
    printf("\n");
    return ok;
}
