/* SPDX-License-Identifier: MIT */
/* The reverse protocol: the wall's constants chosen on all sites but one, judged on that one. A doubtful
 * surface is clipped here, so that a scan that is refused does not outweigh all others. */
#include "judge/judge.h"

#include "base/threads.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { VALUES = 5 };

/* Constants of docs/surface.md that matter, and values of the range of its ablations. */
static const struct {
    wall_constant constant;
    double value[VALUES];
} constants[] = {
    {WALL_CONSTANT(fetus_level), {0.0, 0.2, 0.4, 0.55, 0.7}},
    {WALL_CONSTANT(first_run_extra), {0.0, 0.4, 0.85, 1.2, 1.6}},
    {WALL_CONSTANT(dilation_mm), {1.9, 2.8, 3.75, 4.7, 5.6}},
    {WALL_CONSTANT(cut_cost), {11.0, 13.0, 15.0, 17.0, 19.0}},
    {WALL_CONSTANT(occluder_cost), {3.0, 4.0, 5.6, 6.8, 8.0}},
    {WALL_CONSTANT(sigma_mm), {1.5, 2.2, 3.0, 4.2, 6.0}},
    {WALL_CONSTANT(threshold), {0.55, 0.6, 0.65, 0.7, 0.75}},
    {WALL_CONSTANT(window_mm), {6.0, 8.0, 10.0, 12.0, 15.0}},
    {WALL_CONSTANT(dim), {0.3, 0.35, 0.4, 0.45, 0.5}},
    {WALL_CONSTANT(slope), {3.5, 4.2, 5.0, 6.0, 7.0}},
    {WALL_CONSTANT(average_margin), {0.1, 0.25, 0.5, 0.7, 1.0}},
};
enum { CONSTANTS = sizeof constants / sizeof *constants };

/* One evaluation: every case on its own, so cases run side by side. */
typedef struct {
    const site_set *set;
    const sv_wall_settings *settings;
    wall_score score[SITE_MAX_CASES];
    wall_calibration *calibration; /* of every case */
    bool ok[SITE_MAX_CASES];
} evaluation;

static void judge_block(void *context, uint32_t n) {
    evaluation *e = context;
    const wall_case *c = &e->set->cases[n];
    const size_t plane = (size_t)c->nx * c->ny;
    const sv_wall_volume v = wall_case_volume(c);
    float *depth = malloc(plane * sizeof *depth), *confidence = malloc(plane * sizeof *confidence);
    sv_wall_outcome outcome;
    e->calibration[n] = (wall_calibration){0};
    e->ok[n] = depth && confidence && sv_wall_surface(&v, e->settings, depth, confidence, &outcome, NULL);
    if (e->ok[n]) e->score[n] = wall_judge(c, c->full, depth, confidence, &e->calibration[n]);
    free(depth);
    free(confidence);
}

static bool evaluate(const site_set *set, const sv_wall_settings *settings, site_score *out, hs_error *err) {
    evaluation *e = calloc(1, sizeof *e);
    *out = (site_score){0};
    if (e) e->calibration = calloc(set->count, sizeof *e->calibration);
    bool ok = (e && e->calibration) || hs_fail(err, HS_ERR_MEMORY, "%s: no memory to judge", set->title);
    if (ok) {
        e->set = set;
        e->settings = settings;
        hs_parallel(hs_thread_count(0), set->count, judge_block, e);
    }
    for (uint32_t n = 0; ok && n < set->count; n++) {
        ok = e->ok[n] || hs_fail(err, HS_ERR_INPUT, "%s: the definition refuses it", set->cases[n].name);
        site_score_add(out, set->cases[n].name, &e->score[n]);
        wall_calibration_add(&out->calibration, &e->calibration[n]);
    }
    if (e) free(e->calibration);
    free(e);
    return ok;
}

static sv_wall_settings starting_point(void) {
    sv_wall_settings settings = sv_wall_settings_default();
    settings.clip_doubtful = true;
    return settings;
}

/* The sites of a command line, what the constants as they are come to on each of them, and the one that is
 * left out. */
typedef struct {
    const site_list *list;
    wall_score as_it_is[SITE_MAX_SETS];
    uint32_t left_out;
} protocol;

#define LEAST_SHARE 0.001 /* a site where next to nothing is cut or left shall not decide */

/* Mean of the three measures, each over what it is with the constants as they are. */
static double relative(const wall_score *now, const wall_score *as_it_is) {
    return (now->error / as_it_is->error + (now->cut + LEAST_SHARE) / (as_it_is->cut + LEAST_SHARE) +
            (now->left + LEAST_SHARE) / (as_it_is->left + LEAST_SHARE)) /
           3.0;
}

/* What the search makes least: the mean over all sites but the one that is left out. */
static bool objective(const protocol *p, const sv_wall_settings *settings, double *value, hs_error *err) {
    *value = 0.0;
    for (uint32_t i = 0; i < p->list->count; i++) {
        site_score score;
        if (i == p->left_out) continue;
        if (!evaluate(&p->list->set[i], settings, &score, err)) return false;
        const wall_score now = site_score_mean(&score);
        *value += relative(&now, &p->as_it_is[i]) / (p->list->count - 1);
    }
    return true;
}

static void put(sv_wall_settings *s, const int at[CONSTANTS]) {
    for (int i = 0; i < CONSTANTS; i++)
        *wall_constant_of(s, constants[i].constant) = constants[i].value[at[i]];
}

/* A settled answer of the search. */
typedef struct {
    sv_wall_settings settings;
    double objective, settled; /* of the best values found, and of the settings */
    uint32_t evaluations;
} choice;

/* What the settings come to. */
static bool try_settings(const protocol *p, choice *c, double *value, hs_error *err) {
    c->evaluations++;
    return objective(p, &c->settings, value, err);
}

/* Judges these values of the constants. */
static bool try_values(const protocol *p, const int at[CONSTANTS], choice *c, double *value, hs_error *err) {
    put(&c->settings, at);
    return try_settings(p, c, value, err);
}

/* Values that make the sites at most so much worse than the best one are as good: which of them is best there
 * is chance, and their mean is the choice. */
static const double as_good = 1.03;

/* One constant at a time, while the others keep the values that were found. */
static bool settle(const protocol *p, int at[CONSTANTS], choice *out, hs_error *err) {
    double chosen[CONSTANTS];
    for (int i = 0; i < CONSTANTS; i++) {
        const int found = at[i];
        double sum = constants[i].value[found], count = 1.0, value;
        for (int k = 0; k < VALUES; k++) {
            if (k == found) continue;
            at[i] = k;
            if (!try_values(p, at, out, &value, err)) return false;
            if (value > as_good * out->objective) continue;
            sum += constants[i].value[k];
            count += 1.0;
        }
        at[i] = found;
        chosen[i] = sum / count;
    }
    for (int i = 0; i < CONSTANTS; i++) *wall_constant_of(&out->settings, constants[i].constant) = chosen[i];
    return try_settings(p, out, &out->settled, err);
}

/* One constant at a time to its best value, until a round changes nothing; then to the middle of those that
 * are as good. */
static bool search(const protocol *p, int start, uint32_t rounds, choice *out, hs_error *err) {
    int at[CONSTANTS];
    for (int i = 0; i < CONSTANTS; i++) at[i] = start;
    *out = (choice){.settings = starting_point()};
    if (!try_values(p, at, out, &out->objective, err)) return false;
    bool moved = true;
    for (uint32_t round = 0; moved && round < rounds; round++) {
        moved = false;
        for (int i = 0; i < CONSTANTS; i++) {
            const int was = at[i];
            int best = was;
            for (int k = 0; k < VALUES; k++) {
                double value;
                if (k == was) continue;
                at[i] = k;
                if (!try_values(p, at, out, &value, err)) return false;
                if (value >= out->objective) continue;
                out->objective = value;
                best = k;
            }
            at[i] = best;
            moved = moved || best != was;
        }
    }
    return settle(p, at, out, err);
}

static bool print_on(const protocol *p, const sv_wall_settings *settings, hs_error *err) {
    for (uint32_t i = 0; i < p->list->count; i++) {
        site_score score;
        if (!evaluate(&p->list->set[i], settings, &score, err)) return false;
        printf("    on %-24.24s ", p->list->set[i].title);
        const wall_score m = site_score_mean(&score);
        printf("%5.2f / %5.2f / %5.2f  worst %5.2f %-4s  AUC %.3f  relative to as it is %.2f%s\n", m.error,
               100.0 * m.cut, 100.0 * m.left, score.worst, score.worst_name,
               wall_auc(&score.calibration, WALL_WRONG), relative(&m, &p->as_it_is[i]),
               i == p->left_out ? ", judged" : "");
    }
    return true;
}

static bool choose(const protocol *p, uint32_t rounds, hs_error *err) {
    choice answer[2];
    for (int i = 0; i < 2; i++)
        if (!search(p, i ? VALUES - 1 : 0, rounds, &answer[i], err)) return false;
    choice *best = &answer[answer[1].settled < answer[0].settled];
    printf("  chosen without %s (%u settings tried; from the lowest values %.3f, settled %.3f; "
           "from the highest %.3f, settled %.3f)\n   ",
           p->list->set[p->left_out].title, answer[0].evaluations + answer[1].evaluations,
           answer[0].objective, answer[0].settled, answer[1].objective, answer[1].settled);
    for (int i = 0; i < CONSTANTS; i++)
        printf(" %s %.3g", constants[i].constant.key,
               *wall_constant_of(&best->settings, constants[i].constant));
    printf("\n");
    (void)fflush(stdout);
    return print_on(p, &best->settings, err);
}

static bool find_as_it_is(protocol *p, hs_error *err) {
    const sv_wall_settings settings = starting_point();
    for (uint32_t i = 0; i < p->list->count; i++) {
        site_score score;
        if (!evaluate(&p->list->set[i], &settings, &score, err)) return false;
        p->as_it_is[i] = site_score_mean(&score);
        p->as_it_is[i].error = fmax(p->as_it_is[i].error, LEAST_SHARE);
    }
    return true;
}

bool site_reverse(const site_list *list, uint32_t rounds, hs_error *err) {
    protocol p = {.list = list, .left_out = list->count};
    const sv_wall_settings settings = starting_point();
    if (list->count < 2)
        return hs_fail(err, HS_ERR_USAGE, "reverse: two sites are needed, %u given", list->count);
    printf("Reverse protocol: constants of wall chosen on all sites but one; doubtful surfaces clip\n  as it "
           "is\n");
    if (!find_as_it_is(&p, err) || !print_on(&p, &settings, err)) return false;
    (void)fflush(stdout);
    for (p.left_out = 0; p.left_out < list->count; p.left_out++)
        if (!choose(&p, rounds, err)) return false;
    printf("\n");
    return true;
}
