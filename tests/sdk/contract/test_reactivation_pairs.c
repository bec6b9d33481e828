/* SPDX-License-Identifier: MIT */
/*
 * Every pair of values of the parameters that need reactivation: the instance can be activated with them (so
 * its self-tests hold), and a frame has a surface at every pixel. Which parameters these are, the plugin
 * says.
 */
#include "support/fixture.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <string.h>

#include <cmocka.h>

enum { MAX_PARAMETERS = 16, MAX_VALUES = 64, FEW = 8 };

typedef struct {
    sv_param_info info;
    double value[MAX_VALUES];
    int count;
} knob;

/* All values that there are where they are few, else the ends and the default. */
static void choose_values(const sv_plugin *p, knob *k) {
    char text[64];
    const sv_param_info *i = &k->info;
    const double steps = (i->max_value - i->min_value) / i->step;
    assert_true(i->type == SV_PARAM_ENUM || i->type == SV_PARAM_INT || i->type == SV_PARAM_BOOL);
    if (i->type == SV_PARAM_ENUM || steps < FEW) {
        assert_true(steps < MAX_VALUES);
        for (double v = i->min_value; v <= i->max_value; v += i->step)
            if (p->param_text(p, i->id, v, text, sizeof text) == SV_OK) k->value[k->count++] = v;
        return;
    }
    assert_int_equal(i->type, SV_PARAM_INT);
    k->value[k->count++] = i->min_value;
    k->value[k->count++] = i->default_value;
    k->value[k->count++] = i->max_value;
}

static int find_knobs(const rig *r, knob knobs[MAX_PARAMETERS]) {
    int count = 0;
    for (uint32_t i = 0; i < r->plugin->param_count(r->plugin); i++) {
        knob k = {.info = {.size = sizeof k.info}};
        assert_int_equal(r->plugin->param_info(r->plugin, i, &k.info), SV_OK);
        if (!(k.info.flags & SV_PARAM_REACTIVATE)) continue;
        assert_true(count < MAX_PARAMETERS);
        choose_values(r->plugin, &k);
        knobs[count++] = k;
    }
    return count;
}

static void try_pair(fixture *f, const knob *a, double va, const knob *b, double vb) {
    const rig_format how = {.fixed = {{.id = a->info.id, .value = va}, {.id = b->info.id, .value = vb}},
                            .fixed_count = 2};
    const sv_plugin *p = f->r.plugin;
    fixture_change(f, how);
    const sv_status status = fixture_activate(f);
    if (status != SV_OK)
        fail_msg("%s = %g, %s = %g: status %d, %s", a->info.key, va, b->info.key, vb, status,
                 p->last_error(p));
    const sv_param_value any = {rig_param(&f->r, "evidence"), 0, 0.0};
    const sv_frame frame = {.size = sizeof frame, .values = &any, .value_count = 1};
    for (int i = 0; i < FIXTURE_RAYS; i++) f->out.depth[i] = NAN;
    assert_int_equal(p->begin(p, &frame), SV_OK);
    assert_int_equal(fixture_slabs(f), SV_OK);
    assert_int_equal(fixture_end(f), SV_OK);
    if (f->out.stats.outcome != SV_OK || f->out.stats.unfilled > 0)
        fail_msg("%s = %g, %s = %g: outcome %d", a->info.key, va, b->info.key, vb, f->out.stats.outcome);
    for (int i = 0; i < FIXTURE_RAYS; i++) assert_true(isfinite(f->out.depth[i]));
    p->deactivate(p);
}

static void every_pair(void **state) {
    fixture *f = *state;
    knob knobs[MAX_PARAMETERS];
    const int count = find_knobs(&f->r, knobs);
    int pairs = 0;
    for (int a = 0; a < count; a++)
        for (int b = a + 1; b < count; b++)
            for (int i = 0; i < knobs[a].count; i++)
                for (int j = 0; j < knobs[b].count; j++, pairs++)
                    try_pair(f, &knobs[a], knobs[a].value[i], &knobs[b], knobs[b].value[j]);
    print_message("%d parameters, %d pairs of values\n", count, pairs);
    assert_true(count >= 8 && pairs >= 300);
}

int main(void) {
    const struct CMUnitTest tests[] = {FIXTURE_TEST(every_pair)};
    return cmocka_run_group_tests_name("pairs of values", tests, NULL, NULL);
}
