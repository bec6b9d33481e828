/* SPDX-License-Identifier: MIT */
/*
 * Electronic noise: white, of level_db, added to the echo as power. The power of circular Gaussian noise is
 * exponentially distributed: N = -n^2 ln u (Goodman, "Statistical Optics", 1985, section 2.9).
 */
#include "scene/scene_noise.h"

#include "base/threads.h"
#include "scene/scene_random.h"

enum { QUANTILES = 4096 };

typedef struct {
    hs_field *field;
    uint64_t key;
    float power[QUANTILES];
} noise;

static void noise_slice(void *context, uint32_t z) {
    const noise *n = context;
    hs_field *f = n->field;
    size_t slice = hs_field_slice(f), start = slice * z;
    for (size_t i = start; i < start + slice; i++) {
        float a = hs_level_amplitude(f->envelope[i]);
        f->envelope[i] = hs_level_of_power(a * a + n->power[hs_random_bits(n->key, i) >> 52]);
    }
}

void hs_scene_noise(hs_field *field, const hs_scene_spec *spec) {
    noise n = {.field = field, .key = hs_random_key(field->noise_seed, 1)};
    float mean = powf(10.0f, spec->noise.level_db / 10.0f);
    for (int i = 0; i < QUANTILES; i++) n.power[i] = -mean * logf(((float)i + 0.5f) / QUANTILES);
    hs_parallel(field->threads, field->n[2], noise_slice, &n);
}
