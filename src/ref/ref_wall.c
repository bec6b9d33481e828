/* SPDX-License-Identifier: MIT */
#include "ref/ref_wall.h"

#include "ref/ref_wall_surface.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static void clip_nothing(const sv_wall_layout *l, float *depth, float *confidence) {
    const size_t plane = (size_t)l->width * l->height;
    memset(depth, 0, plane * sizeof *depth);
    memset(confidence, 0, plane * sizeof *confidence);
}

/* The surface of a volume with fluid. `bright` holds the means. */
static bool surface(const sv_wall_volume *v, const sv_wall_layout *l, const sv_wall_levels *levels,
                    uint8_t *bright, float *depth, float *confidence, sv_wall_outcome *outcome,
                    sv_wall_facts *facts) {
    sv_wall_evidence evidence;
    if (!sv_wall_brightest(l, bright) || !sv_wall_evidence_of(v, l, levels, bright, &evidence)) return false;
    facts->rays = evidence.rays;
    facts->wall_rays = evidence.wall_rays;
    facts->wall = (double)evidence.wall / SV_WALL_LEVEL_ONE;
    facts->spread = ldexp(evidence.spread, -SV_WALL_ODDS_BITS);
    const sv_wall_scan scan = {v, l, &evidence, levels->threshold, bright};
    sv_wall_cells cells;
    if (!sv_wall_cells_create(&scan, &cells)) return false;
    facts->fetus = (double)cells.fetus / ((double)evidence.rays * SV_WALL_SURE);
    const uint64_t least = (uint64_t)evidence.rays * SV_WALL_SURE * l->fetus_share;
    *outcome = cells.fetus * SV_WALL_PER_MILLE < least ? SV_WALL_NO_FETUS : SV_WALL_SURFACE;
    bool done = true;
    if (*outcome == SV_WALL_SURFACE)
        done = sv_wall_cheapest(l, &cells, depth, confidence);
    else
        clip_nothing(l, depth, confidence);
    sv_wall_cells_destroy(&cells);
    return done;
}

bool sv_wall_surface(const sv_wall_volume *v, const sv_wall_settings *settings, float *depth,
                     float *confidence, sv_wall_outcome *outcome, sv_wall_facts *facts) {
    char text[160];
    if (!sv_wall_check(v, text, sizeof text)) return false;
    const sv_wall_settings s = settings ? *settings : sv_wall_settings_default();
    const sv_wall_layout l = sv_wall_layout_of(v->width, v->height, v->slices, v->spacing_mm, &s);
    const size_t plane = (size_t)l.width * l.height;
    uint8_t *means = malloc(plane * l.slices);
    uint64_t histogram[256];
    if (!means || !sv_wall_means(v, &l, means)) {
        free(means);
        return false;
    }
    sv_wall_histogram(v, &l, means, histogram);
    const sv_wall_levels levels = sv_wall_levels_of(histogram);
    sv_wall_facts found = {.threshold = levels.threshold, .valley = levels.valley};
    bool done = true;
    *outcome = sv_wall_outcome_of(&l, &levels);
    if (*outcome == SV_WALL_SURFACE)
        done = surface(v, &l, &levels, means, depth, confidence, outcome, &found);
    else
        clip_nothing(&l, depth, confidence);
    free(means);
    if (done && facts) *facts = found;
    return done;
}

/* Ranges and voxels without a padding value: 0 in its place. */
static void strip_padding(const sv_ref_volume *v, uint8_t *voxels, uint16_t *first, uint16_t *end) {
    const size_t plane = (size_t)v->width * v->height;
    memset(voxels, 0, plane * v->slices);
    for (size_t i = 0; i < plane; i++)
        for (uint32_t z = 0; z < v->slices; z++) {
            if (!sv_ref_scanned(v, i, z)) continue;
            if (end[i] == 0) first[i] = (uint16_t)z;
            end[i] = (uint16_t)(z + 1);
            voxels[z * plane + i] = v->voxels[z * plane + i];
        }
}

/* A spacing as sv_wall_check wants it. */
static double in_range(double mm) {
    return mm > 0.0 ? fmin(fmax(mm, SV_WALL_SHORTEST_MM), SV_WALL_LONGEST_MM) : 0.0;
}

bool sv_wall_surface_padded(const sv_ref_volume *v, const double spacing_mm[3], float *depth,
                            float *confidence, sv_wall_outcome *outcome, sv_wall_facts *facts) {
    const size_t plane = (size_t)v->width * v->height;
    uint8_t *voxels = malloc(plane * v->slices);
    uint16_t *ranges = calloc(2 * plane, sizeof *ranges);
    bool done = voxels && ranges;
    if (done) {
        strip_padding(v, voxels, ranges, ranges + plane);
        const sv_wall_volume wall = {
            .voxels = voxels,
            .width = v->width,
            .height = v->height,
            .slices = v->slices,
            .first = ranges,
            .end = ranges + plane,
            .spacing_mm = {in_range(spacing_mm[0]), in_range(spacing_mm[1]), in_range(spacing_mm[2])}};
        done = sv_wall_surface(&wall, NULL, depth, confidence, outcome, facts);
    }
    free(voxels);
    free(ranges);
    return done;
}

/* NOLINTNEXTLINE(readability-non-const-parameter): the signature is that of all methods */
static bool of_task(const sv_ref_task *task, double *surface, uint8_t *either) {
    (void)either; /* integers: no two answers are right */
    const size_t count = (size_t)task->map.width * task->map.height;
    float *maps = malloc(2 * count * sizeof *maps);
    sv_wall_outcome outcome;
    const bool done =
        maps && sv_wall_surface_padded(task->volume, task->spacing_mm, maps, maps + count, &outcome, NULL);
    for (size_t i = 0; done && i < count; i++) surface[i] = (double)maps[i];
    free(maps);
    return done;
}

const sv_ref_method sv_ref_method_wall = {.name = "wall", .takes_volume = true, .surface = of_task};
