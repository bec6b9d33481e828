/* SPDX-License-Identifier: MIT */
/*
 * Haze and clutter. Between the many layers of the abdominal wall a pulse goes to and fro in many ways.
 * Their echoes come in late, at all depths behind the wall and without a phase in common, and the longer
 * the way the weaker they are: a haze in the fluid near the wall, which falls exponentially. In bladders
 * clutter was 0 to 30 dB below the wall's echo (Lediju, Pihl, Dahl and Trahey, Ultrason. Imaging 30, 2008),
 * and behind the abdominal wall it was mostly reverberation (Lediju et al., IEEE Ultrasonics Symp. 2008).
 * At s mm behind the wall's end its level is
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
#include <stdlib.h>

#define WALL_MM    2.0f
#define LEAST_DB   (-100.0f) /* nothing of it can be seen below */
#define FLUID_GREY 40.5f     /* T_L */
#define SPECKLE_DB 4.0f

/* -1 .. 1 at a corner of the lattice. */
static float corner(uint64_t key, int32_t x, int32_t y, int32_t z) {
    const uint64_t at = ((uint64_t)(uint32_t)x & 0xffffu) | ((uint64_t)(uint32_t)y & 0xffffu) << 16 |
                        ((uint64_t)(uint32_t)z & 0xffffu) << 32;
    return 2.0f * hs_random_unit(key, at) - 1.0f;
}

/* The noise along one column. A lattice plane crosses it once per patch, so a plane's value is kept. */
typedef struct {
    uint64_t key;
    int32_t cell[2], plane; /* in x and y; of value[0] */
    float weight[2], value[2];
} noise_column;

static float eased(float t) {
    return t * t * (3.0f - 2.0f * t);
}

/* What a lattice plane has on the column: the four corners around it, blended. */
static float plane_value(const noise_column *n, int32_t plane) {
    float row[2];
    for (int j = 0; j < 2; j++) {
        const float left = corner(n->key, n->cell[0], n->cell[1] + j, plane);
        const float right = corner(n->key, n->cell[0] + 1, n->cell[1] + j, plane);
        row[j] = left + n->weight[0] * (right - left);
    }
    return row[0] + n->weight[1] * (row[1] - row[0]);
}

static noise_column start_noise(uint64_t key, const float p[2]) {
    noise_column n = {.key = key, .plane = INT32_MIN};
    for (int a = 0; a < 2; a++) {
        n.cell[a] = (int32_t)floorf(p[a]);
        n.weight[a] = eased(p[a] - (float)n.cell[a]);
    }
    return n;
}

/* -1 .. 1 at depth z, in patches. */
static float noise_at(noise_column *n, float z) {
    const int32_t plane = (int32_t)floorf(z);
    if (plane != n->plane) {
        n->plane = plane;
        n->value[0] = plane_value(n, plane);
        n->value[1] = plane_value(n, plane + 1);
    }
    return n->value[0] + eased(z - (float)plane) * (n->value[1] - n->value[0]);
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

/* How deep the haze can be seen, mm: its brightest patches, with speckle 4 dB above the mean, come to
 * T_L there. */
static float visible_until(const hs_scene_spec *spec, float first, float end_mm) {
    const hs_haze_spec *haze = &spec->haze;
    const float least = spec->dynamic_range_db * (FLUID_GREY / 255.0f - 1.0f) - spec->gain_db;
    return end_mm + fmaxf(first + haze->patch_db + SPECKLE_DB - least, 0.0f) / haze->decay_db_mm;
}

static void haze_column(const hs_pass *pass, uint64_t key, uint32_t x, uint32_t y) {
    hs_field *f = pass->field;
    const hs_haze_spec *haze = &pass->spec->haze;
    const size_t slice = hs_field_slice(f), pixel = (size_t)y * f->n[0] + x;
    uint32_t end = 0;
    while (end < f->n[2] && !hs_tissue_is_fluid(f->tissue[slice * end + pixel])) end++;
    f->haze_end[pixel] = 0.0f;
    if (end == 0 || end == f->n[2]) return;
    const float first = wall_level(f, pixel, end) + haze->level_db, size = 1.0f / haze->patch_mm;
    const float p[2] = {((float)x + 0.5f) * f->h[0] * size, ((float)y + 0.5f) * f->h[1] * size};
    noise_column noise = start_noise(key, p);
    f->haze_end[pixel] = visible_until(pass->spec, first, (float)end * f->h[2]);
    for (uint32_t z = end; z < f->n[2]; z++) {
        const float behind = ((float)(z - end) + 0.5f) * f->h[2];
        float level = first - haze->decay_db_mm * behind;
        if (level + haze->patch_db < LEAST_DB) return;
        if (haze->patch_db > 0.0f)
            level += haze->patch_db * noise_at(&noise, ((float)z + 0.5f) * f->h[2] * size);
        const float own = hs_level_amplitude(f->diffuse[slice * z + pixel]),
                    added = hs_level_amplitude(hs_level(level));
        f->diffuse[slice * z + pixel] = hs_level_of_power(own * own + added * added);
    }
}

static void haze_row(void *context, uint32_t y) {
    const hs_pass *pass = context;
    const uint64_t key = hs_random_key(pass->field->seed, 50);
    for (uint32_t x = 0; x < pass->field->n[0]; x++) haze_column(pass, key, x, y);
}

bool hs_scene_haze(hs_field *field, const hs_scene_spec *spec, hs_error *err) {
    hs_pass pass = {field, spec};
    field->haze_end = calloc(hs_field_slice(field), sizeof *field->haze_end);
    if (!field->haze_end) return hs_fail(err, HS_ERR_MEMORY, "scene %s: no memory for haze", spec->name);
    hs_parallel(field->threads, field->n[1], haze_row, &pass);
    return true;
}
