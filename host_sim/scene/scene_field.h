/* SPDX-License-Identifier: MIT */
/* The voxels of a scene while it is made, from what each one is to its grey value, and the steps that make
 * it. */
#pragma once

#include "scene/scene.h"
#include "scene/scene_solid.h"
#include "scene/scene_spec.h"

#include <math.h>
#include <stdatomic.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

/*
 * Decibels: a level is L = 20 log10(A / A_max), A the echo's amplitude and A_max the one the display shows as
 * 255. So 6 dB is a factor of two in amplitude, and a power ratio is 10 log10. Attenuation coefficients are
 * one-way, amplitudes lose 2 f alpha z on the way there and back. Levels are int16 in 64ths of a dB.
 */
#define HS_LEVEL_ONE    64                    /* a dB */
#define HS_LEVEL_SILENT (-200 * HS_LEVEL_ONE) /* nothing comes back */
#define HS_LEVEL_MAX    (60 * HS_LEVEL_ONE)

/* dB to a level, saturated. */
static inline int16_t hs_level(float db) {
    float v = db * (float)HS_LEVEL_ONE;
    if (!(v > (float)HS_LEVEL_SILENT)) return HS_LEVEL_SILENT;
    return v < (float)HS_LEVEL_MAX ? (int16_t)lrintf(v) : (int16_t)HS_LEVEL_MAX;
}

/* A sum of levels, saturated. */
static inline int16_t hs_level_clamp(int v) {
    return (int16_t)(v < HS_LEVEL_SILENT ? HS_LEVEL_SILENT : v > HS_LEVEL_MAX ? HS_LEVEL_MAX : v);
}

extern float hs_level_amplitude_table[HS_LEVEL_MAX - HS_LEVEL_SILENT + 1];
/* Amplitude of a level, 10^(L / 20); 0 for silence. */
static inline float hs_level_amplitude(int16_t level) {
    return hs_level_amplitude_table[level - HS_LEVEL_SILENT];
}
extern float hs_level_mantissa_table[1024];
/* The level of a power (a squared amplitude): its exponent and the upper 10 bits of its mantissa are looked
 * at. With the rounding to 64ths it is right to 0.01 dB. */
static inline int16_t hs_level_of_power(float power) {
    uint32_t bits;
    memcpy(&bits, &power, sizeof bits);
    int exponent = (int)(bits >> 23) - 127; /* the sign is 0 */
    float level =
        (float)exponent * (3.01029996f * HS_LEVEL_ONE) + hs_level_mantissa_table[(bits >> 13) & 1023u];
    return hs_level_clamp((int)lrintf(level));
}

/* Signed distances to a surface in sixteenths of a voxel, saturated: negative inside tissue (or bone). */
#define HS_DISTANCE_ONE 16
#define HS_DISTANCE_FAR 127

/* What the pulse of a beam brings along from the slices before. Of zeros in front of the first one. */
typedef struct {
    float gain, lost;        /* 64ths of a dB: attenuation and its compensation; edges */
    uint16_t boundary, wall; /* slices: where the wall's last layer begins, and where the wall ends so far */
    int16_t wall_echo;       /* coherent level of its last slice */
    float spacing;           /* of its reverberation, slices; 0: there is none */
    uint16_t haze_from;      /* slice; 0: there is none so far */
    float haze;              /* dB, there */
    bool wall_ended, hazes;  /* a fluid came: for reverberation; for haze */
} hs_beam_state;

/*
 * Slices of a scene, all of it or a window of them. A step makes slices `low` to `high` - 1 of the window,
 * from front to back through the scene; those around them are there to be looked at.
 */
typedef struct {
    uint32_t n[3];       /* the window's voxels; the planes have room for `room` slices */
    uint32_t first, end; /* slices of the scene: where the window begins; how many there are in all */
    uint32_t low, high, room;
    float h[3]; /* voxel spacing, mm */
    uint32_t threads;
    uint64_t seed;       /* of the places of things: the same in all frames */
    uint64_t noise_seed; /* of speckle and noise: fresh in every frame */
    uint8_t *tissues;    /* hs_tissue, of the whole scene */
    uint8_t *tissue;     /* of the window: into `tissues` */
    int8_t *surface;     /* distance to the boundary between fluid and tissue, < 0 in tissue; or NULL */
    int8_t *bone;        /* distance to bone; NULL with surface */
    /* Of occluders with an echo or an edge of their own: hs_solid.style, and how much of the tissue's
     * scatterers are there, 255: all. NULL if the scene has none. */
    uint8_t *style, *share;
    hs_beam_state *beam; /* nx * ny */
    float *haze_end;     /* per beam, mm from the probe: haze can be seen before it; NULL if there is none */
    int16_t *wall_end;   /* diffuse levels of the last 2 mm before slice `low`; NULL if there is no haze */
    int16_t *diffuse;    /* level of scattered echo */
    int16_t *coherent;   /* level of interface echo */
    int16_t *envelope;   /* level of what the probe receives */
    uint8_t *greys;      /* what the display shows, of the whole scene; borrowed */
    uint8_t *grey;       /* of the window: into `greys` */
    atomic_bool out_of_memory;
} hs_field;

/* All planes but style, share, haze_end and grey, for a scene of n voxels; but for the tissues with room for
 * a window of so many slices. The window is as much of the scene's front as that. */
bool hs_field_init(hs_field *field, const uint32_t n[3], uint32_t room, const float h[3], hs_error *err);
/* Makes slices `first` to `end` - 1 of the scene the window, at most `room`; what it had of them stays. */
void hs_field_move(hs_field *field, uint32_t first, uint32_t end);
/* The next step makes these slices of the scene, which lie in the window. */
void hs_field_aim(hs_field *field, uint32_t first, uint32_t end);
/* Adds the planes `style` and `share`. */
bool hs_field_add_style(hs_field *field, hs_error *err);
/* Frees all planes but those of the whole scene. The window is all of it then. */
void hs_field_free_planes(hs_field *field);
void hs_field_free(hs_field *field);

static inline size_t hs_field_index(const hs_field *f, uint32_t x, uint32_t y, uint32_t z) {
    return ((size_t)z * f->n[1] + y) * f->n[0] + x;
}
static inline size_t hs_field_slice(const hs_field *f) {
    return (size_t)f->n[0] * f->n[1];
}

/* |cos| of the angle between the beam (+z) and a distance field's gradient, by central differences; 0 if
 * it is flat. */
float hs_field_cosine(const hs_field *f, const int8_t *distance, uint32_t x, uint32_t y, uint32_t z);

/* A loop over the y rows or z slices of a field. Both are borrowed. */
typedef struct {
    hs_field *field;
    const hs_scene_spec *spec;
} hs_pass;

/* Solids to tissue, and to those of surface, bone, style and share that the field has, from a slice of the
 * scene on that is a multiple of HS_SCENE_BRICK. Sorts the list by part. `turn` is NULL, or its rows are the
 * axes of voxels whose cube is turned around its middle. False with HS_ERR_MEMORY, or if there are more than
 * HS_SCENE_MAX_SOLIDS solids. */
enum { HS_SCENE_BRICK = 8 };
bool hs_scene_raster(hs_field *field, const hs_scene_spec *spec, hs_solid_list *solids, const float *turn,
                     hs_error *err);

/* The steps from tissues to grey values. One that finds no memory says so in `out_of_memory`. */
void hs_scene_echo(hs_field *field, const hs_scene_spec *spec);          /* sets diffuse and coherent */
void hs_scene_attenuation(hs_field *field, const hs_scene_spec *spec);   /* lowers and raises both */
void hs_scene_edge_shadow(hs_field *field, const hs_scene_spec *spec);   /* lowers both behind edges */
void hs_scene_reverberation(hs_field *field, const hs_scene_spec *spec); /* adds to coherent */
void hs_scene_haze(hs_field *field, const hs_scene_spec *spec);          /* adds to diffuse, makes haze_end */
void hs_scene_dark_corner(hs_field *field, const hs_scene_spec *spec);   /* lowers both */
void hs_scene_far_band(hs_field *field, const hs_scene_spec *spec);      /* sets both in band and gap */
void hs_scene_add_powers(hs_field *field);                               /* both to the envelope */
void hs_scene_side_lobes(hs_field *field, const hs_scene_spec *spec);    /* adds to the envelope */
void hs_scene_noise(hs_field *field, const hs_scene_spec *spec);         /* adds to the envelope */
void hs_scene_compress(hs_field *field, const hs_scene_spec *spec);      /* envelope to grey, 1 .. 255 */
void hs_scene_fan(hs_field *field, const hs_scene_spec *spec);           /* grey 0 outside the fan */

/* Speckle: both levels to the envelope, which reaches so many slices of `slice_mm` to both sides. Slices are
 * drawn, `slices` at a time at most, and finished when those that they reach are drawn; none is finished
 * before `slices` and twice the reach more are drawn. Field and spec are borrowed. NULL: no memory. */
typedef struct hs_speckle hs_speckle;
uint32_t hs_speckle_reach(const hs_scene_spec *spec, float slice_mm);
hs_speckle *hs_speckle_begin(hs_field *field, const hs_scene_spec *spec, uint32_t slices);
void hs_speckle_draw(hs_speckle *speckle);
void hs_speckle_finish(hs_speckle *speckle);
void hs_speckle_end(hs_speckle *speckle); /* NULL is allowed */

/* Whether the camera does not look along the beams. */
bool hs_scene_camera_turned(const hs_scene_spec *spec);
/* The scene's axes, which are the probe's, in those of the camera: as hs_volume.probe_turn. Not changed if
 * the camera looks along the beams. */
void hs_scene_camera_turn(const hs_scene_spec *spec, double turn[9]);
/* Where the scene has point p of the camera's cube, in mm; p itself if the camera looks along the beams. */
void hs_scene_camera_point(const hs_scene_spec *spec, const float p[3], float out[3]);
/* Samples the grey values again on the camera's voxels, and makes the field's tissue that of the solids
 * there. HS_ERR_MEMORY. */
bool hs_scene_camera(hs_field *field, const hs_scene_spec *spec, hs_solid_list *solids, hs_error *err);

/* Label, interval and clipping surface from full.voxels (0 = not scanned) and the field's tissue; the clipped
 * volume may come later. Of the spec it reads where the camera stands and how thick the slice is.
 * HS_ERR_MEMORY. */
bool hs_scene_truth(const hs_field *field, const hs_scene_spec *spec, hs_scene_data *data, hs_error *err);

/* A scene of kind "real": occluders before a given volume. It is moved back until the room before it is
 * `share` (0 .. 1, exclusive) of the whole depth. */
bool hs_scene_real_lead(hs_volume *given, double share, hs_error *err);
/* The first slice of every column's tissue, or the number of slices: nx * ny. */
void hs_scene_real_front(const hs_volume *given, uint32_t threads, uint32_t *front);
/* Keeps occluders only where the given volume is free. */
void hs_scene_real_place(hs_field *field, const uint32_t *front);
/* Given volume and occluders in one, in the field's grey values. */
void hs_scene_real_combine(hs_field *field, const hs_volume *given, const uint32_t *front);
