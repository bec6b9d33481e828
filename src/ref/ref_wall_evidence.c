/* SPDX-License-Identifier: MIT */
#include "ref/ref_wall_steps.h"

bool sv_wall_is_tissue(const sv_wall_scan *s, size_t ray, size_t z) {
    return s->blocks->relative[z * s->layout->columns * s->layout->rows + ray] > SV_WALL_TISSUE;
}

/* Index of a ray's cell in the maps of cells. */
static size_t cell_index(const sv_wall_layout *l, size_t ray, size_t z) {
    const size_t x = ray % l->columns / 2, y = ray / l->columns / 2;
    return (z * l->cells[1] + y) * l->cells[0] + x;
}

uint8_t sv_wall_brightness_at(const sv_wall_scan *s, size_t ray, size_t z) {
    return s->brightness[cell_index(s->layout, ray, z)];
}

uint8_t sv_wall_surroundings_at(const sv_wall_scan *s, size_t ray, size_t z) {
    return s->surroundings[cell_index(s->layout, ray, z)];
}

sv_wall_run sv_wall_first_run(const sv_wall_scan *s, size_t ray) {
    const uint32_t start = s->blocks->first[ray], end = s->blocks->end[ray];
    uint32_t z = start;
    while (z < end && !sv_wall_is_tissue(s, ray, z)) z++;
    sv_wall_run run = {.begin = z, .touches = z == start};
    while (z < end && sv_wall_is_tissue(s, ray, z)) z++;
    run.end = z;
    run.fluid = z < end;
    return run;
}

/* Counts how bright the walls are: the maximum brightness in the first run of each ray whose first run
 * touches the start of the scan and has fluid behind it. The skin may be much brighter than the wall behind
 * it, so its layers do not count, unless the run has no other. Returns the number of these rays. */
static uint32_t wall_histogram(const sv_wall_scan *s, uint64_t histogram[256]) {
    const size_t plane = (size_t)s->layout->columns * s->layout->rows;
    uint32_t rays = 0;
    for (size_t ray = 0; ray < plane; ray++) {
        const sv_wall_run run = sv_wall_first_run(s, ray);
        if (!run.touches || !run.fluid || run.begin == run.end) continue;
        uint8_t maximum = 0;
        const uint32_t behind = run.begin + s->layout->skin;
        for (size_t z = behind < run.end ? behind : run.end - 1; z < run.end; z++)
            if (sv_wall_brightness_at(s, ray, z) > maximum) maximum = sv_wall_brightness_at(s, ray, z);
        histogram[maximum]++;
        rays++;
    }
    return rays;
}

/* Returns ln of the odds of a level in units of 1 / SV_WALL_LEVEL_ONE, fixed-point. As the level nears 255,
 * saturation squeezes differences, and this stretches them again. */
static int32_t log_odds(const uint32_t *tables, uint32_t level) {
    const int32_t here = (int32_t)tables[SV_WALL_ODDS + level / SV_WALL_LEVEL_ONE],
                  next = (int32_t)tables[SV_WALL_ODDS + level / SV_WALL_LEVEL_ONE + 1];
    return here + (next - here) * (int32_t)(level % SV_WALL_LEVEL_ONE) / SV_WALL_LEVEL_ONE;
}

/* The logistic function, linear between the entries of its table. */
static uint32_t probability(const uint32_t *tables, int32_t evidence) {
    const uint32_t size = (uint32_t)(evidence < 0 ? -evidence : evidence), part = 1 << SV_WALL_LOGISTIC_BITS;
    uint32_t p = SV_WALL_PROBABILITY_ONE;
    if (size / part < SV_WALL_LOGISTIC) {
        const uint32_t *at = tables + SV_WALL_CURVE + size / part;
        p = at[0] + ((at[1] - at[0]) * (size % part) + part / 2) / part;
    }
    return evidence < 0 ? SV_WALL_PROBABILITY_ONE - p : p;
}

/* Returns the argument of the logistic function for a brightness `above` spreads over the wall's. */
static int32_t evidence(const sv_wall_layout *l, int32_t above) {
    const int32_t limit = SV_WALL_MAX_EVIDENCE;
    return (above < -limit ? -limit : above > limit ? limit : above) * l->slope / 16;
}

void sv_wall_evidence_of(const sv_wall_scan *scan, const sv_wall_levels *levels, sv_wall_evidence *out) {
    const sv_wall_layout *l = scan->layout;
    uint64_t histogram[256] = {0};
    uint32_t tables[SV_WALL_TABLE_WORDS];
    sv_wall_tables(tables);
    *out = (sv_wall_evidence){.wall_rays = wall_histogram(scan, histogram)};
    out->bare = out->wall_rays == 0 ||
                (uint64_t)out->wall_rays * SV_WALL_PER_MILLE < (uint64_t)scan->blocks->rays * l->seen_share;
    if (!out->bare) {
        out->wall = sv_wall_quantile(histogram, SV_WALL_PER_MILLE / 2);
        out->spread = log_odds(tables, sv_wall_quantile(histogram, SV_WALL_PER_MILLE - l->tail_rank)) -
                      log_odds(tables, sv_wall_quantile(histogram, l->tail_rank));
        if (out->spread < SV_WALL_MIN_SPREAD) out->spread = SV_WALL_MIN_SPREAD;
    } else {
        const uint32_t wall = levels->bright * l->assumed_wall / SV_WALL_PER_MILLE;
        out->wall = wall < 255 * SV_WALL_LEVEL_ONE ? wall : 255 * SV_WALL_LEVEL_ONE;
        out->spread = l->assumed_spread;
    }
    for (uint32_t i = 0; i < 256; i++) {
        const int32_t more = log_odds(tables, i * SV_WALL_LEVEL_ONE) - log_odds(tables, out->wall);
        const int32_t above = more * (1 << SV_WALL_ODDS_BITS) / out->spread - l->fetus_level;
        out->later_run[i] = probability(tables, evidence(l, above));
        out->first_run[i] = probability(tables, evidence(l, above - l->first_run_extra));
    }
}
