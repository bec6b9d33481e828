/* SPDX-License-Identifier: MIT */
#include "ref/ref_wall_evidence.h"

#include <stdlib.h>
#include <string.h>

void sv_wall_tissue(const sv_wall_volume *v, const sv_wall_layout *l, uint32_t threshold, size_t pixel,
                    uint8_t *tissue) {
    const size_t plane = (size_t)l->width * l->height;
    const uint32_t end = sv_wall_end(v, pixel);
    memset(tissue, 0, l->slices);
    uint32_t run = 0;
    for (uint32_t z = sv_wall_first(v, pixel); z < end; z++) {
        run = v->voxels[z * plane + pixel] > threshold ? run + 1 : 0;
        if (run == l->thin) memset(tissue + z + 1 - run, 1, run);
        if (run > l->thin) tissue[z] = 1;
    }
}

bool sv_wall_first_run(const sv_wall_volume *v, const sv_wall_layout *l, size_t pixel, const uint8_t *tissue,
                       sv_wall_run *out) {
    const uint32_t start = sv_wall_first(v, pixel), end = sv_wall_end(v, pixel);
    uint32_t z = start;
    while (z < end && !tissue[z]) z++;
    if (z == end) return false;
    *out = (sv_wall_run){.begin = z, .touches = z - start < l->gap};
    while (z < end && tissue[z]) z++;
    out->end = z;
    while (z < end && !tissue[z]) z++;
    out->fluid = z - out->end;
    return true;
}

/* Histogram of how bright the walls are: the largest brightness in the first tissue of rays where that
 * touches the start of the scan and has fluid behind it. */
static bool wall_histogram(const sv_wall_volume *v, const sv_wall_layout *l, uint32_t threshold,
                           const uint8_t *bright, uint64_t histogram[256], sv_wall_evidence *out) {
    const size_t plane = (size_t)l->width * l->height;
    uint8_t *tissue = malloc(l->slices);
    if (!tissue) return false;
    for (size_t i = 0; i < plane; i++) {
        sv_wall_run run;
        out->rays += sv_wall_first(v, i) < sv_wall_end(v, i);
        sv_wall_tissue(v, l, threshold, i, tissue);
        if (!sv_wall_first_run(v, l, i, tissue, &run) || !run.touches || run.fluid < l->gap) continue;
        uint8_t most = 0;
        for (size_t z = run.begin; z < run.end; z++)
            if (bright[z * plane + i] > most) most = bright[z * plane + i];
        histogram[most]++;
        out->wall_rays++;
    }
    free(tissue);
    return true;
}

/* ln of the odds of a level in units of 1 / SV_WALL_LEVEL_ONE, fixed-point: as the level nears 255,
 * saturation squeezes differences, and this stretches them again. */
static int32_t odds(const uint32_t *tables, uint32_t level) {
    const int32_t here = (int32_t)tables[SV_WALL_ODDS + level / SV_WALL_LEVEL_ONE],
                  next = (int32_t)tables[SV_WALL_ODDS + level / SV_WALL_LEVEL_ONE + 1];
    return here + (next - here) * (int32_t)(level % SV_WALL_LEVEL_ONE) / SV_WALL_LEVEL_ONE;
}

/* The logistic function, linear between the entries of its table. */
static uint32_t probability(const uint32_t *tables, int32_t evidence) {
    const uint32_t size = (uint32_t)(evidence < 0 ? -evidence : evidence), part = 1 << SV_WALL_LOGISTIC_BITS;
    uint32_t p = SV_WALL_SURE;
    if (size / part < SV_WALL_LOGISTIC) {
        const uint32_t *at = tables + SV_WALL_CURVE + size / part;
        p = at[0] + ((at[1] - at[0]) * (size % part) + part / 2) / part;
    }
    return evidence < 0 ? SV_WALL_SURE - p : p;
}

/* Evidence of a brightness `above` spreads over the wall's. */
static int32_t evidence(const sv_wall_layout *l, int32_t above) {
    const int32_t most = SV_WALL_FAR_ABOVE;
    return (above < -most ? -most : above > most ? most : above) * l->sure / 16;
}

bool sv_wall_evidence_of(const sv_wall_volume *v, const sv_wall_layout *l, const sv_wall_levels *levels,
                         const uint8_t *bright, sv_wall_evidence *out) {
    uint64_t histogram[256] = {0};
    uint32_t tables[SV_WALL_TABLE_WORDS];
    *out = (sv_wall_evidence){0};
    sv_wall_tables(tables);
    if (!wall_histogram(v, l, levels->threshold, bright, histogram, out)) return false;
    if (out->wall_rays > 0 &&
        (uint64_t)out->wall_rays * SV_WALL_PER_MILLE >= (uint64_t)out->rays * l->wall_share) {
        out->wall = sv_wall_quantile(histogram, l->wall_rank);
        out->spread = odds(tables, sv_wall_quantile(histogram, l->high_rank)) -
                      odds(tables, sv_wall_quantile(histogram, l->low_rank));
        if (out->spread < SV_WALL_SPREAD_LEAST) out->spread = SV_WALL_SPREAD_LEAST;
    } else {
        const uint32_t wall = levels->bright * l->assumed_wall / SV_WALL_PER_MILLE;
        out->wall = wall < 255 * SV_WALL_LEVEL_ONE ? wall : 255 * SV_WALL_LEVEL_ONE;
        out->spread = l->assumed_spread;
    }
    for (uint32_t i = 0; i < 256; i++) {
        const int32_t more = odds(tables, i * SV_WALL_LEVEL_ONE) - odds(tables, out->wall);
        const int32_t above = more * (1 << SV_WALL_ODDS_BITS) / out->spread - l->level;
        out->other[i] = probability(tables, evidence(l, above));
        out->first[i] = probability(tables, evidence(l, above - l->first));
    }
    return true;
}
