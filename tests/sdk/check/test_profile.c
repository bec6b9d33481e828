/* SPDX-License-Identifier: MIT */
/*
 * Ray profiles and initial points, ray by ray: each ray is written out with the fluid interval a person reads
 * off it (spec 3, spec 9), so nothing here leans on src/ref/. All rays lie in one row, four pixels apart: a 3
 * x 3 mean filter with fill weight 0 then leaves each depth as it is.
 */
#include "support/rig.h"

enum { SLICES = 12, SPACING = 4, FLUID = 40, BONE = 200, MAX_RAYS = 24 };

/* Tissue lies above 40, bone above 200. An unlisted voxel is 0: fluid, or, in the padded table, not
 * scanned. */
typedef struct {
    const char *name;
    uint8_t voxels[SLICES];
    uint8_t status;
    double near_end, far_end; /* slices */
} ray;

static const ray whole_steps[] = {
    {"occluder, fluid, skin, bone", {90, 90, 90, 10, 10, 10, 10, 60, 60, 250}, 1, 3, 7},
    {"a maximum equal to T_B is no bone", {90, 10, 10, 60, 200}, 0, 0, 0},
    {"one level above T_B is bone", {90, 10, 10, 60, 201}, 1, 1, 3},
    {"of equal maxima the first counts", {90, 10, 250, 10, 10, 90, 250}, 1, 1, 2},
    {"a larger maximum later counts", {90, 10, 240, 10, 10, 90, 250}, 1, 3, 5},
    {"a smaller maximum later does not", {90, 10, 250, 10, 10, 90, 249}, 1, 1, 2},
    {"a sample equal to T_L is fluid", {90, 40, 41, 250}, 1, 1, 2},
    {"a fall onto T_L ends tissue", {90, 90, 40, 40, 250}, 1, 2, 4},
    {"one level above T_L is tissue", {90, 41, 41, 41, 250}, 2, 0, 0},
    {"the maximum in the first tissue: empty", {90, 250, 90, 10, 10, 90}, 2, 0, 0},
    {"bone in the first slice: empty", {250, 10, 10, 10, 90}, 2, 0, 0},
    {"fluid from the first slice", {10, 10, 250}, 1, 0, 2},
    {"bone straight after fluid", {90, 10, 10, 250, 90}, 1, 1, 3},
    {"fluid behind the bone does not count", {90, 10, 10, 250, 10, 10, 90, 90}, 1, 1, 3},
    {"the last interval before the bone", {90, 10, 60, 10, 10, 60, 255}, 1, 3, 5},
    {"bone in the last slice", {90, 90, 10, 10, 10, 10, 10, 10, 10, 10, 10, 255}, 1, 2, 11},
    {"one slice of fluid", {90, 90, 10, 250}, 1, 2, 3},
    {"all bone", {255, 255, 255, 255, 255, 255, 255, 255, 255, 255, 255, 255}, 2, 0, 0},
    {"all fluid", {0}, 0, 0, 0},
    {"a plateau at T_L", {40, 40, 40, 40, 40, 40, 40, 40, 40, 40, 40, 40}, 0, 0, 0},
    {"a plateau at T_L, then bone", {40, 40, 40, 40, 40, 40, 40, 40, 40, 40, 40, 255}, 1, 0, 11},
};

/* 0 marks voxels that were not scanned. */
static const ray padded[] = {
    {"padding before tissue is no fluid", {0, 0, 0, 90, 90, 250}, 2, 0, 0},
    {"padding before fluid: it begins when scanned", {0, 0, 10, 10, 250}, 1, 2, 4},
    {"padding inside fluid does not break it", {90, 10, 0, 10, 10, 250}, 1, 1, 5},
    {"padding between fluid and bone", {90, 10, 0, 0, 250}, 1, 1, 4},
    {"padding between tissue and fluid", {90, 0, 0, 10, 250}, 1, 3, 4},
    {"padding inside tissue does not break it", {90, 0, 90, 10, 10, 250}, 1, 3, 5},
    {"padding behind the bone", {90, 10, 250, 0, 0, 0}, 1, 1, 2},
    {"nothing scanned", {0}, 0, 0, 0},
    {"bone alone", {0, 0, 0, 0, 255}, 2, 0, 0},
    {"no interpolation across padding", {90, 0, 10, 10, 0, 250}, 1, 2, 5},
};

/* 255 marks voxels that were not scanned: it is no bone either. */
static const ray padded_255[] = {
    {"a padding of 255 is no bone", {90, 10, 255, 10, 60, 150, 255}, 0, 0, 0},
    {"a padding of 255 hides no bone", {90, 10, 255, 10, 60, 254, 255}, 1, 1, 4},
    {"zero is fluid then", {0, 0, 60, 250}, 1, 0, 2},
};

/* Samples half way between slices: (a + b) / 2 against 40. */
static const ray half_steps[] = {
    {"rise: the half sample is tissue", {90, 10, 10, 90, 250}, 1, 1, 2.5},
    {"rise: the half sample is fluid", {90, 10, 10, 60, 250}, 1, 1, 3},
    {"rise: the half sample equals T_L", {90, 10, 10, 70, 250}, 1, 1, 3},
    {"rise: the half sample is half a level above T_L", {90, 10, 10, 71, 250}, 1, 1, 2.5},
    {"fall: the half sample is fluid", {60, 10, 10, 60, 250}, 1, 0.5, 3},
    {"fall: the half sample equals T_L", {70, 10, 10, 60, 250}, 1, 0.5, 3},
    {"fall: the half sample is tissue", {71, 10, 10, 60, 250}, 1, 1, 3},
    {"bone straight after fluid", {90, 10, 10, 250}, 1, 1, 2.5},
    {"one slice of fluid", {60, 60, 10, 60, 250}, 1, 1.5, 3},
};

/* Quarters: (3 a + b) / 4, (a + b) / 2, (a + 3 b) / 4. */
static const ray quarter_steps[] = {
    {"20 30 40 | 50", {90, 10, 50, 250}, 1, 0.75, 2},
    {"10 30 50 | 70", {90, 10, 70, 250}, 1, 0.75, 1.75},
    {"30 50 70 | 90", {90, 10, 90, 250}, 1, 0.75, 1.5},
    {"70 130 190 | 250", {90, 10, 10, 250}, 1, 0.75, 2.25},
    {"fall 185 130 75 | 20", {240, 20, 20, 250}, 1, 1, 2.25},
    {"fall 47.5 35 22.5 | 10", {60, 10, 10, 250}, 1, 0.5, 2.25},
};

/* Thirds: (2 a + b) / 3, (a + 2 b) / 3. A depth of n / 3 is rounded to fixed point. */
static const ray third_steps[] = {
    {"20 30 | 40", {90, 10, 40, 250}, 1, 2 / 3.0, 2 + 1 / 3.0},
    {"20.3 30.7 | 41", {90, 10, 41, 250}, 1, 2 / 3.0, 2},
    {"25 40 | 55", {90, 10, 55, 250}, 1, 2 / 3.0, 2},
    {"30 50 | 70", {90, 10, 70, 250}, 1, 2 / 3.0, 1 + 2 / 3.0},
    {"fall 43.3 | 26.7 10", {60, 10, 10, 250}, 1, 2 / 3.0, 2 + 1 / 3.0},
};

typedef struct {
    const ray *rays;
    uint32_t count, substeps;
    int32_t padding;
    double tolerance; /* slices: 0 where all depths are whole fixed-point numbers */
} table;
#define TABLE(rays, substeps, padding, tolerance)                                                            \
    { rays, sizeof rays / sizeof *rays, substeps, padding, tolerance }

static const table tables[] = {
    TABLE(whole_steps, 1, SV_NO_PADDING, 0.0),
    TABLE(padded, 1, 0, 0.0),
    TABLE(padded_255, 1, 255, 0.0),
    TABLE(half_steps, 2, SV_NO_PADDING, 0.0),
    TABLE(quarter_steps, 4, SV_NO_PADDING, 0.0),
    TABLE(third_steps, 3, SV_NO_PADDING, 1.0 / 65536),
};
enum { TABLES = sizeof tables / sizeof *tables };

static void fill(uint8_t *volume, const table *t, uint32_t width) {
    memset(volume, t->padding >= 0 ? t->padding : 0, (size_t)width * SLICES);
    for (uint32_t i = 0; i < t->count; i++)
        for (uint32_t z = 0; z < SLICES; z++) volume[z * width + i * SPACING] = t->rays[i].voxels[z];
}

static void check_depth(const ray *expected, const table *t, double got, double depth, const char *end) {
    if (!(got - depth <= t->tolerance && depth - got <= t->tolerance))
        fail_msg("'%s', %s end: %.9g, expected %.9g", expected->name, end, got, depth);
}

/* One table in one split, by both ends of the knob: q = 0 is the far end, q = 1 the near end. */
static void check_table(rig *r, const table *t, const uint32_t *lengths, uint32_t strategy) {
    const uint32_t width = t->count * SPACING;
    uint8_t *volume = unit_memory((size_t)width * SLICES);
    fill(volume, t, width);
    const rig_format f = {
        .width = width,
        .height = 1,
        .slices = SLICES,
        .lengths = lengths,
        .padding = t->padding,
        .fixed = {{rig_param(r, "substeps"), 0, t->substeps}, {rig_param(r, "strategy"), 0, strategy}}};
    sv_param_value values[] = {{rig_param(r, "fluid_threshold"), 0, FLUID / 255.0},
                               {rig_param(r, "bone_mode"), 0, 0},
                               {rig_param(r, "bone_threshold"), 0, BONE / 255.0},
                               {rig_param(r, "kernel"), 0, 3},
                               {rig_param(r, "fill_weight"), 0, 0},
                               {rig_param(r, "evidence"), 0, 0},
                               {rig_param(r, "q"), 0, 0}};
    rig_result far_map = rig_result_make(width, 1), near_map = rig_result_make(width, 1);
    stage *textures = rig_stage(r, &f, volume);
    assert_int_equal(r->plugin->activate(r->plugin, &textures->format), SV_OK);
    assert_int_equal(rig_frame(r, textures, values, 7, &far_map), SV_PARTIAL);
    values[6].value = 1.0;
    assert_int_equal(rig_frame(r, textures, values, 7, &near_map), SV_PARTIAL);
    r->plugin->deactivate(r->plugin);
    uint32_t points = 0, empty = 0;
    for (uint32_t i = 0; i < t->count; i++) {
        const ray *expected = &t->rays[i];
        if (far_map.status[i * SPACING] != expected->status)
            fail_msg("'%s': status is %u, expected %u", expected->name, far_map.status[i * SPACING],
                     expected->status);
        check_depth(expected, t, (double)near_map.depth[i * SPACING], expected->near_end, "near");
        check_depth(expected, t, (double)far_map.depth[i * SPACING], expected->far_end, "far");
        points += expected->status != SV_POINT_NONE;
        empty += expected->status == SV_POINT_EMPTY;
    }
    assert_int_equal(far_map.stats.points, points);
    assert_int_equal(far_map.points.empty_points, empty);
}

/* Every crossing lies on a seam in one of these. */
static const uint32_t splits[][SLICES + 1] = {
    {SLICES}, {1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1}, {2, 2, 2, 2, 2, 2}, {1, 2, 2, 2, 2, 2, 1}, {5, 5, 2}};
enum { SPLITS = sizeof splits / sizeof *splits };

static void rays_by_hand(void **state) {
    for (uint32_t i = 0; i < TABLES; i++)
        for (uint32_t strategy = 1; strategy <= 3; strategy += 2)
            for (uint32_t s = 0; s < SPLITS; s++) check_table(*state, &tables[i], splits[s], strategy);
}

/* The three modes find T_B from maxima that a person chose: 1, 2, 3, 4 rays of 250, 240, 230, 220. */
static void thresholds_by_hand(void **state) {
    rig *r = *state;
    enum { RAYS = 10 };
    static const uint8_t maxima[RAYS] = {220, 230, 240, 250, 240, 230, 220, 230, 220, 220};
    uint8_t volume[4 * RAYS];
    for (uint32_t i = 0; i < RAYS; i++) {
        volume[i] = 90;
        volume[RAYS + i] = 10;
        volume[2 * RAYS + i] = maxima[i];
        volume[3 * RAYS + i] = 100;
    }
    const struct {
        double mode, value;
        uint32_t level, points;
    } cases[] = {
        {0, 229 / 255.0, 229, 6}, {0, 230 / 255.0, 230, 3},  {0, 230.5 / 255.0, 230, 3},
        {0, 1.0, 255, 0},         {0, 0.0, 40, 10},          {1, 0.0, 250, 0},
        {1, 10 / 255.0, 240, 1},  {1, 10.5 / 255.0, 239, 3}, {1, 1.0, 40, 10},
        {2, 0.1, 249, 1},         {2, 0.11, 239, 3},         {2, 0.3, 239, 3},
        {2, 0.301, 229, 6},       {2, 1.0, 219, 10},         {2, 0.0, 249, 1},
    };
    static const char *const keys[] = {"bone_threshold", "bone_offset", "bone_fraction"};
    const rig_format f = {.width = RAYS, .height = 1, .slices = 4, .padding = SV_NO_PADDING};
    stage *t = rig_stage(r, &f, volume);
    assert_int_equal(r->plugin->activate(r->plugin, &t->format), SV_OK);
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        const sv_param_value values[] = {{rig_param(r, "fluid_threshold"), 0, FLUID / 255.0},
                                         {rig_param(r, "bone_mode"), 0, cases[i].mode},
                                         {rig_param(r, keys[(int)cases[i].mode]), 0, cases[i].value},
                                         {rig_param(r, "evidence"), 0, 0}};
        rig_result out = rig_result_make(RAYS, 1);
        assert_int_equal(rig_frame(r, t, values, 4, &out), cases[i].points ? SV_OK : SV_NO_SURFACE);
        if (out.points.bone_threshold != (float)cases[i].level / 255.0f ||
            out.stats.points != cases[i].points)
            fail_msg("mode %g, %g: T_B %g / 255 and %u points, expected %u and %u", cases[i].mode,
                     cases[i].value, (double)out.points.bone_threshold * 255.0, out.stats.points,
                     cases[i].level, cases[i].points);
        assert_true(out.points.volume_max == 250.0f / 255.0f);
        for (uint32_t x = 0; x < RAYS; x++) assert_int_equal(out.status[x], maxima[x] > cases[i].level);
    }
}

/* Evidence: ten bone rays whose gaps are 0 (empty), 1, 1, 2, 2, 3, 3, 3, 4 and 5 slices. Those of at least
 * min_gap count as sure; with too small a share of them nothing is sure, and the map clips nothing. */
static void evidence_by_hand(void **state) {
    rig *r = *state;
    enum { RAYS = 10 };
    static const uint8_t gaps[RAYS] = {0, 1, 1, 2, 2, 3, 3, 3, 4, 5};
    static const struct {
        double min_gap, evidence;
        uint32_t sure;
        bool surface;
    } cases[] = {
        {2, 0.5, 7, true},        {2, 0.7, 7, true},      {2, 0.701, 7, false},   {2, 1, 7, false},
        {1, 0.9, 9, true},        {1, 0.901, 9, false},   {0, 0.9, 9, true},      {0, 1, 9, false},
        {2.5, 0.5, 5, true},      {2.5, 0.501, 5, false}, {3, 0.5, 5, true},      {3.001, 0.2, 2, true},
        {3.001, 0.201, 2, false}, {5, 0.1, 1, true},      {5.5, 0.001, 0, false}, {64, 0, 0, true},
    };
    uint8_t volume[8 * RAYS];
    memset(volume, 90, sizeof volume);
    for (uint32_t i = 0; i < RAYS; i++) {
        for (uint32_t z = 0; z < gaps[i]; z++) volume[(1 + z) * RAYS + i] = 10;
        volume[(1u + gaps[i]) * RAYS + i] = 250;
    }
    for (uint32_t strategy = 1; strategy <= 3; strategy++) {
        const rig_format f = {.width = RAYS,
                              .height = 1,
                              .slices = 8,
                              .padding = SV_NO_PADDING,
                              .fixed = {{rig_param(r, "strategy"), 0, strategy}}};
        stage *t = rig_stage(r, &f, volume);
        assert_int_equal(r->plugin->activate(r->plugin, &t->format), SV_OK);
        for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
            const sv_param_value values[] = {{rig_param(r, "min_gap"), 0, cases[i].min_gap},
                                             {rig_param(r, "evidence"), 0, cases[i].evidence}};
            rig_result out = rig_result_make(RAYS, 1);
            const sv_status status = rig_frame(r, t, values, 2, &out);
            if (status != (cases[i].surface ? SV_OK : SV_NO_SURFACE) ||
                out.points.sure_points != cases[i].sure)
                fail_msg("gap %g, evidence %g: status %d, %u sure, expected %u", cases[i].min_gap,
                         cases[i].evidence, status, out.points.sure_points, cases[i].sure);
            assert_int_equal(out.stats.points, RAYS);
            assert_int_equal(out.points.empty_points, 1);
            assert_int_equal(out.stats.unfilled, cases[i].surface ? 0 : RAYS);
            for (uint32_t x = 0; x < RAYS; x++) {
                assert_int_equal(out.status[x], x == 0 ? SV_POINT_EMPTY : SV_POINT_INITIAL);
                assert_true((out.depth[x] > 0.0f) == cases[i].surface);
            }
        }
        r->plugin->deactivate(r->plugin);
    }
}

UNIT_MAIN_OF(NULL, NULL, RIG_TEST(rays_by_hand), RIG_TEST(thresholds_by_hand), RIG_TEST(evidence_by_hand))
