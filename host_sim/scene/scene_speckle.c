/* SPDX-License-Identifier: MIT */
/* The point spread of the beam: speckle, and the haze of its side lobes. */
#include "core/threads.h"
#include "scene/scene_field.h"
#include "scene/scene_random.h"
#include "volume/volume.h"

#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>

/*
 * Speckle. Every voxel holds a scatterer with a circular complex Gaussian amplitude whose mean power is the
 * tissue's; the sum over the point spread of the pulse is again circular Gaussian, so its magnitude A is
 * Rayleigh:
 *
 *     p(A) = A / s^2 exp(-A^2 / 2 s^2),   mean / standard deviation = sqrt(pi / (4 - pi)) = 1.91
 *
 * (Burckhardt, "Speckle in ultrasound B-mode scans", IEEE Trans. Sonics Ultrason. 25, 1978; Wagner et al.,
 * IEEE Trans. Sonics Ultrason. 30, 1983; the convolution model: Bamber and Dickinson, Phys. Med. Biol. 25,
 * 1980.) The point spread is Gaussian along the beam (the pulse) and across it, where it widens off the
 * focus as a Gaussian beam does: sigma(z) = sigma_0 sqrt(1 + ((z - z_f) / z_R)^2). Interfaces add their
 * echo in phase before the point spread.
 *
 * With slice_thickness the point spread across the image plane (y) is another one: a probe focuses there by
 * a lens, at one depth and with a small aperture, so the slice is thick, and off its focus much thicker
 * (Goldstein and Madsen, "Slice thickness artifacts in gray-scale ultrasound", J. Clin. Ultrasound 9,
 * 1981). Borders that are oblique to the slice fill the fluid beside them.
 */

enum { MAX_RADIUS = 96, LANES = 16, QUANTILES = 4096 };

typedef struct {
    float weight[MAX_RADIUS + 1]; /* of distance 0 .. radius on both sides */
    int radius;
    float sum; /* of all weights */
} kernel;

struct hs_speckle {
    hs_pass pass;
    uint32_t width; /* row length in floats, a multiple of LANES */
    size_t plane;   /* floats: height x width */
    float normal[QUANTILES];
    kernel axial;
    uint32_t slices; /* of the ring */
    float *ring;     /* slices that were drawn, and filtered across the beam: real part, imaginary part */
};

/* One thread's planes. */
typedef struct {
    float *raw, *lateral; /* real part, then imaginary part; one of them */
} planes;

/* Gaussian weights of unit energy: filtered noise keeps its mean power. */
static kernel gaussian(float sigma_voxels) {
    kernel k = {.radius = (int)ceilf(3.0f * sigma_voxels)};
    if (k.radius > MAX_RADIUS) k.radius = MAX_RADIUS;
    if (sigma_voxels < 0.2f) k.radius = 0;
    float energy = 0.0f;
    for (int i = 0; i <= k.radius; i++) {
        k.weight[i] = k.radius ? expf(-0.5f * (float)(i * i) / (sigma_voxels * sigma_voxels)) : 1.0f;
        energy += (i ? 2.0f : 1.0f) * k.weight[i] * k.weight[i];
    }
    for (int i = 0; i <= k.radius; i++) {
        k.weight[i] /= sqrtf(energy);
        k.sum += (i ? 2.0f : 1.0f) * k.weight[i];
    }
    return k;
}

/* Quantiles of the normal distribution by Newton's method on its integral, scaled to unit variance. A
 * draw is one of them, by 12 random bits; the point spread sums many draws. */
static void make_normal(float *table) {
    double x = -4.5, square = 0.0;
    for (int i = 0; i < QUANTILES; i++) {
        double p = ((double)i + 0.5) / QUANTILES;
        for (int step = 0; step < 60; step++) {
            double cdf = 0.5 * erfc(-x * 0.70710678118654752440);
            double move = (cdf - p) * 2.5066282746310002 * exp(0.5 * x * x);
            x -= move > 0.5 ? 0.5 : move < -0.5 ? -0.5 : move;
            if (fabs(move) < 1e-12) break;
        }
        table[i] = (float)x;
        square += x * x;
    }
    float scale = (float)sqrt(QUANTILES / square);
    for (int i = 0; i < QUANTILES; i++) table[i] *= scale;
}

/* Slice z of the scene in the ring. */
static float *slot_of(const hs_speckle *s, uint32_t z) {
    return s->ring + 2 * s->plane * (z % s->slices);
}

static kernel lateral_kernel(const hs_speckle *s, uint32_t z, int axis) {
    const hs_speckle_spec *spec = &s->pass.spec->speckle;
    const hs_slice_spec *slice = &s->pass.spec->slice;
    const bool thick = axis == 1 && slice->on;
    const float focus = thick ? slice->focus_mm : spec->focus_mm;
    const float rayleigh = thick ? slice->rayleigh_mm : spec->rayleigh_mm;
    const float narrowest_mm = thick ? slice->elevation_mm : spec->lateral_mm;
    float off = (((float)(s->pass.field->first + z) + 0.5f) * s->pass.field->h[2] - focus) / rayleigh;
    return gaussian(narrowest_mm * sqrtf(1.0f + off * off) / s->pass.field->h[axis]);
}

/* Scatterers and interfaces of slice z of the window. An interface is wide across the beam and thin along it:
 * it is scaled so that its peak keeps its level behind the point spread. */
static void draw(const hs_speckle *s, uint32_t z, const kernel *kx, const kernel *ky, const planes *p) {
    const hs_field *f = s->pass.field;
    const uint64_t before = (uint64_t)hs_field_slice(f) * f->first;
    float *re = p->raw, *im = p->raw + s->plane;
    const float keep = 1.0f / (kx->sum * ky->sum * s->axial.weight[0]);
    const float half = 0.70710678f; /* half of the power in each part */
    for (uint32_t y = 0; y < f->n[1]; y++) {
        size_t index = hs_field_index(f, 0, y, z), out = (size_t)y * s->width;
        for (uint32_t x = 0; x < f->n[0]; x++) {
            float amplitude = half * hs_level_amplitude(f->diffuse[index + x]);
            float interface = f->coherent[index + x] > HS_LEVEL_SILENT
                                  ? keep * hs_level_amplitude(f->coherent[index + x])
                                  : 0.0f;
            uint64_t bits = hs_random_bits(f->noise_seed, before + index + x);
            re[out + x] = amplitude * s->normal[bits >> 52] + interface;
            im[out + x] = amplitude * s->normal[(bits >> 40) & (QUANTILES - 1)];
        }
    }
}

/* out = in filtered along x; `row` holds radius zeros on both sides of the copy. */
static void filter_x(const float *in, float *out, uint32_t n, uint32_t width, const kernel *k) {
    float row[2 * MAX_RADIUS + HS_VOLUME_MAX_AXIS + LANES];
    const int r = k->radius;
    memset(row, 0, sizeof row);
    memcpy(row + r, in, n * sizeof *in);
    for (uint32_t x = 0; x < width; x += LANES) {
        const float *c = row + r + x;
        float sum[LANES];
        for (int l = 0; l < LANES; l++) sum[l] = k->weight[0] * c[l];
        for (int i = 1; i <= r; i++)
            for (int l = 0; l < LANES; l++) sum[l] += k->weight[i] * (c[l - i] + c[l + i]);
        memcpy(out + x, sum, sizeof sum);
    }
}

/* out = planes at distance i on both sides, weighted; a NULL plane lies outside. */
static void filter_across(const float *const *row, float *out, uint32_t width, const kernel *k) {
    const int r = k->radius;
    for (uint32_t x = 0; x < width; x += LANES) {
        float sum[LANES];
        for (int l = 0; l < LANES; l++) sum[l] = k->weight[0] * row[r][x + (uint32_t)l];
        for (int i = 1; i <= r; i++) {
            const float *above = row[r - i], *below = row[r + i];
            if (above)
                for (int l = 0; l < LANES; l++) sum[l] += k->weight[i] * above[x + (uint32_t)l];
            if (below)
                for (int l = 0; l < LANES; l++) sum[l] += k->weight[i] * below[x + (uint32_t)l];
        }
        memcpy(out + x, sum, sizeof sum);
    }
}

/* Slice z of the window, drawn and filtered across the beam, into the ring. */
static void make_slice(const hs_speckle *s, uint32_t z, const planes *p) {
    const hs_field *f = s->pass.field;
    kernel kx = lateral_kernel(s, z, 0), ky = lateral_kernel(s, z, 1);
    draw(s, z, &kx, &ky, p);
    float *slot = slot_of(s, f->first + z);
    for (int part = 0; part < 2; part++) {
        float *raw = p->raw + (size_t)part * s->plane, *lateral = p->lateral;
        for (uint32_t y = 0; y < f->n[1]; y++)
            filter_x(raw + (size_t)y * s->width, lateral + (size_t)y * s->width, f->n[0], s->width, &kx);
        for (uint32_t y = 0; y < f->n[1]; y++) {
            const float *row[2 * MAX_RADIUS + 1];
            for (int i = -ky.radius; i <= ky.radius; i++) {
                int64_t at = (int64_t)y + i;
                bool inside = at >= 0 && at < (int64_t)f->n[1];
                row[ky.radius + i] = inside ? lateral + (size_t)at * s->width : NULL;
            }
            filter_across(row, slot + (size_t)part * s->plane + (size_t)y * s->width, s->width, &ky);
        }
    }
}

/* The slices of a block, as even as they can be shared. */
static void block_range(const hs_field *f, uint32_t block, uint32_t *first, uint32_t *end) {
    const uint32_t count = f->high - f->low;
    *first = f->low + (uint32_t)((uint64_t)count * block / f->threads);
    *end = f->low + (uint32_t)((uint64_t)count * (block + 1) / f->threads);
}

static void draw_block(void *context, uint32_t block) {
    const hs_speckle *s = context;
    hs_field *f = s->pass.field;
    uint32_t z, end;
    block_range(f, block, &z, &end);
    if (z == end) return;
    float *memory = malloc(3 * s->plane * sizeof *memory);
    if (!memory) {
        atomic_store(&f->out_of_memory, true);
        return;
    }
    const planes p = {memory, memory + 2 * s->plane};
    for (; z < end; z++) make_slice(s, z, &p);
    free(memory);
}

/* Filters along the beam and takes the magnitude. */
static void finish_slice(void *context, uint32_t slice) {
    const hs_speckle *s = context;
    hs_field *f = s->pass.field;
    const int r = s->axial.radius;
    const uint32_t z = f->low + slice;
    float part[2][HS_VOLUME_MAX_AXIS + LANES] = {{0}};
    for (uint32_t y = 0; y < f->n[1]; y++) {
        for (int k = 0; k < 2; k++) {
            const float *row[2 * MAX_RADIUS + 1];
            for (int i = -r; i <= r; i++) {
                const int64_t at = (int64_t)f->first + z + i;
                const bool inside = at >= 0 && at < (int64_t)f->end;
                row[r + i] =
                    inside ? slot_of(s, (uint32_t)at) + (size_t)k * s->plane + (size_t)y * s->width : NULL;
            }
            filter_across(row, part[k], s->width, &s->axial);
        }
        size_t index = hs_field_index(f, 0, y, z);
        for (uint32_t x = 0; x < f->n[0]; x++)
            f->envelope[index + x] = hs_level_of_power(part[0][x] * part[0][x] + part[1][x] * part[1][x]);
    }
}

static kernel axial_kernel(const hs_scene_spec *spec, float slice_mm) {
    return gaussian(spec->speckle.axial_mm / slice_mm);
}

uint32_t hs_speckle_reach(const hs_scene_spec *spec, float slice_mm) {
    return spec->speckle.on ? (uint32_t)axial_kernel(spec, slice_mm).radius : 0;
}

hs_speckle *hs_speckle_begin(hs_field *field, const hs_scene_spec *spec, uint32_t slices) {
    hs_speckle *s = calloc(1, sizeof *s);
    if (!s) return NULL;
    s->pass = (hs_pass){field, spec};
    s->width = (field->n[0] + LANES - 1) / LANES * LANES;
    s->plane = (size_t)s->width * field->n[1];
    s->axial = axial_kernel(spec, field->h[2]);
    make_normal(s->normal);
    s->slices = slices + 2 * (uint32_t)s->axial.radius;
    if (s->slices > field->end) s->slices = field->end;
    s->ring = malloc(2 * s->plane * s->slices * sizeof *s->ring);
    if (s->ring) return s;
    free(s);
    return NULL;
}

void hs_speckle_end(hs_speckle *s) {
    if (s) free(s->ring);
    free(s);
}

void hs_speckle_draw(hs_speckle *s) {
    hs_field *f = s->pass.field;
    atomic_store(&f->out_of_memory, false);
    hs_parallel(f->threads, f->threads, draw_block, s);
}

void hs_speckle_finish(hs_speckle *s) {
    const hs_field *f = s->pass.field;
    hs_parallel(f->threads, f->high - f->low, finish_slice, s);
}

/*
 * Side-lobe haze. Energy outside the main beam hits strong reflectors beside it, and their echoes appear as
 * haze in the fluid at the same depth (Laing and Kurtz, "The importance of ultrasonic side-lobe artifacts",
 * Radiology 145, 1982). A uniform aperture's first side lobe lies 13.3 dB below the main lobe one way, 26.5
 * dB both ways (Szabo 2014, chapter 6); level_db is that number. The lobes of a wide-band pulse run together,
 * so the pattern is a smooth one:
 *
 *     H = 10^(level_db / 20) * (interface amplitude blurred over width_mm across the beam),  A^2 + H^2
 */

typedef struct {
    hs_pass pass;
    uint32_t radius[2]; /* voxels of the box in x and y; two boxes make a triangle */
    float factor;
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

/* Averages across the rows, for all columns at once. */
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
    const side_lobes *s = context;
    hs_field *f = s->pass.field;
    const uint32_t nx = f->n[0], ny = f->n[1];
    const size_t slice = hs_field_slice(f), start = slice * (f->low + z);
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
        atomic_store(&f->out_of_memory, true);
    }
    free(sum);
    free(a);
}

void hs_scene_side_lobes(hs_field *field, const hs_scene_spec *spec) {
    side_lobes s = {.pass = {field, spec}};
    for (int axis = 0; axis < 2; axis++)
        s.radius[axis] = (uint32_t)lrintf(0.25f * spec->side_lobe.width_mm / field->h[axis]);
    s.factor = powf(10.0f, spec->side_lobe.level_db / 20.0f);
    hs_parallel(field->threads, field->high - field->low, lobe_slice, &s);
}
