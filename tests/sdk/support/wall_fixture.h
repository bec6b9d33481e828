/* SPDX-License-Identifier: MIT */
/* Scans for the tests of the surface told by the wall: a wall, fluid, and a fetus with bright bone in a cube
 * of 120 mm. */
#pragma once

#include "ref/ref_wall.h"
#include "support/unit.h"

#include <math.h>

enum { N = 64, PIXELS = N * N, RAYS = 4 * PIXELS };
static const double MM = 1.875; /* of a voxel: the cube is 120 mm wide */
enum { WALL = 16, GAP = 34, FLUID = 6, FLESH = 90, MUSCLE = 85, BONE = 200 };

typedef struct {
    uint32_t width, height, slices;
    uint8_t *voxels;
    uint16_t *first, *end;
    const sv_beams *beams; /* NULL: not told */
    float *depth, *confidence;
    sv_wall_outcome outcome;
    sv_wall_facts facts;
} scan;

static inline scan scan_make(uint32_t width, uint32_t height, uint32_t slices) {
    const size_t plane = (size_t)width * height;
    scan s = {.width = width, .height = height, .slices = slices};
    s.voxels = unit_memory(plane * slices);
    s.first = unit_memory(plane * sizeof *s.first);
    s.end = unit_memory(plane * sizeof *s.end);
    s.depth = unit_memory(plane * sizeof *s.depth);
    s.confidence = unit_memory(plane * sizeof *s.confidence);
    for (size_t i = 0; i < plane; i++) s.end[i] = (uint16_t)slices;
    return s;
}

/* Runs with `settings`; NULL is the default. */
static inline void scan_run_with(scan *s, const sv_wall_settings *settings) {
    const sv_wall_volume v = {.voxels = s->voxels,
                              .width = s->width,
                              .height = s->height,
                              .slices = s->slices,
                              .first = s->first,
                              .end = s->end,
                              .spacing_mm = {MM, MM, MM},
                              .beams = s->beams};
    for (size_t i = 0; i < (size_t)s->width * s->height; i++) s->depth[i] = s->confidence[i] = -1.0f;
    assert_true(sv_wall_surface(&v, settings, s->depth, s->confidence, &s->outcome, &s->facts));
    for (size_t i = 0; i < (size_t)s->width * s->height; i++) {
        assert_true(s->depth[i] >= 0.0f && s->depth[i] <= (float)s->slices);
        assert_true(s->confidence[i] >= 0.0f && s->confidence[i] <= 1.0f);
    }
}

static inline void scan_run(scan *s) {
    scan_run_with(s, NULL);
}

static inline size_t at(const scan *s, uint32_t x, uint32_t y, uint32_t z) {
    return ((size_t)z * s->height + y) * s->width + x;
}

/* Grain of a voxel, 0.75 .. 1.25: a hash of its place. */
static inline double grain(uint32_t x, uint32_t y, uint32_t z) {
    uint32_t h = x * 73856093u ^ y * 19349663u ^ z * 83492791u;
    h = (h ^ h >> 15) * 2246822519u;
    return 0.75 + 0.5 * (double)(h >> 16) / 65535.0;
}

static inline double square(double v) {
    return v * v;
}

/* The fetus: a ball of flesh with a bone in its middle, left of the centre, so that no turn leaves the volume
 * as it is. */
static inline double fetus_level(double x, double y, double z, double front) {
    const double r = sqrt(square(x - 26.0) + square(y - 35.0) + square(z - front - 12.0));
    return r > 12.0 ? 0.0 : r < 7.0 ? BONE : FLESH;
}

/* Wall up to `wall` slices, fluid, the fetus from about `front` on, the back of the sac from 58 on. */
static inline void draw(scan *s, uint32_t wall, double front, bool with_fetus) {
    for (uint32_t z = 0; z < s->slices; z++)
        for (uint32_t y = 0; y < s->height; y++)
            for (uint32_t x = 0; x < s->width; x++) {
                const double body = with_fetus ? fetus_level(x, y, z, front) : 0.0;
                const double level = z < wall || z >= 58 ? MUSCLE : body > 0.0 ? body : FLUID;
                s->voxels[at(s, x, y, z)] = (uint8_t)(level * grain(x, y, z) + 0.5);
            }
}

static inline scan scene(void) {
    scan s = scan_make(N, N, N);
    draw(&s, WALL, GAP, true);
    return s;
}

/* First slice of the fetus on a ray, or N. */
static inline uint32_t skin(uint32_t x, uint32_t y) {
    uint32_t z = 0;
    while (z < N && fetus_level(x, y, z, GAP) <= 0.0) z++;
    return z;
}
