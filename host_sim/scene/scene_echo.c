/* SPDX-License-Identifier: MIT */
/* Echo levels, from what tissues send back to grey: echo, the far band, receiver noise, compression. */
#include "core/threads.h"
#include "scene/scene_field.h"
#include "scene/scene_random.h"
#include "scene/scene_solid.h"

/*
 * What the tissues send back before anything happens to it on the way: scattered echo, of random phase, and
 * the echo of interfaces. The amplitude reflected by an interface is R = (Z2 - Z1) / (Z2 + Z1) (Szabo 2014,
 * chapter 3), and it falls with the angle t between beam and normal as a power of the cosine, as simulators
 * by geometrical acoustics set it (Kutter, Shams and Navab, Comput. Methods Programs Biomed. 94, 2009;
 * Burger et al., IEEE Trans. Med. Imaging 32, 2013):
 *
 *     L = specular_db + 20 log10(R cos^p t)
 *
 * A soft edge is no interface: where the impedance grows linearly over a depth d, the reflections of its
 * layers cancel, and what is left is R sin(k d) / (k d) with k = 2 pi f / c (Born's approximation; Szabo
 * 2014, chapter 8). Its envelope, 1 / (k d), is taken. The power of its scatterers grows linearly, too,
 * from the fluid's to the tissue's.
 *
 * An interface's echo is laid into the outermost voxel of the tissue, so the fluid's side holds nothing but
 * fluid.
 */

typedef struct {
    hs_pass pass;
    int16_t scatter[HS_TISSUE_COUNT];
    int16_t reflect[HS_TISSUE_COUNT][HS_TISSUE_COUNT];
    int16_t layers;     /* what a boundary of layers loses */
    int16_t cosine[65]; /* level of cos^power at 64 steps of the cosine */
    int16_t share[256]; /* level of a share of the scatterers' power */
    int16_t soft[HS_SCENE_MAX_STRUCTURES + 1], brighter[HS_SCENE_MAX_STRUCTURES + 1]; /* by style */
} echo;

static float reflection(const hs_scene_spec *spec, int a, int b) {
    float za = spec->tissue[a].impedance_mrayl, zb = spec->tissue[b].impedance_mrayl;
    return fabsf(zb - za) / (zb + za);
}

static int16_t interface_level(const echo *e, uint32_t x, uint32_t y, uint32_t z) {
    const hs_field *f = e->pass.field;
    size_t index = hs_field_index(f, x, y, z);
    uint8_t here = f->tissue[index];
    if (hs_tissue_is_fluid(here)) return HS_LEVEL_SILENT;
    /* The outermost voxel of the tissue: its centre is less than one voxel inside. */
    if (here == HS_TISSUE_BONE && f->bone[index] > -HS_DISTANCE_ONE)
        return hs_level_clamp(e->reflect[HS_TISSUE_BONE][HS_TISSUE_SOFT] +
                              e->cosine[lrintf(64.0f * hs_field_cosine(f, f->bone, x, y, z))]);
    if (f->surface[index] > -HS_DISTANCE_ONE)
        return hs_level_clamp(e->reflect[here][HS_TISSUE_FLUID] +
                              e->cosine[lrintf(64.0f * hs_field_cosine(f, f->surface, x, y, z))]);
    if (z == 0) return HS_LEVEL_SILENT;
    /* Layers of the wall lie across the beam. */
    uint8_t before = f->tissue[index - hs_field_slice(f)];
    if (before == here || here >= HS_TISSUE_SOFT) return HS_LEVEL_SILENT;
    return hs_level_clamp(e->reflect[before][here] + e->layers);
}

/* The fluid's power is too small to be told from none. */
static void styled(const echo *e, size_t index) {
    hs_field *f = e->pass.field;
    const uint8_t style = f->style[index];
    if (style == 0) return;
    f->diffuse[index] = hs_level_clamp(f->diffuse[index] + e->brighter[style] + e->share[f->share[index]]);
    if (f->diffuse[index] < e->scatter[HS_TISSUE_FLUID]) f->diffuse[index] = e->scatter[HS_TISSUE_FLUID];
    if (f->coherent[index] > HS_LEVEL_SILENT)
        f->coherent[index] = hs_level_clamp(f->coherent[index] + e->soft[style]);
}

static void echo_slice(void *context, uint32_t slice) {
    const echo *e = context;
    hs_field *f = e->pass.field;
    const uint32_t z = f->low + slice;
    for (uint32_t y = 0; y < f->n[1]; y++)
        for (uint32_t x = 0; x < f->n[0]; x++) {
            size_t index = hs_field_index(f, x, y, z);
            f->diffuse[index] = e->scatter[f->tissue[index]];
            f->coherent[index] = interface_level(e, x, y, z);
            if (f->style) styled(e, index);
        }
}

static void make_styles(echo *e) {
    const hs_scene_spec *spec = e->pass.spec;
    for (int i = 0; i < 256; i++)
        e->share[i] = i ? hs_level(10.0f * log10f((float)i / 255.0f)) : (int16_t)HS_LEVEL_SILENT;
    for (uint32_t i = 0; i < spec->structure_count; i++) {
        if (spec->structure[i].kind != HS_STRUCTURE_OCCLUDER) continue;
        const hs_occluder_spec *o = &spec->structure[i].of.occluder;
        /* mm by MHz and m/s: d f / c = 10^3 mm MHz / (m/s) */
        const float kd =
            6.2831853f * 1e3f * spec->frequency_mhz * o->soft_mm / spec->tissue[o->tissue].speed_m_s;
        e->soft[i + 1] = hs_level(-20.0f * log10f(fmaxf(kd, 1.0f)));
        e->brighter[i + 1] = hs_level(o->echo_db);
    }
}

void hs_scene_echo(hs_field *field, const hs_scene_spec *spec) {
    echo e = {.pass = {field, spec}, .layers = hs_level(spec->layers.boundary_db)};
    for (int a = 0; a < HS_TISSUE_COUNT; a++) {
        e.scatter[a] = hs_level(spec->tissue[a].echo_db);
        for (int b = 0; b < HS_TISSUE_COUNT; b++) {
            float r = reflection(spec, a, b);
            e.reflect[a][b] =
                r > 0.0f ? hs_level(spec->specular_db + 20.0f * log10f(r)) : (int16_t)HS_LEVEL_SILENT;
        }
    }
    for (int i = 0; i <= 64; i++)
        e.cosine[i] =
            i ? hs_level(20.0f * spec->specular_power * log10f((float)i / 64.0f)) : (int16_t)HS_LEVEL_SILENT;
    make_styles(&e);
    hs_parallel(field->threads, field->high - field->low, echo_slice, &e);
}

/*
 * A bright band at the far bone of the head with a thin dark interval before it (thesis 5.3, Figure 5.16: "a
 * small interval with low intensity directly in front of the back part of the head bone ... It is likely that
 * the interval as well as the high intensity head bone are results of US artifacts"). The thesis gives no
 * model; this one sets the levels as the figure shows them: a shell of thickness_mm at level_db on the
 * skull's ellipsoid, and gap_mm of silence on its inner side, within angle_deg of a direction.
 */

typedef struct {
    hs_pass pass;
    hs_solid skull;
    float direction[3], cosine;
    float gap, half; /* mm */
    int16_t level;
} far_band;

static void band_row(far_band *b, uint32_t y, uint32_t z) {
    hs_field *f = b->pass.field;
    for (uint32_t x = 0; x < f->n[0]; x++) {
        const float p[3] = {((float)x + 0.5f) * f->h[0], ((float)y + 0.5f) * f->h[1],
                            ((float)(f->first + z) + 0.5f) * f->h[2]};
        float along = 0.0f, length = 0.0f;
        for (int a = 0; a < 3; a++) {
            float d = p[a] - b->skull.centre[a];
            along += d * b->direction[a];
            length += d * d;
        }
        if (along < b->cosine * sqrtf(length)) continue;
        float d = hs_solid_distance(&b->skull, p);
        size_t index = hs_field_index(f, x, y, z);
        if (fabsf(d) <= b->half) {
            if (b->level > f->diffuse[index]) f->diffuse[index] = b->level;
        } else if (d < 0.0f && d >= -b->half - b->gap) {
            f->diffuse[index] = f->coherent[index] = HS_LEVEL_SILENT;
        }
    }
}

static void band_slice(void *context, uint32_t slice) {
    far_band *b = context;
    const hs_field *f = b->pass.field;
    const hs_solid *s = &b->skull;
    const uint32_t z = f->low + slice;
    float zmm = ((float)(f->first + z) + 0.5f) * f->h[2];
    if (zmm < s->low[2] - b->half || zmm > s->high[2] + b->half) return;
    for (uint32_t y = 0; y < f->n[1]; y++) band_row(b, y, z);
}

void hs_scene_far_band(hs_field *field, const hs_scene_spec *spec) {
    for (uint32_t i = 0; i < spec->structure_count; i++) {
        if (spec->structure[i].kind != HS_STRUCTURE_FETUS) continue;
        far_band b = {.pass = {field, spec}};
        hs_fetus_skull(&spec->structure[i].of.fetus, &b.skull);
        b.half = 0.5f * spec->far_band.thickness_mm;
        b.gap = spec->far_band.gap_mm;
        b.level = hs_level(spec->far_band.level_db);
        b.cosine = cosf(spec->far_band.angle_deg * 3.14159265f / 180.0f);
        const float *to = spec->far_band.direction;
        float length = sqrtf(to[0] * to[0] + to[1] * to[1] + to[2] * to[2]);
        for (int a = 0; a < 3; a++) b.direction[a] = to[a] / length;
        hs_parallel(field->threads, field->high - field->low, band_slice, &b);
    }
}

/*
 * Electronic noise: white, of level_db, added to the echo as power. The power of circular Gaussian noise is
 * exponentially distributed: N = -n^2 ln u (Goodman, "Statistical Optics", 1985, section 2.9).
 */

enum { QUANTILES = 4096 };

typedef struct {
    hs_field *field;
    uint64_t key;
    float power[QUANTILES];
} noise;

static void noise_slice(void *context, uint32_t z) {
    const noise *n = context;
    hs_field *f = n->field;
    size_t slice = hs_field_slice(f), start = slice * (f->low + z), before = slice * f->first;
    for (size_t i = start; i < start + slice; i++) {
        float a = hs_level_amplitude(f->envelope[i]);
        f->envelope[i] = hs_level_of_power(a * a + n->power[hs_random_bits(n->key, before + i) >> 52]);
    }
}

void hs_scene_noise(hs_field *field, const hs_scene_spec *spec) {
    noise n = {.field = field, .key = hs_random_key(field->noise_seed, 1)};
    float mean = powf(10.0f, spec->noise.level_db / 10.0f);
    for (int i = 0; i < QUANTILES; i++) n.power[i] = -mean * logf(((float)i + 0.5f) / QUANTILES);
    hs_parallel(field->threads, field->high - field->low, noise_slice, &n);
}

/* Log compression: grey = 255 (1 + (L + gain) / range), rounded, 1 .. 255. */

typedef struct {
    const hs_field *field;
    const uint8_t *grey; /* by level - HS_LEVEL_SILENT */
} compress;

static void compress_slice(void *context, uint32_t z) {
    const compress *c = context;
    size_t slice = hs_field_slice(c->field), start = slice * (c->field->low + z);
    for (size_t i = start; i < start + slice; i++)
        c->field->grey[i] = c->grey[c->field->envelope[i] - HS_LEVEL_SILENT];
}

void hs_scene_compress(hs_field *field, const hs_scene_spec *spec) {
    uint8_t grey[HS_LEVEL_MAX - HS_LEVEL_SILENT + 1];
    for (int i = 0; i < (int)sizeof grey; i++) {
        float db = (float)(i + HS_LEVEL_SILENT) / (float)HS_LEVEL_ONE + spec->gain_db;
        float g = 255.0f * (1.0f + db / spec->dynamic_range_db);
        grey[i] = (uint8_t)lrintf(fminf(fmaxf(g, 1.0f), 255.0f));
    }
    compress c = {field, grey};
    hs_parallel(field->threads, field->high - field->low, compress_slice, &c);
}

/* Without speckle the two kinds of echo are added by power. */
static void add_slice(void *context, uint32_t z) {
    hs_field *f = context;
    size_t slice = hs_field_slice(f), start = slice * (f->low + z);
    for (size_t i = start; i < start + slice; i++) {
        float a = hs_level_amplitude(f->diffuse[i]), b = hs_level_amplitude(f->coherent[i]);
        f->envelope[i] = hs_level_of_power(a * a + b * b);
    }
}

void hs_scene_add_powers(hs_field *field) {
    hs_parallel(field->threads, field->high - field->low, add_slice, field);
}
