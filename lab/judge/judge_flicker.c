/* SPDX-License-Identifier: MIT */
#include "judge/judge.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* ----------------------------------------------------------------------------------------------- moves -- */

/* Mean move of the rays' ends, which are those of the truth, or of a result. */
static double move(const wall_case *before, const wall_case *now, const float *end_before,
                   const float *end_now) {
    const size_t rays = (size_t)now->nx * now->ny;
    double sum = 0.0, count = 0.0;
    for (size_t i = 0; i < rays; i++) {
        if (before->label[i] == 0 || now->label[i] == 0) continue;
        sum += fabs((double)(end_now[i] - end_before[i]));
        count += 1.0;
    }
    return count > 0.0 ? 128.0 / now->nz * sum / count : 0.0;
}

static bool check(const wall_case *frames, uint32_t count, hs_error *err) {
    if (count < 2) return hs_fail(err, HS_ERR_USAGE, "flicker: a sequence of %u frame", count);
    for (uint32_t n = 1; n < count; n++)
        if (frames[n].nx != frames[0].nx || frames[n].ny != frames[0].ny)
            return hs_fail(err, HS_ERR_INPUT, "%s: %u x %u rays, the first frame has %u x %u", frames[n].name,
                           frames[n].nx, frames[n].ny, frames[0].nx, frames[0].ny);
    return true;
}

/* How far the ends of rays move from frame to frame, slices of 128; mean of all frames but the first. */
typedef struct {
    double result, truth;
} flicker;

static bool flicker_of(const site_set *frames, surf_session *s, flicker *out, hs_error *err) {
    *out = (flicker){0};
    if (!check(frames->cases, frames->count, err)) return false;
    const size_t rays = (size_t)frames->cases[0].nx * frames->cases[0].ny;
    float *const memory = malloc(2 * rays * sizeof *memory);
    float *const before = memory, *const now = memory + rays;
    if (!memory) return hs_fail(err, HS_ERR_MEMORY, "flicker: no memory for %zu rays", rays);
    bool ok = true;
    for (uint32_t n = 0; n < frames->count; n++) {
        const wall_case *c = &frames->cases[n];
        if (!(ok = surf_session_frame(s, c, err))) break;
        for (size_t i = 0; i < rays; i++) now[i] = wall_ray_end(c, c->full, i, s->depth[i]);
        if (n > 0) {
            out->result += move(c - 1, c, before, now) / (frames->count - 1);
            out->truth += move(c - 1, c, c[-1].truth, c->truth) / (frames->count - 1);
        }
        memcpy(before, now, rays * sizeof *now);
    }
    free(memory);
    return ok;
}

/* ------------------------------------------------------------------------------------------- sequences -- */

enum { SCENES = 4, FRAMES = 20, SEED = 401 };
static const char *const scenes[SCENES] = {"E01", "E03", "M02", "D01"};
static const double goal = 0.5; /* slices a frame */

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
static bool judge(const site_set *frames, const char *plugin, const site_method *m, flicker *moves,
                  site_score *score, hs_error *err) {
    surf_session s;
    double q;
    if (!surf_session_open(&s, plugin, m->settings, err)) return false;
    const bool ok =
        site_judge(&s, frames, m->best_q, score, &q, NULL, err) && flicker_of(frames, &s, moves, err);
    surf_session_close(&s);
    return ok;
}

/* Adds every method's flicker beyond the truth's to `sum`. */
static bool print_sequence(const site_set *frames, const char *name, const site_methods *methods,
                           double sum[SITE_MAX_METHODS], hs_error *err) {
    for (uint32_t i = 0; i < methods->count; i++) {
        site_score score;
        flicker f;
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
