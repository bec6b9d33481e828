/* SPDX-License-Identifier: MIT */
#include "scene/scene_field.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

bool hs_field_init(hs_field *field, const uint32_t n[3], const float h[3], hs_error *err) {
    size_t count = (size_t)n[0] * n[1] * n[2];
    memcpy(field->n, n, sizeof field->n);
    memcpy(field->h, h, sizeof field->h);
    field->tissue = malloc(count);
    field->surface = malloc(count);
    field->bone = malloc(count);
    field->diffuse = malloc(count * sizeof *field->diffuse);
    field->coherent = malloc(count * sizeof *field->coherent);
    field->envelope = malloc(count * sizeof *field->envelope);
    if (!field->tissue || !field->surface || !field->bone || !field->diffuse || !field->coherent ||
        !field->envelope) {
        hs_field_free(field);
        return hs_fail(err, HS_ERR_MEMORY, "scene: no memory for %zu voxels", count);
    }
    hs_level_tables();
    return true;
}

bool hs_field_add_style(hs_field *field, hs_error *err) {
    const size_t count = hs_field_slice(field) * field->n[2];
    field->style = malloc(count);
    field->share = malloc(count);
    return (field->style && field->share) ||
           hs_fail(err, HS_ERR_MEMORY, "scene: no memory for %zu voxels", count);
}

void hs_field_free(hs_field *field) {
    free(field->style);
    free(field->share);
    free(field->haze_end);
    free(field->tissue);
    free(field->surface);
    free(field->bone);
    free(field->diffuse);
    free(field->coherent);
    free(field->envelope);
    memset(field, 0, sizeof *field);
}

float hs_field_cosine(const hs_field *f, const int8_t *distance, uint32_t x, uint32_t y, uint32_t z) {
    const uint32_t at[3] = {x, y, z};
    const size_t stride[3] = {1, f->n[0], hs_field_slice(f)};
    const size_t index = hs_field_index(f, x, y, z);
    float g[3];
    for (int a = 0; a < 3; a++) {
        size_t back = at[a] > 0 ? index - stride[a] : index,
               ahead = at[a] + 1 < f->n[a] ? index + stride[a] : index;
        g[a] = (float)(distance[ahead] - distance[back]) / f->h[a];
    }
    float norm = sqrtf(g[0] * g[0] + g[1] * g[1] + g[2] * g[2]);
    return norm > 0.0f ? fabsf(g[2]) / norm : 0.0f;
}
