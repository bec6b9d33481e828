/* SPDX-License-Identifier: MIT */
/* Tissues and their acoustic properties. */
#ifndef HS_SCENE_TISSUE_H
#define HS_SCENE_TISSUE_H

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

#endif
