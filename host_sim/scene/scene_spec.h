/* SPDX-License-Identifier: MIT */
/* A scene as its file describes it. Lengths in mm of the scene's box, angles in degrees, levels in dB. */
#pragma once

#include "core/error.h"

#include <stdbool.h>
#include <stdint.h>

typedef enum {
    HS_TISSUE_FLUID,    /* amniotic fluid */
    HS_TISSUE_WALL,     /* uterine wall (myometrium) */
    HS_TISSUE_FAT,      /* abdominal wall */
    HS_TISSUE_MUSCLE,   /* abdominal wall */
    HS_TISSUE_PLACENTA, /* also cervical and other large occluders */
    HS_TISSUE_CORD,
    HS_TISSUE_CLOUD, /* vernix and other particles in the fluid */
    HS_TISSUE_URINE, /* in the bladder: fluid, but none of the sac's */
    HS_TISSUE_SOFT,  /* of the fetus: all from here on is the fetus */
    HS_TISSUE_BRAIN,
    HS_TISSUE_BONE,
    HS_TISSUE_COUNT
} hs_tissue;

typedef struct {
    float echo_db;               /* mean backscatter level; 0 dB is the brightest level the display shows */
    float attenuation_db_cm_mhz; /* one way */
    float impedance_mrayl;       /* 10^6 kg / (m^2 s) */
    float speed_m_s;             /* of sound */
} hs_tissue_properties;

/* The table a scene starts from (docs/scenes.md gives the sources). */
extern const hs_tissue_properties hs_tissue_defaults[HS_TISSUE_COUNT];
extern const char *const hs_tissue_names[HS_TISSUE_COUNT];

static inline bool hs_tissue_is_fetus(uint8_t tissue) {
    return tissue >= HS_TISSUE_SOFT;
}

/* Whether it is dark and its border an interface; only HS_TISSUE_FLUID is the sac's. */
static inline bool hs_tissue_is_fluid(uint8_t tissue) {
    return tissue == HS_TISSUE_FLUID || tissue == HS_TISSUE_URINE;
}

/*
 * The fetal frame, in mm at scale 1 (crown to rump 90 mm, about 14 weeks): x to the fetus' left, which is the
 * viewer's right when it looks at the viewer; y from crown to rump; z from the face to the back. At rotation
 * 0, 0, 0 it stands upright and faces the probe. Index 0 is its own right side, 1 its left.
 */
typedef struct {
    float elbow[2][3], hand[2][3], knee[2][3], ankle[2][3];
    float head_turn_deg[3]; /* of the head about the neck: nod, turn, tilt */
} hs_fetus_pose;

#define HS_SCENE_MAX_STRUCTURES 32
#define HS_SCENE_MAX_POINTS     32
#define HS_SCENE_MAX_LAYERS     6
#define HS_SCENE_MAX_LOOPS      3

typedef struct {
    float p[HS_SCENE_MAX_POINTS][3];
    uint32_t count;
} hs_points;

typedef struct {
    float centre[3], radii[3], rotation[3];
    float roughness_mm, roughness_scale_mm; /* height of the bumps, and their wavelength */
} hs_sac_spec;

typedef struct {
    hs_tissue tissue[HS_SCENE_MAX_LAYERS]; /* from the probe inwards; behind the last one is uterine wall */
    float thickness_mm[HS_SCENE_MAX_LAYERS];
    uint32_t count;
    float undulation_mm;
    /* <= 0: the layers interleave, so their boundaries echo that much less than smooth ones. */
    float boundary_db;
} hs_layers_spec;

typedef enum {
    HS_STRUCTURE_OCCLUDER,
    HS_STRUCTURE_CORD,
    HS_STRUCTURE_CLOUD,
    HS_STRUCTURE_FETUS,
    HS_STRUCTURE_NUCHAL_CORD,
    HS_STRUCTURE_BLADDER
} hs_structure_kind;

typedef struct {
    hs_tissue tissue;
    float centre[3], radii[3], rotation[3], blend_mm;
    float echo_db; /* brighter than its tissue, or dimmer */
    float soft_mm; /* > 0: over this depth its scatterers grow from none to its tissue's */
    /* Fluid between it and the fetus where it is thinnest, along the beam; below 0 it presses into the
     * fetus by that much, and the two touch. NAN: the centre is as given. */
    float gap_mm;
} hs_occluder_spec;

typedef struct {
    hs_points points; /* a curve through them */
    float radius_mm, twist_mm;
} hs_cord_spec;

typedef struct {
    float centre[3], radii[3]; /* the region that holds the particles */
    uint32_t count;
    float particle_min_mm, particle_max_mm; /* radii */
} hs_cloud_spec;

typedef struct {
    float position[3], rotation[3], scale;
    hs_fetus_pose pose;
    float gap_mm; /* the same between the wall before the fetus and its skin */
} hs_fetus_spec;

/* A cord wound round the neck of a fetus and led to its navel. */
typedef struct {
    uint32_t fetus; /* which of the scene's, from 0 */
    uint32_t loops;
    float radius_mm, twist_mm;
    float slack_mm; /* of fluid between cord and skin; 0: they touch */
} hs_nuchal_spec;

/* Urine in a wall of muscle. */
typedef struct {
    float centre[3], radii[3], rotation[3]; /* of the urine */
    float wall_mm;
} hs_bladder_spec;

typedef struct {
    hs_structure_kind kind;
    union {
        hs_occluder_spec occluder;
        hs_cord_spec cord;
        hs_cloud_spec cloud;
        hs_fetus_spec fetus;
        hs_nuchal_spec nuchal;
        hs_bladder_spec bladder;
    } of;
} hs_structure;

/* Every artefact: `on` only if the scene lists it. */
typedef struct {
    bool on;
    float tgc_db_cm_mhz; /* the one-way attenuation that the time-gain compensation assumes */
} hs_attenuation_spec;
typedef struct {
    bool on;
    float max_loss_db; /* two-way, at one edge */
} hs_edge_spec;
typedef struct {
    bool on;
    uint32_t count;   /* bands after the first echo */
    float spacing_mm; /* 0: from the two interfaces of the column */
    float loss_db;    /* from band to band */
} hs_reverberation_spec;
typedef struct {
    bool on;
    float level_db;    /* where the wall ends, relative to the wall's own echo there */
    float decay_db_mm; /* per mm behind it */
    float patch_db;    /* how much brighter or darker its patches are at most */
    float patch_mm;    /* their size */
} hs_haze_spec;
typedef struct {
    bool on;
    float direction_deg; /* in the image: 0 to the right, 90 down */
    float start_mm;      /* from the image's middle, where the loss begins */
    float width_mm;      /* until it is whole */
    float loss_db;       /* two-way */
} hs_corner_spec;
typedef struct {
    bool on;
    float elevation_mm; /* standard deviation of the point spread across the image plane (y) at the focus */
    float focus_mm, rayleigh_mm;
} hs_slice_spec;
typedef struct {
    bool on;
    float gap_mm, thickness_mm, level_db;
    float direction[3]; /* of the band's middle from the skull's centre, in the scene */
    float angle_deg;    /* half opening */
} hs_far_band_spec;
typedef struct {
    bool on;
    float axial_mm, lateral_mm; /* standard deviations of the point spread, lateral at the focus */
    float focus_mm, rayleigh_mm;
} hs_speckle_spec;
typedef struct {
    bool on;
    float level_db, width_mm;
} hs_side_lobe_spec;
typedef struct {
    bool on;
    float level_db;
} hs_noise_spec;
typedef struct {
    bool on;
    float azimuth_deg, sweep_deg;             /* full opening angles */
    float azimuth_radius_mm, sweep_radius_mm; /* of the probe's surface */
    float depth_mm;
} hs_fan_spec;

/* Motion: x(f) = x(0) + amplitude (sin(2 pi f / period + phase) - sin(phase)). */
typedef struct {
    bool on;
    float period_frames;
    float drift_mm[3]; /* of the whole fetus */
    float limb_mm;     /* of elbows, hands, knees, ankles; each with a phase of its own */
    float cloud_drift_mm[3];
} hs_motion_spec;

typedef struct {
    char name[64];
    char title[512];
    bool real; /* occluders before a given volume */
    uint64_t seed;
    float extent_mm;     /* edge of the cube */
    float camera_deg[3]; /* the camera's turn about x, y, z around the cube's middle; the beams stay */
    float lead_mm;       /* real: depth of the cube that is put before the given volume, < extent_mm */
    float frequency_mhz;
    float dynamic_range_db, gain_db;   /* grey = 255 (1 + (level + gain) / range) */
    float specular_db, specular_power; /* level of an interface: specular_db + 20 log10(R cos^power) */
    hs_tissue_properties tissue[HS_TISSUE_COUNT];
    hs_sac_spec sac;
    hs_layers_spec layers;
    hs_structure structure[HS_SCENE_MAX_STRUCTURES];
    uint32_t structure_count;
    hs_attenuation_spec attenuation;
    hs_edge_spec edge;
    hs_reverberation_spec reverberation;
    hs_haze_spec haze;
    hs_corner_spec corner;
    hs_slice_spec slice;
    hs_far_band_spec far_band;
    hs_speckle_spec speckle;
    hs_side_lobe_spec side_lobe;
    hs_noise_spec noise;
    hs_fan_spec fan;
    hs_motion_spec motion;
} hs_scene_spec;

/* Reads a scene from a file's text; `path` is for messages, which name file, line and field. */
bool hs_scene_read_text(const char *path, const char *text, hs_scene_spec *spec, hs_error *err);

/* Moves along the beam what has a gap_mm: first every such fetus, until the fluid between the sac's wall and
 * its skin is that long where it is shortest; then every such occluder, until its far side is that far before
 * the nearest fetus. Below 0 the two overlap by that much. HS_ERR_INPUT if no beam meets both, HS_ERR_MEMORY.
 */
bool hs_scene_place(hs_scene_spec *spec, hs_error *err);

/* Moves the scene to where it stands at `frame`. */
void hs_scene_move(hs_scene_spec *spec, uint32_t frame);
