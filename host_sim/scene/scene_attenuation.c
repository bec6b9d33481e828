/* SPDX-License-Identifier: MIT */
/*
 * Attenuation and time-gain compensation. On its way to depth z and back an echo loses
 *
 *     2 f  integral_0^z alpha(s) ds   [dB],  f in MHz, alpha in dB / (cm MHz), s in cm
 *
 * and 20 log10 of (1 - R^2) at every interface it crosses twice; the compensation adds 2 f alpha_tgc z (Szabo
 * 2014, chapters 4 and 6). What absorbs more than alpha_tgc throws a shadow, what absorbs less brightens what
 * lies behind. Beams run along +z.
 */
#include "scene/scene_attenuation.h"

#include "base/threads.h"

#include <stdlib.h>

typedef struct {
    hs_pass pass;
    float slope[HS_TISSUE_COUNT]; /* 64ths of a dB gained per voxel */
    float crossing[HS_TISSUE_COUNT][HS_TISSUE_COUNT];
} attenuation;

static void attenuate_row(void *context, uint32_t y) {
    const attenuation *a = context;
    hs_field *f = a->pass.field;
    enum { CHUNK = 64 };
    for (uint32_t first = 0; first < f->n[0]; first += CHUNK) {
        uint32_t width = f->n[0] - first < CHUNK ? f->n[0] - first : CHUNK;
        float gain[CHUNK] = {0};
        uint8_t before[CHUNK];
        for (uint32_t x = 0; x < width; x++) before[x] = f->tissue[hs_field_index(f, first + x, y, 0)];
        for (uint32_t z = 0; z < f->n[2]; z++) {
            size_t row = hs_field_index(f, first, y, z);
            for (uint32_t x = 0; x < width; x++) {
                uint8_t t = f->tissue[row + x];
                float half = 0.5f * a->slope[t];
                gain[x] += half + a->crossing[before[x]][t];
                int add = (int)lrintf(gain[x]);
                f->diffuse[row + x] = hs_level_clamp(f->diffuse[row + x] + add);
                if (f->coherent[row + x] > HS_LEVEL_SILENT)
                    f->coherent[row + x] = hs_level_clamp(f->coherent[row + x] + add);
                gain[x] += half;
                before[x] = t;
            }
        }
    }
}

void hs_scene_attenuation(hs_field *field, const hs_scene_spec *spec) {
    attenuation a = {.pass = {field, spec}};
    for (int t = 0; t < HS_TISSUE_COUNT; t++) {
        float excess = spec->attenuation.tgc_db_cm_mhz - spec->tissue[t].attenuation_db_cm_mhz;
        a.slope[t] = 2.0f * spec->frequency_mhz * excess * 0.1f * field->h[2] * (float)HS_LEVEL_ONE;
        for (int u = 0; u < HS_TISSUE_COUNT; u++) {
            float zt = spec->tissue[t].impedance_mrayl, zu = spec->tissue[u].impedance_mrayl;
            float r = (zu - zt) / (zu + zt);
            a.crossing[t][u] = (float)HS_LEVEL_ONE * 20.0f * log10f(1.0f - r * r);
        }
    }
    hs_parallel(field->threads, field->n[1], attenuate_row, &a);
}
