/* SPDX-License-Identifier: MIT */
/* What happens to the pulse on its way: attenuation, edge shadows, reverberation, haze, a corner without
 * contact. */
#include "core/threads.h"
#include "scene/scene_field.h"
#include "scene/scene_random.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/*
 * Attenuation and time-gain compensation. On its way to depth z and back an echo loses
 *
 *     2 f  integral_0^z alpha(s) ds   [dB],  f in MHz, alpha in dB / (cm MHz), s in cm
 *
 * and 20 log10 of (1 - R^2) at every interface it crosses twice; the compensation adds 2 f alpha_tgc z (Szabo
 * 2014, chapters 4 and 6). What absorbs more than alpha_tgc throws a shadow, what absorbs less brightens what
 * lies behind. Beams run along +z.
 */

typedef struct {
    hs_pass pass;
    float slope[HS_TISSUE_COUNT]; /* 64ths of a dB gained per voxel */
    float crossing[HS_TISSUE_COUNT][HS_TISSUE_COUNT];
} attenuation;

static void attenuate_row(void *context, uint32_t y) {
    const attenuation *a = context;
    hs_field *f = a->pass.field;
    enum { CHUNK = 64 };
    for (uint32_t first = 0; first < f->n[0]; first += CHUNK) {
        uint32_t width = f->n[0] - first < CHUNK ? f->n[0] - first : CHUNK;
        hs_beam_state *beam = f->beam + hs_field_index(f, first, y, 0);
        float gain[CHUNK];
        uint8_t before[CHUNK];
        for (uint32_t x = 0; x < width; x++) {
            gain[x] = beam[x].gain;
            before[x] = f->tissue[hs_field_index(f, first + x, y, f->low > 0 ? f->low - 1 : 0)];
        }
        for (uint32_t z = f->low; z < f->high; z++) {
            size_t row = hs_field_index(f, first, y, z);
            for (uint32_t x = 0; x < width; x++) {
                uint8_t t = f->tissue[row + x];
                float half = 0.5f * a->slope[t];
                gain[x] += half + a->crossing[before[x]][t];
                int add = (int)lrintf(gain[x]);
                f->diffuse[row + x] = hs_level_clamp(f->diffuse[row + x] + add);
                if (f->coherent[row + x] > HS_LEVEL_SILENT)
                    f->coherent[row + x] = hs_level_clamp(f->coherent[row + x] + add);
                gain[x] += half;
                before[x] = t;
            }
        }
        for (uint32_t x = 0; x < width; x++) beam[x].gain = gain[x];
    }
}

void hs_scene_attenuation(hs_field *field, const hs_scene_spec *spec) {
    attenuation a = {.pass = {field, spec}};
    for (int t = 0; t < HS_TISSUE_COUNT; t++) {
        float excess = spec->attenuation.tgc_db_cm_mhz - spec->tissue[t].attenuation_db_cm_mhz;
        a.slope[t] = 2.0f * spec->frequency_mhz * excess * 0.1f * field->h[2] * (float)HS_LEVEL_ONE;
        for (int u = 0; u < HS_TISSUE_COUNT; u++) {
            float zt = spec->tissue[t].impedance_mrayl, zu = spec->tissue[u].impedance_mrayl;
            float r = (zu - zt) / (zu + zt);
            a.crossing[t][u] = (float)HS_LEVEL_ONE * 20.0f * log10f(1.0f - r * r);
        }
    }
    hs_parallel(field->threads, field->n[1], attenuate_row, &a);
}

/*
 * Edge (refraction) shadows. A beam that meets a curved surface at a grazing angle is bent or totally
 * reflected, and what lies behind the edge is dark (Robinson, Wilson and Kossoff, "Shadowing and enhancement
 * in ultrasonic echograms by reflection and refraction", J. Clin. Ultrasound 9, 1981). With Snell's law sin t
 * / c2 = sin i / c1 the transmitted part of the power is (Szabo 2014, chapter 3)
 *
 *     T = 4 Z1 Z2 cos i cos t / (Z2 cos i + Z1 cos t)^2,   T = 0 beyond the critical angle,
 *
 * and the echo loses 2 * -10 log10 T, at most max_loss_db. The loss at normal incidence belongs to the
 * attenuation step and is taken off here.
 */

enum { COSINES = 64 };

typedef struct {
    hs_pass pass;
    float loss[HS_TISSUE_COUNT][HS_TISSUE_COUNT][COSINES + 1]; /* 64ths of a dB */
} edge;

static float transmitted(const hs_tissue_properties *a, const hs_tissue_properties *b, float cos_i) {
    float sin_t = b->speed_m_s / a->speed_m_s * sqrtf(fmaxf(1.0f - cos_i * cos_i, 0.0f));
    if (sin_t >= 1.0f || cos_i <= 0.0f) return 0.0f;
    float cos_t = sqrtf(1.0f - sin_t * sin_t), sum = b->impedance_mrayl * cos_i + a->impedance_mrayl * cos_t;
    return 4.0f * a->impedance_mrayl * b->impedance_mrayl * cos_i * cos_t / (sum * sum);
}

static void make_losses(edge *e) {
    const hs_scene_spec *spec = e->pass.spec;
    for (int a = 0; a < HS_TISSUE_COUNT; a++)
        for (int b = 0; b < HS_TISSUE_COUNT; b++) {
            float normal = transmitted(&spec->tissue[a], &spec->tissue[b], 1.0f);
            for (int c = 0; c <= COSINES; c++) {
                float t = transmitted(&spec->tissue[a], &spec->tissue[b], (float)c / COSINES);
                float db = t > 0.0f ? -20.0f * log10f(t / normal) : spec->edge.max_loss_db;
                e->loss[a][b][c] = (float)HS_LEVEL_ONE * fminf(fmaxf(db, 0.0f), spec->edge.max_loss_db);
            }
        }
}

/* Walks all columns of a row; a loss counts behind the interface it comes from. */
static void edge_row(void *context, uint32_t y) {
    const edge *e = context;
    hs_field *f = e->pass.field;
    enum { CHUNK = 64 };
    for (uint32_t first = 0; first < f->n[0]; first += CHUNK) {
        uint32_t width = f->n[0] - first < CHUNK ? f->n[0] - first : CHUNK;
        hs_beam_state *beam = f->beam + hs_field_index(f, first, y, 0);
        float lost[CHUNK];
        for (uint32_t x = 0; x < width; x++) lost[x] = beam[x].lost;
        for (uint32_t z = f->low > 0 ? f->low : 1; z < f->high; z++) {
            size_t row = hs_field_index(f, first, y, z);
            for (uint32_t x = 0; x < width; x++) {
                uint8_t here = f->tissue[row + x], before = f->tissue[row + x - hs_field_slice(f)];
                int loss = (int)lrintf(lost[x]);
                if (loss) {
                    f->diffuse[row + x] = hs_level_clamp(f->diffuse[row + x] - loss);
                    f->coherent[row + x] = hs_level_clamp(f->coherent[row + x] - loss);
                }
                if (here == before) continue;
                bool bone = here == HS_TISSUE_BONE || before == HS_TISSUE_BONE;
                if (!bone && !hs_tissue_is_fluid(here) && !hs_tissue_is_fluid(before)) continue;
                float cosine = hs_field_cosine(f, bone ? f->bone : f->surface, first + x, y, z);
                lost[x] += e->loss[before][here][lrintf(COSINES * cosine)];
            }
        }
        for (uint32_t x = 0; x < width; x++) beam[x].lost = lost[x];
    }
}

void hs_scene_edge_shadow(hs_field *field, const hs_scene_spec *spec) {
    edge e = {.pass = {field, spec}};
    make_losses(&e);
    hs_parallel(field->threads, field->n[1], edge_row, &e);
}

/*
 * Reverberation bands. Between two parallel reflectors a distance d apart a pulse goes to and fro; the echo
 * of the far one at depth z2 comes back again at z2 + k d, weaker by the two reflections at every turn: A_k =
 * A_2 (R1 R2)^k (Feldman, Katyal and Blackwood, "US artifacts", RadioGraphics 29, 2009; Kremkau and Taylor,
 * J. Ultrasound Med. 5, 1986). loss_db stands for -20 log10(R1 R2). The reflectors of a column are where the
 * wall ends at the fluid, and the last boundary of its layers before.
 */

/* Looks for the wall's last boundary and its end, and keeps the echo that it ends with. */
static void follow_wall(const hs_field *f, const hs_reverberation_spec *spec, size_t pixel,
                        hs_beam_state *b) {
    const size_t slice = hs_field_slice(f);
    for (uint32_t z = f->low; !b->wall_ended && z < f->high; z++) {
        const size_t index = slice * z + pixel;
        const uint32_t at = f->first + z;
        if (hs_tissue_is_fluid(f->tissue[index])) {
            const float own = (float)(b->wall - 1 - b->boundary);
            const float spacing = spec->spacing_mm > 0.0f ? spec->spacing_mm / f->h[2] : own;
            b->wall_ended = true;
            if (at > 0 && spacing >= 2.0f) b->spacing = spacing;
            return;
        }
        if (at > 0 && f->tissue[index] != f->tissue[index - slice]) b->boundary = (uint16_t)at;
        b->wall = (uint16_t)(at + 1);
        b->wall_echo = f->coherent[index];
    }
}

static void bands(hs_field *f, const hs_reverberation_spec *spec, size_t pixel, const hs_beam_state *b) {
    for (uint32_t k = 1; k <= spec->count; k++) {
        const float z = (float)(b->wall - 1) + (float)k * b->spacing;
        if (z > (float)(f->end - 1)) return;
        const uint32_t at = (uint32_t)lrintf(z) - f->first;
        if (at < f->low || at >= f->high) continue;
        const size_t index = hs_field_slice(f) * at + pixel;
        int16_t level =
            hs_level_clamp(b->wall_echo - (int)lrintf((float)k * spec->loss_db * (float)HS_LEVEL_ONE));
        if (level > f->coherent[index]) f->coherent[index] = level;
    }
}

static void reverberation_row(void *context, uint32_t y) {
    const hs_pass *pass = context;
    hs_field *f = pass->field;
    const hs_reverberation_spec *spec = &pass->spec->reverberation;
    for (uint32_t x = 0; x < f->n[0]; x++) {
        const size_t pixel = (size_t)y * f->n[0] + x;
        hs_beam_state *b = f->beam + pixel;
        follow_wall(f, spec, pixel, b);
        if (b->spacing > 0.0f) bands(f, spec, pixel, b);
    }
}

void hs_scene_reverberation(hs_field *field, const hs_scene_spec *spec) {
    hs_pass pass = {field, spec};
    hs_parallel(field->threads, field->n[1], reverberation_row, &pass);
}

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

#define WALL_MM    2.0f
#define MIN_DB     (-100.0f) /* nothing of it can be seen below */
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

/* Slices of WALL_MM. */
static uint32_t wall_slices(const hs_field *f) {
    return (uint32_t)ceilf(WALL_MM / f->h[2]);
}

/* The mean power of the last WALL_MM before slice `end` of the window, in dB. */
static float wall_level(const hs_field *f, size_t pixel, uint32_t end) {
    const size_t slice = hs_field_slice(f);
    const uint32_t wanted = wall_slices(f), at = f->first + end, count = wanted < at ? wanted : at;
    float power = 0.0f;
    for (uint32_t back = count; back > 0; back--) {
        const int64_t z = (int64_t)end - back, before = (int64_t)f->low - z;
        const float a = hs_level_amplitude(before > 0 ? f->wall_end[(wanted - (size_t)before) * slice + pixel]
                                                      : f->diffuse[slice * (size_t)z + pixel]);
        power += a * a;
    }
    return 10.0f * log10f(fmaxf(power / (float)count, 1e-20f));
}

/* Keeps the last WALL_MM for the slices that follow. */
static void keep_wall_end(const hs_field *f) {
    const size_t slice = hs_field_slice(f), bytes = slice * sizeof *f->wall_end;
    const uint32_t wanted = wall_slices(f), made = f->high - f->low, fresh = made < wanted ? made : wanted;
    memmove(f->wall_end, f->wall_end + slice * fresh, bytes * (wanted - fresh));
    memcpy(f->wall_end + slice * (wanted - fresh), f->diffuse + slice * (f->high - fresh), bytes * fresh);
}

/* How deep the haze can be seen, mm: its brightest patches, with speckle 4 dB above the mean, come to
 * T_L there. */
static float visible_until(const hs_scene_spec *spec, float first, float end_mm) {
    const hs_haze_spec *haze = &spec->haze;
    const float fluid_db = spec->dynamic_range_db * (FLUID_GREY / 255.0f - 1.0f) - spec->gain_db;
    return end_mm + fmaxf(first + haze->patch_db + SPECKLE_DB - fluid_db, 0.0f) / haze->decay_db_mm;
}

/* Looks for the first fluid. Haze begins there, unless it is the first slice. */
static void find_haze(const hs_pass *pass, size_t pixel, hs_beam_state *b) {
    const hs_field *f = pass->field;
    for (uint32_t z = f->low; !b->hazes && z < f->high; z++) {
        b->hazes = hs_tissue_is_fluid(f->tissue[hs_field_slice(f) * z + pixel]);
        if (!b->hazes || f->first + z == 0) continue;
        b->haze_from = (uint16_t)(f->first + z);
        b->haze = wall_level(f, pixel, z) + pass->spec->haze.level_db;
        f->haze_end[pixel] = visible_until(pass->spec, b->haze, (float)b->haze_from * f->h[2]);
    }
}

static void haze_column(const hs_pass *pass, uint64_t key, uint32_t x, uint32_t y) {
    hs_field *f = pass->field;
    const hs_haze_spec *haze = &pass->spec->haze;
    const size_t slice = hs_field_slice(f), pixel = (size_t)y * f->n[0] + x;
    hs_beam_state *b = f->beam + pixel;
    find_haze(pass, pixel, b);
    if (b->haze_from == 0) return;
    const float size = 1.0f / haze->patch_mm;
    const float p[2] = {((float)x + 0.5f) * f->h[0] * size, ((float)y + 0.5f) * f->h[1] * size};
    noise_column noise = start_noise(key, p);
    const uint32_t from = f->first + f->low;
    for (uint32_t z = b->haze_from > from ? b->haze_from : from; z < f->first + f->high; z++) {
        const float behind = ((float)(z - b->haze_from) + 0.5f) * f->h[2];
        float level = b->haze - haze->decay_db_mm * behind;
        if (level + haze->patch_db < MIN_DB) return;
        if (haze->patch_db > 0.0f)
            level += haze->patch_db * noise_at(&noise, ((float)z + 0.5f) * f->h[2] * size);
        int16_t *diffuse = f->diffuse + slice * (z - f->first) + pixel;
        const float own = hs_level_amplitude(*diffuse), added = hs_level_amplitude(hs_level(level));
        *diffuse = hs_level_of_power(own * own + added * added);
    }
}

static void haze_row(void *context, uint32_t y) {
    const hs_pass *pass = context;
    const uint64_t key = hs_random_key(pass->field->seed, 50);
    for (uint32_t x = 0; x < pass->field->n[0]; x++) haze_column(pass, key, x, y);
}

void hs_scene_haze(hs_field *field, const hs_scene_spec *spec) {
    hs_pass pass = {field, spec};
    const size_t pixels = hs_field_slice(field);
    if (!field->haze_end) field->haze_end = calloc(pixels, sizeof *field->haze_end);
    if (!field->wall_end) field->wall_end = calloc(pixels * wall_slices(field), sizeof *field->wall_end);
    atomic_store(&field->out_of_memory, !field->haze_end || !field->wall_end);
    if (!field->haze_end || !field->wall_end) return;
    hs_parallel(field->threads, field->n[1], haze_row, &pass);
    keep_wall_end(field);
}

/*
 * A dark corner. Where a corner of the probe is lifted off the skin, or rib or bowel shades a part of the
 * aperture, all echoes of those beams come back weaker, at all depths alike, and the loss has no sharp
 * border. With u the distance from the image's middle in the direction of the corner,
 *
 *     loss(u) = loss_db s(t),   t = (u - start_mm) / width_mm in 0 .. 1,   s(t) = 3 t^2 - 2 t^3.
 *
 * The noise of the receiver comes later and is not weakened, so a corner of much loss holds noise.
 */

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
        for (uint32_t z = f->low; loss > 0 && z < f->high; z++) {
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
