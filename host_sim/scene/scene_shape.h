/* SPDX-License-Identifier: MIT */
/* Distances to what solids make together: bodies with their carvings, occluders, the sac. In mm,
 * negative inside. */
#ifndef HS_SCENE_SHAPE_H
#define HS_SCENE_SHAPE_H

#include "scene/scene_solid.h"
#include "scene/scene_spec.h"

#include <math.h>

#define HS_SHAPE_FAR 1e3f /* there is none */

/* Solids, or some of them, by their indices: first[part] .. first[part + 1] are of one part. All borrowed. */
typedef struct {
    const hs_solid *solids;
    const uint16_t *item;
    const uint32_t *first;
} hs_shape;

/* All of a list's solids, which it sorts; `item` has room for HS_SCENE_MAX_SOLIDS, `first` for
 * HS_PART_COUNT + 1. False if the list is not to be used, or too long. */
static inline bool hs_shape_all(hs_solid_list *list, uint16_t *item, uint32_t *first) {
    uint32_t part = 0;
    if (list->out_of_memory || list->count > HS_SCENE_MAX_SOLIDS) return false;
    hs_solid_list_sort(list);
    first[0] = 0;
    for (uint32_t i = 0; i < list->count; i++) {
        while (part < (uint32_t)list->items[i].part) first[++part] = i;
        item[i] = (uint16_t)i;
    }
    while (part < HS_PART_COUNT) first[++part] = (uint32_t)list->count;
    return true;
}

/* The solids of a part and a body, melted together one after the other, beginning with distance d. */
static inline float hs_shape_blended(const hs_shape *shape, hs_solid_part part, uint32_t body,
                                     const float p[3], float d) {
    for (uint32_t i = shape->first[part]; i < shape->first[part + 1]; i++) {
        const hs_solid *s = &shape->solids[shape->item[i]];
        if (s->body == body) d = hs_smooth_min(d, hs_solid_distance(s, p), s->blend);
    }
    return d;
}

/* The skin of one fetus. */
static inline float hs_shape_one_body(const hs_shape *shape, uint32_t body, const float p[3]) {
    float d = hs_shape_blended(shape, HS_PART_SKIN, body, p, HS_SHAPE_FAR);
    for (uint32_t i = shape->first[HS_PART_CARVE]; i < shape->first[HS_PART_CARVE + 1]; i++) {
        const hs_solid *s = &shape->solids[shape->item[i]];
        if (s->body == body) d = -hs_smooth_min(-d, hs_solid_distance(s, p), s->blend);
    }
    return hs_shape_blended(shape, HS_PART_PATCH, body, p, d);
}

/* The nearest of `bodies`: they touch, but they do not melt together. */
static inline float hs_shape_body(const hs_shape *shape, uint32_t bodies, const float p[3]) {
    float d = hs_shape_one_body(shape, 0, p);
    for (uint32_t b = 1; b < bodies; b++) d = fminf(d, hs_shape_one_body(shape, b, p));
    return d;
}

/* Solids of another part, melted together; *nearest is the one whose own distance is the least, and
 * stays as it is if there is none. */
static inline float hs_shape_nearest(const hs_shape *shape, hs_solid_part part, const float p[3],
                                     const hs_solid **nearest) {
    float d = HS_SHAPE_FAR, least = HS_SHAPE_FAR;
    for (uint32_t i = shape->first[part]; i < shape->first[part + 1]; i++) {
        const hs_solid *s = &shape->solids[shape->item[i]];
        float e = hs_solid_distance(s, p);
        if (e < least) {
            least = e;
            *nearest = s;
        }
        d = hs_smooth_min(d, e, s->blend);
    }
    return d;
}

/* The sac's ellipsoid. */
static inline hs_solid hs_shape_sac(const hs_sac_spec *sac) {
    hs_solid s = {.shape = HS_SOLID_ELLIPSOID};
    for (int a = 0; a < 3; a++) {
        s.centre[a] = sac->centre[a];
        s.radii[a] = sac->radii[a];
    }
    hs_rotation(sac->rotation, s.axis);
    return s;
}

/* The sac with its bumps: three plane waves. */
static inline float hs_shape_sac_distance(const hs_solid *solid, const hs_sac_spec *sac, const float p[3]) {
    float d = hs_solid_distance(solid, p);
    if (sac->roughness_mm <= 0.0f) return d;
    float k = 6.2831853f / sac->roughness_scale_mm;
    float s = sinf(k * (p[0] + 0.35f * p[1])) + sinf(k * (0.8f * p[1] - 0.4f * p[0]) + 1.3f) +
              sinf(k * (0.7f * p[2] + 0.5f * p[0] - 0.3f * p[1]) + 2.1f);
    return d + sac->roughness_mm * s * (1.0f / 3.0f);
}

#endif
