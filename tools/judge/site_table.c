/* SPDX-License-Identifier: MIT */
#include "judge/site_table.h"

#include <stdio.h>
#include <stdlib.h>

enum { QS = 31 };
static const double q_step = 0.05;

site_methods site_methods_default(const char *plugin) {
    return (site_methods){.plugin = plugin,
                          .method = {{"method=mean", true}, {"method=cost", false}, {"method=wall", false}},
                          .count = 3};
}

/* One frame, judged. */
static bool judge_case(surf_session *s, const wall_case *c, wall_calibration *calibration, wall_score *out,
                       hs_error *err) {
    const surf_volume v = site_volume(c);
    if (!surf_session_frame(s, &v, err) || !surf_session_confidence(s, NULL, err)) return false;
    *out = wall_judge(c, c->full, s->depth, s->confidence, calibration);
    return true;
}

static bool find_q(surf_session *s, const site_set *set, double *q, hs_error *err) {
    double least = 0.0;
    *q = -1.0;
    for (int i = 0; i < QS; i++) {
        wall_calibration unused = {0};
        double sum = 0.0;
        if (!surf_session_set(s, "q", q_step * i, err)) return false;
        for (uint32_t n = 0; n < set->count; n++) {
            wall_score score;
            if (!judge_case(s, &set->cases[n], &unused, &score, err)) return false;
            sum += score.error;
        }
        if (*q >= 0.0 && sum >= least) continue;
        least = sum;
        *q = q_step * i;
    }
    return surf_session_set(s, "q", *q, err);
}

bool site_judge(surf_session *s, const site_set *set, bool best_q, site_score *out, double *q,
                wall_score *each, hs_error *err) {
    *out = (site_score){0};
    *q = -1.0;
    if (best_q && !find_q(s, set, q, err)) return false;
    for (uint32_t n = 0; n < set->count; n++) {
        wall_score score;
        if (!judge_case(s, &set->cases[n], &out->calibration, &score, err)) return false;
        site_score_add(out, set->cases[n].name, &score);
        out->refused += !surf_session_clips(s);
        if (each) each[n] = score;
    }
    return true;
}

typedef struct {
    site_score score;
    bool sure;
    char name[96];
    wall_score each[SITE_MAX_CASES];
} row;

static bool fill_row(row *r, const site_set *set, const char *plugin, const site_method *m, hs_error *err) {
    surf_session s;
    double q;
    if (!surf_session_open(&s, plugin, m->settings, err)) return false;
    const bool ok = site_judge(&s, set, m->best_q, &r->score, &q, r->each, err);
    r->sure = s.sure;
    if (m->best_q)
        (void)snprintf(r->name, sizeof r->name, "%s, best q = %.2f", m->settings, q);
    else
        (void)snprintf(r->name, sizeof r->name, "%s", m->settings);
    surf_session_close(&s);
    return ok;
}

static void print_cases(const site_set *set, const row *rows, uint32_t count) {
    for (uint32_t n = 0; n < set->count; n++) {
        printf("    %-6s", set->cases[n].name);
        for (uint32_t i = 0; i < count; i++)
            printf("  %6.2f / %5.1f / %5.1f", rows[i].each[n].error, 100.0 * rows[i].each[n].cut,
                   100.0 * rows[i].each[n].left);
        printf("\n");
    }
}

static bool print_set(const site_set *set, const site_methods *methods, row *rows, hs_error *err) {
    printf("%s (%u cases)\n", set->title, set->count);
    for (uint32_t i = 0; i < methods->count; i++) {
        if (!fill_row(&rows[i], set, methods->plugin, &methods->method[i], err)) return false;
        printf("  %-28s ", rows[i].name);
        site_score_print(&rows[i].score, rows[i].sure);
        (void)fflush(stdout);
    }
    printf("  every case, in the order of the methods:\n");
    print_cases(set, rows, methods->count);
    for (uint32_t i = 0; i < methods->count; i++)
        if (rows[i].sure) site_score_print_calibration(rows[i].name, &rows[i].score.calibration);
    printf("\n");
    return true;
}

bool site_table(const site_list *list, const site_methods *methods, hs_error *err) {
    row *rows = calloc(SITE_MAX_METHODS, sizeof *rows);
    bool ok = rows || hs_fail(err, HS_ERR_MEMORY, "no memory for %d rows", SITE_MAX_METHODS);
    if (ok)
        printf("Error in slices of 128 / fetus pixels cut by more than 2 slices, %% / labelled rays with an "
               "occluder left, %%\n\n");
    for (uint32_t i = 0; ok && i < list->count; i++) ok = print_set(&list->set[i], methods, rows, err);
    free(rows);
    return ok;
}
