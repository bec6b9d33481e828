/* SPDX-License-Identifier: MIT */
/*
 * The plate's energy (Eq. 3.4 on the pixel grid): the sum of S_xx^2 + 2 S_xy^2 + S_yy^2, second differences
 * where all their pixels exist, and a tension of a thousandth of the membrane's, which makes the surface
 * unique where the points do not: across collinear points, and for one or two.
 */
#include "ref/ref_plate.h"

#include <stdlib.h>

static const double TENSION = (double)1e-3f; /* the kernels' own float32 constant */

/* Each adds weight * (c . s) * c for one difference with coefficients c: 1, -2, 1 on three
 * pixels `step` apart, */
static inline void add_bend(const double *s, size_t i, size_t step, double weight, double *out) {
    const double value = weight * (s[i] - 2.0 * s[i + step] + s[i + 2 * step]);
    out[i] += value;
    out[i + step] -= 2.0 * value;
    out[i + 2 * step] += value;
}

/* 1, -1, -1, 1 on a square of pixels, */
static inline void add_twist(const double *s, size_t i, size_t width, double weight, double *out) {
    const double value = weight * (s[i] - s[i + 1] - s[i + width] + s[i + width + 1]);
    out[i] += value;
    out[i + 1] -= value;
    out[i + width] -= value;
    out[i + width + 1] += value;
}

/* 1, -1 on neighbours. */
static inline void add_slope(const double *s, size_t i, size_t step, double weight, double *out) {
    const double value = weight * (s[i] - s[i + step]);
    out[i] += value;
    out[i + step] -= value;
}

void sv_ref_plate_energy(const double *s, uint32_t width, uint32_t height, double spacing, double *out) {
    const double bending = 1.0 / (spacing * spacing);
    for (size_t y = 0; y < height; y++)
        for (size_t x = 0; x < width; x++) {
            const size_t i = y * width + x;
            if (x + 2 < width) add_bend(s, i, 1, bending, out);
            if (y + 2 < height) add_bend(s, i, width, bending, out);
            if (x + 1 < width && y + 1 < height) add_twist(s, i, width, 2.0 * bending, out);
            if (x + 1 < width) add_slope(s, i, 1, TENSION, out);
            if (y + 1 < height) add_slope(s, i, width, TENSION, out);
        }
}

/* NOLINTNEXTLINE(readability-non-const-parameter): the signature is that of all methods */
static bool of_task(const sv_ref_task *task, double *surface, uint8_t *either) {
    (void)either;
    return sv_ref_least_energy(&task->map, sv_ref_plate_energy, task->settings->data_weight, surface);
}

const sv_ref_method sv_ref_method_plate = {.name = "plate", .surface = of_task};
