/* SPDX-License-Identifier: MIT */
/*
 * The hard cases (spec 8) over every method, alone and behind the pre-filter: the result lies
 * within the method's bound of its float64 definition, or the frame ends with a clear status;
 * never a NaN, a hang or a crash.
 */
#include "support/surfaces.h"

#include <math.h>

/* One case: what it attacks, and how it lays its points. */
typedef struct {
    const char *name, *attacks;
    uint32_t width, height, slices, k;
    void (*lay)(surface_points *p);
} hard_case;

static void lay_none(surface_points *p) {}
static void lay_all(surface_points *p) {
    for (uint32_t y = 0; y < p->height; y++)
        for (uint32_t x = 0; x < p->width; x++) surface_put(p, x, y, 3 + x % 4, 20 + (x + y) % 9);
}
static void lay_one(surface_points *p) {
    surface_put(p, p->width / 3, p->height / 2, p->slices / 4, p->slices / 2);
}
static void lay_two(surface_points *p) {
    surface_put(p, 0, 0, 2, 10);
    surface_put(p, p->width - 1, p->height - 1, 20, 50);
}
static void lay_row(surface_points *p) {
    for (uint32_t x = 0; x < p->width; x += 5) surface_put(p, x, 7, 2, 10 + x % 11);
}
static void lay_diagonal(surface_points *p) {
    for (uint32_t i = 0; i < p->width && i < p->height; i += 2) surface_put(p, i, i, 1, 9 + i % 13);
}
/* Pixels side by side with very different depths: nearly coincident points that contradict each other. */
static void lay_pairs(surface_points *p) {
    for (uint32_t y = 2; y + 4 < p->height; y += 7)
        for (uint32_t x = 2; x + 4 < p->width; x += 9) {
            surface_put(p, x, y, 1, 5);
            surface_put(p, x + 1, y, 30, 55);
        }
}
/* Figure 5.1: dense clusters of unlike depths, and nothing between them. */
static void lay_clusters(surface_points *p) {
    for (uint32_t y = 0; y < 9; y++)
        for (uint32_t x = 0; x < 9; x++) {
            surface_put(p, 3 + x, 4 + y, 2, 15 + (x * y) % 3);
            surface_put(p, p->width - 13 + x, p->height - 12 + y, 2, 48 + (x + y) % 3);
        }
}
static void lay_checkerboard(surface_points *p) {
    for (uint32_t y = 0; y < p->height; y++)
        for (uint32_t x = 0; x < p->width; x++)
            surface_put(p, x, y, (x + y) % 2 ? 1 : 30, (x + y) % 2 ? 5 : 55);
}
static void lay_deep(surface_points *p) {
    for (uint32_t y = 1; y < p->height; y += 6)
        for (uint32_t x = 1; x < p->width; x += 5) surface_put(p, x, y, 8100 + x % 3, 8150 + (x * y) % 4);
}

static const hard_case cases[] = {
    {"no bone", "nothing to reconstruct from", 40, 30, 60, 23, lay_none},
    {"all bone", "no empty pixel; more points than the spline takes are merged", 40, 36, 60, 23, lay_all},
    {"one point", "a plane of rank 1; most passes", 40, 30, 60, 3, lay_one},
    {"two points far apart", "k = 3: as many passes as the map is long", 64, 48, 60, 3, lay_two},
    {"collinear", "a singular spline matrix", 40, 30, 60, 9, lay_row},
    {"collinear, slanting", "rank found only after rounding", 40, 40, 60, 9, lay_diagonal},
    {"contradicting neighbours", "nearly coincident points, steep surfaces", 40, 30, 60, 9, lay_pairs},
    {"unlike clusters", "Figure 5.1: bad conditioning, overshoot", 48, 40, 60, 11, lay_clusters},
    {"checkerboard", "the highest frequency there is", 32, 24, 60, 3, lay_checkerboard},
    {"depths near 8,150", "cancellation in float32", 40, 30, 8192, 3, lay_deep},
    {"1 x 1, no point", "no neighbour at all", 1, 1, 60, 3, lay_none},
    {"1 x 1, one point", "no neighbour at all", 1, 1, 60, 63, lay_one},
    {"one row", "differences in one direction only", 50, 1, 60, 5, lay_one},
    {"one column", "differences in one direction only", 1, 50, 60, 5, lay_one},
    {"2 x 2", "pyramids of two levels, no second difference", 2, 2, 60, 3, lay_two},
    {"window larger than the image", "every window is the whole image", 20, 15, 60, 63, lay_two},
};

/* What a frame may not do even where its surface is right. Whether there is one depends on the points, or is
 * for a method to say that takes the volume. */
static void check_frame(const surface_points *p, const rig_result *out, sv_status status, int method) {
    const bool takes_volume = sv_ref_method_of((uint32_t)method)->takes_volume;
    const size_t count = (size_t)p->width * p->height;
    uint32_t points = 0;
    for (size_t i = 0; i < count; i++) points += p->status[i] != 0;
    if (!takes_volume) assert_int_equal(status, points > 0 ? SV_OK : SV_NO_SURFACE);
    assert_true(status == SV_OK || status == SV_NO_SURFACE);
    assert_int_equal(out->stats.unfilled, status == SV_OK ? 0 : count);
    surface_check_points(out, p, method);
}

static void check_case(rig *r, const hard_case *c, const surface_chain *chain) {
    surface_points p = surface_points_make(c->width, c->height, c->slices);
    c->lay(&p);
    rig_result out = rig_result_make(c->width, c->height);
    for (size_t i = 0; i < (size_t)c->width * c->height; i++)
        out.depth[i] = NAN; /* every pixel must be written */
    const sv_status status = surface_run(r, &p, chain, &out);
    if (status < 0) print_message("%s, %s: %s\n", c->name, surface_name(chain->method), r->last_log);
    check_frame(&p, &out, status, chain->method);
    double *expected = surface_expect(&p, chain);
    const double error = surface_error(&out, expected, (size_t)c->width * c->height);
    const double bound = surface_bound(chain, &p);
    if (!(error <= bound) || getenv("SV_VERBOSE"))
        print_message("%-28s %-9s %s error %.2e slices, bound %.0e (%s)\n", c->name,
                      surface_name(chain->method), chain->prefilter_passes ? "pre-filtered" : "            ",
                      error, bound, c->attacks);
    assert_true(error <= bound);
}

static void check_method(rig *r, int method) {
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++)
        for (uint32_t passes = 0; passes < 3; passes += 2) {
            const surface_chain chain = {.method = method,
                                         .k = cases[i].k,
                                         .q = 0.5f,
                                         .prefilter_passes = passes,
                                         .prefilter_k = i % 2 ? 7 : 3};
            check_case(r, &cases[i], &chain);
        }
}

static void test_every_method(void **state) {
    for (int method = surface_next(-1); method >= 0; method = surface_next(method))
        check_method(*state, method);
}

/* The spline's other ways: smoothed, merged, and on coarse grids that are finer or coarser than the map. */
static void test_spline_ways(void **state) {
    static const uint32_t merge[] = {1, 8, 37}, grid[] = {1, 32, 256};
    static const double lambda[] = {0.0, 3.5, 250.0};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++)
        for (int n = 0; n < 3; n++) {
            surface_chain chain = {
                .method = SV_METHOD_SPLINE, .k = 3, .q = 0.5f, .merge_grid = merge[n], .lambda = lambda[n]};
            check_case(*state, &cases[i], &chain);
            if ((grid[n] + 1) * (grid[n] + 1) < cases[i].width * cases[i].height) chain.spline_grid = grid[n];
            check_case(*state, &cases[i], &chain);
        }
}

UNIT_MAIN(rig_setup, rig_teardown, test_every_method, test_spline_ways)
