/* SPDX-License-Identifier: MIT */
/*
 * The cost volume against its float64 definition: on scenes, on any volume, by any split into slabs; and its
 * report where there is no fluid.
 */
#include "common/sv_shared.h"
#include "method_list.h"
#include "ref/ref_cost.h"
#include "scene/scene.h"
#include "support/rig.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

static const double BOUND = 1e-3; /* slices */

typedef struct {
    uint32_t width, height, slices, slab_slices;
    int32_t padding;
    float voxel_mm; /* 0: unknown */
} shape;

static sv_param_value value_of(const rig *r, const char *key, double value) {
    return (sv_param_value){.id = rig_param(r, key), .value = value};
}

/* Method cost on side^3 voxels, in slabs of 16. */
static rig_format cube_of(const rig *r, uint32_t side) {
    return (rig_format){.width = side,
                        .height = side,
                        .slices = side,
                        .slab_slices = 16,
                        .fixed = {value_of(r, "method", SV_METHOD_COST)},
                        .fixed_count = 1};
}

static sv_status run(rig *r, const shape *s, const uint8_t *volume, float q, double evidence,
                     rig_result *out) {
    const rig_format f = {.width = s->width,
                          .height = s->height,
                          .slices = s->slices,
                          .slab_slices = s->slab_slices,
                          .padding = s->padding,
                          .voxel_mm = s->voxel_mm,
                          .extra_w = 3,
                          .fixed = {value_of(r, "method", SV_METHOD_COST)},
                          .fixed_count = 1};
    const sv_param_value values[] = {value_of(r, "q", (double)q), value_of(r, "evidence", evidence)};
    return rig_run(r, &f, volume, values, 2, out);
}

/* Largest error over the pixels that no tie reaches; prints what docs/cost_volume.md quotes. */
static void compare(rig *r, const shape *s, const uint8_t *volume, float q, const char *what) {
    const size_t count = (size_t)s->width * s->height;
    const sv_ref_volume v = {volume, s->width, s->height, s->slices, s->padding, NULL};
    double *maps = calloc(3 * count, sizeof *maps);
    uint8_t *tie = calloc(count, 1);
    rig_result out = rig_result_make(s->width, s->height);
    sv_ref_cost_facts facts;
    assert_non_null(maps);
    assert_true(sv_ref_cost_surface(&v, s->voxel_mm, maps, maps + count, maps + 2 * count, tie, &facts));
    const sv_status status = run(r, s, volume, q, 0.0, &out);
    if (status < 0) print_message("%s\n", r->last_log);
    const bool wanted = facts.open > 0 && facts.open * 8 >= facts.rays && out.stats.points > 0;
    assert_int_equal(status, wanted ? SV_OK : SV_NO_SURFACE);
    double error = 0.0;
    for (size_t i = 0; i < count; i++) {
        const double expected = wanted ? maps[count + i] + (double)q * (maps[i] - maps[count + i]) : 0.0;
        assert_true(isfinite(out.depth[i]));
        if (!tie[i]) error = fmax(error, fabs((double)out.depth[i] - expected));
    }
    print_message(
        "%-28s %3u x %3u x %3u, slabs of %2u: error %.1e slices, T_L %u, %u of %zu pixels at a tie%s\n", what,
        s->width, s->height, s->slices, s->slab_slices, error, facts.levels.fluid, facts.ties, count,
        wanted ? "" : ", no surface");
    assert_true(error <= BOUND);
    assert_true(facts.ties * 4 <= count || !wanted); /* or the test would prove little */
    assert_true(wanted ? out.stats.unfilled == 0 : out.stats.unfilled == count);
    rig_result_free(&out);
    free(tie);
    free(maps);
}

static void test_scenes(void **state) {
    static const char *const names[] = {"E01", "E02", "E03", "E04", "M01", "M02", "M03", "D01", "D02"};
    for (size_t n = 0; n < sizeof names / sizeof *names; n++) {
        hs_scene_data data;
        hs_error err = {0};
        assert_true(hs_scene_generate(names[n], 96, 1, &data, &err));
        const shape s = {96, 96, 96, .slab_slices = 16};
        compare(*state, &s, data.full.voxels, 0.5f, names[n]);
        if (n == 1) {
            const shape whole = {96, 96, 96, .slab_slices = 96}, single = {96, 96, 96, .slab_slices = 1},
                        odd = {96, 96, 96, .slab_slices = 7};
            const shape fine = {96, 96, 96, .slab_slices = 16, .voxel_mm = 0.4f},
                        coarse = {96, 96, 96, .slab_slices = 16, .voxel_mm = 2.0f};
            compare(*state, &whole, data.full.voxels, 0.0f, "one slab, q = 0");
            compare(*state, &single, data.full.voxels, 1.5f, "a slab a slice, q = 1.5");
            compare(*state, &odd, data.full.voxels, 1.0f, "a short last slab, q = 1");
            compare(*state, &fine, data.full.voxels, 0.5f, "bins of 0.4 mm");
            compare(*state, &coarse, data.full.voxels, 0.5f, "bins of 2 mm");
        }
        hs_scene_free(&data);
    }
}

/* Sizes that are no multiple of anything, and volumes that are no scans. */
static void test_any_volume(void **state) {
    static const shape shapes[] = {
        {75, 40, 61, .slab_slices = 9},
        {171, 33, 171, .slab_slices = 16},
        {17, 130, 40, .slab_slices = 40, .padding = SV_NO_PADDING},
        {1, 1, 1, .slab_slices = 1},
        {3, 5, 2, .slab_slices = 1},
        {40, 40, 200, .slab_slices = 16, .padding = 255},
        {263, 40, 400, .slab_slices = 16}, /* rays of 2 x 2 pixels, bins of 3 slices */
    };
    for (size_t n = 0; n < sizeof shapes / sizeof *shapes; n++)
        for (int kind = 0; kind < RIG_KIND_COUNT; kind++) {
            const shape *s = &shapes[n];
            uint8_t *volume = rig_volume((rig_kind)kind, s->width, s->height, s->slices, 77 + (uint32_t)n);
            static const char *const kinds[] = {"noise", "extremes", "layers", "sparse"};
            compare(*state, s, volume, 0.5f, kinds[kind]);
            free(volume);
        }
}

/* Tissue everywhere: nothing may be clipped, and the extension says why. */
static void test_no_fluid(void **state) {
    rig *r = *state;
    const shape s = {64, 48, 64, .slab_slices = 16};
    const size_t voxels = (size_t)s.width * s.height * s.slices, count = (size_t)s.width * s.height;
    uint8_t *volume = malloc(voxels);
    assert_non_null(volume);
    for (size_t i = 0; i < voxels; i++) volume[i] = (uint8_t)(100 + i * 2654435761u % 120);
    rig_result out = rig_result_make(s.width, s.height);
    assert_int_equal(run(r, &s, volume, 0.5f, 0.0, &out), SV_NO_SURFACE);
    for (size_t i = 0; i < count; i++) assert_true(out.depth[i] == 0.0f);
    rig_result_free(&out);
    free(volume);
}

/* The confidence map is the definition's, and belongs to this method only. */
static void test_confidence(void **state) {
    rig *r = *state;
    const sv_ext_confidence *ext = r->plugin->get_extension(r->plugin, SV_EXT_CONFIDENCE);
    assert_non_null(ext);
    enum { SIDE = 64, COUNT = SIDE * SIDE };
    hs_scene_data data;
    hs_error err = {0};
    assert_true(hs_scene_generate("E01", SIDE, 1, &data, &err));
    static double maps[3][COUNT];
    static uint8_t tie[COUNT];
    static float map[COUNT];
    const sv_ref_volume v = {data.full.voxels, SIDE, SIDE, SIDE, 0, NULL};
    sv_ref_cost_facts facts;
    assert_true(sv_ref_cost_surface(&v, 0.0f, maps[0], maps[1], maps[2], tie, &facts));
    const rig_format f = cube_of(r, SIDE);
    rig_textures *t = rig_textures_make(r, &f, data.full.voxels);
    rig_result out = rig_result_make(SIDE, SIDE);
    sv_confidence_report report = {.size = sizeof report};
    assert_int_equal(r->plugin->activate(r->plugin, &t->format), SV_OK);
    assert_int_equal(ext->read(r->plugin, map, &report), SV_ERR_STATE);
    assert_int_equal(rig_frame(r, t, NULL, 0, &out), SV_OK);
    assert_int_equal(ext->read(r->plugin, map, &report), SV_OK);
    for (size_t i = 0; i < COUNT; i++)
        if (!tie[i]) assert_true(fabs((double)map[i] - maps[2][i]) < 1e-3);
    assert_int_equal(report.rays, facts.rays);
    assert_int_equal(report.open_rays, facts.open);
    assert_true(fabs((double)report.fluid_threshold * 255.0 - facts.levels.fluid) < 1e-3);
    r->plugin->deactivate(r->plugin);
    rig_textures_free(t);
    rig_result_free(&out);
    hs_scene_free(&data);
}

/* A still scene with other speckle, then a cut to another scene: both as the definition says, and the cut
 * leaves no trace of the scene before. */
static void test_memory(void **state) {
    rig *r = *state;
    enum { SIDE = 64, COUNT = SIDE * SIDE, STEPS = 4 };
    static const char *const names[STEPS] = {"E01", "E01", "E01", "M03"};
    sv_ref_cost_layout l = sv_ref_cost_layout_of(SIDE, SIDE, SIDE, 0.0f);
    l.memory = 0.75;
    l.previous = calloc((size_t)l.sizes.cells_x * l.sizes.cells_y * SV_COST_VALUES, sizeof *l.previous);
    assert_non_null(l.previous);
    static double maps[3][COUNT];
    static uint8_t tie[COUNT], tied[COUNT];
    const sv_param_value values[] = {value_of(r, "memory", 0.75), value_of(r, "evidence", 0.0)};
    const rig_format f = cube_of(r, SIDE);
    rig_result out = rig_result_make(SIDE, SIDE);
    for (int step = 0; step < STEPS; step++) {
        hs_scene_data data;
        hs_error err = {0};
        assert_true(hs_scene_generate(names[step], SIDE, 5 + (uint64_t)step, &data, &err));
        const sv_ref_volume v = {data.full.voxels, SIDE, SIDE, SIDE, 0, NULL};
        assert_true(sv_ref_cost_surface_with(&v, &l, maps[0], maps[1], maps[2], tie, NULL));
        rig_textures *t = rig_textures_make(r, &f, data.full.voxels);
        if (step == 0) assert_int_equal(r->plugin->activate(r->plugin, &t->format), SV_OK);
        assert_int_equal(rig_frame(r, t, values, 2, &out), SV_OK);
        double error = 0.0;
        for (size_t i = 0; i < COUNT; i++) {
            tied[i] |= tie[i]; /* a choice is remembered */
            if (!tied[i]) error = fmax(error, fabs((double)out.depth[i] - 0.5 * (maps[0][i] + maps[1][i])));
        }
        print_message("memory 0.75, frame %d (%s): error %.1e slices\n", step, names[step], error);
        assert_true(error <= BOUND);
        rig_textures_free(t);
        hs_scene_free(&data);
    }
    r->plugin->deactivate(r->plugin);
    rig_result_free(&out);
    free(l.previous);
}

/* The same seed twice: the result of a frame does not depend on the frame before unless memory is asked for.
 * */
static void test_no_memory(void **state) {
    rig *r = *state;
    enum { SIDE = 48, COUNT = SIDE * SIDE };
    const rig_format f = cube_of(r, SIDE);
    rig_result first = rig_result_make(SIDE, SIDE), second = rig_result_make(SIDE, SIDE);
    hs_scene_data a, b;
    hs_error err = {0};
    assert_true(hs_scene_generate("E01", SIDE, 1, &a, &err));
    assert_true(hs_scene_generate("E01", SIDE, 2, &b, &err));
    rig_textures *ta = rig_textures_make(r, &f, a.full.voxels), *tb = rig_textures_make(r, &f, b.full.voxels);
    assert_int_equal(r->plugin->activate(r->plugin, &ta->format), SV_OK);
    assert_int_equal(rig_frame(r, ta, NULL, 0, &first), SV_OK);
    assert_int_equal(rig_frame(r, tb, NULL, 0, &second), SV_OK);
    assert_int_equal(rig_frame(r, ta, NULL, 0, &second), SV_OK);
    assert_memory_equal(first.depth, second.depth, COUNT * sizeof(float));
    r->plugin->deactivate(r->plugin);
    rig_textures_free(ta);
    rig_textures_free(tb);
    rig_result_free(&first);
    rig_result_free(&second);
    hs_scene_free(&a);
    hs_scene_free(&b);
}

/* Twice the gain, half the gain: T_L is found from the volume, so the surface hardly moves. */
static void test_gain(void **state) {
    (void)state;
    enum { SIDE = 96, COUNT = SIDE * SIDE };
    hs_scene_data data;
    hs_error err = {0};
    assert_true(hs_scene_generate("E03", SIDE, 1, &data, &err));
    static double maps[3][3][COUNT];
    static const double gains[] = {1.0, 0.7, 1.4};
    uint8_t *louder = malloc((size_t)SIDE * COUNT);
    assert_non_null(louder);
    for (int g = 0; g < 3; g++) {
        for (size_t i = 0; i < (size_t)SIDE * COUNT; i++) {
            const double voxel = data.full.voxels[i] * gains[g] + 0.5;
            louder[i] = data.full.voxels[i] ? (uint8_t)fmin(fmax(voxel, 1.0), 255.0) : 0;
        }
        const sv_ref_volume v = {louder, SIDE, SIDE, SIDE, 0, NULL};
        sv_ref_cost_facts facts;
        assert_true(sv_ref_cost_surface(&v, 0.0f, maps[g][0], maps[g][1], maps[g][2], NULL, &facts));
        double change = 0.0;
        for (size_t i = 0; i < COUNT; i++) change += fabs(maps[g][0][i] - maps[0][0][i]) / COUNT;
        print_message("gain %.1f: T_L %u, mean change of the surface %.2f slices\n", gains[g],
                      facts.levels.fluid, change);
        assert_true(change < 1.0);
    }
    free(louder);
    hs_scene_free(&data);
}

int main(void) {
    const struct CMUnitTest tests[] = {RIG_TEST(test_scenes),      RIG_TEST(test_any_volume),
                                       RIG_TEST(test_no_fluid),    RIG_TEST(test_confidence),
                                       RIG_TEST(test_memory),      RIG_TEST(test_no_memory),
                                       cmocka_unit_test(test_gain)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
