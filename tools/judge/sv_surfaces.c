/* SPDX-License-Identifier: MIT */
/* sv_surfaces: how good a plugin's surfaces are on scenes, against their ground truth;
 * their flicker and their time. */
#include "judge/site_table.h"
#include "judge/surf_ablation.h"
#include "judge/surf_session.h"
#include "volume/metaimage.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

enum { N = 128, PIXELS = N * N, CASES = 9, QS = 31, FRAMES = 40 };
static const char *const names[CASES] = {"E01", "E02", "E03", "E04", "M01", "M02", "M03", "D01", "D02"};

/* clang-format off */
static const char help[] =
    "Usage: sv_surfaces [PLUGIN] [VOLUME.mha...]\n"
    "       sv_surfaces --ablation\n"
    "       sv_surfaces --site FOLDER | --case FULL,TRUTH,LABEL[,FIRST,END]...\n"
    "Judges the methods mean and cost on the nine scenes at 128^3, in sets of a seed and a pose: the ray\n"
    "termination error e_abs in slices, and the share of the fetus that is cut. 'mean' is at the q that is best\n"
    "for the whole set, 'cost' at its default. Sets 101 and 102 were used for tuning, the others were not. Then\n"
    "both in motion, their times at 128^3 and 171^3, and what cost says of the volumes that are given.\n"
    "--site, --case: these methods on volumes of other programs, as sv_sites table judges them.\n"
    "--ablation: what each part of the cost volume is worth, by its scalar definition.\n";
/* clang-format on */

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
        if (!surf_case_make(names[n], N, seed, pose, 0, &c, err)) return false;
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
        printf("  %s  mean %5.2f (cut %4.1f %%)  cost %5.2f (cut %4.1f %%)  truth %5.2f\n", names[n],
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

/* ---- time */

static double now_ms(void) {
    struct timespec t;
    (void)clock_gettime(CLOCK_MONOTONIC, &t);
    return 1e3 * (double)t.tv_sec + 1e-6 * (double)t.tv_nsec;
}

static int ascending(const void *a, const void *b) {
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

static bool print_times(const char *path, const char *method, uint32_t n, hs_error *err) {
    hs_scene_data scene;
    surf_session s = {0};
    if (!hs_scene_generate("E01", n, 1, &scene, err)) return false;
    bool ok = open_method(&s, path, method, err);
    const sv_ext_timing *stats = ok ? hs_plugin_timing(s.plugin.instance) : NULL;
    double ms[FRAMES];
    sv_stage_times t = {.size = sizeof t};
    for (int i = 0; ok && i < FRAMES; i++) {
        const double start = now_ms();
        ok = cube_frame(&s, scene.full.voxels, n, 0.5f, 0.0, err);
        ms[i] = now_ms() - start;
    }
    if (ok && stats && stats->enable(s.plugin.instance, 1) == SV_OK) {
        ok = cube_frame(&s, scene.full.voxels, n, 0.5f, 0.0, err);
        (void)stats->stage_times(s.plugin.instance, &t);
    }
    if (ok) {
        qsort(ms, FRAMES, sizeof *ms, ascending);
        printf("  %-5s %3u^3: %6.2f ms a frame (median of %d; least %.2f); once by stage: copy %.2f, profile "
               "%.2f, "
               "threshold %.2f, reconstruct %.2f, output %.2f\n",
               method, n, ms[FRAMES / 2], FRAMES, ms[0], t.transfer_ms, t.profile_ms, t.threshold_ms,
               t.reconstruct_ms, t.output_ms);
    }
    surf_session_close(&s);
    hs_scene_free(&scene);
    return ok;
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

static bool judge_all(const char *path, hs_error *err) {
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

/* Volumes of other programs. */
static bool judge_foreign(int argc, char **argv, hs_error *err) {
    site_list list = {0};
    site_methods methods = {
        .plugin = SURF_PLUGIN, .method = {{"method=mean", true}, {"method=cost", false}}, .count = 2};
    bool ok = argc > 2 || hs_fail(err, HS_ERR_USAGE, "%s: a value is missing", argv[1]);
    for (int i = 2; ok && i < argc; i++)
        ok = strcmp(argv[1], "--site") == 0 ? site_add_folder(&list, argv[i], err)
                                            : site_add_files(&list, argv[i], err);
    ok = ok && site_table(&list, &methods, err);
    site_free(&list);
    return ok;
}

int main(int argc, char **argv) {
    if (argc > 1 && strcmp(argv[1], "--help") == 0) {
        printf("%s", help);
        return HS_OK;
    }
    hs_error err = {0};
    if (argc > 1 && strcmp(argv[1], "--ablation") == 0) {
        if (surf_ablation(names, CASES, N, &err)) return HS_OK;
        fprintf(stderr, "sv_surfaces: %s\n", err.text);
        return (int)err.code;
    }
    if (argc > 1 && (strcmp(argv[1], "--site") == 0 || strcmp(argv[1], "--case") == 0)) {
        if (judge_foreign(argc, argv, &err)) return HS_OK;
        fprintf(stderr, "sv_surfaces: %s\n", err.text);
        return (int)err.code;
    }
    const char *path = argc > 1 ? argv[1] : SURF_PLUGIN;
    bool ok = judge_all(path, &err);
    if (ok) printf("Times\n");
    for (uint32_t n = 128; ok && n <= 171; n += 43)
        ok = print_times(path, "mean", n, &err) && print_times(path, "cost", n, &err);
    if (ok && argc > 2) printf("Volumes\n");
    for (int i = 2; ok && i < argc; i++) ok = print_volume(path, argv[i], &err);
    if (!ok) fprintf(stderr, "sv_surfaces: %s\n", err.text);
    return ok ? HS_OK : (int)err.code;
}
