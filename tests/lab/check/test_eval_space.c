/* SPDX-License-Identifier: MIT */
/* The parameter space: the quick way against the direct one, and the best settings. */
#include "eval/eval_study.h"
#include "support/host_fixture.h"

#include <math.h>

enum { SIZE = 64 };
static const hs_eval_request request = {.name = "M01", .size = SIZE};

/* The real plugin on a small scene. */
typedef struct {
    hs_cl cl;
    hs_plugin plugin;
    hs_eval_plan plan;
    hs_eval_case c;
} rig;

static int open_rig(void **state) {
    static rig r;
    hs_error err = {0};
    const char *build = getenv("SV_BUILD_DIR");
    const char *const path = unit_text("%s/smartvis.so", build ? build : ".");
    if (!hs_cl_open(&r.cl, &err) || !hs_plugin_open(&r.plugin, path, NULL, SV_LOG_ERROR, &err) ||
        !hs_eval_plan_make(&r.plan, &r.plugin, NULL, 0, true, &err) ||
        !hs_eval_case_open(&r.c, &r.cl, &r.plugin, &r.plan.base, &request, &err)) {
        print_error("%s\n", err.text);
        return -1;
    }
    *state = &r;
    return 0;
}

static int close_rig(void **state) {
    rig *r = *state;
    hs_eval_case_close(&r->c);
    hs_plugin_close(&r->plugin);
    hs_cl_close(&r->cl);
    return 0;
}

static hs_eval_space make_space(rig *r) {
    hs_eval_space space;
    must(hs_eval_space_open(&space, &r->plan, &r->c, &err));
    return space;
}

/* Table 5.1 as it stands, and a fifth of it. */
static void axes_are_those_of_the_thesis(void **state) {
    rig *r = *state;
    hs_eval_plan plan;
    must(hs_eval_plan_make(&plan, &r->plugin, NULL, 0, false, &err));
    assert_int_equal(plan.threshold.count, 51);
    assert_int_equal(plan.kernel.count, 16);
    assert_int_equal(plan.knob.count, 31);
    assert_true(plan.threshold.value[7] == 0.57 && plan.threshold.value[50] == 1.0);
    assert_true(plan.kernel.value[0] == 3 && plan.kernel.value[15] == 63);
    assert_true(plan.knob.value[3] == 0.15 && plan.knob.value[30] == 1.5);
    assert_int_equal(hs_eval_plan_items(&r->plan), 11 * 4);
}

/* Every quick result is what the renderer and Eq. 4.5 - 4.10 give: 60 settings to 0.001 steps. And the
 * comparison can fail: another position of the knob gives other errors. */
static void quick_way_is_the_direct_one(void **state) {
    rig *r = *state;
    test_random random = {77};
    double elsewhere = 0;
    hs_eval_space space = make_space(r);
    must(hs_eval_space_run(&space, &r->c, NULL, &err));
    for (int n = 0; n < 60; n++) {
        const uint32_t item = unit_random(&random.state) % space.items,
                       q = unit_random(&random.state) % r->plan.knob.count;
        const hs_measures *quick = &space.at[item * r->plan.knob.count + q];
        hs_eval_values values;
        hs_measures direct;
        sv_status outcome;
        must(hs_eval_plan_values(&r->plan, item, &values, &err));
        must(hs_eval_values_add(&values, r->plan.knob.info.id, r->plan.knob.value[q], &err));
        must(hs_eval_case_direct(&r->c, &values, &direct, &outcome, &err));
        assert_int_equal(outcome, space.outcome[item]);
        for (int m = 0; m < HS_MEASURE_COUNT; m++)
            if (fabs((double)(quick->of[m] - direct.of[m])) > 1e-3)
                fail_msg("item %u, knob %u, %s: %g, the direct way gives %g", item, q,
                         hs_measure_key((hs_measure)m), (double)quick->of[m], (double)direct.of[m]);
        const hs_measures *other = &space.at[item * r->plan.knob.count + (q + 3) % r->plan.knob.count];
        elsewhere = fmax(elsewhere, fabs((double)(other->of[0] - direct.of[0])));
    }
    assert_true(elsewhere > 0.1);
    hs_eval_space_close(&space);
}

/* Two cases whose maxima differ by three steps of 0.05: their best common setting is found by Delta_MI. */
static void common_setting_is_found_by_delta(void **state) {
    rig *r = *state;
    hs_eval_space spaces[2] = {make_space(r), make_space(r)};
    hs_eval_mean mean;
    uint32_t t;
    spaces[0].volume_max = 0.8;
    spaces[1].volume_max = 0.95;
    for (int s = 0; s < 2; s++)
        for (size_t i = 0; i < (size_t)spaces[s].items * r->plan.knob.count; i++)
            spaces[s].at[i].of[HS_MEASURE_ABS] = 10;
    /* Delta_MI 0.2, k = 23, position 4: the lowest average. Each case alone has a lower one elsewhere. */
    const hs_eval_setting low[2] = {{2, 1, 4}, {5, 1, 4}}, own[2] = {{0, 3, 1}, {10, 0, 6}};
    for (int s = 0; s < 2; s++) {
        const size_t k = r->plan.kernel.count, q = r->plan.knob.count;
        spaces[s].at[(low[s].threshold * k + low[s].kernel) * q + low[s].knob].of[HS_MEASURE_ABS] = 2;
        spaces[s].at[(own[s].threshold * k + own[s].kernel) * q + own[s].knob].of[HS_MEASURE_ABS] = 1;
    }
    must(hs_eval_mean_make(&mean, spaces, 2, &err));
    assert_true(fabs(mean.delta[mean.best] - 0.2) < 1e-9);
    assert_int_equal(mean.best_kernel, 1);
    assert_int_equal(mean.best_knob, 4);
    assert_int_equal(mean.deltas, 7); /* 0 .. 0.3: T_B = 0.8 .. 0.5 of the first case */
    for (int s = 0; s < 2; s++) {
        const hs_eval_setting best = hs_eval_best(&spaces[s]);
        assert_memory_equal(&best, &own[s], sizeof best);
        assert_true(hs_eval_threshold_at(&spaces[s], 0.2, &t));
        assert_int_equal(t, low[s].threshold);
    }
    assert_false(hs_eval_threshold_at(&spaces[0], 0.4, &t));
    hs_eval_mean_free(&mean);
    for (int s = 0; s < 2; s++) hs_eval_space_close(&spaces[s]);
}

UNIT_MAIN(open_rig, close_rig, axes_are_those_of_the_thesis, quick_way_is_the_direct_one,
          common_setting_is_found_by_delta)
