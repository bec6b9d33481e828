/* SPDX-License-Identifier: MIT */
/* Solids as signed distances, from which the voxels of a scene are made, and what they make together. All
 * lengths in millimetres of the scene, negative inside. */
#pragma once

#include "scene/scene_spec.h"

#include <math.h>
#include <stddef.h>

#define HS_SCENE_MAX_SOLIDS 4096u

typedef enum {
    HS_SOLID_ELLIPSOID,
    HS_SOLID_CONE,  /* a tube from `centre` to `end` with radii r0 and r1 and round ends */
    HS_SOLID_SHELL, /* the surface of an ellipsoid, `thickness` thick */
    HS_SOLID_RIBS   /* bands of that shell, `pitch` apart, tilted */
} hs_solid_shape;

/* What a solid is part of. */
typedef enum {
    HS_PART_SKIN,     /* the fetus: blended into one body */
    HS_PART_CARVE,    /* cut out of that body (mouth, orbits) */
    HS_PART_PATCH,    /* joined to the body after the carving (eyelids) */
    HS_PART_ORGAN,    /* inside the body: a tissue of its own */
    HS_PART_BONE,     /* inside the body */
    HS_PART_OCCLUDER, /* placenta, cord, particles, the bladder with its wall */
    HS_PART_BLADDER,  /* urine: cut out of the occluders */
    HS_PART_COUNT
} hs_solid_part;

typedef struct {
    hs_solid_shape shape;
    hs_solid_part part;
    uint32_t order; /* place in the list; blending depends on it */
    hs_tissue tissue;
    uint8_t body;  /* of the fetus: which one, from 0 */
    uint8_t style; /* of an occluder: 1 + its structure if that has an echo or an edge of its own, else 0 */
    float blend;   /* width over which it melts into the solids of its part before it; 0: a hard union */
    float centre[3], end[3];
    float axis[9]; /* rows: the solid's own x, y, z axes */
    float radii[3];
    float r0, r1;
    float thickness, pitch, tilt, span; /* ribs: half length of the cage along its own y */
    float low[3], high[3];              /* holds the solid and its blend */
} hs_solid;

typedef struct {
    hs_solid *items;
    size_t count, capacity;
    bool out_of_memory; /* an add failed; the list is then not to be used */
} hs_solid_list;

/* A frame in which solids are described: scene = origin + scale * (x, y, z) . axis rows. */
typedef struct {
    float origin[3], axis[9], scale;
} hs_solid_frame;

/* Signed distance of point p, negative inside; exact for cones, close to the surface right for the others. */
float hs_solid_distance(const hs_solid *solid, const float p[3]);

/* The smaller of two distances, melted together where they differ by less than k (polynomial smooth
 * minimum: min(a, b) - h^2 k / 4 with h = max(k - |a - b|, 0) / k). k = 0: the plain minimum. */
static inline float hs_smooth_min(float a, float b, float k) {
    float low = a < b ? a : b, gap = a < b ? b - a : a - b;
    if (gap >= k) return low;
    float h = (k - gap) / k;
    return low - 0.25f * h * h * k;
}

/* Rows of a rotation by degrees about x, then y, then z. */
void hs_rotation(const float deg[3], float axis[9]);
/* A point or a direction of the frame in the scene. */
void hs_frame_point(const hs_solid_frame *frame, const float p[3], float out[3]);

/* Adds a solid described in `frame`: NULL memory is noted in the list. Returns it for further fields, or
 * NULL. */
hs_solid *hs_solid_ellipsoid(hs_solid_list *list, const hs_solid_frame *frame, hs_solid_part part,
                             hs_tissue tissue, float blend, const float centre[3], const float radii[3]);
hs_solid *hs_solid_cone(hs_solid_list *list, const hs_solid_frame *frame, hs_solid_part part,
                        hs_tissue tissue, float blend, const float from[3], float r0, const float to[3],
                        float r1);
hs_solid *hs_solid_shell(hs_solid_list *list, const hs_solid_frame *frame, hs_solid_part part,
                         hs_tissue tissue, const float centre[3], const float radii[3], float thickness);
hs_solid *hs_solid_ribs(hs_solid_list *list, const hs_solid_frame *frame, const float centre[3],
                        const float radii[3], float thickness, float pitch, float tilt, float span);
/* Groups the solids by their part, and leaves them in their order within it. */
void hs_solid_list_sort(hs_solid_list *list);
/* Bodies: one more than the largest hs_solid.body. */
uint32_t hs_solid_list_bodies(const hs_solid_list *list);
void hs_solid_list_free(hs_solid_list *list);

/* A frame at `origin`, turned by degrees about x, then y, then z. */
hs_solid_frame hs_frame_at(const float origin[3], const float deg[3]);

/* The frame a fetus is described in. */
hs_solid_frame hs_fetus_frame(const hs_fetus_spec *fetus);
/* Adds skin, carved and bone solids of a fetus as body number `body`. */
void hs_fetus_solids(hs_solid_list *list, const hs_fetus_spec *fetus, uint32_t body);
/* The middle surface of the skull as an ellipsoid in the scene. */
void hs_fetus_skull(const hs_fetus_spec *fetus, hs_solid *skull);

/* Adds the solids of all structures but sac and layers. The places of particles come from `seed`.
 * HS_ERR_MEMORY. */
bool hs_scene_solids(const hs_scene_spec *spec, uint64_t seed, hs_solid_list *list, hs_error *err);

/* Whether a structure has an echo or an edge of its own: its voxels then carry a style. */
bool hs_scene_style(const hs_structure *structure);

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
    float d = HS_SHAPE_FAR, closest = HS_SHAPE_FAR;
    for (uint32_t i = shape->first[part]; i < shape->first[part + 1]; i++) {
        const hs_solid *s = &shape->solids[shape->item[i]];
        float e = hs_solid_distance(s, p);
        if (e < closest) {
            closest = e;
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
