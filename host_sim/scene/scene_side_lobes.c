/* SPDX-License-Identifier: MIT */
/*
 * Side-lobe haze. Energy outside the main beam hits strong reflectors beside it, and their echoes appear as
 * haze in the fluid at the same depth (Laing and Kurtz, "The importance of ultrasonic side-lobe artifacts",
 * Radiology 145, 1982). A uniform aperture's first side lobe lies 13.3 dB below the main lobe one way, 26.5
 * dB both ways (Szabo 2014, chapter 6); level_db is that number. The lobes of a wide-band pulse run together,
 * so the pattern is a smooth one:
 *
 *     H = 10^(level_db / 20) * (interface amplitude blurred over width_mm across the beam),  A^2 + H^2
 */
#include "scene/scene_side_lobes.h"

#include "base/threads.h"

#include <stdatomic.h>
#include <stdlib.h>

typedef struct {
    hs_pass pass;
    uint32_t radius[2]; /* voxels of the box in x and y; two boxes make a triangle */
    float factor;
    atomic_bool out_of_memory;
} side_lobes;

/* One box of 2 r + 1 samples along every row by a running sum; outside is 0. The sum is in double, so that
 * what goes in comes out again. */
static void box_along(const float *in, float *out, uint32_t nx, uint32_t ny, uint32_t r) {
    for (uint32_t y = 0; y < ny; y++, in += nx, out += nx) {
        double sum = 0.0;
        for (uint32_t x = 0; x < r && x < nx; x++) sum += (double)in[x];
        for (uint32_t x = 0; x < nx; x++) {
            if (x + r < nx) sum += (double)in[x + r];
            if (x > r) sum -= (double)in[x - r - 1];
            out[x] = (float)(sum / (2.0 * r + 1.0));
        }
    }
}

/* The same across the rows, for all columns at once. */
static void box_across(const float *in, float *out, double *sum, uint32_t nx, uint32_t ny, uint32_t r) {
    for (uint32_t x = 0; x < nx; x++) sum[x] = 0.0;
    for (uint32_t y = 0; y < r && y < ny; y++)
        for (uint32_t x = 0; x < nx; x++) sum[x] += (double)in[(size_t)y * nx + x];
    for (uint32_t y = 0; y < ny; y++) {
        const float *enters = y + r < ny ? in + ((size_t)y + r) * nx : NULL;
        const float *leaves = y > r ? in + ((size_t)y - r - 1) * nx : NULL;
        for (uint32_t x = 0; enters && x < nx; x++) sum[x] += (double)enters[x];
        for (uint32_t x = 0; leaves && x < nx; x++) sum[x] -= (double)leaves[x];
        for (uint32_t x = 0; x < nx; x++) out[(size_t)y * nx + x] = (float)(sum[x] / (2.0 * r + 1.0));
    }
}

static void lobe_slice(void *context, uint32_t z) {
    side_lobes *s = context;
    hs_field *f = s->pass.field;
    const uint32_t nx = f->n[0], ny = f->n[1];
    const size_t slice = hs_field_slice(f), start = slice * z;
    float *a = calloc(2 * slice, sizeof *a);
    double *sum = calloc(nx, sizeof *sum);
    if (a && sum) {
        float *b = a + slice;
        for (size_t i = 0; i < slice; i++) a[i] = hs_level_amplitude(f->coherent[start + i]);
        box_along(a, b, nx, ny, s->radius[0]);
        box_along(b, a, nx, ny, s->radius[0]);
        box_across(a, b, sum, nx, ny, s->radius[1]);
        box_across(b, a, sum, nx, ny, s->radius[1]);
        for (size_t i = 0; i < slice; i++) {
            float haze = s->factor * a[i], main = hs_level_amplitude(f->envelope[start + i]);
            if (haze > 1e-5f * main) f->envelope[start + i] = hs_level_of_power(main * main + haze * haze);
        }
    } else {
        atomic_store(&s->out_of_memory, true);
    }
    free(sum);
    free(a);
}

bool hs_scene_side_lobes(hs_field *field, const hs_scene_spec *spec, hs_error *err) {
    side_lobes s = {.pass = {field, spec}};
    for (int axis = 0; axis < 2; axis++)
        s.radius[axis] = (uint32_t)lrintf(0.25f * spec->side_lobe.width_mm / field->h[axis]);
    s.factor = powf(10.0f, spec->side_lobe.level_db / 20.0f);
    atomic_init(&s.out_of_memory, false);
    hs_parallel(field->threads, field->n[2], lobe_slice, &s);
    return !atomic_load(&s.out_of_memory) ||
           hs_fail(err, HS_ERR_MEMORY, "scene %s: no memory for side lobes", spec->name);
}
