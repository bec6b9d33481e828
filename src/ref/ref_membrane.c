/* SPDX-License-Identifier: MIT */
/* The membrane's energy: the sum of (S_i - S_j)^2 over all pairs of pixels that share an edge. */
#include "ref/ref_membrane.h"

void sv_ref_membrane_energy(const double *s, uint32_t width, uint32_t height, double spacing, double *out) {
    (void)spacing;
    for (uint32_t y = 0; y < height; y++)
        for (uint32_t x = 0; x < width; x++) {
            const size_t i = (size_t)y * width + x;
            if (x + 1 < width) {
                out[i] += s[i] - s[i + 1];
                out[i + 1] += s[i + 1] - s[i];
            }
            if (y + 1 < height) {
                out[i] += s[i] - s[i + width];
                out[i + width] += s[i + width] - s[i];
            }
        }
}

/* NOLINTNEXTLINE(readability-non-const-parameter): the signature is that of all methods */
static bool of_task(const sv_ref_task *task, double *surface, uint8_t *either) {
    (void)either;
    return sv_ref_least_energy(&task->map, sv_ref_membrane_energy, task->settings->data_weight, surface);
}

const sv_ref_method sv_ref_method_membrane = {.name = "membrane", .surface = of_task};
