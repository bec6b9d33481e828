/* SPDX-License-Identifier: MIT */
/*
 * Where a thin limb lies near the wall: the fetus begins where its run does. By hand from the numbers of
 * docs/surface.md.
 */
#include "support/wall_model.h"

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

UNIT_MAIN(NULL, NULL, the_fetus_begins_where_its_run_does)
