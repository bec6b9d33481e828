/* SPDX-License-Identifier: MIT */
/* How bright the wall is, and how likely tissue of a brightness is the fetus. */
#ifndef REF_WALL_EVIDENCE_H
#define REF_WALL_EVIDENCE_H

#include "ref/ref_wall_levels.h"

typedef struct {
    uint32_t wall_rays;
    bool bare;                       /* there is no wall: the next two are assumed */
    uint32_t wall;                   /* grey level, in units of 1 / SV_WALL_LEVEL_ONE */
    int32_t spread;                  /* ln of the odds, fixed-point */
    uint32_t first[256], other[256]; /* brightness to probability: the first tissue of a ray, any other */
} sv_wall_evidence;

/* Everything that rays are judged from. Borrowed. */
typedef struct {
    const sv_wall_layout *layout;
    const sv_wall_blocks *blocks;
    const uint8_t *bright;       /* of every cell (sv_wall_brightest) */
    const uint8_t *surroundings; /* the same (sv_wall_find_surroundings) */
    uint32_t threshold;          /* tissue is brighter */
} sv_wall_scan;

/* True if the block in layer z of a ray is tissue. */
bool sv_wall_is_tissue(const sv_wall_scan *scan, size_t ray, size_t z);

/* The brightness of a ray in layer z: its cell's. */
uint8_t sv_wall_brightness(const sv_wall_scan *scan, size_t ray, size_t z);

/* What is surroundings the ray's cell there. Enclosed: through tissue alone one comes to the wall to the
 * left, to the right, upwards and downwards. Flanked: to the fetus to the left and to the right, or upwards
 * and downwards. One side: to the fetus on some side only. */
enum { SV_WALL_ENCLOSED = 1, SV_WALL_FLANKED = 2, SV_WALL_ONE_SIDE = 4 };
uint8_t sv_wall_surroundings_at(const sv_wall_scan *scan, size_t ray, size_t z);

/* The first tissue of a ray: layers [begin, end), both the end of the scan if there is none. `touches`: it
 * begins where the scan does. `fluid`: fluid follows it. */
typedef struct {
    uint32_t begin, end;
    bool touches, fluid;
} sv_wall_run;
sv_wall_run sv_wall_first_run(const sv_wall_scan *scan, size_t ray);

void sv_wall_evidence_of(const sv_wall_scan *scan, const sv_wall_levels *levels, sv_wall_evidence *out);

#endif
