/* SPDX-License-Identifier: MIT */
/* Where rays have no fluid of their own, the surface goes on from those that have. By hand from the numbers
 * of docs/surface.md. */
#include "support/wall_model.h"

/* One ray of tissue, with layers from .. to - 1 of a level. */
static bool has_fluid(uint32_t from, uint32_t to, uint8_t level, float place, uint32_t shown) {
    model m;
    make(&m, 1, 1, DEEP, NULL);
    fill(&m, m.blocks.relative, 0, 0, DEEP, TISSUE);
    fill(&m, m.blocks.relative, 0, from, to, level);
    return sv_wall_has_fluid(&m.scan, 0, place, shown);
}

/* Dark is what has at most 0.4 of the threshold, 51 of 128; near is at most 7 mm, four layers. */
static void two_dark_blocks_near_the_surface_are_its_fluid(void **state) {
    assert_true(has_fluid(5, 7, 51, 6.0f, 0));
    assert_false(has_fluid(5, 7, 52, 6.0f, 0));
    assert_false(has_fluid(5, 6, 0, 6.0f, 0));
    assert_true(has_fluid(5, 7, 0, 9.9f, 0));
    assert_false(has_fluid(5, 7, 0, 10.0f, 0));
    assert_true(has_fluid(5, 7, 0, 2.0f, 0));
    assert_false(has_fluid(5, 7, 0, 1.9f, 0));
}

static void a_ray_with_a_fetus_or_without_tissue_is_left_alone(void **state) {
    assert_true(has_fluid(0, 0, 0, 6.0f, 9830)); /* 0.3 of 32768 */
    assert_false(has_fluid(0, 0, 0, 6.0f, 9829));
    assert_true(has_fluid(0, DEEP, 100, 6.0f, 0));
}

/* Rays of cells in a row, whose surfaces go on. */
typedef struct {
    model m;
    uint32_t *costs;
    size_t rays;
    bool *own;
    float *places, *near, *far, *least, *confidence;
} line;

/* All surfaces lie in layer 12, in a range of a layer to either side, and no ray has fluid of its own. */
static line *line_of(uint32_t cells) {
    line *const l = unit_memory(sizeof *l);
    l->rays = (size_t)4 * cells;
    make(&l->m, cells, 1, DEEP, NULL);
    l->costs = unit_memory((size_t)cells * DEEP * sizeof *l->costs);
    l->own = unit_memory(l->rays * sizeof *l->own);
    l->near = unit_memory(SV_WALL_PLACES * l->rays * sizeof *l->near);
    l->places = l->near + l->rays;
    l->far = l->places + l->rays;
    l->least = unit_memory(l->rays * sizeof *l->least);
    l->confidence = unit_memory(l->rays * sizeof *l->confidence);
    for (size_t i = 0; i < l->rays; i++) {
        l->near[i] = 11.0f;
        l->places[i] = 12.0f;
        l->far[i] = 13.0f;
        l->confidence[i] = 1.0f;
    }
    return l;
}

/* Ray x of the first row or of both has fluid of its own, with its surface in that layer. */
static void put_own(line *l, uint32_t x, uint32_t rows, float place) {
    for (size_t i = x; i < l->rays && rows > 0; i += l->m.layout.columns, rows--) {
        l->own[i] = true;
        l->near[i] = place - 1.0f;
        l->places[i] = place;
        l->far[i] = place + 1.0f;
    }
}

static void go_on(line *l) {
    assert_true(sv_wall_go_on(&l->m.scan, l->costs, l->least, l->own, l->near, l->confidence));
}

/* In layer 9, which costs 5.5 on all rays: half as sure as where nothing is to pay. Behind eight layers of
 * tissue, of 2 mm each, half of that; behind four, four fifths. */
static void the_surface_goes_on_and_is_less_sure_behind_tissue(void **state) {
    line *const l = line_of(16);
    put_own(l, 0, 2, 9.0f);
    put_own(l, 1, 2, 9.0f);
    for (uint32_t cell = 0; cell < 16; cell++) {
        l->costs[cell * DEEP + 9] = 11 * SV_WALL_FINE_COST_ONE / 2;
        fill(&l->m, l->m.blocks.relative, cell, 0, cell % 2 ? 8 : 4, TISSUE);
    }
    go_on(l);
    for (size_t i = 0; i < l->rays; i++) {
        assert_true(l->near[i] == 8.0f && l->places[i] == 9.0f && l->far[i] == 10.0f);
        assert_true(l->confidence[i] == (l->own[i] ? 1.0f : i / 2 % 2 ? 0.25f : 0.4f));
    }
}

/* Between two rims it is linear, but for steps of less than a layer. */
static void between_two_rims_it_is_smooth(void **state) {
    line *const l = line_of(16);
    for (uint32_t x = 0; x < 2; x++) {
        put_own(l, x, 2, 2.0f);
        put_own(l, 31 - x, 2, 10.0f);
    }
    go_on(l);
    for (size_t i = 1; i < 32; i++)
        assert_true(l->places[i] >= l->places[i - 1] && l->places[i] < l->places[i - 1] + 2.0f);
    assert_true(l->places[15] + l->places[16] == 12.0f);
}

/* It goes deeper as long as no layer costs 1 more than the ray's minimum. */
static float goes_to(uint32_t cost) {
    line *const l = line_of(2);
    put_own(l, 0, 2, 14.0f);
    put_own(l, 1, 2, 14.0f);
    for (uint32_t z = 13; z < DEEP; z++) l->costs[DEEP + z] = l->costs[z] = cost;
    for (size_t i = 0; i < l->rays; i++) l->least[i] = 0.5f;
    go_on(l);
    return l->places[3];
}

static void a_fetus_that_lies_against_the_wall_stops_it(void **state) {
    assert_true(goes_to(3 * SV_WALL_FINE_COST_ONE / 2 - 1) == 14.0f);
    assert_true(goes_to(3 * SV_WALL_FINE_COST_ONE / 2) == 12.0f);
}

/* A single ray may be noise: three of a cell's four tell the others. */
static void a_single_ray_tells_nothing(void **state) {
    line *const l = line_of(4);
    put_own(l, 0, 2, 5.0f);
    go_on(l);
    assert_true(l->places[0] == 5.0f && l->places[1] == 12.0f && l->confidence[1] == 1.0f);
    put_own(l, 1, 1, 5.0f);
    go_on(l);
    assert_true(l->places[7] == 5.0f);
}

static void what_was_not_scanned_stays_and_tells_nothing(void **state) {
    line *const l = line_of(4);
    for (uint32_t x = 0; x < 2; x++) put_own(l, x, 2, 5.0f);
    for (size_t i = 0; i < l->rays; i++) {
        l->m.blocks.end[i] = i % 8 < 2 ? 0 : DEEP;
        l->own[i] = l->own[i] || l->m.blocks.end[i] == 0;
    }
    go_on(l);
    assert_true(l->places[0] == 5.0f && l->places[2] == 12.0f && l->confidence[0] == 1.0f);
}

/* An odd number of cells, and of theirs. */
static void a_mirrored_line_has_mirrored_surfaces(void **state) {
    for (uint32_t cells = 3; cells <= 13; cells += 2) {
        line *const a = line_of(cells), *const b = line_of(cells);
        const uint32_t rays = 2 * cells;
        for (uint32_t x = 0; x < 4; x++) {
            put_own(a, x, 2, 3.0f + 1.7f * (float)x);
            put_own(b, rays - 1 - x, 2, 3.0f + 1.7f * (float)x);
        }
        go_on(a);
        go_on(b);
        for (uint32_t x = 0; x < rays; x++) {
            assert_true(a->places[x] == b->places[rays - 1 - x]);
            assert_true(a->confidence[x] == b->confidence[rays - 1 - x]);
        }
    }
}

UNIT_MAIN(NULL, NULL, two_dark_blocks_near_the_surface_are_its_fluid,
          a_ray_with_a_fetus_or_without_tissue_is_left_alone,
          the_surface_goes_on_and_is_less_sure_behind_tissue, between_two_rims_it_is_smooth,
          a_fetus_that_lies_against_the_wall_stops_it, a_single_ray_tells_nothing,
          what_was_not_scanned_stays_and_tells_nothing, a_mirrored_line_has_mirrored_surfaces)
