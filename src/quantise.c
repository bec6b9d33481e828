/* SPDX-License-Identifier: MIT */
#include "quantise.h"

#include <math.h>

enum {
    MAX_FRACTION = 16, /* 32-bit sums: 1 / 65,536 slice */
    MIN_FRACTION = 10, /* below this 32-bit sums are too coarse for the promised bound */
    QUOTIENT_BITS =
        23, /* 32-bit sums: fixed-point depths stay below 2^23, where a float32 still knows halves */
    WIDE_FRACTION = 20 /* 64-bit sums: slices and weights leave room for more bits, float32 does not */
};
static const double PROMISE = 1e-3; /* slices: the largest error against float64 (docs/numerics.md) */

uint32_t sv_grey_level(double threshold, uint32_t substeps) {
    const double level = floor(threshold * 255.0 * substeps + SV_LEVEL_SLACK);
    if (level < 0.0) return 0;
    return level > 255.0 * substeps ? 255 * substeps : (uint32_t)level;
}

uint32_t sv_rays_wanted(double fraction, uint32_t rays) {
    const double wanted = ceil(fraction * rays - SV_LEVEL_SLACK);
    return wanted < 1.0 ? 1 : (uint32_t)wanted;
}

uint32_t sv_gap_samples(double gap, uint32_t substeps) {
    return (uint32_t)ceil(gap * substeps - SV_LEVEL_SLACK);
}

void sv_fill_weights(double omega, uint32_t *weight_initial, uint32_t *weight_filled) {
    uint32_t quarters = (uint32_t)(omega * 4.0 + 0.5), whole = 4;
    while (whole > 1 && quarters % 2 == 0) {
        quarters /= 2;
        whole /= 2;
    }
    *weight_initial = whole;
    *weight_filled = quarters;
}

static uint32_t smaller(uint32_t a, uint32_t b) {
    return a < b ? a : b;
}

uint32_t sv_pass_limit(uint32_t width, uint32_t height, uint32_t k) {
    const uint32_t longest = width > height ? width : height;
    const uint32_t limit = (longest - 1 + k / 2 - 1) / (k / 2);
    return limit < 3 ? 3 : limit;
}

/* Every pass rounds to half a unit. Windows of 7 x 7 and more average that away; in smaller ones it was seen
 * to add up to an eighth of passes * half a unit (docs/numerics.md). */
static bool drifts(uint32_t k, uint32_t passes, uint32_t fraction) {
    return k < 7 && passes / 8.0 * 0.5 / (1u << fraction) > PROMISE;
}

sv_fixed sv_fixed_format(uint32_t width, uint32_t height, uint32_t slices, uint32_t k,
                         uint32_t weight_initial) {
    const uint64_t depth = slices > 1 ? slices - 1 : 1;
    const uint64_t window = (uint64_t)smaller(k, width) * smaller(k, height) * weight_initial;
    uint32_t fraction = MAX_FRACTION;
    while (fraction > 0 &&
           (window * (depth << fraction) > UINT32_MAX || (depth << fraction) >= 1u << QUOTIENT_BITS))
        fraction--;
    if (fraction < MIN_FRACTION || drifts(k, sv_pass_limit(width, height, k), fraction))
        return (sv_fixed){.fraction = WIDE_FRACTION, .wide = true};
    return (sv_fixed){.fraction = fraction};
}
