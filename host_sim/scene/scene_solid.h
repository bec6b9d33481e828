/* SPDX-License-Identifier: MIT */
/* Solids as signed distances, from which the voxels of a scene are made. All lengths in millimetres of
 * the scene. */
#ifndef HS_SCENE_SOLID_H
#define HS_SCENE_SOLID_H

#include "base/error.h"
#include "scene/scene_tissue.h"

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

#endif
