/* SPDX-License-Identifier: MIT */
/* What random scenes are drawn from: one table, which `host_sim scenes --ranges` prints. */
#ifndef HS_SCENE_RANGES_H
#define HS_SCENE_RANGES_H

#include <stdbool.h>
#include <stdint.h>

/* In the order of the table. The share_* are in percent of the scenes. */
typedef enum {
    HS_RANGE_NO_FETUS,
    HS_RANGE_BARE,
    HS_RANGE_TWINS,
    HS_RANGE_LATERAL,
    HS_RANGE_FRONTAL,
    HS_RANGE_FROM_BEHIND,
    HS_RANGE_CONTACT,
    HS_RANGE_LIMB_CONTACT,
    HS_RANGE_LIMB_FORWARD,
    HS_RANGE_BLADDER,
    HS_RANGE_NUCHAL,
    HS_RANGE_CORD,
    HS_RANGE_CLOUD,
    HS_RANGE_SOFT,
    HS_RANGE_HAZE,
    HS_RANGE_THICK,
    HS_RANGE_CORNER,
    HS_RANGE_EDGE,
    HS_RANGE_REVERBERATION,
    HS_RANGE_SIDE_LOBES,
    HS_RANGE_FREQUENCY,
    HS_RANGE_DYNAMIC,
    HS_RANGE_GAIN,
    HS_RANGE_TGC,
    HS_RANGE_FAT,
    HS_RANGE_MUSCLE,
    HS_RANGE_UNDULATION,
    HS_RANGE_SAC_X,
    HS_RANGE_SAC_Y,
    HS_RANGE_SAC_Z,
    HS_RANGE_ROUGHNESS,
    HS_RANGE_SCALE,
    HS_RANGE_TWIN_SCALE,
    HS_RANGE_PLACE,
    HS_RANGE_NOD,
    HS_RANGE_TURN,
    HS_RANGE_CAMERA,
    HS_RANGE_JOINT,
    HS_RANGE_FORWARD,
    HS_RANGE_GAP,
    HS_RANGE_OVERLAP,
    HS_RANGE_OCCLUDERS,
    HS_RANGE_ASIDE,
    HS_RANGE_ACROSS,
    HS_RANGE_PROTRUSION,
    HS_RANGE_BLEND,
    HS_RANGE_BRIGHTNESS,
    HS_RANGE_SOFT_MM,
    HS_RANGE_LOOPS,
    HS_RANGE_CORD_RADIUS,
    HS_RANGE_PARTICLES,
    HS_RANGE_BLADDER_X,
    HS_RANGE_BLADDER_Z,
    HS_RANGE_HAZE_LEVEL,
    HS_RANGE_HAZE_DECAY,
    HS_RANGE_HAZE_PATCH,
    HS_RANGE_ELEVATION,
    HS_RANGE_THICK_FOCUS,
    HS_RANGE_THICK_RAYLEIGH,
    HS_RANGE_CORNER_LOSS,
    HS_RANGE_CORNER_TURN,
    HS_RANGE_AXIAL,
    HS_RANGE_LATERAL_MM,
    HS_RANGE_FOCUS,
    HS_RANGE_NOISE,
    HS_RANGE_COUNT
} hs_range_id;

/* A number is low + i step, i = 0 .. (high - low) / step, all of them alike. In hundredths, so that a
 * scene is drawn with whole numbers only. */
typedef struct {
    const char *key, *unit;
    int32_t low, high, step;
    const char *what; /* what it is, and where the range comes from */
} hs_range;

extern const hs_range hs_scene_ranges[HS_RANGE_COUNT];

/* Number `k` (0 .. 255) of a range, in hundredths; it depends on key, range and k only. */
int32_t hs_range_draw(uint64_t key, hs_range_id id, uint32_t k);

/* Whether something with that share is in the scene of the key. */
bool hs_range_has(uint64_t key, hs_range_id id);

#endif
