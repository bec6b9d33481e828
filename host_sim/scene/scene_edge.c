/* SPDX-License-Identifier: MIT */
/*
 * Edge (refraction) shadows. A beam that meets a curved surface at a grazing angle is bent or totally
 * reflected, and what lies behind the edge is dark (Robinson, Wilson and Kossoff, "Shadowing and enhancement
 * in ultrasonic echograms by reflection and refraction", J. Clin. Ultrasound 9, 1981). With Snell's law sin t
 * / c2 = sin i / c1 the transmitted part of the power is (Szabo 2014, chapter 3)
 *
 *     T = 4 Z1 Z2 cos i cos t / (Z2 cos i + Z1 cos t)^2,   T = 0 beyond the critical angle,
 *
 * and the echo loses 2 * -10 log10 T, at most max_loss_db. The loss at normal incidence belongs to the
 * attenuation step and is taken off here.
 */
#include "scene/scene_edge.h"

#include "base/threads.h"

#include <stdlib.h>
#include <string.h>

enum { COSINES = 64 };

typedef struct {
    hs_pass pass;
    float loss[HS_TISSUE_COUNT][HS_TISSUE_COUNT][COSINES + 1]; /* 64ths of a dB */
} edge;

static float transmitted(const hs_tissue_properties *a, const hs_tissue_properties *b, float cos_i) {
    float sin_t = b->speed_m_s / a->speed_m_s * sqrtf(fmaxf(1.0f - cos_i * cos_i, 0.0f));
    if (sin_t >= 1.0f || cos_i <= 0.0f) return 0.0f;
    float cos_t = sqrtf(1.0f - sin_t * sin_t), sum = b->impedance_mrayl * cos_i + a->impedance_mrayl * cos_t;
    return 4.0f * a->impedance_mrayl * b->impedance_mrayl * cos_i * cos_t / (sum * sum);
}

static void make_losses(edge *e) {
    const hs_scene_spec *spec = e->pass.spec;
    for (int a = 0; a < HS_TISSUE_COUNT; a++)
        for (int b = 0; b < HS_TISSUE_COUNT; b++) {
            float normal = transmitted(&spec->tissue[a], &spec->tissue[b], 1.0f);
            for (int c = 0; c <= COSINES; c++) {
                float t = transmitted(&spec->tissue[a], &spec->tissue[b], (float)c / COSINES);
                float db = t > 0.0f ? -20.0f * log10f(t / normal) : spec->edge.max_loss_db;
                e->loss[a][b][c] = (float)HS_LEVEL_ONE * fminf(fmaxf(db, 0.0f), spec->edge.max_loss_db);
            }
        }
}

/* Walks all columns of a row; a loss counts behind the interface it comes from. */
static void edge_row(void *context, uint32_t y) {
    const edge *e = context;
    hs_field *f = e->pass.field;
    enum { CHUNK = 64 };
    for (uint32_t first = 0; first < f->n[0]; first += CHUNK) {
        uint32_t width = f->n[0] - first < CHUNK ? f->n[0] - first : CHUNK;
        float lost[CHUNK] = {0};
        for (uint32_t z = 1; z < f->n[2]; z++) {
            size_t row = hs_field_index(f, first, y, z);
            for (uint32_t x = 0; x < width; x++) {
                uint8_t here = f->tissue[row + x], before = f->tissue[row + x - hs_field_slice(f)];
                int loss = (int)lrintf(lost[x]);
                if (loss) {
                    f->diffuse[row + x] = hs_level_clamp(f->diffuse[row + x] - loss);
                    f->coherent[row + x] = hs_level_clamp(f->coherent[row + x] - loss);
                }
                if (here == before) continue;
                bool bone = here == HS_TISSUE_BONE || before == HS_TISSUE_BONE;
                if (!bone && !hs_tissue_is_fluid(here) && !hs_tissue_is_fluid(before)) continue;
                float cosine = hs_field_cosine(f, bone ? f->bone : f->surface, first + x, y, z);
                lost[x] += e->loss[before][here][lrintf(COSINES * cosine)];
            }
        }
    }
}

void hs_scene_edge_shadow(hs_field *field, const hs_scene_spec *spec) {
    edge e = {.pass = {field, spec}};
    make_losses(&e);
    hs_parallel(field->threads, field->n[1], edge_row, &e);
}
