/* SPDX-License-Identifier: MIT */
#include "judge/judge.h"

#include "volume/metaimage_write.h"

#include <math.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

/* -------------------------------------------------------------------------------------------- variants -- */

enum { FLUID_LEVEL = 40, POOL = 65536, LEAST_POOL = 64, NEAR = 3, FAR = 8, LEAD = 16, NOISE = 24 };
/* Half a bladder's width, and how much of the tissue between it and the true surface stays: it lies on the
 * wall of the sac, and never in the sac or the fetus. */
static const double bladder_mm = 20.0, between_mm = 5.0;

/* Made from a case with a truth. What becomes fluid gets levels of the case's own fluid, unless it is black.
 */
typedef enum {
    BARE,       /* all before the true surface is fluid: nothing hides the fetus */
    BARE_BLACK, /* the same, and that fluid is 0 */
    NO_FETUS,   /* all behind the true surface is fluid; the labelled rays are sac */
    BLADDER,    /* an ellipsoid of fluid, 40 mm wide, in the front tissue; the truth is the case's */
    VARIANTS
} variant;
static const char *const variant_names[VARIANTS] = {"bare, noisy fluid", "bare, black fluid", "no fetus",
                                                    "bladder"};

/* Made from a volume that nothing hides: every ray that ends on tissue is labelled fetus, and its own end is
 * the truth. The last two are the scene `real`: its occluders before the volume, in coarse and fine views. */
typedef enum {
    AS_IT_IS,
    NO_RANGES,    /* all was scanned: what lies outside the fan is black fluid */
    BEHIND_NOISE, /* behind 16 slices of noisy fluid */
    BEHIND_BLACK, /* the same with fluid of 0 */
    OCCLUDED,
    OCCLUDED_FINE,
    ROWS
} row;
static const char *const row_names[ROWS] = {"scanned ranges given", "no ranges",
                                            "behind noisy fluid",   "behind black fluid",
                                            "behind occluders",     "fine, behind occluders"};

/* Numerical Recipes' constants: the same noise on every machine. */
static uint32_t next(uint32_t *state) {
    *state = *state * 1664525u + 1013904223u;
    return *state >> 8;
}

static size_t plane_of(const wall_case *c) {
    return (size_t)c->nx * c->ny;
}

/* The fetus is whatever can be seen; its truth is the volume as it is. */
static void nothing_hides(wall_case *c, bool relabel) {
    const size_t plane = plane_of(c);
    memcpy(c->clean, c->full, plane * c->nz);
    for (size_t i = 0; i < plane; i++) {
        c->truth[i] = hs_eval_ray_end(c->full, plane, c->nz, i, 0);
        if (relabel) c->label[i] = c->truth[i] < (float)c->nz ? HS_LABEL_FETUS : HS_LABEL_NEITHER;
    }
}

/* ---- from a case with a truth */

/* Levels of fluid just before the surface. */
static size_t find_fluid(const wall_case *c, uint8_t pool[POOL]) {
    size_t count = 0;
    for (size_t i = 0; i < plane_of(c); i++) {
        if (c->label[i] == HS_LABEL_NEITHER) continue;
        for (uint32_t back = NEAR; back <= FAR && count < POOL; back++) {
            const int64_t z = (int64_t)c->truth[i] - back;
            if (z < c->first[i] || z >= c->end[i]) continue;
            const uint8_t level = c->full[(size_t)z * plane_of(c) + i];
            if (level < FLUID_LEVEL) pool[count++] = level;
        }
    }
    return count;
}

/* Where the truth begins: removed voxels are 0 or 1. */
static uint32_t clip_of(const wall_case *c, size_t pixel) {
    uint32_t z = c->first[pixel];
    while (z < c->end[pixel] && c->clean[z * plane_of(c) + pixel] <= 1) z++;
    return z;
}

/* An ellipsoid half way between the start of the scan and the surface, over the middle of the labelled
 * rays. */
typedef struct {
    double centre[3], radius[3];
} ellipsoid;

static ellipsoid place_bladder(const wall_case *c) {
    double sum[3] = {0}, front = 0.0, rays = 0.0;
    for (size_t i = 0; i < plane_of(c); i++) {
        if (c->label[i] == HS_LABEL_NEITHER) continue;
        const size_t x = i % c->nx, y = i / c->nx;
        sum[0] += (double)x;
        sum[1] += (double)y;
        sum[2] += clip_of(c, i);
        front += c->first[i];
        rays += 1.0;
    }
    const double thick = (sum[2] - front) / rays;
    return (ellipsoid){{sum[0] / rays, sum[1] / rays, front / rays + 0.4 * thick},
                       {bladder_mm / c->spacing_mm[0], bladder_mm / c->spacing_mm[1], 0.25 * thick}};
}

static bool is_inside(const ellipsoid *e, size_t x, size_t y, uint32_t z) {
    const double at[3] = {(double)x, (double)y, z};
    double sum = 0.0;
    for (int k = 0; k < 3; k++) sum += pow((at[k] - e->centre[k]) / e->radius[k], 2.0);
    return sum < 1.0;
}

/* Whether a voxel becomes fluid. */
static bool becomes_fluid(const wall_case *c, variant kind, const ellipsoid *bladder, size_t i, uint32_t clip,
                          uint32_t z) {
    const double between = between_mm / c->spacing_mm[2];
    if (kind == BLADDER)
        return is_inside(bladder, i % c->nx, i / c->nx, z) &&
               (c->label[i] == HS_LABEL_NEITHER || (double)z + between < (double)clip);
    if (kind == NO_FETUS) return c->label[i] != HS_LABEL_NEITHER && z >= clip;
    return z < clip;
}

static bool make_variant(const wall_case *from, variant kind, wall_case *out, hs_error *err) {
    static uint8_t pool[POOL];
    uint32_t state = 1;
    *out = (wall_case){0};
    const size_t plane = plane_of(from), levels = find_fluid(from, pool);
    if (levels < LEAST_POOL)
        return hs_fail(err, HS_ERR_INPUT, "%s: %zu voxels of fluid before the surface, expected %d or more",
                       from->name, levels, LEAST_POOL);
    if (!wall_case_room(from, 0, out, err)) return false;
    const ellipsoid bladder = place_bladder(from);
    memcpy(out->full, from->full, plane * from->nz);
    memcpy(out->first, from->first, plane * sizeof *out->first);
    memcpy(out->end, from->end, plane * sizeof *out->end);
    memcpy(out->label, from->label, plane);
    for (size_t i = 0; i < plane; i++) {
        const uint32_t clip = clip_of(from, i);
        for (uint32_t z = from->first[i]; z < from->end[i]; z++)
            if (becomes_fluid(from, kind, &bladder, i, clip, z))
                out->full[z * plane + i] = kind == BARE_BLACK ? 0 : pool[next(&state) % levels];
        if (kind == NO_FETUS && out->label[i] != HS_LABEL_NEITHER) out->label[i] = HS_LABEL_SAC;
    }
    nothing_hides(out, false);
    if (kind == BLADDER) {
        memcpy(out->truth, from->truth, plane * sizeof *out->truth);
        memcpy(out->clean, from->clean, plane * from->nz);
    }
    return true;
}

/* ---- from a volume that nothing hides */

static bool make_bare(const wall_case *from, row kind, wall_case *out, hs_error *err) {
    const bool behind = kind == BEHIND_NOISE || kind == BEHIND_BLACK;
    const uint32_t lead = behind ? LEAD : 0;
    const size_t plane = plane_of(from);
    uint32_t state = 1;
    if (!wall_case_room(from, lead, out, err)) return false;
    memcpy(out->full + lead * plane, from->full, plane * from->nz);
    for (size_t i = 0; i < plane; i++) {
        const bool seen = from->first[i] < from->end[i];
        out->end[i] = (uint16_t)(kind == NO_RANGES ? out->nz : seen ? from->end[i] + lead : 0);
        out->first[i] = (uint16_t)(kind == AS_IT_IS ? from->first[i] : 0);
        for (uint32_t z = 0; seen && kind == BEHIND_NOISE && z < from->first[i] + lead; z++)
            out->full[z * plane + i] = (uint8_t)(1 + next(&state) % NOISE);
    }
    nothing_hides(out, true);
    return true;
}

/* Writes the slices in which anything was scanned: the room before them would pass for fluid, and the
 * occluders grow with the volume. */
static bool write_volume(const wall_case *c, char *path, size_t size, hs_error *err) {
    uint32_t from = c->nz, to = 0;
    for (size_t i = 0; i < plane_of(c); i++) {
        if (c->first[i] >= c->end[i]) continue;
        if (c->first[i] < from) from = c->first[i];
        if (c->end[i] > to) to = c->end[i];
    }
    if (from >= to) return hs_fail(err, HS_ERR_INPUT, "%s: nothing of it was scanned", c->name);
    const int file = judge_temporary("occluded", ".mha", path, size, err);
    if (file < 0) return false;
    (void)close(file);
    const hs_metaimage_format format = {.type = HS_MET_UCHAR,
                                        .dims = 3,
                                        .size = {c->nx, c->ny, to - from},
                                        .spacing = {c->spacing_mm[0], c->spacing_mm[1], c->spacing_mm[2]}};
    return hs_metaimage_write(path, &format, c->full + from * plane_of(c), err);
}

static bool make_occluded(const wall_case *from, wall_case *out, hs_error *err) {
    char path[1024];
    hs_eval_source source;
    const hs_eval_request request = {.name = "real", .real = path};
    *out = (wall_case){0};
    if (!write_volume(from, path, sizeof path, err)) return false;
    const bool open = hs_eval_source_open(&source, &request, err);
    (void)unlink(path);
    if (!open) return false;
    const bool ok = wall_case_take(&source, out, err);
    hs_eval_source_close(&source);
    if (ok) memcpy(out->name, from->name, sizeof out->name);
    return ok;
}

/* ------------------------------------------------------------------------------------------ do no harm -- */

enum {
    TURNS = 12, /* about each of three axes */
    VIEWS = 3 * TURNS,
    COARSE = 96, /* voxels along a side of a view; */
    FINE = 144   /* 1.8 and 1.2 mm each for a head */
};

static void print_score(const char *what, const char *method, const site_score *s, bool sure) {
    const wall_score mean = site_score_mean(s);
    printf("  %-22s %-18s %3u of %3u refused, %3u cut above 2 %%; cut %5.2f, worst %5.1f; error %6.2f, worst "
           "%6.2f; left %5.1f",
           what, method, s->refused, s->count, s->harmed, 100.0 * mean.cut, 100.0 * s->worst_cut, mean.error,
           s->worst, 100.0 * mean.left);
    if (sure && s->count > s->refused)
        printf("; confidence %.2f", s->sum.confidence / (s->count - s->refused));
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

static bool judge_all(team *t, const wall_case *c, site_score scores[SITE_MAX_METHODS], hs_error *err) {
    wall_score unused;
    for (uint32_t i = 0; i < t->methods->count; i++)
        if (!site_judge_case(&t->at[i], c, &scores[i], &unused, err)) return false;
    return true;
}

static void print_all(const team *t, const char *what, const site_score scores[SITE_MAX_METHODS]) {
    for (uint32_t i = 0; i < t->methods->count; i++)
        print_score(what, t->methods->method[i].settings, &scores[i], t->at[i].sure);
}

static bool print_variants(team *t, const site_set *set, hs_error *err) {
    printf("%s\n", set->title);
    for (int kind = 0; kind < VARIANTS; kind++) {
        static site_score scores[SITE_MAX_METHODS]; /* too large for the stack */
        memset(scores, 0, sizeof scores);
        for (uint32_t n = 0; n < set->count; n++) {
            wall_case c;
            if (!make_variant(&set->cases[n], (variant)kind, &c, err)) return false;
            const bool ok = judge_all(t, &c, scores, err);
            wall_case_free(&c);
            if (!ok) return false;
        }
        print_all(t, variant_names[kind], scores);
    }
    return true;
}

static bool judge_row(team *t, const wall_case *view, row kind, site_score scores[SITE_MAX_METHODS],
                      hs_error *err) {
    wall_case c;
    if (kind < OCCLUDED ? !make_bare(view, kind, &c, err) : !make_occluded(view, &c, err)) return false;
    const bool ok = judge_all(t, &c, scores, err);
    wall_case_free(&c);
    return ok;
}

/* All rows of one side of a volume. */
static bool judge_side(team *t, const wall_case *whole, int view, site_score scores[ROWS][SITE_MAX_METHODS],
                       hs_error *err) {
    wall_case coarse = {0}, fine = {0};
    const double degrees = 360.0 / TURNS * (view % TURNS);
    bool ok = wall_case_turn(whole, view / TURNS, degrees, COARSE, &coarse, err) &&
              wall_case_turn(whole, view / TURNS, degrees, FINE, &fine, err);
    for (int i = 0; ok && i < ROWS; i++)
        ok = judge_row(t, i == OCCLUDED_FINE ? &fine : &coarse, (row)i, scores[i], err);
    wall_case_free(&coarse);
    wall_case_free(&fine);
    return ok;
}

static bool print_views(team *t, const char *path, hs_error *err) {
    static site_score scores[ROWS][SITE_MAX_METHODS]; /* too large for the stack */
    wall_case whole;
    memset(scores, 0, sizeof scores);
    if (!wall_case_open(path, &whole, err)) return false;
    bool ok = true;
    for (int i = 0; ok && i < VIEWS; i++) ok = judge_side(t, &whole, i, scores, err);
    if (ok) printf("%s, %d views\n", whole.name, VIEWS);
    wall_case_free(&whole);
    for (int i = 0; ok && i < ROWS; i++) print_all(t, row_names[i], scores[i]);
    return ok;
}

bool site_harm(const site_list *list, const char *const *volumes, uint32_t count, const site_methods *methods,
               hs_error *err) {
    team t;
    printf("Do no harm: cut and left in %%, error in slices of 128. No fetus: nothing can be cut, and all "
           "that counts is\nrefused or a low confidence\n");
    if (!open_team(&t, methods, err)) return false;
    bool ok = true;
    for (uint32_t i = 0; ok && i < list->count; i++) ok = print_variants(&t, &list->set[i], err);
    for (uint32_t i = 0; ok && i < count; i++) ok = print_views(&t, volumes[i], err);
    close_team(&t);
    printf("\n");
    return ok;
}
