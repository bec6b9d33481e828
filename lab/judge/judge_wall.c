/* SPDX-License-Identifier: MIT */
#include "judge/judge.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* ------------------------------------------------------------------------------------------- constants -- */

/* The constant of that name, "block_mm" or another number of sv_wall_settings; NULL if there is none. */
static double *find_constant(sv_wall_settings *s, const char *key) {
#define NAMED(name, value) {#name, offsetof(sv_wall_settings, name)},
    static const struct {
        const char *key;
        size_t offset;
    } all[] = {SV_WALL_CONSTANTS(NAMED)};
#undef NAMED
    for (size_t i = 0; i < sizeof all / sizeof *all; i++)
        if (strcmp(all[i].key, key) == 0) return (double *)(void *)((char *)s + all[i].offset);
    return NULL;
}

/* ------------------------------------------------------------------------------------------ definition -- */
/* The definition of the wall's surface on cases, with any of its constants changed. */

wall_change wall_change_none(void) {
    return (wall_change){.settings = sv_wall_settings_default(), .gain = 1.0, .gamma = 1.0, .near_gain = 1.0};
}

bool wall_change_set(wall_change *o, const char *text, hs_error *err) {
    char key[64];
    const size_t length = strcspn(text, "=");
    if (text[length] != '=' || length >= sizeof key)
        return hs_fail(err, HS_ERR_USAGE, "--set: '%s' is no KEY=VALUE", text);
    (void)snprintf(key, sizeof key, "%.*s", (int)length, text);
    const struct {
        const char *key;
        double *value;
    } levels[] = {
        {"gain", &o->gain},           {"gamma", &o->gamma},           {"black", &o->black},
        {"near_gain", &o->near_gain}, {"near_black", &o->near_black}, {"near_slices", &o->near_slices}};
    double *value = find_constant(&o->settings, key);
    for (size_t i = 0; i < sizeof levels / sizeof *levels; i++)
        if (strcmp(levels[i].key, key) == 0) value = levels[i].value;
    char *end;
    const double number = strtod(text + length + 1, &end);
    if (end == text + length + 1 || *end != '\0')
        return hs_fail(err, HS_ERR_USAGE, "--set: '%s' is no KEY=NUMBER", text);
    if (strcmp(key, "clip_doubtful") == 0)
        o->settings.clip_doubtful = number != 0.0;
    else if (strcmp(key, "median") == 0)
        o->settings.median = number != 0.0;
    else if (strcmp(key, "beams") == 0)
        o->beams = number != 0.0;
    else if (!value)
        return hs_fail(err, HS_ERR_USAGE, "--set: there is no constant '%s'", key);
    else
        *value = number;
    return true;
}

/* What the definition says of a case. */
typedef struct {
    float *depth, *confidence;
    sv_wall_outcome outcome;
    sv_wall_facts facts;
} answer;

static void free_answer(answer *a) {
    free(a->depth);
    free(a->confidence);
}

/* The answer must be freed, even on failure. */
static bool ask(const wall_case *c, const wall_change *o, answer *a, hs_error *err) {
    const size_t plane = (size_t)c->nx * c->ny;
    sv_frame told = c->told;
    told.size = sizeof told;
    const sv_beams beams = sv_beams_of(&told);
    sv_wall_volume v = wall_case_volume(c);
    if (o->beams) v.beams = &beams;
    char text[160];
    *a = (answer){.depth = malloc(plane * sizeof *a->depth),
                  .confidence = malloc(plane * sizeof *a->confidence)};
    if (!sv_wall_check(&v, text, sizeof text)) return hs_fail(err, HS_ERR_INPUT, "%s: %s", c->name, text);
    return (a->depth && a->confidence &&
            sv_wall_surface(&v, &o->settings, a->depth, a->confidence, &a->outcome, &a->facts)) ||
           hs_fail(err, HS_ERR_MEMORY, "%s: no memory", c->name);
}

static void print_case(const wall_case *c, const wall_score *s, const answer *a) {
    const sv_wall_facts *const f = &a->facts;
    printf("  %-4s %5.2f / %4.1f / %4.1f   outcome %d, T %u, gap share %.2f, wall %.0f, spread "
           "%.2f, seen by %.0f %%, fetus %.3f\n",
           c->name, s->error, 100.0 * s->cut, 100.0 * s->left, (int)a->outcome, f->threshold, f->gap_share,
           f->wall, f->spread, f->rays ? 100.0 * f->wall_rays / f->rays : 0.0, f->fetus);
}

static bool is_tilted(const wall_change *o) {
    return o->tilt[0] != 0.0 || o->tilt[1] != 0.0;
}

static void change_levels(wall_case *c, const wall_change *o) {
    if (o->gain != 1.0 || o->gamma != 1.0 || o->black != 0.0)
        wall_case_change(c, o->gain, o->gamma, o->black);
    if (o->near_slices > 0.0) wall_case_change_near(c, (uint32_t)o->near_slices, o->near_gain, o->near_black);
}

/* The verdict of a volume without a truth. */
static bool print_volume(const char *path, const wall_change *o, hs_error *err) {
    wall_case c;
    answer a = {0};
    if (is_tilted(o)) return hs_fail(err, HS_ERR_USAGE, "--tilt: is for cases with a truth");
    if (!wall_case_open(path, &c, err)) return false;
    change_levels(&c, o);
    const bool ok = ask(&c, o, &a, err);
    if (ok)
        printf("%s: outcome %d, gap share %.3f, fetus %.3f\n", c.name, (int)a.outcome, a.facts.gap_share,
               a.facts.fetus);
    free_answer(&a);
    wall_case_free(&c);
    return ok;
}

/* The case is turned and gets other levels before; it is judged on its own levels. `clipped`: of cases that
 * were not refused. */
static bool judge_case(wall_case *c, const wall_change *o, site_score *score, wall_calibration *clipped,
                       hs_error *err) {
    if (is_tilted(o) && !wall_case_tilt(c, o->tilt, err)) return false;
    const size_t bytes = (size_t)c->nx * c->ny * c->nz;
    uint8_t *const original = malloc(bytes);
    answer a = {0};
    bool ok = original || hs_fail(err, HS_ERR_MEMORY, "%s: no memory", c->name);
    if (ok) {
        memcpy(original, c->full, bytes);
        change_levels(c, o);
        ok = ask(c, o, &a, err);
    }
    if (ok) {
        wall_calibration own = {0};
        const wall_score s = wall_judge(c, original, a.depth, a.confidence, &own);
        const bool tried = a.outcome == SV_WALL_DOUBTFUL && o->settings.clip_doubtful;
        site_score_add(score, c->name, &s);
        wall_calibration_add(&score->calibration, &own);
        if (a.outcome == SV_WALL_SURFACE || tried)
            wall_calibration_add(clipped, &own);
        else
            score->refused++;
        print_case(c, &s, &a);
    }
    free_answer(&a);
    free(original);
    return ok;
}

static bool judge_set(site_set *set, const wall_change *o, hs_error *err) {
    site_score score = {0};
    wall_calibration clipped = {0};
    printf("%s (%u cases)\n", set->title, set->count);
    for (uint32_t n = 0; n < set->count; n++)
        if (!judge_case(&set->cases[n], o, &score, &clipped, err)) return false;
    printf("  all  ");
    site_score_print(&score, true);
    site_score_print_fetus(&score);
    site_score_print_calibration("wall", &score.calibration);
    if (score.refused)
        printf("  without the refused: AUC %.3f, cut %.3f, left %.3f\n", wall_auc(&clipped, WALL_WRONG),
               wall_auc(&clipped, WALL_CUT), wall_auc(&clipped, WALL_LEFT));
    return true;
}

bool judge_wall(judge_request *r, hs_error *err) {
    const bool nothing_given = r->sites.count == 0 && r->volume_count == 0;
    bool ok = !nothing_given || site_add_scenes(&r->sites, "201,0", err);
    for (uint32_t i = 0; ok && i < r->sites.count; i++) ok = judge_set(&r->sites.set[i], &r->wall, err);
    for (uint32_t i = 0; ok && i < r->volume_count; i++) ok = print_volume(r->volumes[i], &r->wall, err);
    return ok;
}
