/* SPDX-License-Identifier: MIT */
/*
 * Where a thin limb lies against the wall or near it: valleys part first runs, and the fetus begins where its
 * run does. By hand from the numbers of docs/surface.md.
 */
#include "support/wall_model.h"

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

UNIT_MAIN(NULL, NULL, a_valley_parts_a_limb_from_the_wall, a_valley_is_as_wide_as_a_block, a_limb_is_thin,
          skin_and_tissue_without_fluid_are_not_parted, the_fetus_begins_where_its_run_does)
