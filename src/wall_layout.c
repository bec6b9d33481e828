/* SPDX-License-Identifier: MIT */
#include "wall_layout.h"

#include <math.h>

#define GAUSSIAN_REACH 3.0 /* standard deviations */

sv_wall_settings sv_wall_settings_default(void) {
    return (sv_wall_settings){.block_mm = 2.0,
                              .beside_mm = 3.75,
                              .valley = 0.9,
                              .walled = 0.75,
                              .parted = 0.8,
                              .tissue = 0.15,
                              .wall_rank = 0.5,
                              .low_rank = 0.1,
                              .high_rank = 0.9,
                              .sure = 5.0,
                              .level = 0.4,
                              .first = 0.85,
                              .skin_mm = 5.5,
                              .tau_mm = 9.0,
                              .cut = 13.0,
                              .left = 5.6,
                              .other = 1.15,
                              .sigma_mm = 3.0,
                              .slack = 0.5,
                              .reach = 0.25,
                              .q = 0.5,
                              .median = true,
                              .aside_mm = 5.0,
                              .around_mm = 4.0,
                              .doubt = 4.2,
                              .wall_share = 0.15,
                              .fetus_share = 0.05,
                              .assumed_wall = 0.6,
                              .assumed_spread = 0.5};
}

/* A length in voxels, rounded half up; at least `least`. The hair makes up for a spacing that was rounded. */
static uint32_t voxels(double mm, double spacing, uint32_t least) {
    const double hair = 1e-4, n = floor(mm / spacing + 0.5 + hair);
    return n > least ? (uint32_t)n : least;
}

static uint32_t at_most(uint32_t value, uint32_t most) {
    return value < most ? value : most;
}

static uint32_t rounded(double value) {
    return (uint32_t)floor(value + 0.5);
}

/* Integer weights of a Gaussian, mirrored at 0, that sum up to SV_WALL_KERNEL_ONE; the one at 0 takes what
 * rounding leaves. */
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

/* Everything that is no length. */
static void take_numbers(sv_wall_layout *l, const sv_wall_settings *s) {
    const double odds_one = 1 << SV_WALL_ODDS_BITS;
    l->cut = rounded(s->cut * SV_WALL_ONE);
    l->left = rounded(s->left * SV_WALL_ONE);
    l->other = rounded(s->other * SV_WALL_ONE);
    l->slack = rounded(s->slack * SV_WALL_FINE_ONE);
    l->reach = rounded(s->reach * SV_WALL_FINE_ONE);
    l->q = (float)s->q;
    l->tissue = rounded(s->tissue * SV_WALL_PER_MILLE);
    l->valley = rounded(s->valley * SV_WALL_PER_MILLE);
    l->walled = rounded(s->walled * SV_WALL_PER_MILLE);
    l->parted = rounded(s->parted * SV_WALL_PER_MILLE);
    l->wall_share = rounded(s->wall_share * SV_WALL_PER_MILLE);
    l->fetus_share = rounded(s->fetus_share * SV_WALL_PER_MILLE);
    l->wall_rank = rounded(s->wall_rank * SV_WALL_PER_MILLE);
    l->low_rank = rounded(s->low_rank * SV_WALL_PER_MILLE);
    l->high_rank = rounded(s->high_rank * SV_WALL_PER_MILLE);
    l->assumed_wall = rounded(s->assumed_wall * SV_WALL_PER_MILLE);
    l->assumed_spread = (int)floor(s->assumed_spread * odds_one + 0.5);
    l->level = (int)floor(s->level * odds_one + 0.5);
    l->first = (int)floor(s->first * odds_one + 0.5);
    l->sure = (int)floor(s->sure * 16.0 + 0.5);
    l->median = s->median;
    l->doubt = (float)s->doubt;
}

/* The spacing that counts: what is not known is assumed, and what is out of range is brought into it. */
static void find_spacing(const sv_wall_layout *l, const double given[3], double mm[3]) {
    const uint32_t side = l->width > l->height ? l->width : l->height;
    const double assumed = SV_WALL_EXTENT_MM / (side > l->slices ? side : l->slices);
    for (int axis = 0; axis < 3; axis++)
        mm[axis] =
            fmin(fmax(given[axis] > 0.0 ? given[axis] : assumed, SV_WALL_SHORTEST_MM), SV_WALL_LONGEST_MM);
}

/* Voxels along a side of a block. */
static uint32_t side_of(const sv_wall_settings *s, double mm) {
    return at_most(voxels(s->block_mm, mm, 1), SV_WALL_BLOCK);
}

static uint32_t whole(uint32_t voxels, uint32_t side) {
    return (voxels + side - 1) / side;
}

/* The slack is capped so that the sums over it (slack * layers^2 / 2) stay below 2^32. */
sv_wall_layout sv_wall_layout_of(uint32_t width, uint32_t height, uint32_t slices, const double spacing_mm[3],
                                 const sv_wall_settings *s) {
    sv_wall_layout l = {.width = width, .height = height, .slices = slices};
    double mm[3];
    find_spacing(&l, spacing_mm, mm);
    l.columns = whole(width, side_of(s, mm[0]));
    l.rows = whole(height, side_of(s, mm[1]));
    l.depth = side_of(s, mm[2]);
    l.layers = whole(slices, l.depth);
    l.single[0] = l.columns == width;
    l.single[1] = l.rows == height;
    l.single[2] = l.depth == 1;
    const double block_mm[2] = {mm[0] * width / l.columns, mm[1] * height / l.rows};
    const double layer_mm = mm[2] * l.depth;
    for (int axis = 0; axis < 2; axis++) {
        l.beside[axis] = at_most(voxels(s->beside_mm, block_mm[axis], 0), SV_WALL_BESIDE);
        l.aside[axis] = at_most(voxels(s->aside_mm, block_mm[axis], 1), SV_WALL_BESIDE);
        l.around[axis] = at_most(voxels(s->around_mm, block_mm[axis], 1), SV_WALL_BESIDE);
    }
    l.skin = voxels(s->skin_mm, layer_mm, 0);
    l.far = at_most((uint32_t)ceil(s->tau_mm / layer_mm), SV_WALL_FAR);
    l.rate = rounded(ldexp(SV_WALL_ONE, SV_WALL_RATE_BITS) * fmin(layer_mm / s->tau_mm, 1.0));
    l.reach_x = gaussian(s->sigma_mm / block_mm[0], l.kernel_x);
    l.reach_y = gaussian(s->sigma_mm / block_mm[1], l.kernel_y);
    take_numbers(&l, s);
    l.slack = at_most(l.slack, (uint32_t)(((uint64_t)1 << 33) / l.layers / l.layers));
    return l;
}

sv_wall_span sv_wall_span_of(uint32_t block, uint32_t voxels, uint32_t blocks) {
    /* In halves of voxels; the centre of voxel i is 2 i + 1. */
    const uint64_t from = 2 * (uint64_t)block * voxels, to = 2 * (uint64_t)(block + 1) * voxels;
    sv_wall_span s = {.first = (uint32_t)(from / blocks / 2), .weight = 2};
    const bool inside = (2 * (uint64_t)s.first + 1) * blocks >= from;
    if (!inside) s.first++;
    s.shares_first = block > 0 && (2 * (uint64_t)s.first + 1) * blocks == from;
    uint32_t last = s.first;
    while (last + 1 < voxels && (2 * (uint64_t)last + 3) * blocks <= to) last++;
    s.shares_last = block + 1 < blocks && (2 * (uint64_t)last + 1) * blocks == to;
    s.count = last + 1 - s.first;
    s.weight = 2 * s.count - s.shares_first - s.shares_last;
    return s;
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
        tables[SV_WALL_CURVE + i] = rounded(SV_WALL_SURE / (1.0 + exp(-i * step)));
    tables[SV_WALL_CURVE + SV_WALL_LOGISTIC - 1] = tables[SV_WALL_CURVE + SV_WALL_LOGISTIC] = SV_WALL_SURE;
}
