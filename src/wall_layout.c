/* SPDX-License-Identifier: MIT */
#include "wall_layout.h"

#include "smartvis_plugin.h"

#include <math.h>

#define GAUSSIAN_REACH 3.0 /* standard deviations */
#define SURE_OPENING   4u  /* a doubtful surface is opened over so many times what a sure one is */

sv_wall_settings sv_wall_settings_default(void) {
#define VALUE(name, value) .name = (value),
    return (sv_wall_settings){SV_WALL_CONSTANTS(VALUE).last = SV_WALL_EMPTY, .median = true};
#undef VALUE
}

#define HAIR 1e-4 /* tolerance for a spacing that was rounded, and for the rounding of quotients */

/* Converts a length to voxels, rounding half up; at least `least`. */
static uint32_t voxels(double mm, double spacing, uint32_t least) {
    const double n = floor(mm / spacing + 0.5 + HAIR);
    return n > least ? (uint32_t)n : least;
}

static uint32_t at_most(uint32_t value, uint32_t most) {
    return value < most ? value : most;
}

static uint32_t rounded(double value) {
    return (uint32_t)floor(value + 0.5);
}

/* Computes the integer weights of a Gaussian, mirrored at 0, that sum up to SV_WALL_KERNEL_ONE. The weight
 * at 0 takes what rounding leaves. Returns its reach. */
static uint32_t gaussian(double sigma, uint32_t *weights) {
    const double wanted = floor(GAUSSIAN_REACH * sigma + 0.5);
    const uint32_t reach = wanted < SV_WALL_KERNEL ? (uint32_t)wanted : SV_WALL_KERNEL;
    double sum = 1.0;
    for (uint32_t i = 1; i <= reach; i++) sum += 2.0 * exp(-0.5 * i * i / (sigma * sigma));
    uint32_t rest = SV_WALL_KERNEL_ONE;
    for (uint32_t i = 1; i <= reach; i++) {
        weights[i] = (uint32_t)(SV_WALL_KERNEL_ONE * exp(-0.5 * i * i / (sigma * sigma)) / sum + 0.5);
        rest -= 2 * weights[i];
    }
    weights[0] = rest;
    uint32_t last = reach;
    while (last > 0 && weights[last] == 0) last--;
    return last;
}

/* Converts all settings that are no lengths. */
static void take_numbers(sv_wall_layout *l, const sv_wall_settings *s) {
    const double odds_one = 1 << SV_WALL_ODDS_BITS;
    l->cut_cost = rounded(s->cut_cost * SV_WALL_COST_ONE);
    l->occluder_cost = rounded(s->occluder_cost * SV_WALL_COST_ONE);
    l->average_margin = rounded(s->average_margin * SV_WALL_FINE_COST_ONE);
    l->knob_margin = rounded(0.5 * s->average_margin * SV_WALL_FINE_COST_ONE);
    l->q = (float)s->q;
    l->threshold = rounded(s->threshold * SV_WALL_PER_MILLE);
    l->dark_rank = rounded(s->dark_rank * SV_WALL_PER_MILLE);
    l->tail_rank = rounded(s->tail_rank * SV_WALL_PER_MILLE);
    l->dim = rounded(s->dim * SV_WALL_TISSUE);
    l->darkness = l->dim < SV_WALL_TISSUE ? SV_WALL_PROBABILITY_ONE / (SV_WALL_TISSUE - l->dim) : 0;
    l->fluid_rank = rounded(s->fluid_rank * SV_WALL_PER_MILLE);
    l->gap_share = rounded(s->gap_share * SV_WALL_PER_MILLE);
    l->doubtful_share = rounded(s->doubtful_share * SV_WALL_PER_MILLE);
    l->clear_share = rounded(s->clear_share * SV_WALL_PER_MILLE);
    l->hysteresis = rounded(s->hysteresis * SV_WALL_PER_MILLE);
    l->last = (unsigned)s->last;
    l->doubtful_confidence = (float)s->doubtful_confidence;
    l->clip_doubtful = s->clip_doubtful;
    l->seen_share = rounded(s->seen_share * SV_WALL_PER_MILLE);
    l->assumed_wall = rounded(s->assumed_wall * SV_WALL_PER_MILLE);
    l->assumed_spread = (int)floor(s->assumed_spread * odds_one + 0.5);
    l->fetus_level = (int)floor(s->fetus_level * odds_one + 0.5);
    l->first_run_extra = (int)floor(s->first_run_extra * odds_one + 0.5);
    l->slope = (int)floor(s->slope * 16.0 + 0.5);
    l->valley = rounded(s->valley * SV_WALL_VALLEY_ONE);
    l->one_side = rounded(s->one_side * SV_WALL_PROBABILITY_ONE);
    l->median = s->median;
    l->half_confidence_cost = (float)s->half_confidence_cost;
}

void sv_wall_spacing_of(const sv_wall_layout *l, const double given[3], double mm[3]) {
    const uint32_t side = l->width > l->height ? l->width : l->height;
    const double assumed = (double)SV_ASSUMED_EXTENT_MM / (side > l->slices ? side : l->slices);
    for (int axis = 0; axis < 3; axis++)
        mm[axis] =
            fmin(fmax(given[axis] > 0.0 ? given[axis] : assumed, SV_WALL_SHORTEST_MM), SV_WALL_LONGEST_MM);
}

#define NEARLY 0.07 /* the sides of blocks may be so much longer or shorter than wanted */

static uint32_t whole(uint32_t voxels, uint32_t side) {
    return (voxels + side - 1) / side;
}

/* Returns the cells along an axis across the image. They have whole voxels if that comes near enough and
 * leaves none over, for that is fast. */
static uint32_t cells_of(const sv_wall_settings *s, uint32_t count, double mm) {
    const uint32_t side = at_most(voxels(s->block_mm, mm, 1), SV_WALL_BLOCK);
    const bool fits = count % side == 0 && fabs(side * mm / s->block_mm - 1.0) <= NEARLY + HAIR;
    if (side == SV_WALL_BLOCK || fits) return whole(count, side);
    return at_most(voxels(count * mm, s->block_mm, 1), count);
}

#define THICKER 0.25 /* a layer may be so much deeper than a block */

/* Returns the slices of a layer: as many as come nearest to a block, but none much deeper than that. */
static uint32_t depth_of(const sv_wall_settings *s, double mm) {
    const uint32_t depth = at_most(voxels(s->block_mm, mm, 1), SV_WALL_BLOCK);
    return depth > 1 && depth * mm > (1.0 + THICKER + HAIR) * s->block_mm ? depth - 1 : depth;
}

/* Converts all lengths and numbers for rays and layers that are so far apart. The margins are capped: the
 * average margin so that the sums over it (margin * layers^2 / 2) stay below 2^32, and both so that they and
 * the costs have 16 bits. */
static void take_settings(sv_wall_layout *l, const double ray_mm[2], double layer_mm,
                          const sv_wall_settings *s) {
    for (int axis = 0; axis < 2; axis++) {
        l->dilation[axis] = at_most(voxels(s->dilation_mm, 2.0 * ray_mm[axis], 0), SV_WALL_MAX_NEIGHBOUR);
        l->window[axis] = at_most(voxels(s->window_mm, 2.0 * ray_mm[axis], 0), SV_WALL_MAX_WINDOW);
        l->median_step[axis] = at_most(voxels(2.0 * s->sigma_mm, ray_mm[axis], 1), SV_WALL_MAX_NEIGHBOUR);
        l->opening[1][axis] = at_most(voxels(0.5 * s->opening_mm, ray_mm[axis], 0), SV_WALL_MAX_NEIGHBOUR);
        l->opening[0][axis] = (l->opening[1][axis] + SURE_OPENING / 2) / SURE_OPENING;
    }
    l->window[2] = at_most(voxels(s->window_mm, layer_mm, 0), SV_WALL_MAX_LAYERS);
    const double blocks = 4.0 * (2 * l->window[0] + 1) * (2 * l->window[1] + 1) * (2 * l->window[2] + 1);
    l->bright_blocks = (unsigned)fmax(rounded(s->bright_share * blocks), 1.0);
    l->near_field = voxels(s->tau_mm, layer_mm, 0);
    l->dim_front = SV_WALL_ALL_DIM;
    l->skin = voxels(s->skin_mm, layer_mm, 0);
    l->full_distance = at_most((uint32_t)ceil(s->tau_mm / layer_mm), SV_WALL_MAX_DISTANCE);
    l->rate = rounded(ldexp(SV_WALL_COST_ONE, SV_WALL_RATE_BITS) * fmin(layer_mm / s->tau_mm, 1.0));
    l->reach_x = gaussian(s->sigma_mm / (2.0 * ray_mm[0]), l->kernel_x);
    l->reach_y = gaussian(s->sigma_mm / (2.0 * ray_mm[1]), l->kernel_y);
    take_numbers(l, s);
    l->average_margin = at_most(l->average_margin, (uint32_t)(((uint64_t)1 << 33) / l->layers / l->layers));
    l->average_margin = at_most(l->average_margin, SV_WALL_FINE_COST_ONE - 1);
    l->knob_margin = at_most(l->knob_margin, SV_WALL_FINE_COST_ONE - 1);
}

sv_wall_layout sv_wall_layout_of(uint32_t width, uint32_t height, uint32_t slices, const double spacing_mm[3],
                                 const sv_wall_settings *s) {
    sv_wall_layout l = {.width = width, .height = height, .slices = slices};
    double mm[3];
    sv_wall_spacing_of(&l, spacing_mm, mm);
    l.cells[0] = cells_of(s, width, mm[0]);
    l.cells[1] = cells_of(s, height, mm[1]);
    l.columns = 2 * l.cells[0];
    l.rows = 2 * l.cells[1];
    l.depth = depth_of(s, mm[2]);
    l.layers = whole(slices, l.depth);
    l.smoothed = l.depth == 1;
    const double ray_mm[2] = {mm[0] * width / l.columns, mm[1] * height / l.rows};
    take_settings(&l, ray_mm, mm[2] * l.depth, s);
    return l;
}

sv_wall_layout sv_wall_layout_of_grid(uint32_t lines, uint32_t planes, uint32_t samples, double ray_mm,
                                      double layer_mm, const sv_wall_settings *s) {
    sv_wall_layout l = {.width = lines, .height = planes, .slices = samples};
    l.columns = lines;
    l.rows = planes;
    l.layers = samples;
    l.cells[0] = lines / 2;
    l.cells[1] = planes / 2;
    l.depth = 1;
    take_settings(&l, (double[]){ray_mm, ray_mm}, layer_mm, s);
    return l;
}

#define LEAST_REACH 0.75 /* voxels from a ray to the sides of its block: a single voxel is all speckle */

/* Computes whole weights that add up to SV_WALL_SPAN_ONE for voxels `first` and those behind it, of which
 * `part` lies in the block around `centre`. They are rounded down, and those that lost most get the rest,
 * the nearest first: so mirrored blocks get mirrored weights. */
static void weigh(const double *part, uint32_t count, double all, double first, double centre,
                  unsigned char *weight) {
    double lost[SV_WALL_SPAN + 1] = {0};
    uint32_t rest = SV_WALL_SPAN_ONE;
    for (uint32_t i = 0; i < count; i++) {
        const double wanted = part[i] * SV_WALL_SPAN_ONE / all;
        weight[i] = (unsigned char)floor(wanted + HAIR);
        lost[i] = wanted - weight[i] - HAIR * fabs(first + i + 0.5 - centre);
        rest -= weight[i];
    }
    for (; rest > 0; rest--) {
        uint32_t most = 0;
        for (uint32_t i = 1; i < count; i++)
            if (lost[i] > lost[most]) most = i;
        weight[most]++;
        lost[most] -= 1.0;
    }
}

/* Returns the span of a ray in the first half. */
static sv_wall_span near_span(uint32_t ray, uint32_t voxels, uint32_t rays) {
    const double step = (double)voxels / rays, centre = (ray + 0.5) * step;
    const double reach = fmax(step, LEAST_REACH), from = centre - reach, to = centre + reach;
    const double first = floor(from + HAIR);
    double part[SV_WALL_SPAN + 1];
    unsigned char weight[SV_WALL_SPAN + 1] = {0};
    uint32_t touched = 0;
    for (double at = first; at < to - HAIR && touched <= SV_WALL_SPAN; at += 1.0)
        part[touched++] = fmin(to, at + 1.0) - fmax(from, at);
    weigh(part, touched, to - from, first, centre, weight);
    sv_wall_span s = {.count = 0};
    for (uint32_t i = 0; i < touched; i++) {
        const double at = fmin(fmax(first + i, 0.0), voxels - 1.0);
        if (weight[i] == 0) continue;
        if (s.count == 0) s.first = (uint32_t)at;
        s.count = (uint32_t)at - s.first + 1;
        s.weight[s.count - 1] = (unsigned char)(s.weight[s.count - 1] + weight[i]);
    }
    return s;
}

sv_wall_span sv_wall_span_of(uint32_t ray, uint32_t voxels, uint32_t rays) {
    if (ray < rays / 2) return near_span(ray, voxels, rays);
    const sv_wall_span other = near_span(rays - 1 - ray, voxels, rays);
    sv_wall_span s = {.first = voxels - other.first - other.count, .count = other.count};
    for (uint32_t i = 0; i < s.count; i++) s.weight[i] = other.weight[s.count - 1 - i];
    return s;
}

sv_wall_taps sv_wall_taps_of(const sv_wall_span *spans, uint32_t x, uint32_t rays) {
    const uint32_t count = rays - x < SV_WALL_TOGETHER ? rays - x : SV_WALL_TOGETHER;
    int32_t low = INT32_MAX, end = INT32_MIN;
    sv_wall_taps t = {0};
    for (uint32_t i = 0; i < count; i++) {
        const int32_t first = (int32_t)spans[x + i].first - (int32_t)i;
        if (first < low) low = first;
        if (first + (int32_t)spans[x + i].count > end) end = first + (int32_t)spans[x + i].count;
    }
    if (end - low > SV_WALL_TAPS) return t;
    t.shift = low;
    t.count = (uint32_t)(end - low);
    for (uint32_t i = 0; i < count; i++)
        for (uint32_t k = 0; k < spans[x + i].count; k++)
            t.weight[(int32_t)(spans[x + i].first + k) - (int32_t)i - low][i] = spans[x + i].weight[k];
    return t;
}

#define HALF_PI 1.57079632679489661923

size_t sv_wall_pyramid_cells(uint32_t columns, uint32_t rows) {
    size_t cells = (size_t)columns * rows;
    while (columns > 1 || rows > 1) {
        columns = (columns + 1) / 2;
        rows = (rows + 1) / 2;
        cells += (size_t)columns * rows;
    }
    return cells;
}

void sv_wall_tables(uint32_t tables[SV_WALL_TABLE_WORDS]) {
    const double odds_one = 1 << SV_WALL_ODDS_BITS;
    const double step = (double)(1 << SV_WALL_LOGISTIC_BITS) / odds_one;
    for (int i = 0; i < 256; i++) tables[SV_WALL_ROOTS + i] = rounded(SV_WALL_ROOT_ONE * sqrt(i));
    for (int i = 0; i <= 256; i++) {
        const double level = fmin(fmax(i, 1.0), 255.0);
        tables[SV_WALL_ODDS + i] = (uint32_t)(int32_t)floor(odds_one * log(level / (255.5 - level)) + 0.5);
    }
    for (int i = 0; i <= SV_WALL_LOGISTIC; i++)
        tables[SV_WALL_CURVE + i] = rounded(SV_WALL_PROBABILITY_ONE / (1.0 + exp(-i * step)));
    for (int i = 0; i <= SV_WALL_SINE_STEPS + 1; i++)
        tables[SV_WALL_SINES + i] = rounded(ldexp(sin(i * HALF_PI / SV_WALL_SINE_STEPS), SV_WALL_SINE_BITS));
    tables[SV_WALL_CURVE + SV_WALL_LOGISTIC - 1] = tables[SV_WALL_CURVE + SV_WALL_LOGISTIC] =
        SV_WALL_PROBABILITY_ONE;
}
