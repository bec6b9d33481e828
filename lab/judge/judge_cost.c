/* SPDX-License-Identifier: MIT */
#include "judge/judge.h"

#include "ref/ref_cost.h"
#include "volume/metaimage.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

enum { N = 128, PIXELS = N * N, CASES = SITE_NAMES };

/* -------------------------------------------------------------------------------------------- ablation -- */
/* What each part of the cost volume is worth: the scalar definition with one thing changed at a time. */

/* One thing changed. Numbers are factors; 0 in `gain` is 1. */
static const struct {
    const char *what;
    enum {
        NOTHING,
        CUT,
        OCCLUDER,
        WRONG_FLUID,
        THICK,
        BEHIND,
        TAU,
        SIGMA,
        AVERAGE_MARGIN,
        SHIFT,
        SPLIT,
        CONTACT,
        MEDIAN
    } part;
    double factor;
    int level;   /* T_L; 0: from the histogram */
    double gain; /* of the grey levels */
} changes[] = {
    {"as it is", NOTHING, 1, 0, 0},
    {"cutting costs half", CUT, 0.5, 0, 0},
    {"cutting costs twice", CUT, 2, 0, 0},
    {"leaving occluders costs nothing", OCCLUDER, 0, 0, 0},
    {"leaving occluders costs twice", OCCLUDER, 2, 0, 0},
    {"no term for the longest interval", WRONG_FLUID, 0, 0, 0},
    {"thickness is no evidence", THICK, 0, 0, 0},
    {"no doubt by runs farther back", BEHIND, 0, 0, 0},
    {"runs are not parted at bone", SPLIT, 0, 0, 0},
    {"what touches the wall is part of it", CONTACT, 0, 0, 0},
    {"fluid four times as near (tau / 4)", TAU, 0.25, 0, 0},
    {"fluid twice as far (tau x 2)", TAU, 2, 0, 0},
    {"lateral Gaussian x 0.7", SIGMA, 0.7, 0, 0},
    {"lateral Gaussian x 1.4", SIGMA, 1.4, 0, 0},
    {"no median", MEDIAN, 0, 0, 0},
    {"sharper minimum (slack / 4)", AVERAGE_MARGIN, 0.25, 0, 0},
    {"no yielding where unsure", SHIFT, 0, 0, 0},
    {"yielding three times as much", SHIFT, 3, 0, 0},
    {"T_L fixed at 25", NOTHING, 1, 25, 0},
    {"T_L fixed at 40", NOTHING, 1, 40, 0},
    {"T_L fixed at 60", NOTHING, 1, 60, 0},
    {"gain 0.7, T_L found", NOTHING, 1, 0, 0.7},
    {"gain 1.4, T_L found", NOTHING, 1, 0, 1.4},
    {"gain 1.4, T_L fixed at 40", NOTHING, 1, 40, 1.4},
};
enum { CHANGES = sizeof changes / sizeof *changes };

static sv_ref_cost_layout changed_layout(uint32_t n, int i) {
    sv_ref_cost_layout l = sv_ref_cost_layout_of(n, n, n, 0.0f);
    double *const parts[] = {
        [CUT] = &l.cut_cost, [OCCLUDER] = &l.occluder_cost,        [WRONG_FLUID] = &l.wrong_fluid_cost,
        [THICK] = &l.thick,  [BEHIND] = &l.behind_penalty,         [TAU] = &l.tau,
        [SIGMA] = &l.sigma,  [AVERAGE_MARGIN] = &l.average_margin, [SHIFT] = &l.viewer_shift};
    switch (changes[i].part) {
    case NOTHING:
        break;
    case SPLIT:
        l.bone_splits = false;
        break;
    case CONTACT:
        l.sizes.contact = l.sizes.labels;
        break;
    case MEDIAN:
        l.median = false;
        break;
    default:
        *parts[changes[i].part] *= changes[i].factor;
    }
    l.level = changes[i].level;
    return l;
}

/* Grey levels times `gain`; what was scanned stays scanned. */
static void amplify(const uint8_t *from, size_t count, double gain, uint8_t *to) {
    for (size_t i = 0; i < count; i++) {
        const double value = from[i] * gain + 0.5;
        to[i] = from[i] == 0 ? 0 : value < 1.0 ? 1 : value > 255.0 ? 255 : (uint8_t)value;
    }
}

static bool score(const surf_case *c, int i, uint8_t *voxels, double *maps, float *depth, surf_score *out,
                  hs_error *err) {
    const size_t pixels = (size_t)c->n * c->n;
    const sv_ref_cost_layout l = changed_layout(c->n, i);
    amplify(c->voxels, pixels * c->n, changes[i].gain > 0.0 ? changes[i].gain : 1.0, voxels);
    const sv_ref_volume v = {voxels, c->n, c->n, c->n, 0, NULL};
    if (!sv_ref_cost_surface_with(&v, &l, maps, maps + pixels, maps + 2 * pixels, NULL, NULL))
        return hs_fail(err, HS_ERR_MEMORY, "no memory for the cost volume");
    for (size_t p = 0; p < pixels; p++) depth[p] = (float)(0.5 * (maps[p] + maps[pixels + p]));
    *out = surf_judge(c, depth);
    return true;
}

/* Prints the mean e_abs and cut share over the nine cases of a tuned and of an
 * untuned set for every change. */
bool judge_ablation(judge_request *r, hs_error *err) {
    (void)r;
    static const uint32_t sets[2][2] = {{101, 0}, {402, 31}}; /* seed, pose */
    surf_score sums[2][CHANGES] = {{{0}}};
    const size_t pixels = (size_t)N * N;
    uint8_t *voxels = malloc(pixels * N);
    double *maps = malloc(3 * pixels * sizeof *maps);
    float *depth = malloc(pixels * sizeof *depth);
    bool ok = (voxels && maps && depth) || hs_fail(err, HS_ERR_MEMORY, "no memory for %u^3 voxels", N);
    for (int set = 0; set < 2; set++)
        for (uint32_t k = 0; ok && k < CASES; k++) {
            surf_case c;
            ok = surf_case_make(site_names[k], N, sets[set][0], sets[set][1], 0, &c, err);
            for (int i = 0; ok && i < CHANGES; i++) {
                surf_score s = {0};
                ok = score(&c, i, voxels, maps, depth, &s, err);
                sums[set][i].error += s.error / CASES;
                sums[set][i].cut += s.cut / CASES;
            }
            if (ok) surf_case_free(&c);
        }
    if (ok) printf("One thing changed at a time (scalar definition): tuned set 101/0, untuned set 402/31\n");
    for (int i = 0; ok && i < CHANGES; i++)
        printf("  %-36s %5.2f (cut %4.1f %%)   %5.2f (cut %4.1f %%)\n", changes[i].what, sums[0][i].error,
               100.0 * sums[0][i].cut, sums[1][i].error, 100.0 * sums[1][i].cut);
    free(depth);
    free(maps);
    free(voxels);
    return ok;
}

/* ------------------------------------------------------------------------------------------------ sets -- */
/* Methods mean and cost on scenes, against their ground truth, and how calm they are. */

enum { QS = 31 };

static bool open_method(surf_session *s, const char *path, const char *method, hs_error *err) {
    char text[64];
    (void)snprintf(text, sizeof text, "method=%s", method);
    return surf_session_open(s, path, text, err);
}

/* A cube of n^3 voxels, whose zeros were not scanned. */
static bool cube_frame(surf_session *s, const uint8_t *voxels, uint32_t n, float q, double memory,
                       hs_error *err) {
    const surf_volume v = {.voxels = voxels, .width = n, .height = n, .slices = n};
    return surf_session_set(s, "q", (double)q, err) && surf_session_set(s, "memory", memory, err) &&
           surf_session_frame(s, &v, err);
}

/* ---- the table */

typedef struct {
    surf_score mean[QS], cost, truth;
} case_scores;

static bool score_case(surf_session *mean, surf_session *cost, const surf_case *c, case_scores *out,
                       hs_error *err) {
    for (int i = 0; i < QS; i++) {
        if (!cube_frame(mean, c->voxels, N, 0.05f * (float)i, 0.0, err)) return false;
        out->mean[i] = surf_judge(c, mean->depth);
    }
    if (!cube_frame(cost, c->voxels, N, 0.5f, 0.0, err)) return false;
    out->cost = surf_judge(c, cost->depth);
    for (size_t y = 0; y < N; y++)
        for (size_t x = 0; x < N; x++)
            mean->depth[y * N + x] = (c->fine.clip[2 * y * 2 * N + 2 * x] + 0.5f) / 2.0f - 0.5f;
    out->truth = surf_judge(c, mean->depth);
    return true;
}

/* Sums over sets of their means over the cases. */
typedef struct {
    int sets;
    double mean, cost, mean_cut, cost_cut;
} totals;

static bool score_set(surf_session *mean, surf_session *cost, uint64_t seed, uint32_t pose, bool tuned,
                      totals *sum, hs_error *err) {
    case_scores scores[CASES];
    double at_q[QS] = {0};
    for (int n = 0; n < CASES; n++) {
        surf_case c;
        if (!surf_case_make(site_names[n], N, seed, pose, 0, &c, err)) return false;
        const bool ok = score_case(mean, cost, &c, &scores[n], err);
        surf_case_free(&c);
        if (!ok) return false;
        for (int i = 0; i < QS; i++) at_q[i] += scores[n].mean[i].error / CASES;
    }
    int best = 0;
    for (int i = 1; i < QS; i++)
        if (at_q[i] < at_q[best]) best = i;
    printf("seed %llu, pose %u (%s); mean filter at q = %.2f\n", (unsigned long long)seed, pose,
           tuned ? "tuned on" : "not tuned on", 0.05 * best);
    double cost_error = 0.0, cost_cut = 0.0, mean_cut = 0.0, floor_error = 0.0;
    for (int n = 0; n < CASES; n++) {
        const case_scores *s = &scores[n];
        printf("  %s  mean %5.2f (cut %4.1f %%)  cost %5.2f (cut %4.1f %%)  truth %5.2f\n", site_names[n],
               s->mean[best].error, 100.0 * s->mean[best].cut, s->cost.error, 100.0 * s->cost.cut,
               s->truth.error);
        cost_error += s->cost.error / CASES;
        cost_cut += s->cost.cut / CASES;
        mean_cut += s->mean[best].cut / CASES;
        floor_error += s->truth.error / CASES;
    }
    printf("  all  mean %5.2f (cut %4.1f %%)  cost %5.2f (cut %4.1f %%)  truth %5.2f  ratio %.2f\n\n",
           at_q[best], 100.0 * mean_cut, cost_error, 100.0 * cost_cut, floor_error, cost_error / at_q[best]);
    if (tuned) return true;
    sum->sets++;
    sum->mean += at_q[best];
    sum->cost += cost_error;
    sum->mean_cut += mean_cut;
    sum->cost_cut += cost_cut;
    return true;
}

/* ---- in motion */

enum { STILL = 8, MOVING = 8 };

/* One unmoved scene with other speckle in every frame: mean absolute change of the
 * map over the fetus and the sac. */
static bool flicker(surf_session *s, const char *scene, float q, double memory, double *change,
                    hs_error *err) {
    static float before[PIXELS];
    uint32_t counted = 0;
    *change = 0.0;
    for (uint32_t n = 0; n < STILL; n++) {
        surf_case c;
        if (!surf_case_make(scene, N, 301 + n, 0, 0, &c, err)) return false;
        const bool ok = cube_frame(s, c.voxels, N, q, memory, err);
        for (uint32_t i = 0; ok && n > 0 && i < PIXELS; i++) {
            const size_t fine =
                (size_t)(i / N) * SURF_FINE_PER_VOXEL * c.fine.full.nx + i % N * SURF_FINE_PER_VOXEL;
            if (c.fine.label[fine] == HS_LABEL_NEITHER) continue;
            *change += fabs((double)(s->depth[i] - before[i]));
            counted++;
        }
        surf_case_free(&c);
        if (!ok) return false;
        memcpy(before, s->depth, sizeof before);
    }
    *change /= counted ? counted : 1;
    return true;
}

/* A scene that moves, five frames of its motion at a time: mean e_abs. What memory adds to it is its lag. */
static bool moving(surf_session *s, const char *scene, double memory, double *error, hs_error *err) {
    *error = 0.0;
    for (uint32_t n = 0; n < MOVING; n++) {
        surf_case c;
        if (!surf_case_make(scene, N, 401, 0, 5 * n, &c, err)) return false;
        const bool ok = cube_frame(s, c.voxels, N, 0.5f, memory, err);
        if (ok) *error += surf_judge(&c, s->depth).error / MOVING;
        surf_case_free(&c);
        if (!ok) return false;
    }
    return true;
}

/* Adds up the maps of `count` frames of a scene that stands at `at` of its motion. */
static bool add_maps(surf_session *s, const char *scene, uint64_t seed, uint32_t at, int count, double memory,
                     double *sum, hs_error *err) {
    for (int n = 0; n < count; n++) {
        surf_case c;
        if (!surf_case_make(scene, N, seed + (uint64_t)n, 0, at, &c, err)) return false;
        const bool ok = cube_frame(s, c.voxels, N, 0.5f, memory, err);
        surf_case_free(&c);
        if (!ok) return false;
        for (int i = 0; sum && i < PIXELS; i++) sum[i] += (double)s->depth[i] / count;
    }
    return true;
}

enum { JUMP = 15, STEPS = 4 };

/* A scene that stands still, jumps on by JUMP frames of its motion and stands still again: how much of its
 * way the surface has gone in each of the frames after that. 1: no lag. */
static bool lag(surf_session *s, const char *scene, double memory, double share[STEPS], hs_error *err) {
    static double from[PIXELS], to[PIXELS], now[PIXELS];
    memset(from, 0, sizeof from);
    memset(to, 0, sizeof to);
    if (!add_maps(s, scene, 501, 0, 6, 0.0, from, err) || !add_maps(s, scene, 511, JUMP, 6, 0.0, to, err) ||
        !add_maps(s, scene, 521, 0, 6, memory, NULL, err))
        return false;
    for (int n = 0; n < STEPS; n++) {
        memset(now, 0, sizeof now);
        if (!add_maps(s, scene, 531 + (uint64_t)n, JUMP, 1, memory, now, err)) return false;
        double gone = 0.0, way = 0.0;
        for (int i = 0; i < PIXELS; i++) {
            gone += (now[i] - from[i]) * (to[i] - from[i]);
            way += (to[i] - from[i]) * (to[i] - from[i]);
        }
        share[n] = way > 0.0 ? gone / way : 1.0;
    }
    return true;
}

static bool print_motion(surf_session *mean, surf_session *cost, hs_error *err) {
    static const char *const scenes[] = {"E01", "E03", "M02", "D01"};
    printf(
        "In motion: mean change of the map from one speckle to the next, slices (mean at q = 0.40); e_abs of "
        "a moving\n"
        "scene; share of its way that the surface has gone 1 .. 4 frames after a jump, with memory 0.75\n");
    for (size_t i = 0; i < sizeof scenes / sizeof *scenes; i++) {
        double by_mean, by_cost, by_memory, without, with, share[STEPS];
        const char *name = scenes[i];
        const bool ok =
            flicker(mean, name, 0.4f, 0.0, &by_mean, err) && flicker(cost, name, 0.5f, 0.0, &by_cost, err) &&
            flicker(cost, name, 0.5f, 0.75, &by_memory, err) && moving(cost, name, 0.0, &without, err) &&
            moving(cost, name, 0.75, &with, err) && lag(cost, name, 0.75, share, err);
        if (!ok) return false;
        printf("  %s  still: mean %.2f, cost %.2f, with memory %.2f;  moving: cost %.2f, with memory %.2f;  "
               "gone: %.2f %.2f %.2f %.2f\n",
               name, by_mean, by_cost, by_memory, without, with, share[0], share[1], share[2], share[3]);
    }
    return true;
}

/* ---- volumes from files */

static bool print_volume(const char *path, const char *file, hs_error *err) {
    hs_volume v;
    if (!hs_metaimage_read(file, NULL, &v, err)) return false;
    surf_session s = {0};
    sv_confidence_report r = {.size = sizeof r};
    const surf_volume volume = {.voxels = v.voxels, .width = v.nx, .height = v.ny, .slices = v.nz};
    const bool ok = open_method(&s, path, "cost", err) && surf_session_frame(&s, &volume, err) &&
                    surf_session_confidence(&s, &r, err);
    if (ok) {
        double depth = 0.0, sure = 0.0;
        for (size_t i = 0; i < (size_t)v.nx * v.ny; i++) {
            depth += (double)s.depth[i] / ((double)v.nx * v.ny);
            sure += (double)s.confidence[i] / ((double)v.nx * v.ny);
        }
        printf("  %s: outcome %d, T_L %.0f, %u of %u rays with fluid, mean depth %.1f of %u slices, "
               "confidence %.2f\n",
               v.name, s.stats.outcome, 255.0 * (double)r.fluid_threshold, r.open_rays, r.rays, depth, v.nz,
               sure);
    }
    surf_session_close(&s);
    hs_volume_free(&v);
    return ok;
}

static bool judge_sets(const char *path, hs_error *err) {
    static const struct {
        uint64_t seed;
        uint32_t pose;
        bool tuned;
    } sets[] = {{101, 0, true},   {102, 1, true},   {201, 0, false},  {202, 11, false},
                {203, 12, false}, {301, 0, false},  {302, 21, false}, {303, 22, false},
                {401, 0, false},  {402, 31, false}, {403, 32, false}};
    surf_session mean = {0}, cost = {0};
    totals sum = {0};
    bool ok = open_method(&mean, path, "mean", err) && open_method(&cost, path, "cost", err);
    for (size_t i = 0; ok && i < sizeof sets / sizeof *sets; i++)
        ok = score_set(&mean, &cost, sets[i].seed, sets[i].pose, sets[i].tuned, &sum, err);
    if (ok)
        printf("The %d sets not tuned on: mean %.2f (cut %.1f %%)  cost %.2f (cut %.1f %%)  ratio %.2f\n\n",
               sum.sets, sum.mean / sum.sets, 100.0 * sum.mean_cut / sum.sets, sum.cost / sum.sets,
               100.0 * sum.cost_cut / sum.sets, sum.cost / sum.mean);
    ok = ok && print_motion(&mean, &cost, err);
    surf_session_close(&mean);
    surf_session_close(&cost);
    return ok;
}

bool judge_cost(judge_request *r, hs_error *err) {
    bool ok = r->volume_count > 0 || judge_sets(r->methods.plugin, err);
    for (uint32_t i = 0; ok && i < r->volume_count; i++)
        ok = print_volume(r->methods.plugin, r->volumes[i], err);
    return ok;
}
