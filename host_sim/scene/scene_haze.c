/* SPDX-License-Identifier: MIT */
/*
 * Haze and clutter. Between the many layers of the abdominal wall a pulse goes to and fro in many ways. Their
 * echoes come in late, at all depths behind the wall, without a phase in common, and the longer the way the
 * weaker they are: a haze in the fluid near the wall, which falls exponentially (Pinton, Trahey and Dahl,
 * IEEE Trans. UFFC 58, 2011; Lediju, Pihl, Dahl and Trahey, Ultrason. Imaging 30, 2008). At s mm behind the
 * wall's end its level is
 *
 *     L(s) = L_wall + level_db - decay_db_mm s + patch_db n(x, y, z)
 *
 * where L_wall is the wall's own scattered echo over its last 2 mm, and n is a smooth noise of -1 .. 1 with
 * patches of patch_mm: layers are no planes. It is added as power, behind the wall only, before the point
 * spread makes speckle of it.
 */
#include "scene/scene_haze.h"

#include "base/threads.h"
#include "scene/scene_random.h"

#include <math.h>

#define WALL_MM  2.0f
#define LEAST_DB (-110.0f) /* nothing of it can be seen below */

/* -1 .. 1 at a corner of the lattice. */
static float corner(uint64_t key, int32_t x, int32_t y, int32_t z) {
    const uint64_t at = ((uint64_t)(uint32_t)x & 0xffffu) | ((uint64_t)(uint32_t)y & 0xffffu) << 16 |
                        ((uint64_t)(uint32_t)z & 0xffffu) << 32;
    return 2.0f * hs_random_unit(key, at) - 1.0f;
}

/* Values at the corners of a lattice of `size` mm, blended by 3 t^2 - 2 t^3. */
static float smooth_noise(uint64_t key, const float p[3], float size) {
    int32_t cell[3];
    float t[3], sum = 0.0f;
    for (int a = 0; a < 3; a++) {
        float u = p[a] / size;
        cell[a] = (int32_t)floorf(u);
        u -= (float)cell[a];
        t[a] = u * u * (3.0f - 2.0f * u);
    }
    for (int i = 0; i < 8; i++) {
        const int dx = i & 1, dy = i >> 1 & 1, dz = i >> 2;
        const float weight =
            (dx ? t[0] : 1.0f - t[0]) * (dy ? t[1] : 1.0f - t[1]) * (dz ? t[2] : 1.0f - t[2]);
        sum += weight * corner(key, cell[0] + dx, cell[1] + dy, cell[2] + dz);
    }
    return sum;
}

/* The mean power of the last WALL_MM before slice `end`, in dB. */
static float wall_level(const hs_field *f, size_t pixel, uint32_t end) {
    const size_t slice = hs_field_slice(f);
    const uint32_t wanted = (uint32_t)ceilf(WALL_MM / f->h[2]), count = wanted < end ? wanted : end;
    float power = 0.0f;
    for (uint32_t z = end - count; z < end; z++) {
        const float a = hs_level_amplitude(f->diffuse[slice * z + pixel]);
        power += a * a;
    }
    return 10.0f * log10f(fmaxf(power / (float)count, 1e-20f));
}

static void haze_column(hs_field *f, const hs_haze_spec *haze, uint64_t key, uint32_t x, uint32_t y) {
    const size_t slice = hs_field_slice(f), pixel = (size_t)y * f->n[0] + x;
    uint32_t end = 0;
    while (end < f->n[2] && !hs_tissue_is_fluid(f->tissue[slice * end + pixel])) end++;
    if (end == 0 || end == f->n[2]) return;
    const float first = wall_level(f, pixel, end) + haze->level_db;
    for (uint32_t z = end; z < f->n[2]; z++) {
        const float behind = ((float)(z - end) + 0.5f) * f->h[2], falls = first - haze->decay_db_mm * behind;
        if (falls + haze->patch_db < LEAST_DB) return;
        const float p[3] = {((float)x + 0.5f) * f->h[0], ((float)y + 0.5f) * f->h[1],
                            ((float)z + 0.5f) * f->h[2]};
        const float patch =
            haze->patch_db > 0.0f ? haze->patch_db * smooth_noise(key, p, haze->patch_mm) : 0.0f;
        const float own = hs_level_amplitude(f->diffuse[slice * z + pixel]),
                    added = hs_level_amplitude(hs_level(falls + patch));
        f->diffuse[slice * z + pixel] = hs_level_of_power(own * own + added * added);
    }
}

static void haze_row(void *context, uint32_t y) {
    const hs_pass *pass = context;
    const uint64_t key = hs_random_key(pass->field->seed, 50);
    for (uint32_t x = 0; x < pass->field->n[0]; x++) haze_column(pass->field, &pass->spec->haze, key, x, y);
}

void hs_scene_haze(hs_field *field, const hs_scene_spec *spec) {
    hs_pass pass = {field, spec};
    hs_parallel(field->threads, field->n[1], haze_row, &pass);
}
