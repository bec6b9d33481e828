/* SPDX-License-Identifier: MIT */
#include "volume/metaimage_levels.h"

#include <string.h>

enum { LANES = 16 }; /* loops of a fixed length, which compilers turn into vectors */

void hs_met_widen(const double *value, size_t count, double *low, double *high) {
    double least[LANES], most[LANES];
    size_t i = 0;
    for (int k = 0; k < LANES; k++) {
        least[k] = *low;
        most[k] = *high;
    }
    for (; i + LANES <= count; i += LANES)
        for (int k = 0; k < LANES; k++) {
            const double v = value[i + (size_t)k];
            least[k] = v < least[k] ? v : least[k];
            most[k] = v > most[k] ? v : most[k];
        }
    for (; i < count; i++) {
        least[0] = value[i] < least[0] ? value[i] : least[0];
        most[0] = value[i] > most[0] ? value[i] : most[0];
    }
    for (int k = 0; k < LANES; k++) {
        *low = least[k] < *low ? least[k] : *low;
        *high = most[k] > *high ? most[k] : *high;
    }
}

double hs_met_scale(double low, double high) {
    return 255.0 / (high * 0.5 - low * 0.5);
}

static inline int level_of(double value, double half, double scale) {
    const double level = (value * 0.5 - half) * scale;
    const double at_least = level < 0.0 ? 0.0 : level;
    return (int)((at_least > 255.0 ? 255.0 : at_least) + 0.5);
}

void hs_met_levels(const double *value, size_t count, double low, double high, uint8_t *out) {
    const double half = low * 0.5, scale = hs_met_scale(low, high);
    size_t i = 0;
    for (; i + LANES <= count; i += LANES) {
        int level[LANES];
        for (int k = 0; k < LANES; k++) level[k] = level_of(value[i + (size_t)k], half, scale);
        for (int k = 0; k < LANES; k++) out[i + (size_t)k] = (uint8_t)level[k];
    }
    for (; i < count; i++) out[i] = (uint8_t)level_of(value[i], half, scale);
}

void hs_met_look_up(const uint8_t *table, const uint8_t *raw, uint32_t width, size_t count, uint8_t *out) {
    for (size_t i = 0; width == 1 && i < count; i++) out[i] = table[raw[i]];
    for (size_t i = 0; width == 2 && i < count; i++) {
        uint16_t pattern;
        memcpy(&pattern, raw + 2 * i, sizeof pattern);
        out[i] = table[pattern];
    }
}
