/* SPDX-License-Identifier: MIT */
/* The reverse protocol: the wall's constants chosen on one site alone, judged on the others. */
#include "judge/judge.h"

#include "base/threads.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { VALUES = 5 };

/* What docs/negative_results.md says matters, and values of the range that it shows there. */
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
    {WALL_CONSTANT(wall_rank), {0.3, 0.4, 0.5, 0.6, 0.7}},
    {WALL_CONSTANT(median_mm), {2.0, 3.5, 5.0, 6.5, 8.0}},
    {WALL_CONSTANT(average_margin), {0.1, 0.25, 0.5, 0.7, 1.0}},
};
enum { CONSTANTS = sizeof constants / sizeof *constants };

/* The bounds that a known site is held to. */
static const wall_score bounds = {0.7, 0.015, 0.02};

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
        for (int i = 0; i < WALL_BINS; i++) {
            out->calibration.right[i] += e->calibration[n].right[i];
            out->calibration.wrong[i] += e->calibration[n].wrong[i];
        }
    }
    if (e) free(e->calibration);
    free(e);
    return ok;
}

/* What the search makes least: the three measures, each over its bound. */
static double objective(const site_score *s) {
    const wall_score m = site_score_mean(s);
    return m.error / bounds.error + m.cut / bounds.cut + m.left / bounds.left;
}

/* The largest of the three over their bounds. */
static double largest(const site_score *s) {
    const wall_score m = site_score_mean(s);
    return fmax(m.error / bounds.error, fmax(m.cut / bounds.cut, m.left / bounds.left));
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
static bool try_settings(const site_set *set, choice *c, double *value, hs_error *err) {
    site_score score;
    if (!evaluate(set, &c->settings, &score, err)) return false;
    c->evaluations++;
    *value = objective(&score);
    return true;
}

/* Judges these values of the constants. */
static bool try_values(const site_set *set, const int at[CONSTANTS], choice *c, double *value,
                       hs_error *err) {
    put(&c->settings, at);
    return try_settings(set, c, value, err);
}

/* Values that make a site at most so much worse than the best one are as good: which of them is best there is
 * chance, and their mean is the choice. */
static const double as_good = 1.03;

/* One constant at a time, while the others keep the values that were found. */
static bool settle(const site_set *set, int at[CONSTANTS], choice *out, hs_error *err) {
    double chosen[CONSTANTS];
    for (int i = 0; i < CONSTANTS; i++) {
        const int found = at[i];
        double sum = constants[i].value[found], count = 1.0, value;
        for (int k = 0; k < VALUES; k++) {
            if (k == found) continue;
            at[i] = k;
            if (!try_values(set, at, out, &value, err)) return false;
            if (value > as_good * out->objective) continue;
            sum += constants[i].value[k];
            count += 1.0;
        }
        at[i] = found;
        chosen[i] = sum / count;
    }
    for (int i = 0; i < CONSTANTS; i++) *wall_constant_of(&out->settings, constants[i].constant) = chosen[i];
    return try_settings(set, out, &out->settled, err);
}

/* One constant at a time to its best value, until a round changes nothing; then to the middle of those that
 * are as good. */
static bool search(const site_set *set, int start, uint32_t rounds, choice *out, hs_error *err) {
    int at[CONSTANTS];
    for (int i = 0; i < CONSTANTS; i++) at[i] = start;
    *out = (choice){.settings = sv_wall_settings_default()};
    if (!try_values(set, at, out, &out->objective, err)) return false;
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
                if (!try_values(set, at, out, &value, err)) return false;
                if (value >= out->objective) continue;
                out->objective = value;
                best = k;
            }
            at[i] = best;
            moved = moved || best != was;
        }
    }
    return settle(set, at, out, err);
}

static bool print_on(const site_list *list, const sv_wall_settings *settings, hs_error *err) {
    for (uint32_t i = 0; i < list->count; i++) {
        site_score score;
        if (!evaluate(&list->set[i], settings, &score, err)) return false;
        printf("    on %-24.24s ", list->set[i].title);
        const wall_score m = site_score_mean(&score);
        printf(
            "%5.2f / %5.2f / %5.2f  worst %5.2f %-4s  AUC %.3f  largest ratio to %.1f / %.1f / %.0f: %.2f\n",
            m.error, 100.0 * m.cut, 100.0 * m.left, score.worst, score.worst_name,
            wall_auc(&score.calibration), bounds.error, 100.0 * bounds.cut, 100.0 * bounds.left,
            largest(&score));
    }
    return true;
}

static bool choose(const site_list *list, uint32_t index, uint32_t rounds, hs_error *err) {
    choice answer[2];
    for (int i = 0; i < 2; i++)
        if (!search(&list->set[index], i ? VALUES - 1 : 0, rounds, &answer[i], err)) return false;
    choice *best = &answer[answer[1].settled < answer[0].settled];
    printf("  chosen on %s alone (%u settings tried; from the lowest values %.3f, settled %.3f; "
           "from the highest %.3f, settled %.3f)\n   ",
           list->set[index].title, answer[0].evaluations + answer[1].evaluations, answer[0].objective,
           answer[0].settled, answer[1].objective, answer[1].settled);
    for (int i = 0; i < CONSTANTS; i++)
        printf(" %s %.3g", constants[i].constant.key,
               *wall_constant_of(&best->settings, constants[i].constant));
    printf("\n");
    (void)fflush(stdout);
    return print_on(list, &best->settings, err);
}

bool site_reverse(const site_list *list, uint32_t rounds, hs_error *err) {
    if (list->count < 2)
        return hs_fail(err, HS_ERR_USAGE, "reverse: two sites are needed, %u given", list->count);
    const sv_wall_settings settled = sv_wall_settings_default();
    printf("Reverse protocol: constants of wall chosen on one site alone\n  as it is\n");
    if (!print_on(list, &settled, err)) return false;
    (void)fflush(stdout);
    for (uint32_t i = 0; i < list->count; i++)
        if (!choose(list, i, rounds, err)) return false;
    printf("\n");
    return true;
}
