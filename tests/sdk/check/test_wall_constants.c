/* SPDX-License-Identifier: MIT */
/*
 * Constants of the surface told by the wall (docs/surface.md), step by step: each step gets a few blocks, and
 * its answer is worked out by hand from the numbers of the docs. Voxels are 1 mm wide, so a cell is 2 mm, a
 * ray 1 mm, and a layer 2 mm.
 */
#include "support/near.h"
#include "support/wall_model.h"

#include <math.h>

/* ------------------------------------------------------------------------------------------- blocks -- */

static sv_wall_layout layout_at(uint32_t side, double mm) {
    const sv_wall_settings s = sv_wall_settings_default();
    return sv_wall_layout_of(side, side, side, (double[]){mm, mm, mm}, &s);
}

/* Four voxels of 0.535 mm are 2.14 mm, seven hundredths too many: 40 of them are ten cells. Of 0.54 mm they
 * are more than that, and 21.6 mm are eleven cells. 41 voxels leave one over, and 20.5 mm are ten cells. Two
 * slices of 1.25 mm are the deepest layer. Unknown spacing: 120 mm have 60 cells. */
static void blocks_are_of_about_two_millimetres(void **state) {
    assert_int_equal(layout_at(40, 0.535).cells[0], 10);
    assert_int_equal(layout_at(40, 0.54).cells[0], 11);
    assert_int_equal(layout_at(41, 0.5).cells[0], 10);
    assert_int_equal(layout_at(40, 1.25).depth, 2);
    assert_int_equal(layout_at(40, 1.26).depth, 1);
    assert_int_equal(layout_at(240, 0.0).cells[0], 60);
}

/* ------------------------------------------------------------------------------------------- levels -- */

/* A twentieth of all is darker than the dark level: 40 of 1000 blocks and half of the next 20, which are
 * spread evenly over 9.5 .. 10.5. */
static void a_twentieth_is_darker(void **state) {
    uint64_t histogram[256] = {[2] = 40, [10] = 20, [12] = 340, [100] = 600};
    model m;
    make(&m, 1, 1, 4, NULL);
    const sv_wall_levels levels = sv_wall_levels_of(&m.layout, histogram);
    assert_true(levels.two);
    assert_int_equal(levels.dark, 10 * SV_WALL_LEVEL_ONE);
}

/* The middle cell sees the 264 blocks within 10 mm, five cells, to either side, whose level is 64; the cells
 * behind them are brighter. A twentieth of the window's 4 * 11^3
 * blocks are 266, and they count as 144: E = (264 * 64 + 266 * 144) / 530 = 104.15. With dark fluid of 16 the
 * root of T is 0.35 * 4 + 0.65 * 10.205 = 8.033, and 128 * 64 / 8.033^2 = 126.9. */
static void all_that_is_bright_weighs_a_twentieth(void **state) {
    enum { CELLS = 13, LAYERS = 6, MIDDLE = 2 * (CELLS / 2) };
    const sv_wall_levels known = {
        .two = true, .threshold = 40, .bright = 144 * SV_WALL_LEVEL_ONE, .dark = 16 * SV_WALL_LEVEL_ONE};
    model m;
    make(&m, CELLS, 1, LAYERS, NULL);
    for (uint32_t x = 0; x < CELLS; x++)
        fill(&m, m.blocks.levels, x, 0, LAYERS, x == 0 || x == CELLS - 1 ? 250 : 64);
    assert_true(sv_wall_relate_levels(&m.layout, &known, &m.blocks));
    assert_near(m.blocks.relative[MIDDLE], 126.9, 1.5);
}

/* 0.4 of the threshold is 51.2 of 128. */
static void a_front_is_dim_from_two_fifths_on(void **state) {
    model m;
    make(&m, 2, 1, 3, NULL);
    fill(&m, m.blocks.relative, 0, 0, 3, 51);
    fill(&m, m.blocks.relative, 1, 0, 3, 52);
    sv_wall_fill_dim_fronts(&m.layout, &m.blocks);
    assert_int_equal(m.blocks.relative[0], 51);
    assert_int_equal(m.blocks.relative[2], SV_WALL_DIM_TISSUE);
}

/* ----------------------------------------------------------------------------------------- the wall -- */

/* 3.75 mm are 1.9 cells: two cells aside it is as bright, three cells aside it is not. */
static void brightness_reaches_two_cells(void **state) {
    model m;
    make(&m, 9, 1, 4, NULL);
    fill(&m, m.blocks.means, 4, 0, 4, 90);
    uint8_t *const map = sv_wall_brightness_map(&m.layout, &m.blocks);
    assert_non_null(map);
    assert_true(map[1] == 0 && map[2] == 90 && map[6] == 90 && map[7] == 0);
    free(map);
}

static double odds(double level) {
    return log(level / (255.5 - level));
}

static double logistic(double x) {
    return 1.0 / (1.0 + exp(-x));
}

static double as_p(uint32_t fixed) {
    return (double)fixed / SV_WALL_PROBABILITY_ONE;
}

/* Ten cells of wall. The first decile is the upper end of 30, the median that of the fifth, the last decile
 * that of the ninth. */
static void the_wall_is_the_median_and_its_spread_that_of_the_deciles(void **state) {
    static const uint8_t walls[] = {30, 60, 60, 60, 80, 82, 84, 86, 120, 180};
    enum { CELLS = 10, LAYERS = 8 };
    sv_wall_evidence e;
    model m;
    make(&m, CELLS, 1, LAYERS, NULL);
    for (uint32_t x = 0; x < CELLS; x++) {
        fill(&m, m.blocks.relative, x, 0, 5, TISSUE);
        for (uint32_t z = 0; z < LAYERS; z++) m.brightness[z * CELLS + x] = walls[x];
    }
    sv_wall_evidence_of(&m.scan, &(sv_wall_levels){.two = true}, &e);
    const double spread = odds(120.5) - odds(30.5); /* 1.885 */
    assert_false(e.bare);
    assert_near((double)e.wall / SV_WALL_LEVEL_ONE, 80.5, 0.01);
    assert_near(ldexp(e.spread, -SV_WALL_ODDS_BITS), spread, 0.01);
    const double later = (odds(150) - odds(80.5)) / spread, first = (odds(220) - odds(80.5)) / spread;
    assert_near(as_p(e.later_run[150]), logistic(6.0 * (later - 0.4)), 0.01);  /* 0.77 */
    assert_near(as_p(e.first_run[220]), logistic(6.0 * (first - 1.35)), 0.01); /* 0.55 */
}

/* Of 100 cells, so many begin with a wall; behind the first run comes fluid. */
static sv_wall_evidence evidence_of_walls(uint32_t walls) {
    enum { CELLS = 100, LAYERS = 8 };
    const sv_wall_levels levels = {.two = true, .bright = 100 * SV_WALL_LEVEL_ONE};
    sv_wall_evidence e;
    model m;
    make(&m, CELLS, 1, LAYERS, NULL);
    memset(m.brightness, 90, CELLS * LAYERS);
    for (uint32_t x = 0; x < walls; x++) fill(&m, m.blocks.relative, x, 0, 5, TISSUE);
    sv_wall_evidence_of(&m.scan, &levels, &e);
    return e;
}

/* Below a tenth of the rays there is no wall. It counts as 0.6 of the bright mean then, with a spread of 0.5.
 */
static void a_wall_on_few_rays_is_assumed(void **state) {
    const sv_wall_evidence few = evidence_of_walls(9), many = evidence_of_walls(10);
    assert_true(few.bare && !many.bare);
    assert_int_equal(few.wall, 60 * SV_WALL_LEVEL_ONE);
    assert_near(ldexp(few.spread, -SV_WALL_ODDS_BITS), 0.5, 0.001);
}

/* The flags of a cell of first runs between two cells of tissue behind fluid: that shows the fetus with
 * probability p, and on the left it is on so many of the four rays. */
static uint8_t flags_beside(uint32_t p, size_t rays) {
    enum { LAYERS = 3, COLUMNS = 6, PLANE = 2 * COLUMNS, MIDDLE = 3 + 1 };
    sv_wall_evidence e = {.wall_rays = 4};
    model m;
    make(&m, 3, 1, LAYERS, NULL);
    e.later_run[0] = p;
    fill(&m, m.blocks.relative, 1, 0, 2, TISSUE);
    fill(&m, m.blocks.relative, 2, 1, 2, TISSUE);
    for (size_t i = 0; i < rays; i++) m.blocks.relative[PLANE + i / 2 * COLUMNS + i % 2] = TISSUE;
    uint8_t *const map = sv_wall_surroundings_map(&m.scan, &e);
    assert_non_null(map);
    const uint8_t flags = map[MIDDLE] & (SV_WALL_FLANKED | SV_WALL_ONE_SIDE);
    free(map);
    return flags;
}

/* A cell shows the fetus from a probability of one half on, and counts by three of its rays. */
static void three_rays_and_one_half_make_the_fetus(void **state) {
    const uint32_t half = SV_WALL_PROBABILITY_ONE / 2;
    assert_int_equal(flags_beside(half, 3), SV_WALL_FLANKED);
    assert_int_equal(flags_beside(half, 2), SV_WALL_ONE_SIDE);
    assert_int_equal(flags_beside(half - 1, 3), 0);
}

/* ------------------------------------------------------------------------------------------ the costs -- */

/* What layers cost in a cell where bright tissue of a later run is the fetus, and none of a first run is. */
static void costs_of(const model *m, double cost[DEEP]) {
    sv_wall_evidence e = {.wall_rays = 4};
    sv_wall_costs costs;
    e.later_run[BRIGHT_CELL] = SV_WALL_PROBABILITY_ONE;
    assert_true(sv_wall_costs_create(&m->scan, &e, &costs));
    for (uint32_t z = 0; z < DEEP; z++) cost[z] = (double)costs.all[z] / SV_WALL_COST_ONE;
    sv_wall_costs_destroy(&costs);
}

#define COST_STEP (1.0 / SV_WALL_COST_ONE)

/* Wall in layers 0 .. 4, fluid of `level` up to 9, then the fetus: what the layers cost. */
static void costs_behind_wall(uint8_t level, double cost[DEEP]) {
    model m;
    make(&m, 1, 1, DEEP, NULL);
    put_tissue(&m, 0, 5, DARK_CELL);
    fill(&m, m.blocks.relative, 0, 5, 10, level);
    put_tissue(&m, 10, DEEP, BRIGHT_CELL);
    costs_of(&m, cost);
}

/* A layer of distance to the fluid costs 2 mm / 7 mm, four cost 1. To leave the wall costs nothing, to cut
 * the fetus 15, to stay before its fluid 8. */
static void what_errors_cost(void **state) {
    double cost[DEEP];
    costs_behind_wall(0, cost);
    assert_near(cost[0], 8.0 + 1.0, COST_STEP);
    assert_near(cost[2], 8.0 + 6.0 / 7.0, COST_STEP);
    assert_near(cost[4], 8.0 + 2.0 / 7.0, COST_STEP);
    for (uint32_t z = 5; z < 10; z++) assert_near(cost[z], 0.0, 0.0);
    assert_near(cost[10], 15.0 + 2.0 / 7.0, COST_STEP);
    assert_near(cost[15], 15.0 + 1.0, COST_STEP);
}

/* Wall in layers 0 .. 2, dark fluid up to 5, a thin run that is no fetus in 6 and 7, two layers of `level`,
 * then the fetus. Returns what the first of the two costs. */
static double cost_between(uint8_t level) {
    double cost[DEEP];
    model m;
    make(&m, 1, 1, DEEP, NULL);
    put_tissue(&m, 0, 3, DARK_CELL);
    put_tissue(&m, 6, 8, DARK_CELL);
    fill(&m, m.blocks.relative, 0, 8, 10, level);
    put_tissue(&m, 10, DEEP, BRIGHT_CELL);
    costs_of(&m, cost);
    assert_near(cost[4], 8.0, COST_STEP); /* the thin run is left, if it is one */
    return cost[8];
}

/* Fluid is certain up to 0.4 T, level 51, and none at T, level 128. Half way it is certain to a quarter. */
static void what_is_dim_is_no_certain_fluid(void **state) {
    assert_near(cost_between(0), 0.0, 0.0);
    assert_near(cost_between(51), 0.0, 0.0);
    assert_near(cost_between(90), 8.0 * (1.0 - pow(38.0 / 77.0, 2.0)), COST_STEP);
    assert_near(cost_between(128), 8.0, COST_STEP);
}

/* But it is where it ends a first run. */
static void the_first_fluid_is_certain(void **state) {
    double cost[DEEP];
    costs_behind_wall(120, cost);
    for (uint32_t z = 5; z < 10; z++) assert_near(cost[z], 0.0, 0.0);
}

/* A first run of seven layers, of which three are skin. If the fetus lies on one side of it, it moves from
 * p = 0 as wall by 0.3 to p = 1 as a later run; if on both, all the way. The fluid behind it pays for that.
 */
static void one_side_weighs_three_tenths(void **state) {
    double cost[DEEP];
    model m;
    make(&m, 1, 1, DEEP, NULL);
    put_tissue(&m, 0, 7, BRIGHT_CELL);
    costs_of(&m, cost);
    assert_near(cost[7], 0.0, 0.0);
    memset(m.surroundings, SV_WALL_ONE_SIDE, DEEP);
    costs_of(&m, cost);
    assert_near(cost[7], 0.3 * 15.0, COST_STEP);
    memset(m.surroundings, SV_WALL_FLANKED, DEEP);
    costs_of(&m, cost);
    assert_near(cost[7], 15.0, COST_STEP);
}

enum { ACROSS = 32, PIXELS = 4 * ACROSS };

typedef struct {
    uint32_t cost[ACROSS][DEEP]; /* in units of 1 / SV_WALL_COST_ONE */
    uint16_t front;              /* where the fetus begins, of every ray; 0: nowhere */
    float depth[PIXELS], confidence[PIXELS];
} row_of_cells;

static void select_surface(row_of_cells *r, const sv_wall_settings *settings) {
    sv_wall_gaps gaps;
    sv_wall_outcome outcome;
    uint16_t fronts[PIXELS], shown[PIXELS];
    model m;
    make(&m, ACROSS, 1, DEEP, settings);
    for (uint32_t i = 0; i < PIXELS; i++) {
        fronts[i] = r->front ? r->front : DEEP;
        shown[i] = r->front ? SV_WALL_LIKELY : 0;
    }
    const sv_wall_costs costs = {.all = &r->cost[0][0], .fronts = fronts, .shown = shown};
    assert_true(sv_wall_select_surface(&m.scan, &(sv_wall_levels){.two = true}, &costs, NULL, r->depth,
                                       r->confidence, &gaps, &outcome));
}

/* Layer 5 costs nothing, the two behind it a quarter, all others 2. Below 0.5 they weigh 2 : 1 : 1, so the
 * surface is layer 5.75, of two slices. Costs cross half of that an eighth before layer 5, and at layer 6. */
static void layers_are_averaged_and_the_knob_moves_over_some(void **state) {
    row_of_cells r = {0};
    for (uint32_t i = 0; i < ACROSS * DEEP; i++) {
        const uint32_t z = i % DEEP;
        r.cost[i / DEEP][z] = z == 5 ? 0 : z == 6 || z == 7 ? SV_WALL_COST_ONE / 4 : 2 * SV_WALL_COST_ONE;
    }
    select_surface(&r, NULL);
    for (uint32_t i = 0; i < PIXELS; i++) assert_near((double)r.depth[i], 11.5, 1e-4);
    sv_wall_settings s = sv_wall_settings_default();
    s.q = 0.0;
    select_surface(&r, &s);
    assert_near((double)r.depth[0], 12.0, 1e-4);
    s.q = 1.0;
    select_surface(&r, &s);
    assert_near((double)r.depth[0], 9.75, 1e-4);
}

/* The depth of a surface that lies in layer 9, on a ray whose fetus begins in layer `front`. */
static double depth_before(uint16_t front) {
    row_of_cells r = {.front = front};
    for (uint32_t i = 0; i < ACROSS * DEEP; i++)
        r.cost[i / DEEP][i % DEEP] = i % DEEP == 9 ? 0 : 2 * SV_WALL_COST_ONE;
    select_surface(&r, NULL);
    return (double)r.depth[0];
}

/* 7 mm are four layers. From twice that behind the front of the fetus the surface goes back to it. */
static void the_surface_goes_back_to_the_fetus(void **state) {
    assert_near(depth_before(DEEP), 18.0, 1e-4);
    assert_near(depth_before(10), 18.0, 1e-4);
    assert_near(depth_before(7), 14.0, 1e-4);
    assert_near(depth_before(1), 2.0, 1e-4);
}

/* 2.9 mm are 1.45 cells. The weights of the Gaussian, in 64ths, are 18, 14, 7, 2. One cell costs 16. Its rays
 * lie a quarter of the way to the next cell: they pay 16 (3 * 18 + 14) / 4 / 64 = 4.25, those beside them
 * 16 (3 * 14 + 18) / 4 / 64 = 3.75. */
static void the_gaussian_smooths_costs(void **state) {
    enum { CELL = ACROSS / 2 };
    row_of_cells r = {.cost = {{0}}};
    for (uint32_t z = 0; z < DEEP; z++) r.cost[CELL][z] = 16 * SV_WALL_COST_ONE;
    select_surface(&r, NULL);
    const double own = 1.0 / (1.0 + 4.25 * 4.25 / 5.5 / 5.5), beside = 1.0 / (1.0 + 3.75 * 3.75 / 5.5 / 5.5);
    assert_near((double)r.confidence[2 * CELL], own, 1e-4);
    assert_near((double)r.confidence[2 * CELL + 1], own, 1e-4);
    assert_near((double)r.confidence[2 * CELL + 2], beside, 1e-4);
    assert_near((double)r.confidence[2 * CELL - 1], beside, 1e-4);
}

/* Counts the columns of a stripe of so many cells, at layer 9 among cells at layer 3, that stay there. */
static uint32_t columns_that_stay(uint32_t cells) {
    enum { FROM = 13, NEAR = 3, FAR = 9 };
    sv_wall_settings s = sv_wall_settings_default();
    row_of_cells r = {0};
    uint32_t columns = 0;
    for (uint32_t i = 0; i < ACROSS * DEEP; i++) {
        const uint32_t x = i / DEEP, at = x >= FROM && x < FROM + cells ? FAR : NEAR;
        r.cost[x][i % DEEP] = i % DEEP == at ? 0 : 16 * SV_WALL_COST_ONE;
    }
    s.opening_mm = 0.0;
    select_surface(&r, &s);
    for (uint32_t x = 0; x < 2 * ACROSS; x++) columns += fabsf(r.depth[x] - 2.0f * FAR) < 1e-3f;
    return columns;
}

/* Twice 2.9 mm are six rays. A column stays if the one six to its left or to its right lies in the stripe,
 * too: all twelve of six cells, but of the ten of five cells not the middle two. */
static void the_median_looks_six_rays_aside(void **state) {
    assert_int_equal(columns_that_stay(6), 12);
    assert_int_equal(columns_that_stay(5), 8);
}

/* Returns the depth in the middle of a pit of so many cells, from layer 2 to 10. */
static double bottom_of_pit(uint32_t cells, const sv_wall_settings *s) {
    enum { FROM = 8 };
    row_of_cells r = {0};
    for (uint32_t i = 0; i < ACROSS * DEEP; i++) {
        const uint32_t cell = i / DEEP, cheapest = cell >= FROM && cell < FROM + cells ? 10 : 2;
        r.cost[cell][i % DEEP] = i % DEEP == cheapest ? 0 : 2 * SV_WALL_COST_ONE;
    }
    select_surface(&r, s);
    assert_near((double)r.depth[0], 4.0, 1e-4);
    return (double)r.depth[2 * FROM + cells];
}

/* Twelve cells are 24 mm wide, and thirteen are wider than an opening of 24 mm, which ends the pit of a
 * surface that is doubtful, as here where no dark block lies in a gap. If that is enough to be sure, it is
 * opened over 6 mm. */
static void a_surface_has_no_narrow_pits(void **state) {
    sv_wall_settings s = sv_wall_settings_default();
    s.sigma_mm = 0.1;
    s.seen_share = 0.0;                             /* no fetus is asked for */
    assert_near(bottom_of_pit(13, &s), 20.0, 1e-4); /* there is no fluid */
    s.doubtful_share = 0.0;
    assert_near(bottom_of_pit(12, &s), 4.0, 1e-4);
    assert_near(bottom_of_pit(13, &s), 20.0, 1e-4);
    s.gap_share = 0.0;
    assert_near(bottom_of_pit(3, &s), 4.0, 1e-4);
    assert_near(bottom_of_pit(4, &s), 20.0, 1e-4);
}

UNIT_MAIN(NULL, NULL, blocks_are_of_about_two_millimetres, a_twentieth_is_darker,
          all_that_is_bright_weighs_a_twentieth, a_front_is_dim_from_two_fifths_on,
          brightness_reaches_two_cells, the_wall_is_the_median_and_its_spread_that_of_the_deciles,
          a_wall_on_few_rays_is_assumed, three_rays_and_one_half_make_the_fetus, what_errors_cost,
          what_is_dim_is_no_certain_fluid, the_first_fluid_is_certain, one_side_weighs_three_tenths,
          layers_are_averaged_and_the_knob_moves_over_some, the_surface_goes_back_to_the_fetus,
          the_gaussian_smooths_costs, the_median_looks_six_rays_aside, a_surface_has_no_narrow_pits)
