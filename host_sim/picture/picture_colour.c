/* SPDX-License-Identifier: MIT */
#include "picture/picture_colour.h"

/* Piecewise linear through `count` colours, t in 0 .. 1. */
static uint32_t interpolate(const uint32_t *colours, unsigned count, double t) {
    if (!(t > 0.0)) return colours[0];
    if (t >= 1.0) return colours[count - 1];
    const double at = t * (count - 1);
    const unsigned i = (unsigned)at;
    const double weight = at - i;
    uint32_t out = 0;
    for (unsigned shift = 0; shift < 24; shift += 8) {
        const double a = colours[i] >> shift & 255, b = colours[i + 1] >> shift & 255;
        out |= (uint32_t)(a + (b - a) * weight + 0.5) << shift;
    }
    return out;
}

uint32_t hs_colour_viridis(double t) {
    /* Viridis by N. Smith, S. van der Walt and E. Firing (matplotlib 2.0, 2015, CC0), sampled at ninths. */
    static const uint32_t points[] = {0x440154, 0x482878, 0x3e4a89, 0x31688e, 0x26828e,
                                      0x1f9e89, 0x35b779, 0x6dcd59, 0xb4de2c, 0xfde725};
    return interpolate(points, sizeof points / sizeof *points, t);
}

uint32_t hs_colour_diverging(double t) {
    /* The 11 classes of RdBu by C. Brewer (colorbrewer2.org, Apache 2.0), from blue to red. */
    static const uint32_t points[] = {0x053061, 0x2166ac, 0x4393c3, 0x92c5de, 0xd1e5f0, 0xf7f7f7,
                                      0xfddbc7, 0xf4a582, 0xd6604d, 0xb2182b, 0x67001f};
    return interpolate(points, sizeof points / sizeof *points, (t + 1.0) * 0.5);
}
