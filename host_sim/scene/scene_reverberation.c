/* SPDX-License-Identifier: MIT */
/*
 * Reverberation bands. Between two parallel reflectors a distance d apart a pulse goes to and fro; the echo
 * of the far one at depth z2 comes back again at z2 + k d, weaker by the two reflections at every turn: A_k =
 * A_2 (R1 R2)^k (Feldman, Katyal and Blackwood, "US artifacts", RadioGraphics 29, 2009; Kremkau and Taylor,
 * J. Ultrasound Med. 5, 1986). loss_db stands for -20 log10(R1 R2). The reflectors of a column are where the
 * wall ends at the fluid, and the last boundary of its layers before.
 */
#include "scene/scene_reverberation.h"

#include "base/threads.h"

static void bands(hs_field *f, const hs_reverberation_spec *spec, size_t pixel, uint32_t far_z,
                  float spacing) {
    const size_t slice = hs_field_slice(f);
    const int16_t first = f->coherent[slice * far_z + pixel];
    for (uint32_t k = 1; k <= spec->count; k++) {
        float z = (float)far_z + (float)k * spacing;
        if (z > (float)(f->n[2] - 1)) return;
        size_t index = slice * (size_t)lrintf(z) + pixel;
        int16_t level = hs_level_clamp(first - (int)lrintf((float)k * spec->loss_db * (float)HS_LEVEL_ONE));
        if (level > f->coherent[index]) f->coherent[index] = level;
    }
}

static void reverberation_row(void *context, uint32_t y) {
    const hs_pass *pass = context;
    hs_field *f = pass->field;
    const hs_reverberation_spec *spec = &pass->spec->reverberation;
    const size_t slice = hs_field_slice(f);
    for (uint32_t x = 0; x < f->n[0]; x++) {
        size_t pixel = (size_t)y * f->n[0] + x;
        uint32_t boundary = 0, z = 1;
        for (; z < f->n[2] && !hs_tissue_is_fluid(f->tissue[slice * z + pixel]); z++)
            if (f->tissue[slice * z + pixel] != f->tissue[slice * (z - 1) + pixel]) boundary = z;
        if (z == f->n[2] || hs_tissue_is_fluid(f->tissue[pixel])) continue;
        float spacing = spec->spacing_mm > 0.0f ? spec->spacing_mm / f->h[2] : (float)(z - 1 - boundary);
        if (spacing >= 2.0f) bands(f, spec, pixel, z - 1, spacing);
    }
}

void hs_scene_reverberation(hs_field *field, const hs_scene_spec *spec) {
    hs_pass pass = {field, spec};
    hs_parallel(field->threads, field->n[1], reverberation_row, &pass);
}
