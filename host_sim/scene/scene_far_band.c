/* SPDX-License-Identifier: MIT */
/*
 * A bright band at the far bone of the head with a thin dark interval before it (thesis 5.3, Figure 5.16: "a
 * small interval with low intensity directly in front of the back part of the head bone ... It is likely that
 * the interval as well as the high intensity head bone are results of US artifacts"). The thesis gives no
 * model; this one sets the levels as the figure shows them: a shell of thickness_mm at level_db on the
 * skull's ellipsoid, and gap_mm of silence on its inner side, within angle_deg of a direction.
 */
#include "scene/scene_far_band.h"

#include "base/threads.h"
#include "scene/scene_fetus.h"
#include "scene/scene_fetus_head.h"

typedef struct {
    hs_pass pass;
    hs_solid skull;
    float direction[3], cosine;
    float gap, half; /* mm */
    int16_t level;
} far_band;

static void band_row(far_band *b, uint32_t y, uint32_t z) {
    hs_field *f = b->pass.field;
    for (uint32_t x = 0; x < f->n[0]; x++) {
        const float p[3] = {((float)x + 0.5f) * f->h[0], ((float)y + 0.5f) * f->h[1],
                            ((float)z + 0.5f) * f->h[2]};
        float along = 0.0f, length = 0.0f;
        for (int a = 0; a < 3; a++) {
            float d = p[a] - b->skull.centre[a];
            along += d * b->direction[a];
            length += d * d;
        }
        if (along < b->cosine * sqrtf(length)) continue;
        float d = hs_solid_distance(&b->skull, p);
        size_t index = hs_field_index(f, x, y, z);
        if (fabsf(d) <= b->half) {
            if (b->level > f->diffuse[index]) f->diffuse[index] = b->level;
        } else if (d < 0.0f && d >= -b->half - b->gap) {
            f->diffuse[index] = f->coherent[index] = HS_LEVEL_SILENT;
        }
    }
}

static void band_slice(void *context, uint32_t z) {
    far_band *b = context;
    const hs_field *f = b->pass.field;
    const hs_solid *s = &b->skull;
    float zmm = ((float)z + 0.5f) * f->h[2];
    if (zmm < s->low[2] - b->half || zmm > s->high[2] + b->half) return;
    for (uint32_t y = 0; y < f->n[1]; y++) band_row(b, y, z);
}

void hs_scene_far_band(hs_field *field, const hs_scene_spec *spec) {
    for (uint32_t i = 0; i < spec->structure_count; i++) {
        if (spec->structure[i].kind != HS_STRUCTURE_FETUS) continue;
        const hs_fetus_spec *fetus = &spec->structure[i].of.fetus;
        const hs_solid_frame body = hs_fetus_frame(fetus);
        hs_solid_frame head;
        hs_fetus_head_frame(&body, fetus->pose.head_turn_deg, &head);
        far_band b = {.pass = {field, spec}};
        hs_fetus_skull(&head, &b.skull);
        b.half = 0.5f * spec->far_band.thickness_mm;
        b.gap = spec->far_band.gap_mm;
        b.level = hs_level(spec->far_band.level_db);
        b.cosine = cosf(spec->far_band.angle_deg * 3.14159265f / 180.0f);
        const float *to = spec->far_band.direction;
        float length = sqrtf(to[0] * to[0] + to[1] * to[1] + to[2] * to[2]);
        for (int a = 0; a < 3; a++) b.direction[a] = to[a] / length;
        hs_parallel(field->threads, field->n[2], band_slice, &b);
    }
}
