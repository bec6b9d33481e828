/* SPDX-License-Identifier: MIT */
/* Log compression: grey = 255 (1 + (L + gain) / range), rounded, 1 .. 255. */
#include "scene/scene_compress.h"

#include "base/threads.h"

typedef struct {
    const hs_field *field;
    const uint8_t *grey; /* by level - HS_LEVEL_SILENT */
    uint8_t *voxels;
} compress;

static void compress_slice(void *context, uint32_t z) {
    const compress *c = context;
    size_t slice = hs_field_slice(c->field), start = slice * z;
    for (size_t i = start; i < start + slice; i++)
        c->voxels[i] = c->grey[c->field->envelope[i] - HS_LEVEL_SILENT];
}

void hs_scene_compress(const hs_field *field, const hs_scene_spec *spec, hs_volume *full) {
    uint8_t grey[HS_LEVEL_MAX - HS_LEVEL_SILENT + 1];
    for (int i = 0; i < (int)sizeof grey; i++) {
        float db = (float)(i + HS_LEVEL_SILENT) / (float)HS_LEVEL_ONE + spec->gain_db;
        float g = 255.0f * (1.0f + db / spec->dynamic_range_db);
        grey[i] = (uint8_t)lrintf(fminf(fmaxf(g, 1.0f), 255.0f));
    }
    compress c = {field, grey, full->voxels};
    hs_parallel(field->threads, field->n[2], compress_slice, &c);
}

/* Without speckle the two kinds of echo are added by power. */
static void add_slice(void *context, uint32_t z) {
    hs_field *f = context;
    size_t slice = hs_field_slice(f), start = slice * z;
    for (size_t i = start; i < start + slice; i++) {
        float a = hs_level_amplitude(f->diffuse[i]), b = hs_level_amplitude(f->coherent[i]);
        f->envelope[i] = hs_level_of_power(a * a + b * b);
    }
}

void hs_scene_add_powers(hs_field *field) {
    hs_parallel(field->threads, field->n[2], add_slice, field);
}
