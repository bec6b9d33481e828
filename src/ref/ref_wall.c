#include "ref/ref_wall.h"

#include "ref/ref_wall_surface.h"

#include <stdlib.h>
#include <string.h>

static void clip_nothing(const sv_wall_layout *l, float *depth, float *confidence) {
    const size_t plane = (size_t)l->width * l->height;
    memset(depth, 0, plane * sizeof *depth);
    memset(confidence, 0, plane * sizeof *confidence);
}

/* The surface of a volume with fluid. `bright` holds the means. */
static bool surface(const sv_wall_volume *v, const sv_wall_layout *l, const sv_wall_settings *s,
                    const sv_wall_levels *levels, uint8_t *bright, float *depth, float *confidence,
                    sv_wall_outcome *outcome, sv_wall_facts *facts) {
    sv_wall_evidence evidence;
    if (!sv_wall_brightest(l, bright) || !sv_wall_evidence_of(v, l, s, levels, bright, &evidence))
        return false;
    facts->rays = evidence.rays;
    facts->wall_rays = evidence.wall_rays;
    facts->wall = evidence.wall;
    facts->spread = evidence.spread;
    const sv_wall_scan scan = {v, l, &evidence, levels->threshold, bright};
    sv_wall_cells cells;
    if (!sv_wall_cells_create(&scan, &cells)) return false;
    facts->fetus = (double)cells.fetus / ((double)evidence.rays * SV_WALL_SURE);
    *outcome = facts->fetus < s->fetus_share ? SV_WALL_NO_FETUS : SV_WALL_SURFACE;
    bool done = true;
    if (*outcome == SV_WALL_SURFACE)
        done = sv_wall_cheapest(l, s, &cells, depth, confidence);
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
    const sv_wall_layout l = sv_wall_layout_of(v, &s);
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
    *outcome = !levels.two ? SV_WALL_EMPTY : levels.valley > s.valley ? SV_WALL_NO_FLUID : SV_WALL_SURFACE;
    if (*outcome == SV_WALL_SURFACE)
        done = surface(v, &l, &s, &levels, means, depth, confidence, outcome, &found);
    else
        clip_nothing(&l, depth, confidence);
    free(means);
    if (done && facts) *facts = found;
    return done;
}
