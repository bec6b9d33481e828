/* SPDX-License-Identifier: MIT */
/* A few blocks for the tests of single steps of the surface told by the wall. Voxels are 1 mm wide, so a cell
 * is 2 mm, a ray 1 mm, and a layer 2 mm. */
#pragma once

#include "ref/ref_wall_steps.h"
#include "support/unit.h"

/* What the steps read; all of it is fluid of level 0 at first. */
typedef struct {
    sv_wall_layout layout;
    sv_wall_blocks blocks;
    sv_wall_scan scan;
    uint8_t *brightness, *surroundings;
} model;

static inline void make(model *m, uint32_t across, uint32_t down, uint32_t layers,
                        const sv_wall_settings *given) {
    const sv_wall_settings s = given ? *given : sv_wall_settings_default();
    const uint32_t rays = 4 * across * down;
    *m = (model){.layout = sv_wall_layout_of(2 * across, 2 * down, 2 * layers, (double[]){1, 1, 1}, &s)};
    assert_int_equal(m->layout.columns * m->layout.rows, rays);
    assert_int_equal(m->layout.layers, layers);
    m->blocks = (sv_wall_blocks){.columns = 2 * across,
                                 .rows = 2 * down,
                                 .layers = layers,
                                 .means = unit_memory((size_t)rays * layers),
                                 .levels = unit_memory((size_t)rays * layers),
                                 .relative = unit_memory((size_t)rays * layers),
                                 .first = unit_memory(rays * sizeof(uint16_t)),
                                 .end = unit_memory(rays * sizeof(uint16_t)),
                                 .rays = rays};
    m->brightness = unit_memory((size_t)rays / 4 * layers);
    m->surroundings = unit_memory((size_t)rays / 4 * layers);
    for (uint32_t i = 0; i < rays; i++) m->blocks.end[i] = (uint16_t)layers;
    m->scan = (sv_wall_scan){&m->layout, &m->blocks, m->brightness, m->surroundings};
}

/* Gives the four rays of the cell in column `x` of the first row, layers from .. to - 1, a level. */
static inline void fill(const model *m, uint8_t *levels, uint32_t x, uint32_t from, uint32_t to,
                        uint8_t level) {
    const size_t columns = m->layout.columns, plane = columns * m->layout.rows;
    for (uint32_t z = from; z < to; z++)
        for (size_t i = 0; i < 4; i++) levels[z * plane + i / 2 * columns + 2 * x + i % 2] = level;
}

enum { TISSUE = 200 }; /* relative to the threshold */

enum { DEEP = 16, DARK_CELL = 10, BRIGHT_CELL = 20 }; /* brightness of what is no fetus, and of what is */

/* Tissue of one cell, layers from .. to - 1. */
static inline void put_tissue(model *m, uint32_t from, uint32_t to, uint8_t brightness) {
    fill(m, m->blocks.relative, 0, from, to, TISSUE);
    memset(m->brightness + from, brightness, to - from);
}
