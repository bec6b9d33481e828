/*
 * The plate's energy (Eq. 3.4 on the pixel grid): the sum of S_xx^2 + 2 S_xy^2 + S_yy^2, second differences
 * where all their pixels exist, and a tension of a thousandth of the membrane's, which makes the surface
 * unique where the points do not: across collinear points, and for one or two.
 */
#include "ref/sv_ref_methods.h"

#include <stdlib.h>

static const double TENSION = (double)1e-3f; /* the kernels' own float32 constant */

/* Adds weight * (c . s) * c for one difference with coefficients c at the given pixels. */
static void add_element(const double *s, const size_t *at, const double *c, int count, double weight,
                        double *out) {
    double value = 0.0;
    for (int n = 0; n < count; n++) value += c[n] * s[at[n]];
    for (int n = 0; n < count; n++) out[at[n]] += weight * value * c[n];
}

void sv_ref_plate_energy(const double *s, uint32_t width, uint32_t height, double spacing, double *out) {
    const double bending = 1.0 / (spacing * spacing);
    static const double bend[] = {1.0, -2.0, 1.0}, twist[] = {1.0, -1.0, -1.0, 1.0}, slope[] = {1.0, -1.0};
    for (size_t y = 0; y < height; y++)
        for (size_t x = 0; x < width; x++) {
            const size_t i = y * width + x;
            if (x + 2 < width) add_element(s, (const size_t[]){i, i + 1, i + 2}, bend, 3, bending, out);
            if (y + 2 < height)
                add_element(s, (const size_t[]){i, i + width, i + (size_t)2 * width}, bend, 3, bending, out);
            if (x + 1 < width && y + 1 < height)
                add_element(s, (const size_t[]){i, i + 1, i + width, i + width + 1}, twist, 4, 2.0 * bending,
                            out);
            if (x + 1 < width) add_element(s, (const size_t[]){i, i + 1}, slope, 2, TENSION, out);
            if (y + 1 < height) add_element(s, (const size_t[]){i, i + width}, slope, 2, TENSION, out);
        }
}
