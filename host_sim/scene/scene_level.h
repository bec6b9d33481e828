/* SPDX-License-Identifier: MIT */
/* Echo levels: decibels in memory, and back to amplitudes. */
#ifndef HS_SCENE_LEVEL_H
#define HS_SCENE_LEVEL_H

#include <math.h>
#include <stdint.h>
#include <string.h>

/*
 * Decibels: a level is L = 20 log10(A / A_max), A the echo's amplitude and A_max the one the display shows as
 * 255. So 6 dB is a factor of two in amplitude, and a power ratio is 10 log10. Attenuation coefficients are
 * one-way, amplitudes lose 2 f alpha z on the way there and back. Levels are int16 in 64ths of a dB.
 */
#define HS_LEVEL_ONE    64                    /* a dB */
#define HS_LEVEL_SILENT (-200 * HS_LEVEL_ONE) /* nothing comes back */
#define HS_LEVEL_MAX    (60 * HS_LEVEL_ONE)

/* dB to a level, saturated. */
static inline int16_t hs_level(float db) {
    float v = db * (float)HS_LEVEL_ONE;
    if (!(v > (float)HS_LEVEL_SILENT)) return HS_LEVEL_SILENT;
    return v < (float)HS_LEVEL_MAX ? (int16_t)lrintf(v) : (int16_t)HS_LEVEL_MAX;
}

/* A sum of levels, saturated. */
static inline int16_t hs_level_clamp(int v) {
    return (int16_t)(v < HS_LEVEL_SILENT ? HS_LEVEL_SILENT : v > HS_LEVEL_MAX ? HS_LEVEL_MAX : v);
}

/* Makes the tables between level and amplitude, once per process. Any thread. */
void hs_level_tables(void);

extern float hs_level_amplitude_table[HS_LEVEL_MAX - HS_LEVEL_SILENT + 1];
/* Amplitude of a level, 10^(L / 20); 0 for silence. */
static inline float hs_level_amplitude(int16_t level) {
    return hs_level_amplitude_table[level - HS_LEVEL_SILENT];
}
extern float hs_level_mantissa_table[1024];
/* The level of a power (a squared amplitude): its exponent and the upper 10 bits of its mantissa are looked
 * at. With the rounding to 64ths it is right to 0.01 dB. */
static inline int16_t hs_level_of_power(float power) {
    uint32_t bits;
    memcpy(&bits, &power, sizeof bits);
    int exponent = (int)(bits >> 23) - 127; /* the sign is 0 */
    float level =
        (float)exponent * (3.01029996f * HS_LEVEL_ONE) + hs_level_mantissa_table[(bits >> 13) & 1023u];
    return hs_level_clamp((int)lrintf(level));
}

#endif
