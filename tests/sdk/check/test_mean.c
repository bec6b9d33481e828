/* SPDX-License-Identifier: MIT */
/*
 * The mean filter on maps small enough to do by hand (spec 4; thesis 3.3, Figure 3.11): expectations here are
 * worked out in the comments, not by src/ref/. Every map goes through each of the three work layouts.
 */
#include "support/rig.h"

#include <math.h>

enum { NONE = -1, MAX_PIXELS = 32 * 32, SLICES = 40 };
static const double ROUNDING =
    1.0 / 16384; /* slices; by hand is exact, these formats keep 16 bits, 7 passes at most */

/* A map by hand: interval ends per pixel, and what the filter is to do with it. */
typedef struct {
    uint32_t width, height, k;
    double omega;
    int32_t far_end[MAX_PIXELS]; /* NONE: no point; 0: empty interval */
    int32_t near_end[MAX_PIXELS];
} map;

static map *empty_map(uint32_t width, uint32_t height, uint32_t k, double omega) {
    map *m = unit_memory(sizeof *m);
    assert_true(width * height <= MAX_PIXELS);
    *m = (map){.width = width, .height = height, .k = k, .omega = omega};
    for (uint32_t i = 0; i < MAX_PIXELS; i++) m->far_end[i] = NONE;
    return m;
}

static void set_point(map *m, uint32_t x, uint32_t y, int32_t depth) {
    m->far_end[y * m->width + x] = depth;
}

static sv_status run_map(rig *r, const map *m, uint32_t strategy, float q, rig_result *out) {
    uint8_t *volume = rig_map_volume(m->near_end, m->far_end, m->width, m->height, SLICES);
    const rig_format f = {.width = m->width,
                          .height = m->height,
                          .slices = SLICES,
                          .slab_slices = 16,
                          .padding = SV_NO_PADDING,
                          .fixed = {{rig_param(r, "strategy"), 0, strategy}}};
    const sv_param_value values[] = {{rig_param(r, "kernel"), 0, m->k},
                                     {rig_param(r, "fill_weight"), 0, m->omega},
                                     {rig_param(r, "q"), 0, (double)q},
                                     {rig_param(r, "evidence"), 0, 0}};
    return rig_run(r, &f, volume, values, 4, out);
}

static void assert_depth(const rig_result *out, uint32_t i, double expected) {
    if (!(fabs((double)out->depth[i] - expected) <= ROUNDING))
        fail_msg("pixel %u is %.9g, expected %.9g", i, (double)out->depth[i], expected);
}

/* In each of the layouts, depth i % count for pixel i, up to `error` slices. */
static void gives(rig *r, const char *name, const map *m, float q, uint32_t passes, const double *depth,
                  uint32_t count, double error) {
    for (uint32_t strategy = 1; strategy <= 3; strategy++) {
        rig_result out = rig_result_make(m->width, m->height);
        if (run_map(r, m, strategy, q, &out) != SV_OK || out.points.passes != passes)
            fail_msg("'%s': outcome %d after %u passes, expected 0 after %u", name, out.stats.outcome,
                     out.points.passes, passes);
        for (uint32_t i = 0; i < m->width * m->height; i++)
            if (!(fabs((double)out.depth[i] - depth[i % count]) <= error))
                fail_msg("'%s': pixel %u is %.9g, expected %.9g", name, i, (double)out.depth[i],
                         depth[i % count]);
    }
}

/* Figure 3.11: points (x, y, depth) on a 13 x 13 grid under a 3 x 3 window. */
static void figure_points(map *m, int32_t right, int32_t below) {
    set_point(m, 3, 3, 5);
    set_point(m, 9, 5, right);
    set_point(m, 5, 9, below);
}

static void figure_3_11(void **state) {
    map *m = empty_map(13, 13, 3, 0.5), *mirrored = empty_map(13, 13, 3, 0.5);
    figure_points(m, 1, 3);
    figure_points(mirrored, 3, 1);
    for (uint32_t strategy = 1; strategy <= 3; strategy++) {
        rig_result out = rig_result_make(13, 13), other = rig_result_make(13, 13);
        assert_int_equal(run_map(*state, m, strategy, 0.0f, &out), SV_OK);
        assert_int_equal(run_map(*state, mirrored, strategy, 0.0f, &other), SV_OK);
        /* Each pass reaches one pixel further; the farthest pixel, (12, 12), is 7 from its nearest point. */
        assert_int_equal(out.points.passes, 7);
        assert_int_equal(out.stats.points, 3);
        assert_depth(&out, 0, 5.0);       /* (0, 0) is 9 pixels from the others: 7 passes bring only (3, 3) */
        assert_depth(&out, 12, 1.0);      /* (12, 0): only (9, 5) */
        assert_depth(&out, 12 * 13, 3.0); /* (0, 12): only (5, 9) */
        assert_depth(&out, 12 * 13 + 12, 2.0); /* (12, 12): 1 and 3 by equal ways, mirrored in the diagonal */
        for (uint32_t y = 0; y < 13; y++)
            for (uint32_t x = 0; x < 13; x++) {
                const float depth = out.depth[y * 13 + x];
                assert_true(depth >= 1.0f && depth <= 5.0f); /* a mean stays within its values */
                assert_true(depth == other.depth[x * 13 + y]);
                const bool point = (x == 3 && y == 3) || (x == 9 && y == 5) || (x == 5 && y == 9);
                assert_int_equal(out.status[y * 13 + x], point);
            }
    }
}

/* Rows of pixels under a window of three. */
static void lines(void **state) {
    static const struct {
        const char *name;
        double omega;
        uint32_t width, passes;
        int32_t far_end[8];
        double depth[8];
    } table[] = {
        /* A full map still gets one pass, and initial points take the mean, too: (10 + 20) / 2. */
        {"two points side by side", 0.5, 2, 1, {10, 20}, {15, 15}},
        {"a point alone", 0.5, 1, 1, {10}, {10}},
        {"a gap of one", 0.5, 3, 1, {10, NONE, 30}, {10, 20, 30}},
        /* Pass 1: 10 10 _ 20 20. Pass 2: the middle is (.5 10 + .5 20) / 1. */
        {"a gap of three", 0.5, 5, 2, {10, NONE, NONE, NONE, 20}, {10, 10, 15, 20, 20}},
        {"a gap of five", 0.5, 7, 3, {10, NONE, NONE, NONE, NONE, NONE, 26}, {10, 10, 10, 18, 26, 26, 26}},
        /* Pass 1: 15 15 20 _. Pass 2: (15 + 15) / 2, (15 + 15 + w 20) / (2 + w), (15 + w 20) / (1 + w),
         * 20. */
        {"weight 1/2", 0.5, 4, 2, {10, 20, NONE, NONE}, {15, 16, 50 / 3.0, 20}},
        {"weight 1", 1.0, 4, 2, {10, 20, NONE, NONE}, {15, 50 / 3.0, 17.5, 20}},
        {"weight 1/4", 0.25, 4, 2, {10, 20, NONE, NONE}, {15, 140 / 9.0, 16, 20}},
        {"weight 3/4", 0.75, 4, 2, {10, 20, NONE, NONE}, {15, 180 / 11.0, 120 / 7.0, 20}},
        /* An empty interval votes for 0. */
        {"an empty interval", 0.5, 3, 1, {0, NONE, 30}, {0, 15, 30}},
    };
    for (uint32_t n = 0; n < sizeof table / sizeof *table; n++) {
        map *m = empty_map(table[n].width, 1, 3, table[n].omega);
        for (uint32_t x = 0; x < table[n].width; x++) set_point(m, x, 0, table[n].far_end[x]);
        gives(*state, table[n].name, m, 0.0f, table[n].passes, table[n].depth, m->width, ROUNDING);
    }
}

/* Pixels outside the image do not count. Depths 1 to 9 row by row: a corner is the mean of 4, an edge of 6,
 * the middle of all 9. (Clamping to the edge would give 2 1/3 in the first corner.) */
static void borders(void **state) {
    static const double expected[] = {3, 3.5, 4, 4.5, 5, 5.5, 6, 6.5, 7};
    map *m = empty_map(3, 3, 3, 0.5);
    for (uint32_t i = 0; i < 9; i++) m->far_end[i] = (int32_t)i + 1;
    gives(*state, "borders", m, 0.0f, 1, expected, 9, ROUNDING);
}

/* One point gives a constant surface, to the bit, however many passes it takes to reach the far corner. */
static void one_point(void **state) {
    static const uint32_t list[][3] = {{3, 0, 0},   {3, 31, 17}, {5, 3, 30},
                                       {7, 16, 16}, {23, 0, 31}, {63, 9, 9}};
    for (uint32_t n = 0; n < sizeof list / sizeof *list; n++) {
        const uint32_t k = list[n][0], x = list[n][1], y = list[n][2], reach = k / 2;
        map *m = empty_map(32, 32, k, 0.5);
        set_point(m, x, y, 29);
        const uint32_t right = 31 - x > x ? 31 - x : x, below = 31 - y > y ? 31 - y : y;
        const uint32_t farthest = right > below ? right : below;
        gives(*state, "one point", m, 0.0f, (farthest + reach - 1) / reach, (const double[]){29}, 1, 0.0);
    }
}

/* A window larger than the image takes every point for every pixel: one constant, in one pass. */
static void window_larger_than_image(void **state) {
    map *m = empty_map(9, 7, 63, 0.5);
    set_point(m, 0, 0, 8);
    set_point(m, 8, 6, 14);
    set_point(m, 3, 3, 38);
    gives(*state, "a large window", m, 0.0f, 1, (const double[]){20}, 1, ROUNDING);
}

/* Weight 0: filled pixels carry nothing on. The 5 x 5 block around the point is reached, the rest never:
 * status "partial", counted, and 0 there, which clips nothing. */
static void weight_zero(void **state) {
    map *m = empty_map(20, 11, 5, 0.0);
    set_point(m, 4, 5, 12);
    for (uint32_t strategy = 1; strategy <= 3; strategy++) {
        rig_result out = rig_result_make(20, 11);
        assert_int_equal(run_map(*state, m, strategy, 0.0f, &out), SV_PARTIAL);
        assert_int_equal(out.stats.outcome, SV_PARTIAL);
        assert_int_equal(out.stats.unfilled, 20 * 11 - 25);
        for (uint32_t i = 0; i < 20 * 11; i++) {
            const bool reached = i % 20 >= 2 && i % 20 <= 6 && i / 20 >= 3 && i / 20 <= 7;
            assert_true(out.depth[i] == (reached ? 12.0f : 0.0f));
        }
    }
}

/* S(q) = S_f + q (S_n - S_f) with S_f = 30, S_n = 10 or 2: 1.5 goes beyond the
 * occluder, below 0 even, unclamped. */
static void knob(void **state) {
    static const struct {
        float q;
        int32_t near_end;
        double depth;
    } table[] = {{0.0f, 10, 30}, {0.25f, 10, 25}, {1.0f, 10, 10},
                 {1.5f, 10, 0},  {1.5f, 2, -12},  {1.5f, 0, -15}};
    for (uint32_t n = 0; n < sizeof table / sizeof *table; n++) {
        map *m = empty_map(6, 5, 3, 0.5);
        set_point(m, 2, 2, 30);
        m->near_end[2 * 6 + 2] = table[n].near_end;
        gives(*state, "the knob", m, table[n].q, 3, &table[n].depth, 1, ROUNDING);
    }
}

/* Two ends of an interval are filtered apart: near 4 and 8 give 6, far 20 and 30 give 25. */
static void both_ends(void **state) {
    map *m = empty_map(2, 1, 3, 0.5);
    m->far_end[0] = 20;
    m->far_end[1] = 30;
    m->near_end[0] = 4;
    m->near_end[1] = 8;
    gives(*state, "both ends", m, 0.5f, 1, (const double[]){15.5}, 1, ROUNDING);
}

UNIT_MAIN_OF(NULL, NULL, RIG_TEST(figure_3_11), RIG_TEST(lines), RIG_TEST(borders), RIG_TEST(one_point),
             RIG_TEST(window_larger_than_image), RIG_TEST(weight_zero), RIG_TEST(knob), RIG_TEST(both_ends))
