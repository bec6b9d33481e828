#include "ref/ref_wall_evidence.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define LEAST_SPREAD 0.05 /* a wall of one single brightness */

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

/* ln of the odds: as the level nears 255, saturation squeezes differences, and this stretches them again. */
static double odds(double level) {
    const double x = fmin(fmax(level, 1.0), 255.0);
    return log(x / (255.5 - x));
}

static uint32_t probability(double evidence) {
    return (uint32_t)(SV_WALL_SURE / (1.0 + exp(-evidence)) + 0.5);
}

bool sv_wall_evidence_of(const sv_wall_volume *v, const sv_wall_layout *l, const sv_wall_settings *s,
                         const sv_wall_levels *levels, const uint8_t *bright, sv_wall_evidence *out) {
    uint64_t histogram[256] = {0};
    *out = (sv_wall_evidence){0};
    if (!wall_histogram(v, l, levels->threshold, bright, histogram, out)) return false;
    if (out->wall_rays > 0 && out->wall_rays >= s->wall_share * out->rays) {
        out->wall = sv_wall_quantile(histogram, s->wall_rank);
        out->spread = fmax(odds(sv_wall_quantile(histogram, s->high_rank)) -
                               odds(sv_wall_quantile(histogram, s->low_rank)),
                           LEAST_SPREAD);
    } else {
        out->wall = fmin(s->assumed_wall * levels->bright, 255.0);
        out->spread = s->assumed_spread;
    }
    for (int i = 0; i < 256; i++) {
        const double above = (odds(i) - odds(out->wall)) / out->spread - s->level;
        out->other[i] = probability(s->sure * above);
        out->first[i] = probability(s->sure * (above - s->first));
    }
    return true;
}
