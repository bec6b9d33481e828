/* SPDX-License-Identifier: MIT */
#include "ref/ref_wall.h"

#include "ref/ref_wall_steps.h"
#include "wall_grid.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define LARGEST_SIDE 8192

static bool check_side(const char *name, uint32_t value, char *text, size_t size) {
    if (value >= 1 && value <= LARGEST_SIDE) return true;
    (void)snprintf(text, size, "%s is %u, allowed are 1 .. %d", name, value, LARGEST_SIDE);
    return false;
}

static bool check_spacing(const sv_wall_volume *v, char *text, size_t size) {
    const double *mm = v->spacing_mm;
    if (mm[0] == 0.0 && mm[1] == 0.0 && mm[2] == 0.0) return true;
    for (int axis = 0; axis < 3; axis++)
        if (!(mm[axis] >= SV_WALL_SHORTEST_MM && mm[axis] <= SV_WALL_LONGEST_MM)) {
            (void)snprintf(text, size, "spacing_mm[%d] is %g, allowed are %g .. %g, or 0 for all three", axis,
                           mm[axis], SV_WALL_SHORTEST_MM, SV_WALL_LONGEST_MM);
            return false;
        }
    return true;
}

bool sv_wall_check(const sv_wall_volume *v, char *text, size_t size) {
    if (!v->voxels) {
        (void)snprintf(text, size, "voxels is NULL");
        return false;
    }
    if (!check_side("width", v->width, text, size) || !check_side("height", v->height, text, size) ||
        !check_side("slices", v->slices, text, size) || !check_spacing(v, text, size))
        return false;
    if (!v->first != !v->end) {
        (void)snprintf(text, size, "%s is NULL and the other is not", v->first ? "end" : "first");
        return false;
    }
    for (size_t i = 0; v->first && i < (size_t)v->width * v->height; i++)
        if (v->first[i] > v->end[i] || v->end[i] > v->slices) {
            (void)snprintf(text, size, "ray (%zu, %zu): first %u, end %u; expected first <= end <= %u",
                           i % v->width, i / v->width, v->first[i], v->end[i], v->slices);
            return false;
        }
    return true;
}

static void clip_nothing(const sv_wall_layout *l, float *depth, float *confidence) {
    const size_t plane = (size_t)l->width * l->height;
    memset(depth, 0, plane * sizeof *depth);
    memset(confidence, 0, plane * sizeof *confidence);
}

/* Less than half of the dark before the fetus, or a doubtful surface: less confidence for all rays, which
 * keep their order. `share`: of the dark blocks in gaps, of 1000. */
static void lower_confidence(const sv_wall_layout *l, bool doubtful, uint32_t share, float *confidence) {
    const uint32_t half = SV_WALL_PER_MILLE / 2;
    const float clear = (float)share / (float)half;
    const float most = doubtful ? l->doubtful_confidence : fminf(clear, 1.0f);
    for (size_t i = 0; i < (size_t)l->width * l->height; i++) confidence[i] = most * confidence[i];
}

/* Costs the layers and selects the surface, unless the beams say that there is none. `told`: what they say,
 * or NULL. */
static bool cost_and_select(const sv_wall_scan *scan, const sv_wall_levels *levels,
                            const sv_wall_evidence *evidence, const sv_wall_told *told, float *depth,
                            float *confidence, sv_wall_outcome *outcome, sv_wall_facts *facts) {
    const sv_wall_layout *l = scan->layout;
    sv_wall_costs costs;
    sv_wall_gaps gaps = {0};
    if (!sv_wall_costs_create(scan, evidence, &costs)) return false;
    facts->fetus = (double)costs.fetus / ((double)scan->blocks->rays * SV_WALL_PROBABILITY_ONE);
    bool done = true;
    if (told) *outcome = told->outcome;
    if (!told || told->outcome == SV_WALL_SURFACE || told->outcome == SV_WALL_DOUBTFUL) {
        done = sv_wall_select_surface(scan, levels, &costs, told ? &told->outcome : NULL, depth, confidence,
                                      &gaps, outcome);
    }
    facts->share = gaps.dark ? (uint32_t)(gaps.in_gaps * SV_WALL_PER_MILLE / gaps.dark) : 0;
    if (done) {
        const bool doubtful = *outcome == SV_WALL_DOUBTFUL;
        lower_confidence(l, doubtful, told ? told->share : facts->share, confidence);
    }
    facts->wanted = (double)(*outcome == SV_WALL_NO_FETUS ? sv_wall_fetus_limit(l) : sv_wall_gap_limit(l)) /
                    SV_WALL_PER_MILLE;
    facts->gap_share = gaps.dark ? (double)gaps.in_gaps / (double)gaps.dark : 0.0;
    sv_wall_costs_destroy(&costs);
    return done;
}

/* Maps of every cell; each is allocated or NULL. */
typedef struct {
    uint8_t *brightness, *surroundings;
} cell_maps;

/* Makes what rays are judged from. False: no memory; the maps must be freed all the same. */
static bool make_maps(sv_wall_scan *scan, const sv_wall_levels *levels, const sv_wall_told *told,
                      cell_maps *maps, sv_wall_evidence *evidence) {
    scan->brightness = maps->brightness = sv_wall_brightness_map(scan->layout, scan->blocks);
    if (!maps->brightness) return false;
    sv_wall_evidence_of(scan, levels, evidence);
    scan->surroundings = maps->surroundings = sv_wall_surroundings_map(scan, evidence);
    if (!maps->surroundings) return false;
    if (told && told->limbs) sv_wall_mark_cells(told, told->limbs, scan->layout, maps->surroundings);
    return true;
}

/* The surface of a volume of two classes. */
static bool surface(const sv_wall_layout *l, sv_wall_blocks *blocks, const sv_wall_levels *levels,
                    const sv_wall_told *told, float *depth, float *confidence, sv_wall_outcome *outcome,
                    sv_wall_facts *facts) {
    sv_wall_evidence evidence;
    sv_wall_scan scan = {.layout = l, .blocks = blocks};
    cell_maps maps = {0};
    if (!sv_wall_relate_levels(l, levels, blocks)) return false;
    if (!told)
        sv_wall_skip_near_field(l, blocks);
    else if (!sv_wall_skip_told_field(told, l, blocks))
        return false;
    sv_wall_fill_dim_fronts(l, blocks);
    sv_wall_part_valleys(l, blocks);
    bool done = make_maps(&scan, levels, told, &maps, &evidence);
    if (done) {
        facts->wall_rays = evidence.wall_rays;
        facts->wall = (double)evidence.wall / SV_WALL_LEVEL_ONE;
        facts->spread = ldexp(evidence.spread, -SV_WALL_ODDS_BITS);
        done = cost_and_select(&scan, levels, &evidence, told, depth, confidence, outcome, facts);
    }
    free(maps.brightness);
    free(maps.surroundings);
    return done;
}

/* Finds the surface of a layout's blocks, if their levels have two classes. */
static bool surface_of_blocks(const sv_wall_layout *l, sv_wall_blocks *blocks, const sv_wall_told *told,
                              float *depth, float *confidence, sv_wall_outcome *outcome,
                              sv_wall_facts *facts) {
    uint64_t histogram[256];
    sv_wall_histogram(blocks, histogram);
    const sv_wall_levels levels = sv_wall_levels_of(l, histogram);
    *facts = (sv_wall_facts){.threshold = levels.threshold, .rays = blocks->rays};
    *outcome = SV_WALL_EMPTY;
    return !levels.two || surface(l, blocks, &levels, told, depth, confidence, outcome, facts);
}

/* Asks for the surface along the beams, and for the limbs that float behind it. */
static bool ask_beams(const sv_wall_blocks *camera, sv_wall_told *told, sv_wall_facts *facts) {
    const sv_wall_layout *l = told->layout;
    const size_t count = (size_t)l->columns * l->rows;
    sv_wall_blocks blocks;
    float *const maps = malloc(2 * count * sizeof *maps);
    bool done = maps && sv_wall_gather(camera, told->grid, l, &blocks);
    if (done) {
        done = surface_of_blocks(l, &blocks, NULL, maps, maps + count, &told->outcome, facts);
        told->share = facts->share;
        if (done && told->outcome != SV_WALL_EMPTY) {
            told->limbs = sv_wall_limbs_of(l, &blocks);
            told->near_field = sv_wall_near_field_of(l, &blocks);
            done = told->limbs && told->near_field;
        }
        sv_wall_blocks_destroy(&blocks);
    }
    free(maps);
    return done;
}

bool sv_wall_surface(const sv_wall_volume *v, const sv_wall_settings *settings, float *depth,
                     float *confidence, sv_wall_outcome *outcome, sv_wall_facts *facts) {
    char text[160];
    if (!sv_wall_check(v, text, sizeof text)) return false;
    const sv_wall_settings s = settings ? *settings : sv_wall_settings_default();
    const sv_wall_layout l = sv_wall_layout_of(v->width, v->height, v->slices, v->spacing_mm, &s);
    const sv_wall_layout beams = sv_wall_grid_layout(&s);
    sv_wall_blocks blocks;
    if (!sv_wall_blocks_create(v, &l, &blocks)) return false;
    sv_wall_grid grid;
    sv_wall_facts found, along;
    sv_wall_told said = {.grid = &grid, .layout = &beams};
    const bool told = v->beams && sv_wall_grid_of(&l, &beams, v->spacing_mm, v->beams, &s, &grid);
    bool done = !told || ask_beams(&blocks, &said, &along);
    if (done) done = surface_of_blocks(&l, &blocks, told ? &said : NULL, depth, confidence, outcome, &found);
    if (told) {
        found.gap_share = along.gap_share;
        found.fetus = along.fetus;
        found.wanted = along.wanted;
    }
    const bool clips = *outcome == SV_WALL_SURFACE || (*outcome == SV_WALL_DOUBTFUL && l.clip_doubtful);
    if (done && !clips) clip_nothing(&l, depth, confidence);
    sv_wall_blocks_destroy(&blocks);
    free(said.limbs);
    free(said.near_field);
    if (done && facts) *facts = found;
    return done;
}

/* Writes 0 in place of the padding value, and the ranges of what remains. */
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

/* Brings a spacing into the range that sv_wall_check allows. */
static double in_range(double mm) {
    return mm > 0.0 ? fmin(fmax(mm, SV_WALL_SHORTEST_MM), SV_WALL_LONGEST_MM) : 0.0;
}

bool sv_wall_surface_padded(const sv_ref_volume *v, const double spacing_mm[3], const sv_beams *beams,
                            const sv_wall_settings *settings, float *depth, float *confidence,
                            sv_wall_outcome *outcome, sv_wall_facts *facts) {
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
            .beams = beams,
            .spacing_mm = {in_range(spacing_mm[0]), in_range(spacing_mm[1]), in_range(spacing_mm[2])}};
        done = sv_wall_surface(&wall, settings, depth, confidence, outcome, facts);
    }
    free(voxels);
    free(ranges);
    return done;
}

/* NOLINTNEXTLINE(readability-non-const-parameter): the signature is that of all methods */
static bool of_task(const sv_ref_task *task, double *surface) {
    const size_t count = (size_t)task->map.width * task->map.height;
    float *maps = malloc(2 * count * sizeof *maps);
    sv_wall_outcome outcome;
    sv_wall_settings settings = sv_wall_settings_default();
    settings.q = task->q;
    const bool done = maps && sv_wall_surface_padded(task->volume, task->spacing_mm, NULL, &settings, maps,
                                                     maps + count, &outcome, NULL);
    for (size_t i = 0; done && i < count; i++) surface[i] = (double)maps[i];
    free(maps);
    return done;
}

/* Integers are used up to the cheapest layers, so these are the definition's. Then come some ten float32
 * operations on numbers up to the depth. Where division is rounded correctly nothing differs, elsewhere a
 * few units in the last place. */
static double bound(const sv_ref_task *task, const sv_ref_device *device) {
    (void)task;
    return device->slices * 16.0 * 0x1p-24;
}

const sv_ref_method sv_ref_method_wall = {.takes_volume = true, .bound = bound, .surface = of_task};
