/* SPDX-License-Identifier: MIT */
/*
 * A dark corner. Where a corner of the probe is lifted off the skin, or rib or bowel shades a part of the
 * aperture, all echoes of those beams come back weaker, at all depths alike, and the loss has no sharp
 * border. With u the distance from the image's middle in the direction of the corner,
 *
 *     loss(u) = loss_db s(t),   t = (u - start_mm) / width_mm in 0 .. 1,   s(t) = 3 t^2 - 2 t^3.
 *
 * The noise of the receiver comes later and is not weakened, so a corner of much loss holds noise.
 */
#include "scene/scene_corner.h"

#include "base/threads.h"

#include <math.h>

static int loss_at(const hs_field *f, const hs_corner_spec *c, uint32_t x, uint32_t y) {
    const float angle = c->direction_deg * (3.14159265f / 180.0f);
    const float u = ((float)x + 0.5f - 0.5f * (float)f->n[0]) * f->h[0];
    const float v = ((float)y + 0.5f - 0.5f * (float)f->n[1]) * f->h[1];
    const float along = (u * cosf(angle) + v * sinf(angle) - c->start_mm) / c->width_mm;
    const float t = fminf(fmaxf(along, 0.0f), 1.0f);
    return (int)lrintf(c->loss_db * t * t * (3.0f - 2.0f * t) * (float)HS_LEVEL_ONE);
}

static void corner_row(void *context, uint32_t y) {
    const hs_pass *pass = context;
    hs_field *f = pass->field;
    for (uint32_t x = 0; x < f->n[0]; x++) {
        const int loss = loss_at(f, &pass->spec->corner, x, y);
        for (uint32_t z = 0; loss > 0 && z < f->n[2]; z++) {
            const size_t index = hs_field_index(f, x, y, z);
            f->diffuse[index] = hs_level_clamp(f->diffuse[index] - loss);
            f->coherent[index] = hs_level_clamp(f->coherent[index] - loss);
        }
    }
}

void hs_scene_dark_corner(hs_field *field, const hs_scene_spec *spec) {
    hs_pass pass = {field, spec};
    hs_parallel(field->threads, field->n[1], corner_row, &pass);
}
