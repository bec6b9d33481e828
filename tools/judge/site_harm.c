/* SPDX-License-Identifier: MIT */
#include "judge/site_harm.h"

#include "judge/site_variant.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

enum { TURNS = 12 };
static const double allowed = 0.02; /* share of the fetus that may be cut */

/* One method on one kind of volume. */
typedef struct {
    wall_score sum;
    uint32_t count, refused, harmed;
    double worst_cut, worst_error, confidence;
} tally;

static void add(tally *t, const wall_case *c, const surf_session *s, const wall_score *score) {
    const bool refused = !surf_session_clips(s);
    double sure = 0.0, rays = 0.0;
    for (size_t i = 0; i < (size_t)c->nx * c->ny; i++) {
        if (c->label[i] == 0) continue;
        sure += (double)s->confidence[i];
        rays += 1.0;
    }
    t->sum.error += score->error;
    t->sum.cut += score->cut;
    t->sum.left += score->left;
    t->worst_cut = fmax(t->worst_cut, score->cut);
    t->worst_error = fmax(t->worst_error, score->error);
    t->harmed += score->cut > allowed;
    t->refused += refused;
    if (!refused && rays > 0.0) t->confidence += sure / rays;
    t->count++;
}

static bool judge(surf_session *s, const wall_case *c, tally *t, hs_error *err) {
    wall_calibration unused = {0};
    const surf_volume v = site_volume(c);
    if (!surf_session_frame(s, &v, err) || !surf_session_confidence(s, NULL, err)) return false;
    const wall_score score = wall_judge(c, c->full, s->depth, s->confidence, &unused);
    add(t, c, s, &score);
    return true;
}

static void print_tally(const char *what, const char *method, const tally *t, bool sure) {
    const double n = t->count ? t->count : 1.0;
    printf(
        "  %-22s %-18s %3u of %3u refused, %3u cut above %.0f %%; cut %5.2f, worst %5.1f; error %6.2f, worst "
        "%6.2f; left %5.1f",
        what, method, t->refused, t->count, t->harmed, 100.0 * allowed, 100.0 * t->sum.cut / n,
        100.0 * t->worst_cut, t->sum.error / n, t->worst_error, 100.0 * t->sum.left / n);
    if (sure && t->count > t->refused) printf("; confidence %.2f", t->confidence / (t->count - t->refused));
    printf("\n");
    (void)fflush(stdout);
}

/* The methods' sessions, open together, so that a volume is made once. */
typedef struct {
    surf_session at[SITE_MAX_METHODS];
    const site_methods *methods;
} team;

static void close_team(team *t) {
    for (uint32_t i = 0; i < t->methods->count; i++) surf_session_close(&t->at[i]);
}

static bool open_team(team *t, const site_methods *methods, hs_error *err) {
    *t = (team){.methods = methods};
    for (uint32_t i = 0; i < methods->count; i++) {
        if (surf_session_open(&t->at[i], methods->plugin, methods->method[i].settings, err)) continue;
        close_team(t);
        return false;
    }
    return true;
}

static bool judge_all(team *t, const wall_case *c, tally tallies[SITE_MAX_METHODS], hs_error *err) {
    for (uint32_t i = 0; i < t->methods->count; i++)
        if (!judge(&t->at[i], c, &tallies[i], err)) return false;
    return true;
}

static void print_all(const team *t, const char *what, const tally tallies[SITE_MAX_METHODS]) {
    for (uint32_t i = 0; i < t->methods->count; i++)
        print_tally(what, t->methods->method[i].settings, &tallies[i], t->at[i].sure);
}

static bool print_variants(team *t, const site_set *set, hs_error *err) {
    printf("%s\n", set->title);
    for (int kind = 0; kind < SITE_VARIANTS; kind++) {
        tally tallies[SITE_MAX_METHODS] = {0};
        for (uint32_t n = 0; n < set->count; n++) {
            wall_case c;
            if (!site_variant_make(&set->cases[n], (site_variant)kind, &c, err)) return false;
            const bool ok = judge_all(t, &c, tallies, err);
            wall_case_free(&c);
            if (!ok) return false;
        }
        print_all(t, site_variant_name((site_variant)kind), tallies);
    }
    return true;
}

bool site_view_make(const wall_case *whole, int view, uint32_t side, wall_case *out, hs_error *err) {
    return wall_case_turn(whole, view / TURNS, 360.0 / TURNS * (view % TURNS), side, out, err);
}

/* The last two rows are for the occluders, before coarse and fine views. */
enum { ROWS = SITE_BARE_VIEWS + 2, FINE_ROW = ROWS - 1 };

static const char *row_name(int row) {
    if (row < SITE_BARE_VIEWS) return site_bare_view_name((site_bare_view)row);
    return row == FINE_ROW ? "fine, behind occluders" : "behind occluders";
}

static bool judge_row(team *t, const wall_case *view, int row, tally tallies[SITE_MAX_METHODS],
                      hs_error *err) {
    wall_case c;
    if (row < SITE_BARE_VIEWS ? !site_bare_view_make(view, (site_bare_view)row, &c, err)
                              : !site_occluded_make(view, &c, err))
        return false;
    const bool ok = judge_all(t, &c, tallies, err);
    wall_case_free(&c);
    return ok;
}

/* All rows of one side of a volume. */
static bool judge_side(team *t, const wall_case *whole, int view, tally tallies[ROWS][SITE_MAX_METHODS],
                       hs_error *err) {
    wall_case coarse = {0}, fine = {0};
    bool ok = site_view_make(whole, view, SITE_COARSE, &coarse, err) &&
              site_view_make(whole, view, SITE_FINE, &fine, err);
    for (int row = 0; ok && row < ROWS; row++)
        ok = judge_row(t, row == FINE_ROW ? &fine : &coarse, row, tallies[row], err);
    wall_case_free(&coarse);
    wall_case_free(&fine);
    return ok;
}

static bool print_views(team *t, const char *path, hs_error *err) {
    tally tallies[ROWS][SITE_MAX_METHODS];
    wall_case whole;
    memset(tallies, 0, sizeof tallies);
    if (!wall_case_open(path, &whole, err)) return false;
    bool ok = true;
    for (int i = 0; ok && i < SITE_VIEWS; i++) ok = judge_side(t, &whole, i, tallies, err);
    if (ok) printf("%s, %d views\n", whole.name, SITE_VIEWS);
    wall_case_free(&whole);
    for (int row = 0; ok && row < ROWS; row++) print_all(t, row_name(row), tallies[row]);
    return ok;
}

bool site_harm(const site_list *list, const char *const *volumes, uint32_t count, const site_methods *methods,
               hs_error *err) {
    team t;
    printf("Do no harm: cut and left in %%, error in slices of 128. No fetus: nothing can be cut, and all "
           "that counts "
           "is\nrefused or a low confidence\n");
    if (!open_team(&t, methods, err)) return false;
    bool ok = true;
    for (uint32_t i = 0; ok && i < list->count; i++) ok = print_variants(&t, &list->set[i], err);
    for (uint32_t i = 0; ok && i < count; i++) ok = print_views(&t, volumes[i], err);
    close_team(&t);
    printf("\n");
    return ok;
}
