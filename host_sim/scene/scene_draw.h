/* SPDX-License-Identifier: MIT */
/* Random scenes by seed and number, and what they are drawn from. */
#pragma once

#include <stdbool.h>
#include <stdint.h>

/* What random scenes are drawn from: id, low, high, step, all in hundredths, so that a scene is drawn with
 * whole numbers only. A number is low + i step, i = 0 .. (high - low) / step, all of them alike. First the
 * shares of the scenes, in percent; then lengths in mm, angles in degrees, levels in dB, frequencies in MHz.
 * Numbers in brackets are sources of docs/scenes.md. */
#define HS_SCENE_RANGES(X)                                                                                   \
    X(NO_FETUS, 500, 500, 100)      /* a scan without a fetus */                                             \
    X(BARE, 600, 600, 100)          /* nothing lies before the fetus */                                      \
    X(TWINS, 600, 600, 100)         /* two fetuses; more often than they are born, so that a set has some */ \
    X(LATERAL, 900, 900, 100)       /* the camera looks from the side of the beams */                        \
    X(FRONTAL, 900, 900, 100)       /* the probe sees a profile, the camera the face */                      \
    X(FROM_BEHIND, 1200, 1200, 100) /* the fetus turns its back, as in M03 and D02 */                        \
    X(CONTACT, 2500, 2500, 100)     /* an occluder touches the fetus over some area */                       \
    X(LIMB_CONTACT, 1200, 1200, 100)  /* what protrudes most of the fetus touches the wall */                \
    X(LIMB_FORWARD, 4000, 4000, 100)  /* a hand or knee is stretched to the probe, as in E02 to E04 */       \
    X(BLADDER, 1200, 1200, 100)       /* a bladder before the uterus: a full one is asked for early scans */ \
    X(NUCHAL, 800, 800, 100)          /* a cord round the neck: so many at 10 to 14 weeks [14] */            \
    X(CORD, 4500, 4500, 100)          /* a cord across the fluid */                                          \
    X(CLOUD, 4500, 4500, 100)         /* particles in the fluid */                                           \
    X(SOFT, 6000, 6000, 100)          /* an occluder with a soft edge */                                     \
    X(HAZE, 7000, 7000, 100)          /* haze behind the wall */                                             \
    X(THICK, 6000, 6000, 100)         /* a thick slice */                                                    \
    X(CORNER, 3500, 3500, 100)        /* a corner without contact, the lower right one most often */         \
    X(EDGE, 8000, 8000, 100)          /* edge shadows */                                                     \
    X(REVERBERATION, 6000, 6000, 100) /* bands behind the wall */                                            \
    X(SIDE_LOBES, 4000, 4000, 100)    /* haze beside strong interfaces */                                    \
    X(FREQUENCY, 250, 500, 25)        /* abdominal 3D probes */                                              \
    X(DYNAMIC, 5500, 6500, 100)       /* around the nine cases' 60 */                                        \
    X(GAIN, 200, 900, 50)             /* the nine cases have 6 or 8 */                                       \
    X(TGC, 13, 23, 1)                 /* the nine cases have 0.16 to 0.21 */                                 \
    X(FAT, 300, 1400, 50)             /* thin to thick abdominal walls */                                    \
    X(MUSCLE, 400, 900, 50)           /* the nine cases have 7 */                                            \
    X(UNDULATION, 0, 300, 25)         /* the nine cases have 1.5 */                                          \
    X(SAC_X, 5000, 6200, 100)         /* radius; the nine cases have 52 or 57 */                             \
    X(SAC_Y, 5800, 6800, 100)         /* radius; the nine cases have 59 or 62 */                             \
    X(SAC_Z, 3600, 4600, 100)         /* radius; the nine cases have 38 */                                   \
    X(ROUGHNESS, 50, 300, 25)         /* height of the wall's bumps */                                       \
    X(SCALE, 66, 100, 2)              /* 59 to 90 mm from crown to rump, 12 to 14 weeks */                   \
    X(TWIN_SCALE, 52, 66, 2)          /* two of them have room in the volume */                              \
    X(PLACE, -600, 600, 50)           /* of the fetus, from the middle, in x and in y */                     \
    X(NOD, -1200, 1200, 100)          /* about x and about z */                                              \
    X(TURN, -3500, 3500, 100)         /* about y; from behind: 180 more */                                   \
    X(CAMERA, 5500, 9500, 500)        /* about y, to either side: far off the beams */                       \
    X(JOINT, -300, 300, 25)           /* of every joint, along every axis, at scale 1 */                     \
    X(FORWARD, 400, 1600, 50)         /* a stretched limb, at scale 1 */                                     \
    X(GAP, 200, 3000, 25)           /* fluid before the fetus where it is thinnest: hardly any to plenty */  \
    X(OVERLAP, 100, 500, 25)        /* how far what touches presses in */                                    \
    X(OCCLUDERS, 100, 300, 100)     /* folds of placenta or uterus */                                        \
    X(ASIDE, -1800, 1800, 50)       /* of an occluder, from the middle, in x and in y */                     \
    X(ACROSS, 1400, 3000, 50)       /* radius of an occluder in x and in y */                                \
    X(PROTRUSION, 300, 1200, 25)    /* how far the nearest occluder stands into the sac */                   \
    X(BLEND, 0, 400, 50)            /* of an occluder into the one before it */                              \
    X(BRIGHTNESS, -1200, 600, 50)   /* of an occluder: dim ones come close to haze, bright ones to bone */   \
    X(SOFT_MM, 100, 500, 25)        /* of an occluder's edge: a chorionic plate or a haematoma */            \
    X(LOOPS, 100, 200, 100)         /* of a cord round the neck */                                           \
    X(CORD_RADIUS, 200, 350, 10)    /* the nine cases have 2.8 or 3 */                                       \
    X(PARTICLES, 2000, 12000, 100)  /* the nine cases have 45 to 110 */                                      \
    X(BLADDER_X, 1800, 3000, 100)   /* radius in x; in y two thirds of it */                                 \
    X(BLADDER_Z, 350, 800, 25)      /* radius in z */                                                        \
    X(HAZE_LEVEL, -1600, -300, 100) /* against the wall's echo; -30 to 0 was found in bladders [15] */       \
    X(HAZE_DECAY, 30, 150, 10)      /* out of sight 5 to 40 mm behind the wall */                            \
    X(HAZE_PATCH, 0, 800, 100)      /* clutter is uneven */                                                  \
    X(ELEVATION, 60, 180, 10)       /* standard deviation: slices 1.5 to 4 mm thick at the focus */          \
    X(THICK_FOCUS, 4000, 8000, 500) /* the lens is fixed */                                                  \
    X(THICK_RAYLEIGH, 1500, 4000, 100) /* of the order of 4 pi sigma^2 / wavelength */                       \
    X(CORNER_LOSS, 800, 3000, 100)     /* from hardly seen to nothing left */                                \
    X(CORNER_TURN, 1500, 7500, 500)    /* 0 to the right, 90 down */                                         \
    X(AXIAL, 30, 60, 5)                /* the nine cases have 0.4 */                                         \
    X(LATERAL_MM, 50, 100, 5)          /* the nine cases have 0.6 */                                         \
    X(FOCUS, 4500, 7500, 500)          /* the nine cases have 60 */                                          \
    X(NOISE, -7400, -6600, 100)        /* the nine cases have -67 */                                         \
    X(GREY, -4500, -900, 50)           /* echo of every tissue but fluid, in sets of random greys */

#define HS_RANGE_ID(id, ...) HS_RANGE_##id,
typedef enum { HS_SCENE_RANGES(HS_RANGE_ID) HS_RANGE_COUNT } hs_range_id;
#undef HS_RANGE_ID

typedef struct {
    int32_t low, high, step;
} hs_scene_range;

extern const hs_scene_range hs_scene_ranges[HS_RANGE_COUNT];

/* Number `k` (0 .. 255) of a range, in hundredths; it depends on key, range and k only. */
int32_t hs_range_draw(uint64_t key, hs_range_id id, uint32_t k);

#define HS_SCENE_MAX_DRAWN 100000u /* numbers of a set are below */

/* One scene of a set. */
typedef struct {
    bool greys; /* of a set of random greys */
    uint64_t seed;
    uint32_t number;
} hs_scene_drawn;

/* True for the name of a random scene: R7_3 is number 3 of the set with seed 7, and G7_3 the same scene in
 * random greys, an echo of its own for every tissue but fluid. */
bool hs_scene_drawn_name(const char *name, hs_scene_drawn *scene);

/* The scene's file, drawn from hs_scene_ranges with whole numbers only: the same text on every machine.
 * free() it; NULL without memory. */
char *hs_scene_draw(const hs_scene_drawn *scene);
