/* SPDX-License-Identifier: MIT */
/* The voxels of a scene while it is made: what each one is, and its echo level. */
#ifndef HS_SCENE_FIELD_H
#define HS_SCENE_FIELD_H

#include "base/error.h"
#include "scene/scene_level.h"
#include "scene/scene_tissue.h"

#include <stddef.h>
#include <stdint.h>

/* Signed distances to a surface in sixteenths of a voxel, saturated: negative inside tissue (or bone). */
#define HS_DISTANCE_ONE 16
#define HS_DISTANCE_FAR 127

typedef struct {
    uint32_t n[3];
    float h[3]; /* voxel spacing, mm */
    uint32_t threads;
    uint64_t seed;       /* of the places of things: the same in all frames */
    uint64_t noise_seed; /* of speckle and noise: fresh in every frame */
    uint8_t *tissue;     /* hs_tissue */
    int8_t *surface;     /* distance to the boundary between fluid and tissue, < 0 in tissue */
    int8_t *bone;        /* distance to bone */
    /* Of occluders with an echo or an edge of their own: hs_solid.style, and how much of the tissue's
     * scatterers are there, 255: all. NULL if the scene has none. */
    uint8_t *style, *share;
    float *haze_end;   /* per beam, mm from the probe: haze can be seen before it; NULL if there is none */
    int16_t *diffuse;  /* level of scattered echo */
    int16_t *coherent; /* level of interface echo */
    int16_t *envelope; /* level of what the probe receives */
} hs_field;

bool hs_field_init(hs_field *field, const uint32_t n[3], const float h[3], hs_error *err);
/* Adds the planes `style` and `share`. */
bool hs_field_add_style(hs_field *field, hs_error *err);
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

#endif
