/*
 * Side-lobe haze. Energy outside the main beam hits strong reflectors beside it, and their echoes appear as
 * haze in the fluid at the same depth (Laing and Kurtz, "The importance of ultrasonic side-lobe artifacts",
 * Radiology 145, 1982). A uniform aperture's first side lobe lies 13.3 dB below the main lobe one way, 26.5
 * dB both ways (Szabo 2014, chapter 6); level_db is that number. The lobes of a wide-band pulse run together,
 * so the pattern is a smooth one:
 *
 *     H = 10^(level_db / 20) * (interface amplitude blurred over width_mm across the beam),  A^2 + H^2
 */
#include "hs_scene_field.h"
#include "hs_scene_threads.h"

#include <stdatomic.h>
#include <stdlib.h>

typedef struct {
    hs_pass pass;
    int radius[2]; /* voxels of the box in x and y; two boxes make a triangle */
    float factor;
    atomic_bool out_of_memory;
} side_lobes;

/* One box of 2 r + 1 samples by a running sum; outside is 0. `in` and `out` step by `stride`. */
static void box(const float *in, float *out, uint32_t n, size_t stride, int r) {
    double sum = 0.0; /* in double, so that what goes in comes out again */
    for (int i = 0; i < r && i < (int)n; i++) sum += (double)in[(size_t)i * stride];
    for (int i = 0; i < (int)n; i++) {
        if (i + r < (int)n) sum += (double)in[(size_t)(i + r) * stride];
        if (i - r - 1 >= 0) sum -= (double)in[(size_t)(i - r - 1) * stride];
        out[(size_t)i * stride] = (float)(sum / (double)(2 * r + 1));
    }
}

static void lobe_slice(void *context, uint32_t z) {
    side_lobes *s = context;
    hs_field *f = s->pass.field;
    const size_t slice = hs_field_slice(f), start = slice * z;
    float *a = malloc(2 * slice * sizeof *a), *b = a + slice;
    if (!a) {
        atomic_store(&s->out_of_memory, true);
        return;
    }
    for (size_t i = 0; i < slice; i++) a[i] = hs_level_amplitude(f->coherent[start + i]);
    for (uint32_t y = 0; y < f->n[1]; y++) {
        size_t row = (size_t)y * f->n[0];
        box(a + row, b + row, f->n[0], 1, s->radius[0]);
        box(b + row, a + row, f->n[0], 1, s->radius[0]);
    }
    for (uint32_t x = 0; x < f->n[0]; x++) {
        box(a + x, b + x, f->n[1], f->n[0], s->radius[1]);
        box(b + x, a + x, f->n[1], f->n[0], s->radius[1]);
    }
    for (size_t i = 0; i < slice; i++) {
        float haze = s->factor * a[i], main = hs_level_amplitude(f->envelope[start + i]);
        if (haze > 1e-5f * main) f->envelope[start + i] = hs_level_of_power(main * main + haze * haze);
    }
    free(a);
}

bool hs_scene_side_lobes(hs_field *field, const hs_scene_spec *spec, hs_error *err) {
    side_lobes s = {.pass = {field, spec}};
    for (int axis = 0; axis < 2; axis++)
        s.radius[axis] = (int)lrintf(0.25f * spec->side_lobe.width_mm / field->h[axis]);
    s.factor = powf(10.0f, spec->side_lobe.level_db / 20.0f);
    atomic_init(&s.out_of_memory, false);
    hs_scene_parallel(field->threads, field->n[2], lobe_slice, &s);
    return !atomic_load(&s.out_of_memory) ||
           hs_fail(err, HS_ERR_MEMORY, "scene %s: no memory for side lobes", spec->name);
}
