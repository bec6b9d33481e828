/* SPDX-License-Identifier: MIT */
/*
 * Where a thin limb lies against the wall or near it: valleys part first runs, the fetus begins where its run
 * does, and along the beams a limb floats. And what the beams skip, a camera skips. By hand from the numbers
 * of docs/surface.md.
 */
#include "support/wall_model.h"
#include "wall_grid.h"

/* A first run of ten layers of level 100, with fluid behind it, and layer `at` of `level`: how many layers
 * the run still has in front of its fluid. */
static uint32_t layers_of_run(uint32_t at, uint8_t level) {
    model m;
    make(&m, 1, 1, 16, NULL);
    fill(&m, m.blocks.relative, 0, 0, 10, TISSUE);
    fill(&m, m.blocks.levels, 0, 0, 10, 100);
    fill(&m, m.blocks.levels, 0, at, at + 1, level);
    sv_wall_part_valleys(&m.layout, &m.blocks);
    return sv_wall_first_run(&m.scan, 3).end;
}

/* 0.75 of the level on both sides is no valley yet; at the run's last layer there is no other side. */
static void a_valley_parts_a_limb_from_the_wall(void **state) {
    assert_int_equal(layers_of_run(8, 74), 8);
    assert_int_equal(layers_of_run(8, 75), 10);
    assert_int_equal(layers_of_run(9, 74), 10);
}

/* Of three cells the one in the middle is dark in layer 8: of the ten rays within two of one of its rays,
 * four are. They have (6 * 100 + 4 * 38) / 10 = 75.2. */
static uint32_t layers_among_brighter_rays(uint8_t level) {
    model m;
    make(&m, 3, 1, 16, NULL);
    for (uint32_t x = 0; x < 3; x++) {
        fill(&m, m.blocks.relative, x, 0, 10, TISSUE);
        fill(&m, m.blocks.levels, x, 0, 10, 100);
    }
    fill(&m, m.blocks.levels, 1, 8, 9, level);
    sv_wall_part_valleys(&m.layout, &m.blocks);
    return sv_wall_first_run(&m.scan, 2).end;
}

static void a_valley_is_as_wide_as_a_block(void **state) {
    assert_int_equal(layers_among_brighter_rays(38), 10);
    assert_int_equal(layers_among_brighter_rays(37), 8);
}

/* A limb is at most 7 mm thick, four layers. What lies farther in front is the wall. */
static void a_limb_is_thin(void **state) {
    assert_int_equal(layers_of_run(6, 74), 6);
    assert_int_equal(layers_of_run(5, 74), 10);
}

/* A valley within the skin, three layers, parts nothing; nor does one behind which the scan ends. */
static void skin_and_tissue_without_fluid_are_not_parted(void **state) {
    for (uint32_t at = 2; at <= 3; at++)
        for (uint32_t fluid = 0; fluid <= 1; fluid++) {
            model m;
            make(&m, 1, 1, 6, NULL);
            fill(&m, m.blocks.relative, 0, 0, fluid ? 5 : 6, TISSUE);
            fill(&m, m.blocks.levels, 0, 0, 6, 100);
            fill(&m, m.blocks.levels, 0, at, at + 1, 74);
            sv_wall_part_valleys(&m.layout, &m.blocks);
            assert_int_equal(sv_wall_is_tissue(&m.scan, 0, at), at == 2 || !fluid);
        }
}

/* Where the fetus begins on a ray of such a cell. */
static uint32_t front_of(const model *m) {
    sv_wall_evidence e = {.wall_rays = 4};
    sv_wall_costs costs;
    e.first_run[BRIGHT_CELL] = e.later_run[BRIGHT_CELL] = SV_WALL_LIKELY;
    assert_true(sv_wall_costs_create(&m->scan, &e, &costs));
    const uint32_t front = costs.fronts[0];
    sv_wall_costs_destroy(&costs);
    return front;
}

/* A run that is dark in its first two layers is the fetus from these on, if fluid lies before it. */
static void the_fetus_begins_where_its_run_does(void **state) {
    model m;
    make(&m, 1, 1, DEEP, NULL);
    assert_int_equal(front_of(&m), DEEP);
    put_tissue(&m, 6, 12, BRIGHT_CELL);
    put_tissue(&m, 6, 8, DARK_CELL);
    assert_int_equal(front_of(&m), 6);
    put_tissue(&m, 0, 5, DARK_CELL);
    assert_int_equal(front_of(&m), 6);
    put_tissue(&m, 0, 5, BRIGHT_CELL); /* without its skin */
    assert_int_equal(front_of(&m), DEEP);
}

/* ---- along the beams: a model's rays are beams, and its layers samples */

enum { WALL_END = 3, LIMB = 6, LIMB_END = 8, MIDDLE = 3, CELLS = 7 };

/* Seven by seven cells have a wall, and the middle one a limb behind fluid. Fluid follows it. */
static void make_beams(model *m) {
    make(m, CELLS, CELLS, DEEP, NULL);
    const size_t plane = (size_t)m->layout.columns * m->layout.rows;
    memset(m->blocks.relative, TISSUE, WALL_END * plane);
}

/* Gives a cell tissue, or another level, in layers from .. to - 1. */
static void set_cell(model *m, uint32_t x, uint32_t y, uint32_t from, uint32_t to, uint8_t level) {
    fill(m, m->blocks.relative + (size_t)2 * y * m->layout.columns, x, from, to, level);
}

static bool floats(const model *m, uint32_t z) {
    const size_t columns = m->layout.columns, plane = columns * m->layout.rows;
    uint8_t *const limbs = sv_wall_limbs_of(&m->layout, &m->blocks);
    assert_non_null(limbs);
    const bool found = limbs[z * plane + 2 * MIDDLE * columns + 2 * MIDDLE];
    free(limbs);
    return found;
}

/* A wall as deep as the limb, so many cells away from it, that tissue connects with it. */
static void connect(model *m, int right, int down) {
    for (int i = 1; i <= 2; i++)
        set_cell(m, (uint32_t)(MIDDLE + i * right), (uint32_t)(MIDDLE + i * down), i == 2 ? 0 : LIMB,
                 LIMB_END, TISSUE);
}

static void a_limb_floats_that_one_side_reaches(void **state) {
    static const int sides[4][2] = {{-1, 0}, {1, 0}, {0, -1}, {0, 1}};
    for (int first = 0; first < 4; first++)
        for (int second = first; second < 4; second++) {
            model m;
            make_beams(&m);
            set_cell(&m, MIDDLE, MIDDLE, LIMB, LIMB_END, TISSUE);
            assert_true(floats(&m, LIMB) && floats(&m, LIMB_END - 1));
            assert_false(floats(&m, LIMB - 1) || floats(&m, LIMB_END) || floats(&m, WALL_END - 1));
            connect(&m, sides[first][0], sides[first][1]);
            connect(&m, sides[second][0], sides[second][1]);
            assert_int_equal(floats(&m, LIMB), first == second);
        }
}

/* What was not scanned may be tissue: it reaches as the wall does. */
static void the_side_of_the_scan_reaches(void **state) {
    model m;
    make_beams(&m);
    set_cell(&m, MIDDLE, MIDDLE, LIMB, LIMB_END, TISSUE);
    for (uint32_t x = 0; x < MIDDLE; x++) set_cell(&m, x, MIDDLE, LIMB, LIMB_END, TISSUE);
    assert_true(floats(&m, LIMB));
    for (uint32_t i = 0; i < 4; i++) {
        const size_t beam = (2 * MIDDLE + i / 2) * m.layout.columns + 2 * MIDDLE + 2 + i % 2;
        m.blocks.end[beam] = LIMB;
    }
    assert_false(floats(&m, LIMB));
}

/* The fluid before it must be dark once: dim fluid is in walls, too. Any fluid may follow it. */
static void a_limb_has_fluid_on_both_sides(void **state) {
    model m;
    make_beams(&m);
    const uint8_t dim = (uint8_t)(m.layout.dim + 1);
    set_cell(&m, MIDDLE, MIDDLE, WALL_END, DEEP, dim);
    set_cell(&m, MIDDLE, MIDDLE, LIMB, LIMB_END, TISSUE);
    assert_false(floats(&m, LIMB));
    set_cell(&m, MIDDLE, MIDDLE, WALL_END, WALL_END + 1, (uint8_t)m.layout.dim);
    assert_true(floats(&m, LIMB));
    set_cell(&m, MIDDLE, MIDDLE, LIMB_END, DEEP, TISSUE);
    assert_false(floats(&m, LIMB));
    set_cell(&m, MIDDLE, MIDDLE, LIMB_END + 1, DEEP, dim);
    assert_true(floats(&m, LIMB));
}

/* 14 mm, in whole samples eight: what is thicker is no limb, and none of it floats. */
static void a_limb_is_thin_along_its_beam(void **state) {
    enum { MOST = 8 };
    model m;
    make_beams(&m);
    assert_int_equal(2 * m.layout.full_distance, MOST);
    set_cell(&m, MIDDLE, MIDDLE, LIMB, LIMB + MOST, TISSUE);
    assert_true(floats(&m, LIMB) && floats(&m, LIMB + MOST - 1));
    set_cell(&m, MIDDLE, MIDDLE, LIMB + MOST, LIMB + MOST + 1, TISSUE);
    for (uint32_t z = LIMB; z <= LIMB + MOST; z++) assert_false(floats(&m, z));
}

/* Parallel beams, 3 mm apart, from the left of a camera of 20 mm: a sample is where it is nearer than the
 * next one. The beams in the middle lie 1.5 mm to either side of that, samples are 2 mm apart. */
static void cells_near_a_limb_float(void **state) {
    const sv_wall_settings s = sv_wall_settings_default();
    const sv_wall_layout beams = sv_wall_grid_layout(&s);
    const double mm[3] = {1.0, 1.0, 1.0};
    const sv_beams left = {.rotation = {0, 0, 1, 0, 1, 0, -1, 0, 0}};
    const size_t plane = (size_t)beams.columns * beams.rows;
    model m;
    sv_wall_grid grid;
    make(&m, 10, 10, 10, NULL);
    assert_true(sv_wall_grid_of(&m.layout, &beams, mm, &left, &s, &grid));
    sv_wall_told told = {.grid = &grid, .layout = &beams, .limbs = unit_memory(plane * beams.layers)};
    told.limbs[beams.layers / 2 * plane + beams.rows / 2 * beams.columns + beams.columns / 2] = 1;
    sv_wall_mark_cells(&told, told.limbs, &m.layout, m.surroundings);
    /* the sample lies at x = 9.5, y = 9.5 + 1.5, z = 9.5 - 1.5 mm, between layers 3 and 4 */
    for (uint32_t z = 0; z < 10; z++)
        for (uint32_t y = 0; y < 10; y++)
            for (uint32_t x = 0; x < 10; x++) {
                const bool near = (x == 4 || x == 5) && (y == 5 || y == 6) && (z == 3 || z == 4);
                assert_int_equal(m.surroundings[(z * 10 + y) * 10 + x], near ? SV_WALL_FLOATS : 0);
            }
}

/* Along a beam the near field is what was skipped of what was scanned; black was not. */
static void the_near_field_is_what_beams_skip(void **state) {
    model m;
    make(&m, 1, 1, DEEP, NULL);
    fill(&m, m.blocks.levels, 0, 0, DEEP, 1);
    fill(&m, m.blocks.levels, 0, 0, 1, 0);
    m.blocks.first[0] = 3;
    uint8_t *const skipped = sv_wall_near_field_of(&m.layout, &m.blocks);
    assert_non_null(skipped);
    for (uint32_t z = 0; z < DEEP; z++) assert_int_equal(skipped[4 * (size_t)z], z == 1 || z == 2);
    free(skipped);
}

/* Where the camera of the test above begins a ray with `dark` dark layers, seen along parallel beams whose
 * samples `from` .. `to` - 1 were skipped. */
static uint32_t first_behind(uint32_t from, uint32_t to, uint32_t dark) {
    const sv_wall_settings s = sv_wall_settings_default();
    const sv_wall_layout beams = sv_wall_grid_layout(&s);
    const double mm[3] = {1.0, 1.0, 1.0};
    const sv_beams ahead = {.rotation = {1, 0, 0, 0, 1, 0, 0, 0, 1}};
    const size_t plane = (size_t)beams.columns * beams.rows;
    model m;
    sv_wall_grid grid;
    make(&m, 10, 10, 10, NULL);
    fill(&m, m.blocks.relative, 5, dark, 10, TISSUE);
    assert_true(sv_wall_grid_of(&m.layout, &beams, mm, &ahead, &s, &grid));
    sv_wall_told told = {.grid = &grid, .layout = &beams, .near_field = unit_memory(plane * beams.layers)};
    /* the camera's ten layers are the ten samples in the middle of a beam */
    for (size_t k = from; k < to; k++) memset(told.near_field + (beams.layers / 2 - 5 + k) * plane, 1, plane);
    assert_true(sv_wall_skip_told_field(&told, &m.layout, &m.blocks));
    return m.blocks.first[2 * 5];
}

/* However deep it is, a ray goes on from there; not into fluid that no beam skipped, and not through a ray
 * without tissue. */
static void a_camera_skips_what_the_beams_skip(void **state) {
    assert_int_equal(first_behind(0, 2, 2), 2);
    assert_int_equal(first_behind(0, 6, 6), 6);
    assert_int_equal(first_behind(0, 6, 1), 1);
    assert_int_equal(first_behind(0, 2, 5), 2);
    assert_int_equal(first_behind(3, 5, 5), 0);
    assert_int_equal(first_behind(0, 10, 10), 0);
    assert_int_equal(first_behind(0, 0, 2), 0);
}

/* All of a limb is judged like a later run: in the camera's first run, its skin, and where the wall encloses
 * it. */
static void what_floats_is_judged_like_a_later_run(void **state) {
    model m;
    sv_wall_evidence e = {.wall_rays = 4};
    e.later_run[BRIGHT_CELL] = SV_WALL_PROBABILITY_ONE;
    for (int limb = 0; limb < 2; limb++)
        for (int behind = 0; behind < 2; behind++) {
            sv_wall_costs costs;
            make(&m, 1, 1, DEEP, NULL);
            put_tissue(&m, behind ? 6 : 0, behind ? 8 : 2, BRIGHT_CELL);
            memset(m.surroundings, (limb ? SV_WALL_FLOATS : 0) | SV_WALL_ENCLOSED, DEEP);
            assert_true(sv_wall_costs_create(&m.scan, &e, &costs));
            assert_int_equal(costs.fetus, limb ? 4 * SV_WALL_PROBABILITY_ONE : 0);
            sv_wall_costs_destroy(&costs);
        }
}

UNIT_MAIN(NULL, NULL, a_valley_parts_a_limb_from_the_wall, a_valley_is_as_wide_as_a_block, a_limb_is_thin,
          skin_and_tissue_without_fluid_are_not_parted, the_fetus_begins_where_its_run_does,
          a_limb_floats_that_one_side_reaches, the_side_of_the_scan_reaches, a_limb_has_fluid_on_both_sides,
          a_limb_is_thin_along_its_beam, cells_near_a_limb_float, the_near_field_is_what_beams_skip,
          a_camera_skips_what_the_beams_skip, what_floats_is_judged_like_a_later_run)
