/* SPDX-License-Identifier: MIT */
#include "judge/judge.h"

#include <glob.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* ----------------------------------------------------------------------------------------------- sites -- */

const char *const site_names[SITE_NAMES] = {"E01", "E02", "E03", "E04", "M01", "M02", "M03", "D01", "D02"};

static site_set *new_set(site_list *list, const char *title, hs_error *err) {
    if (list->count == SITE_MAX_SETS) {
        (void)hs_fail(err, HS_ERR_USAGE, "more than %d sites", SITE_MAX_SETS);
        return NULL;
    }
    site_set *s = &list->set[list->count];
    *s = (site_set){.cases = calloc(SITE_MAX_CASES, sizeof *s->cases)};
    (void)snprintf(s->title, sizeof s->title, "%s", title);
    if (s->cases) {
        list->count++;
        return s;
    }
    (void)hs_fail(err, HS_ERR_MEMORY, "no memory for %d cases", SITE_MAX_CASES);
    return NULL;
}

/* The set whose title begins like that; made if there is none. */
static site_set *set_of(site_list *list, const char *title, hs_error *err) {
    for (uint32_t i = 0; i < list->count; i++)
        if (strncmp(list->set[i].title, title, strlen(title)) == 0) return &list->set[i];
    return new_set(list, title, err);
}

static wall_case *new_case(site_set *s, hs_error *err) {
    if (s->count < SITE_MAX_CASES) return &s->cases[s->count];
    (void)hs_fail(err, HS_ERR_USAGE, "%s: more than %d cases", s->title, SITE_MAX_CASES);
    return NULL;
}

/* Says in the title what was added. */
static void name_part(site_set *s, const char *text) {
    const size_t used = strlen(s->title);
    (void)snprintf(s->title + used, sizeof s->title - used, " %s", text);
}

static bool add_file(site_set *s, const char *folder, const char *full, hs_error *err) {
    char name[256];
    const char *const file = strrchr(full, '/') + 1;
    (void)snprintf(name, sizeof name, "%.*s", (int)(strlen(file) - strlen("_full.mha")), file);
    wall_case *const c = new_case(s, err);
    if (!c || !wall_case_read(folder, name, c, err)) return false;
    s->count++;
    return true;
}

bool site_add_folder(site_list *list, const char *folder, hs_error *err) {
    char pattern[1024];
    glob_t found = {0};
    (void)snprintf(pattern, sizeof pattern, "%s/*_full.mha", folder);
    site_set *s = new_set(list, folder, err);
    bool added = s != NULL;
    if (added && glob(pattern, 0, NULL, &found) != 0)
        added = hs_fail(err, HS_ERR_INPUT, "%s: there is no NAME_full.mha", folder);
    for (size_t i = 0; added && i < found.gl_pathc; i++) added = add_file(s, folder, found.gl_pathv[i], err);
    globfree(&found);
    return added;
}

bool site_add_files(site_list *list, const char *files, hs_error *err) {
    site_set *s = set_of(list, "files", err);
    wall_case *c = s ? new_case(s, err) : NULL;
    if (!c || !wall_case_files(files, c, err)) return false;
    s->count++;
    return true;
}

bool site_add_scenes(site_list *list, const char *text, hs_error *err) {
    unsigned long seed = 0, pose = 0;
    int length = 0;
    if (sscanf(text, "%9lu,%9lu%n", &seed, &pose, &length) != 2 || text[length] != '\0')
        return hs_fail(err, HS_ERR_USAGE, "--scenes: '%s' is no SEED,POSE", text);
    site_set *s = set_of(list, "scenes", err);
    if (!s) return false;
    name_part(s, text);
    for (int i = 0; i < SITE_NAMES; i++) {
        wall_case *c = new_case(s, err);
        if (!c || !wall_case_make(site_names[i], seed, (uint32_t)pose, 0, c, err)) return false;
        s->count++;
    }
    return true;
}

static bool add_named(site_set *s, const char *name, hs_error *err) {
    wall_case *c = new_case(s, err);
    if (!c || !wall_case_make(name, 0, 0, 0, c, err)) return false;
    s->count++;
    return true;
}

bool site_add_scene(site_list *list, const char *name, hs_error *err) {
    site_set *s = set_of(list, "scenes", err);
    if (!s || !add_named(s, name, err)) return false;
    name_part(s, name);
    return true;
}

bool site_add_random(site_list *list, char set, const char *text, hs_error *err) {
    unsigned long seed = 0, count = 0;
    int length = 0;
    if (sscanf(text, "%9lu,%9lu%n", &seed, &count, &length) != 2 || text[length] != '\0' || count < 1 ||
        count > SITE_MAX_CASES)
        return hs_fail(err, HS_ERR_USAGE, "--%s: '%s' is no SEED,COUNT with a count of 1 .. %d",
                       set == 'G' ? "greys" : "random", text, SITE_MAX_CASES);
    site_set *s = set_of(list, "scenes", err);
    if (!s) return false;
    char name[48];
    for (unsigned long n = 0; n < count; n++) {
        (void)snprintf(name, sizeof name, "%c%lu_%lu", set, seed, n);
        if (!add_named(s, name, err)) return false;
    }
    (void)snprintf(name, sizeof name, "%c%lu_0..%lu", set, seed, count - 1);
    name_part(s, name);
    return true;
}

bool site_is_files(const site_set *set) {
    return strcmp(set->title, "files") == 0;
}

void site_free(site_list *list) {
    for (uint32_t i = 0; i < list->count; i++) {
        for (uint32_t n = 0; n < list->set[i].count; n++) wall_case_free(&list->set[i].cases[n]);
        free(list->set[i].cases);
    }
    *list = (site_list){0};
}

/* ----------------------------------------------------------------------------------------------- table -- */

enum { QS = 31 };
static const double q_step = 0.05;

site_methods site_methods_default(const char *plugin) {
    return (site_methods){
        .plugin = plugin, .method = {{"method=mean", true}, {"method=wall", false}}, .count = 2};
}

bool site_judge_case(surf_session *s, const wall_case *c, site_score *to, wall_score *score, hs_error *err) {
    if (!surf_session_frame(s, c, err)) return false;
    *score = wall_judge(c, c->full, s->depth, s->confidence, &to->calibration);
    site_score_add(to, c->name, score);
    to->refused += !surf_session_clips(s);
    to->answers[s->answer]++;
    return true;
}

static bool judge_set(surf_session *s, const site_set *set, site_score *out, wall_score *each,
                      hs_error *err) {
    wall_score unused;
    *out = (site_score){0};
    for (uint32_t n = 0; n < set->count; n++)
        if (!site_judge_case(s, &set->cases[n], out, each ? &each[n] : &unused, err)) return false;
    return true;
}

static bool find_q(surf_session *s, const site_set *set, double *q, hs_error *err) {
    double least = INFINITY;
    for (int i = 0; i < QS; i++) {
        site_score score;
        if (!surf_session_set(s, "q", q_step * i, err) || !judge_set(s, set, &score, NULL, err)) return false;
        if (score.sum.error >= least) continue;
        least = score.sum.error;
        *q = q_step * i;
    }
    return surf_session_set(s, "q", *q, err);
}

bool site_judge(surf_session *s, const site_set *set, bool best_q, site_score *out, double *q,
                wall_score *each, hs_error *err) {
    *q = -1.0;
    return (!best_q || find_q(s, set, q, err)) && judge_set(s, set, out, each, err);
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
        site_score_print_fetus(&rows[i].score);
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
