/* SPDX-License-Identifier: MIT */
/* A user who knows the truth, and marks the largest wrong region as the console's brush would. */
#include "judge/judge.h"

#include "loop/marks.h"
#include "render/dvr_settings.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define SEEN 0.5 /* the opacity that the console's brush finds */

enum { REGIONS = 3, RADII = 4 };
static const double radii_mm[RADII] = {3.0, 5.0, 8.0, 12.0};

typedef struct {
    const site_play *of;
    float *depth, *trial;    /* with the marks so far, and with one more */
    float *off;              /* > 0: so much of an occluder is left, < 0: is cut; 0: right, or not judged */
    uint32_t *region, *todo; /* which wrong region a ray is in, 0: none; rays to be looked at */
    uint32_t size[REGIONS], first[REGIONS]; /* of the largest ones: rays, and one of them */
} game;

static size_t rays_of(const site_play *p) {
    return (size_t)p->n[0] * p->n[1];
}

static mark_score judge(game *g, const float *depth) {
    const site_play *p = g->of;
    site_sum s = {0};
    for (size_t i = 0; i < rays_of(p); i++) {
        const bool of_fetus = !p->c || p->c->label[i] == HS_LABEL_FETUS;
        g->off[i] = 0.0f;
        if (p->c ? p->c->label[i] == HS_LABEL_NEITHER : p->rays[i].high <= 0.0) continue;
        if (p->c)
            g->off[i] =
                (p->c->truth[i] - wall_ray_end(p->c, p->c->full, i, depth[i])) * 128.0f / (float)p->n[2];
        else
            g->off[i] =
                (float)site_scan_off(&p->rays[i], (double)depth[i] * p->camera.depth_extent / p->n[2]);
        site_count(&s, (double)g->off[i], of_fetus);
    }
    return (mark_score){s.error / fmax(s.rays, 1.0), s.cut / fmax(s.fetus, 1.0), s.left / fmax(s.rays, 1.0)};
}

static int wrong(const game *g, size_t i) {
    return fabsf(g->off[i]) <= (float)SITE_TOLERANCE ? 0 : g->off[i] > 0.0f ? 1 : -1;
}

/* All rays of the region of ray `i`, which is wrong; returns how many. */
static uint32_t fill(game *g, uint32_t i, uint32_t number) {
    const uint32_t *n = g->of->n;
    uint32_t count = 0, left = 1;
    g->todo[0] = i;
    g->region[i] = number;
    while (left > 0) {
        const uint32_t at = g->todo[--left], x = at % n[0], y = at / n[0];
        const uint32_t next[4] = {x > 0 ? at - 1 : at, x + 1 < n[0] ? at + 1 : at, y > 0 ? at - n[0] : at,
                                  y + 1 < n[1] ? at + n[0] : at};
        count++;
        for (int k = 0; k < 4; k++) {
            if (g->region[next[k]] != 0 || wrong(g, next[k]) != wrong(g, at)) continue;
            g->region[next[k]] = number;
            g->todo[left++] = next[k];
        }
    }
    return count;
}

static void find_regions(game *g) {
    memset(g->region, 0, rays_of(g->of) * sizeof *g->region);
    memset(g->size, 0, sizeof g->size);
    for (uint32_t i = 0; i < rays_of(g->of); i++) {
        if (wrong(g, i) == 0 || g->region[i] != 0) continue;
        const uint32_t size = fill(g, i, i + 1);
        for (int k = 0; k < REGIONS; k++) {
            if (size <= g->size[k]) continue;
            memmove(&g->size[k + 1], &g->size[k], (size_t)(REGIONS - 1 - k) * sizeof *g->size);
            memmove(&g->first[k + 1], &g->first[k], (size_t)(REGIONS - 1 - k) * sizeof *g->first);
            g->size[k] = size;
            g->first[k] = i;
            break;
        }
    }
}

/* How many rays a region goes on to all four sides of a ray. */
static uint32_t room_at(const game *g, uint32_t x, uint32_t y) {
    const uint32_t *n = g->of->n, *at = g->region + (size_t)y * n[0] + x;
    for (uint32_t r = 1;; r++)
        if (x < r || y < r || x + r >= n[0] || y + r >= n[1] || at[r] != *at || *(at - r) != *at ||
            at[(size_t)r * n[0]] != *at || *(at - (size_t)r * n[0]) != *at)
            return r;
}

/* The ray of a region with the most room around it. */
static uint32_t middle_of(const game *g, uint32_t first) {
    uint32_t best = first, room = 0;
    for (uint32_t i = first; i < rays_of(g->of); i++) {
        if (g->region[i] != g->region[first]) continue;
        const uint32_t here = room_at(g, i % g->of->n[0], i / g->of->n[0]);
        if (here > room) best = i;
        if (here > room) room = here;
    }
    return best;
}

/* The slice at which a ray that starts at its depth has met what is seen. */
static double seen_at(const game *g, uint32_t x, uint32_t y) {
    const site_play *p = g->of;
    const hs_volume *v = &p->volume;
    hs_dvr_settings dvr;
    hs_box_map map;
    uint32_t at[3], z = (uint32_t)fmax(0.0, (double)g->depth[(size_t)y * p->n[0] + x]);
    hs_dvr_defaults(&dvr);
    hs_camera_box_map(&p->camera, v, &map);
    for (double clear = 1.0; z < p->n[2] && clear > 1.0 - SEEN; z++) {
        const double place[3] = {(x + 0.5) / p->n[0], (y + 0.5) / p->n[1], (z + 0.5) / p->n[2]};
        if (!hs_box_map_voxel(&map, v, place, at)) continue;
        const uint8_t level = v->voxels[((size_t)at[2] * v->ny + at[1]) * v->nx + at[0]];
        clear *= 1.0 - (double)hs_dvr_opacity(&dvr, level);
    }
    return z;
}

/* Finds the place of a mark on ray `i`; false: nothing was cut there. */
static bool put_mark(const game *g, uint32_t i, hs_mark *mark) {
    const site_play *p = g->of;
    const hs_camera *c = &p->camera;
    const uint32_t x = i % p->n[0], y = i / p->n[0];
    const double seen[3] = {((x + 0.5) / p->n[0] - 0.5) * c->extent, ((y + 0.5) / p->n[1] - 0.5) * c->extent,
                            ((seen_at(g, x, y) + 0.5) / p->n[2] - 0.5) * c->depth_extent};
    hs_marks_place(&p->volume, c, seen, mark->place);
    return !mark->keep || hs_marks_find_cut(mark, &p->volume, c, p->n, g->depth);
}

/* Adds the mark that helps most; none if none does. */
static bool add_mark(game *g, mark_score *score, hs_error *err) {
    const site_play *p = g->of;
    const size_t bytes = rays_of(p) * sizeof *g->depth;
    hs_mark best = {.radius = 0.0};
    mark_score least = *score;
    uint32_t middle[REGIONS];
    bool keep[REGIONS];
    find_regions(g);
    for (int k = 0; k < REGIONS && g->size[k] > 0; k++) {
        middle[k] = middle_of(g, g->first[k]);
        keep[k] = g->off[middle[k]] < 0.0f;
    }
    for (int k = 0; k < REGIONS && g->size[k] > 0; k++)
        for (int r = 0; r < RADII; r++) {
            hs_mark mark = {.radius = radii_mm[r], .keep = keep[k]};
            if (!put_mark(g, middle[k], &mark)) continue;
            memcpy(g->trial, g->depth, bytes);
            if (!hs_marks_apply(&mark, 1, &p->volume, &p->camera, p->n, g->trial, err)) return false;
            const mark_score now = judge(g, g->trial);
            if (now.error >= least.error) continue;
            least = now;
            best = mark;
        }
    *score = least;
    if (best.radius > 0.0 && !hs_marks_apply(&best, 1, &p->volume, &p->camera, p->n, g->depth, err))
        return false;
    (void)judge(g, g->depth);
    return true;
}

bool site_play_marks(const site_play *p, const float *depth, bool clips, mark_scores *to, hs_error *err) {
    const size_t rays = rays_of(p);
    float *maps = calloc(3 * rays, sizeof *maps);
    uint32_t *regions = calloc(2 * rays, sizeof *regions);
    if (!maps || !regions) {
        free(maps);
        free(regions);
        return hs_fail(err, HS_ERR_MEMORY, "no memory for marks");
    }
    game g = {.of = p,
              .depth = maps,
              .trial = maps + rays,
              .off = maps + 2 * rays,
              .region = regions,
              .todo = regions + rays};
    bool ok = true;
    memcpy(g.depth, depth, rays * sizeof *depth);
    mark_score score = judge(&g, g.depth);
    for (uint32_t marks = 0, row = 0; ok && row < MARK_ROWS; marks++) {
        if (marks == mark_rows[row]) {
            to->sum[row].error += score.error;
            to->sum[row].cut += score.cut;
            to->sum[row++].left += score.left;
        }
        ok = !clips || add_mark(&g, &score, err);
    }
    to->count += ok;
    free(maps);
    free(regions);
    return ok;
}

const uint32_t mark_rows[MARK_ROWS] = {0, 1, 3, 6};

void site_print_marks(const char *what, const char *unit, const mark_scores *s) {
    const double n = fmax(s->count, 1.0);
    printf("  %-32s %3u ", what, s->count);
    for (int i = 0; i < MARK_ROWS; i++)
        printf("%s%5.2f / %5.2f / %5.2f", i ? "  | " : "", s->sum[i].error / n, 100.0 * s->sum[i].cut / n,
               100.0 * s->sum[i].left / n);
    printf("  %s\n", unit);
    (void)fflush(stdout);
}
