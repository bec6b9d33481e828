/* SPDX-License-Identifier: MIT */
/* The voxels of a scene while it is made: what each one is, and its echo level. */
#ifndef HS_SCENE_FIELD_H
#define HS_SCENE_FIELD_H

#include "scene/scene.h"
#include "scene/scene_spec.h"

#include <math.h>
#include <string.h>

/*
 * Decibels: a level is L = 20 log10(A / A_max), A the echo's amplitude and A_max the one the display shows as
 * 255. So 6 dB is a factor of two in amplitude, and a power ratio is 10 log10. Attenuation coefficients are
 * one-way, amplitudes lose 2 f alpha z on the way there and back. In memory levels are int16 in sixteenths of
 * a dB.
 */
#define HS_LEVEL_ONE    64
#define HS_LEVEL_SILENT (-200 * HS_LEVEL_ONE) /* nothing comes back */
#define HS_LEVEL_MAX    (60 * HS_LEVEL_ONE)

/* Signed distances to a surface in sixteenths of a voxel, saturated: negative inside tissue (or bone). */
#define HS_DISTANCE_ONE 16
#define HS_DISTANCE_FAR 127

typedef struct {
    uint32_t n[3];
    float h[3]; /* voxel spacing, mm */
    uint32_t threads;
    uint64_t seed;       /* of the places of things: the same in all frames */
    uint64_t noise_seed; /* of speckle and noise: fresh in every frame */
    uint8_t *tissue;
    int8_t *surface;   /* distance to the boundary between fluid and tissue, < 0 in tissue */
    int8_t *bone;      /* distance to bone */
    int16_t *diffuse;  /* level of scattered echo */
    int16_t *coherent; /* level of interface echo */
    int16_t *envelope; /* level of what the probe receives */
} hs_field;

bool hs_field_init(hs_field *field, const uint32_t n[3], const float h[3], hs_error *err);
void hs_field_free(hs_field *field);

static inline size_t hs_field_index(const hs_field *f, uint32_t x, uint32_t y, uint32_t z) {
    return ((size_t)z * f->n[1] + y) * f->n[0] + x;
}
static inline size_t hs_field_slice(const hs_field *f) {
    return (size_t)f->n[0] * f->n[1];
}

/* |cos| of the angle between the beam (+z) and a distance field's gradient, by central differences; 0 if it
 * is flat. */
float hs_field_cosine(const hs_field *f, const int8_t *distance, uint32_t x, uint32_t y, uint32_t z);

/* dB to the field's units, saturated, and levels added with saturation. */
static inline int16_t hs_level(float db) {
    float v = db * (float)HS_LEVEL_ONE;
    if (!(v > (float)HS_LEVEL_SILENT)) return HS_LEVEL_SILENT;
    return v < (float)HS_LEVEL_MAX ? (int16_t)lrintf(v) : (int16_t)HS_LEVEL_MAX;
}
static inline int16_t hs_level_clamp(int v) {
    return (int16_t)(v < HS_LEVEL_SILENT ? HS_LEVEL_SILENT : v > HS_LEVEL_MAX ? HS_LEVEL_MAX : v);
}

/* Tables between level and amplitude, made once per process. */
void hs_level_tables(void);
extern float hs_level_amplitude_table[HS_LEVEL_MAX - HS_LEVEL_SILENT + 1];
/* Amplitude of a level, 10^(L / 20); 0 for silence. */
static inline float hs_level_amplitude(int16_t level) {
    return hs_level_amplitude_table[level - HS_LEVEL_SILENT];
}
/* The level of a power (a squared amplitude): its exponent and the upper 10 bits of its mantissa are looked
 * at, which is right to 0.005 dB. */
extern float hs_level_mantissa_table[1024];
static inline int16_t hs_level_of_power(float power) {
    uint32_t bits;
    memcpy(&bits, &power, sizeof bits);
    int exponent = (int)(bits >> 23) - 127; /* the sign is 0 */
    float level =
        (float)exponent * (3.01029996f * HS_LEVEL_ONE) + hs_level_mantissa_table[(bits >> 13) & 1023u];
    return hs_level_clamp((int)lrintf(level));
}

/* ---- The steps, in the order of the physics. Those of artefacts are called only if the scene lists them.
 * ---- */

/* Solids of all structures but sac and layers. */
bool hs_scene_solids(const hs_scene_spec *spec, uint64_t seed, hs_solid_list *list, hs_error *err);
/* Voxels from solids: tissue, surface, bone. Sorts the list by part. */
#define HS_SCENE_MAX_SOLIDS 4096u
bool hs_scene_raster(hs_field *field, const hs_scene_spec *spec, hs_solid_list *solids, hs_error *err);
/* Levels of scattered and interface echo. */
void hs_scene_echo(hs_field *field, const hs_scene_spec *spec);
void hs_scene_attenuation(hs_field *field, const hs_scene_spec *spec);
void hs_scene_edge_shadow(hs_field *field, const hs_scene_spec *spec);
void hs_scene_reverberation(hs_field *field, const hs_scene_spec *spec);
void hs_scene_far_band(hs_field *field, const hs_scene_spec *spec);
/* Scattered and interface echo to the received envelope; without speckle their powers are simply added. */
bool hs_scene_speckle(hs_field *field, const hs_scene_spec *spec, hs_error *err);
void hs_scene_add_powers(hs_field *field);
bool hs_scene_side_lobes(hs_field *field, const hs_scene_spec *spec, hs_error *err);
void hs_scene_noise(hs_field *field, const hs_scene_spec *spec);
/* Log compression: grey = 255 (1 + (L + gain) / range), 1 .. 255. */
void hs_scene_compress(const hs_field *field, const hs_scene_spec *spec, hs_volume *full);
/* Zeros outside the fan. */
void hs_scene_fan(const hs_field *field, const hs_scene_spec *spec, hs_volume *full);

/* A `real` scene: occluders only where the given volume is free, then given volume and occluders in one. */
bool hs_scene_real_lead(hs_volume *given, double share, hs_error *err);
void hs_scene_real_place(hs_field *field, const hs_volume *given);
void hs_scene_real_combine(hs_field *field, const hs_volume *given, hs_volume *full);

/* Label, interval, clipping surface and clipped volume from full->voxels (0 = not scanned) and tissue. */
bool hs_scene_truth(const hs_field *field, hs_scene_data *data, hs_error *err);
/* Gives every NAN of a map the value of the nearest pixel that has one (chamfer distance); 0 if none has. */
bool hs_scene_spread(float *map, uint32_t nx, uint32_t ny, hs_error *err);

/* A loop over the y rows or z slices of a field. */
typedef struct {
    hs_field *field;
    const hs_scene_spec *spec;
} hs_pass;

#endif
