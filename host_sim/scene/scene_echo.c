/* SPDX-License-Identifier: MIT */
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
#include "scene/scene_echo.h"

#include "base/threads.h"

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

static void echo_slice(void *context, uint32_t z) {
    const echo *e = context;
    hs_field *f = e->pass.field;
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
    hs_parallel(field->threads, field->n[2], echo_slice, &e);
}
