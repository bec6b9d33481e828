/* SPDX-License-Identifier: MIT */
/* The evaluation's table of termination depths and its measures, against numbers by hand. */
#include "eval/eval_case.h"
#include "support/loop_fixture.h"
#include "support/near.h"

#include <math.h>

/* The layers of loop_fixture.h; in the ground truth the occluder is fluid, so a ray ends at step FETUS. */
typedef struct {
    fixture *f;
    hs_volume truth;
    hs_loop *loop;
    uint8_t label[N * N];
    hs_eval_table table;
} rig;

/* Columns 0 .. 15 of the source are outside, 16 .. 31 sac, 32 .. 47 fetus: 5, 5 and 6 columns of the map,
 * since its column x looks at source column 3 x + 1: 1, 4, 7, 10, 13 | 16, 19, 22, 25, 28, 31 | 34 .. 46. */
enum { OUTSIDE_COLUMNS = 5, SAC_COLUMNS = 6, FETUS_COLUMNS = 5 };

static rig open_rig(fixture *f) {
    rig r = {.f = f, .truth = make_layers(false)};
    for (size_t i = 0; i < hs_volume_count(&r.truth); i++)
        if (i / (N * N) < FLUID) r.truth.voxels[i] = 10;
    for (int i = 0; i < N * N; i++)
        r.label[i] = i % N < 16 ? HS_LABEL_NEITHER : i % N < 32 ? HS_LABEL_SAC : HS_LABEL_FETUS;
    hs_loop_options options = options_with(NULL, 0);
    options.dvr.width = options.dvr.height = LOW;
    r.loop = make_loop(f, &options);
    must(hs_eval_table_build(&r.table, r.loop, &f->layers, &r.truth, r.label, &err));
    return r;
}

static void close_rig(rig *r) {
    hs_eval_table_free(&r->table);
}

/* Where a ray that starts at `step` ends. */
static int end_of(int step) {
    if (step < FLUID) return step > OCCLUDER ? step : OCCLUDER;
    return step > FETUS ? step : FETUS;
}

static void table_holds_every_start(void **state) {
    rig r = open_rig(*state);
    assert_int_equal(r.table.steps, N);
    assert_int_equal(r.table.count, LOW * (SAC_COLUMNS + FETUS_COLUMNS));
    assert_int_equal(r.table.first_fetus, LOW * SAC_COLUMNS);
    assert_int_equal(r.table.occluded, r.table.count); /* 30 - 4 = 26 steps of occluder everywhere */
    for (uint32_t ray = 0; ray < r.table.count; ray++)
        for (int step = 0; step <= N; step++)
            assert_int_equal(r.table.error[ray * (N + 1) + (uint32_t)step], FETUS - end_of(step));
    close_rig(&r);
}

static uint32_t start_step(const hs_eval_table *t, float depth) {
    return hs_eval_start_step(depth, t->steps_per_slice, t->steps);
}

/* The renderer's rule: step 3 (d + 0.5) - 0.5, rounded up; nothing is clipped by 0, less, or no number. */
static void starts_follow_the_renderer(void **state) {
    rig r = open_rig(*state);
    assert_int_equal(start_step(&r.table, 10.0f), 31);
    assert_int_equal(start_step(&r.table, 10.1f), 32);
    assert_int_equal(start_step(&r.table, 10.0001f), 31); /* 0.0003 steps: within the hard cut's margin */
    assert_int_equal(start_step(&r.table, 1e-6f), 1);
    assert_int_equal(start_step(&r.table, 0.0f), 0);
    assert_int_equal(start_step(&r.table, -3.0f), 0);
    assert_int_equal(start_step(&r.table, NAN), 0);
    assert_int_equal(start_step(&r.table, INFINITY), 0);
    assert_int_equal(start_step(&r.table, 1e9f), N);
    close_rig(&r);
}

#define near_to(found, expected) assert_near((double)(found), expected, 1e-5)

/* Sac: rows 0 .. 3 unclipped (e = 26), the rest right (e = 0). Fetus: row 0 cut at depth 12, step 37 (e =
 * -7), row 1 at depth 10, step 31 (e = -1, within the tolerance), the rest right. Outside: as the sac, but
 * row 4 like the fetus' row 0. */
static void fill_map(float *map) {
    for (int i = 0; i < LOW * LOW; i++) {
        const int x = i % LOW, y = i / LOW;
        const bool fetus = x >= OUTSIDE_COLUMNS + SAC_COLUMNS;
        const bool cut = x < OUTSIDE_COLUMNS && y == 4;
        map[i] = cut ? 12.0f : fetus ? (y == 0 ? 12.0f : y == 1 ? 10.0f : 6.0f) : (y < 4 ? 0.0f : 6.0f);
    }
}

static void check_measures(const hs_measures *m) {
    const double sac = LOW * SAC_COLUMNS, fetus = LOW * FETUS_COLUMNS;
    const double left = 4 * SAC_COLUMNS, cut = FETUS_COLUMNS;
    near_to(m->of[HS_MEASURE_ABS], (left * 26 + cut * 7 + cut * 1) / (sac + fetus));
    near_to(m->of[HS_MEASURE_POS], 26); /* over the positive rays only */
    near_to(m->of[HS_MEASURE_NEG], 4);  /* (7 + 1) / 2, as an absolute value */
    near_to(m->of[HS_MEASURE_ABS_SAC], left * 26 / sac);
    near_to(m->of[HS_MEASURE_POS_SAC], 26);
    near_to(m->of[HS_MEASURE_NEG_SAC], 0);
    near_to(m->of[HS_MEASURE_ABS_FETUS], (cut * 7 + cut * 1) / fetus);
    near_to(m->of[HS_MEASURE_POS_FETUS], 0);
    near_to(m->of[HS_MEASURE_NEG_FETUS], 4);
    near_to(m->of[HS_MEASURE_FETUS_CUT], cut / fetus);
    near_to(m->of[HS_MEASURE_OCCLUDER_LEFT], left / (sac + fetus));
    near_to(m->of[HS_MEASURE_ABS_OUTSIDE], (4 * 26 + 7) / (double)LOW);
}

static void measures_are_those_by_hand(void **state) {
    rig r = open_rig(*state);
    float map[LOW * LOW], termination[LOW * LOW], error[LOW * LOW];
    hs_measures m;
    fill_map(map);
    hs_eval_measure_map(&r.table, map, &m);
    check_measures(&m);
    /* A picture of termination depths gives the same measures. */
    memcpy(termination, r.table.truth, sizeof termination);
    for (uint32_t ray = 0; ray < r.table.all; ray++) {
        const uint32_t i = r.table.pixel[ray];
        termination[i] -= (float)r.table.error[ray * (N + 1) + start_step(&r.table, map[i])];
    }
    hs_eval_measure_picture(&r.table, termination, &m);
    check_measures(&m);
    hs_eval_error_picture(&r.table, termination, error);
    assert_true(isnan(error[0]));
    near_to(error[OUTSIDE_COLUMNS], 26);
    near_to(error[OUTSIDE_COLUMNS + SAC_COLUMNS], -7);
    /* No map: everything is left. */
    hs_eval_measure_map(&r.table, NULL, &m);
    near_to(m.of[HS_MEASURE_ABS], 26);
    near_to(m.of[HS_MEASURE_OCCLUDER_LEFT], 1);
    near_to(m.of[HS_MEASURE_FETUS_CUT], 0);
    close_rig(&r);
}

/* Without a fetus its measures are no numbers, and the others are not spoilt. */
static void missing_label_is_no_number(void **state) {
    fixture *f = *state;
    rig r = open_rig(f);
    hs_measures m;
    memset(r.label, HS_LABEL_SAC, sizeof r.label);
    hs_eval_table_free(&r.table);
    must(hs_eval_table_build(&r.table, r.loop, &f->layers, &r.truth, r.label, &err));
    hs_eval_measure_map(&r.table, NULL, &m);
    assert_true(isnan(m.of[HS_MEASURE_ABS_FETUS]));
    assert_true(isnan(m.of[HS_MEASURE_FETUS_CUT]));
    near_to(m.of[HS_MEASURE_ABS], 26);
    /* With no label at all there is nothing to evaluate. */
    memset(r.label, HS_LABEL_NEITHER, sizeof r.label);
    hs_eval_table_free(&r.table);
    must_not(hs_eval_table_build(&r.table, r.loop, &f->layers, &r.truth, r.label, &err), HS_ERR_INPUT, "");
    assert_null(r.table.label);
    close_rig(&r);
}

/* A picture that is not as large as the map would be interpolated: refused. */
static void other_pictures_are_refused(void **state) {
    fixture *f = *state;
    rig r = open_rig(f);
    hs_eval_table table;
    const hs_loop_options options = options_with(NULL, 0);
    r.loop = make_loop(f, &options);
    must_not(hs_eval_table_build(&table, r.loop, &f->layers, &r.truth, r.label, &err), HS_ERR_USAGE,
             "64 x 64");
    assert_null(table.error);
    close_rig(&r);
}

UNIT_MAIN(set_up, tear_down, table_holds_every_start, starts_follow_the_renderer, measures_are_those_by_hand,
          missing_label_is_no_number, other_pictures_are_refused)
