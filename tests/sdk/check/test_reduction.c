/* SPDX-License-Identifier: MIT */
/*
 * Reduced resolution (docs/numerics.md, "Reduced resolution"): the plugin against the definition of the
 * reduced surface, within the bounds of the full one; and how far a reduced surface may lie from the full
 * one, on scattered points and on patches.
 */
#include "support/surfaces.h"
#include "support/unit.h"

#include "ref/ref_mean.h"
#include "ref/ref_minimum.h"
#include "ref/ref_reduce.h"

#include <math.h>

enum { SLICES = 60 };

static surface_points make_set(int set, uint32_t width, uint32_t height) {
    return set == 0 ? surface_scattered(width, height, SLICES, width * height / 33, 71)
                    : surface_patches(width, height, SLICES, 7);
}
static const char *const set_names[] = {"scattered", "patches"};

static void check(rig *r, const surface_points *p, const surface_chain *chain, const char *set) {
    const size_t count = (size_t)p->width * p->height;
    rig_result out = rig_result_make(p->width, p->height);
    const sv_status status = surface_run(r, p, chain, &out, NULL);
    if (status != SV_OK) print_message("%s: %s\n", surface_name(chain->method), r->last_log);
    assert_int_equal(status, SV_OK);
    assert_memory_equal(out.status, p->status, count); /* of the rays, at full resolution */
    assert_int_equal(out.stats.unfilled, 0);
    double *expected = surface_expect(p, chain);
    const double error = surface_error(&out, expected, count), bound = surface_bound(chain, p);
    print_message("%-9s 1/%u, %-9s %3u x %-3u pre-filter %u error %.2e slices, bound %.0e\n",
                  surface_name(chain->method), chain->reduction, set, p->width, p->height,
                  chain->prefilter_passes, error, bound);
    assert_true(error <= bound);
    free(expected);
    rig_result_free(&out);
}

/* Every method, every reduction, with and without pre-filter; sides that the cells do not divide. */
static void test_definition(void **state) {
    static const uint32_t sizes[][2] = {{75, 41}, {64, 48}, {3, 50}};
    for (int set = 0; set < 2; set++)
        for (int size = 0; size < 3; size++) {
            surface_points p = make_set(set, sizes[size][0], sizes[size][1]);
            for (int method = surface_next_of_points(-1); method >= 0;
                 method = surface_next_of_points(method))
                for (uint32_t reduction = 2; reduction <= 4; reduction++) {
                    surface_chain chain = {.method = method, .reduction = reduction, .k = 13, .q = 0.25f};
                    check(*state, &p, &chain, set_names[set]);
                    chain.prefilter_passes = reduction / 2;
                    chain.q = 1.25f;
                    check(*state, &p, &chain, set_names[set]);
                }
            surface_points_free(&p);
        }
}

/* What depends on the pixels' size: lambda, merging, the coarse grid, layouts. */
static void test_settings(void **state) {
    surface_points p = make_set(0, 70, 45);
    const surface_chain chains[] = {
        {.method = SV_METHOD_SPLINE, .reduction = 2, .lambda = 250.0},
        {.method = SV_METHOD_SPLINE, .reduction = 4, .merge_grid = 8, .spline_grid = 8, .lambda = 3.5},
        {.method = SV_METHOD_MEAN, .reduction = 2, .k = 3, .strategy = 1},
        {.method = SV_METHOD_MEAN, .reduction = 4, .k = 63, .strategy = 2},
        {.method = SV_METHOD_MEAN, .reduction = 3, .k = 9, .strategy = 3, .q = 1.5f},
        {.method = SV_METHOD_MINIMUM, .reduction = 4, .k = 63},
    };
    for (size_t i = 0; i < sizeof chains / sizeof *chains; i++) check(*state, &p, &chains[i], "settings");
    surface_points_free(&p);
}

/* A fill weight of 0 leaves pixels empty, between which nothing can be interpolated: refused, by name. */
static void test_no_fill_weight(void **state) {
    rig *r = *state;
    surface_points p = make_set(0, 40, 30);
    const sv_param_value fixed[] = {{rig_param(r, "method"), 0, SV_METHOD_MEAN},
                                    {rig_param(r, "reduction"), 0, 2}};
    const sv_format format = surface_format(&p, fixed, 2);
    const sv_param_value none[] = {{rig_param(r, "fill_weight"), 0, 0.0}};
    const sv_frame frame = {.size = sizeof frame, .values = none, .value_count = 1};
    assert_int_equal(r->plugin->activate(r->plugin, &format), SV_OK);
    assert_int_equal(r->plugin->begin(r->plugin, &frame), SV_ERR_PARAM_RANGE);
    assert_non_null(strstr(r->plugin->last_error(r->plugin), "fill_weight"));
    r->plugin->deactivate(r->plugin);
    surface_points_free(&p);
}

/* Smallest and largest depth of the points within `reach` pixels, each way. */
static double range_around(const sv_ref_map *map, uint32_t x0, uint32_t y0, uint32_t reach) {
    double low = INFINITY, high = -INFINITY;
    for (uint32_t y = y0 > reach ? y0 - reach : 0; y < map->height && y <= y0 + reach; y++)
        for (uint32_t x = x0 > reach ? x0 - reach : 0; x < map->width && x <= x0 + reach; x++) {
            const size_t i = (size_t)y * map->width + x;
            if (!map->status[i]) continue;
            low = fmin(low, map->depth[i]);
            high = fmax(high, map->depth[i]);
        }
    return high - low;
}

static bool filter(int method, const sv_ref_map *map, uint32_t k, double *surface, sv_ref_fill *fill) {
    return method == SV_METHOD_MEAN
               ? sv_ref_mean(map->status, map->depth, map->width, map->height, k, 0.5, surface, fill)
               : sv_ref_minimum(map, k, surface, fill);
}

/* The surfaces of a filter at full and at reduced resolution (`full`: room for three maps). Returns how far
 * away, in pixels, a point can be that counts: what the passes reach, and for cells one more for merging and
 * one for interpolation. */
static uint32_t both_surfaces(int method, const sv_ref_map *map, uint32_t reduction, double *full) {
    enum { K = 7 };
    const size_t count = (size_t)map->width * map->height;
    const uint32_t k_cells = sv_reduced_kernel(K, reduction);
    double *less = full + count, *cells = less + count;
    sv_ref_reduced reduced;
    sv_ref_fill fill, fill_cells;
    assert_true(filter(method, map, K, full, &fill));
    assert_true(sv_ref_reduce(map, reduction, method == SV_METHOD_MINIMUM, &reduced));
    assert_true(filter(method, &reduced.map, k_cells, cells, &fill_cells));
    sv_ref_spread(cells, map->width, map->height, reduction, less);
    sv_ref_reduced_free(&reduced);
    const uint32_t reach = fill.passes * (K / 2);
    const uint32_t reach_cells = (fill_cells.passes * (k_cells / 2) + 2) * reduction;
    return reach > reach_cells ? reach : reach_cells;
}

/*
 * Derived, for any set of points: both filters' values are means (or one) of points within reach of their
 * passes, at either resolution. So the reduced surface differs from the full one by no more than the depths
 * of these points do.
 */
static void check_reach(int method, int set, uint32_t reduction) {
    surface_points p = make_set(set, 96, 80);
    const sv_ref_map map = {.status = p.status, .depth = p.far_end, .width = p.width, .height = p.height};
    const size_t count = (size_t)p.width * p.height;
    double *full = malloc(3 * count * sizeof *full), worst = 0.0, share = 0.0;
    assert_non_null(full);
    const uint32_t reach = both_surfaces(method, &map, reduction, full);
    const double *now = full, *less = full + count;
    for (uint32_t y = 0; y < map.height; y++)
        for (uint32_t x = 0; x < map.width; x++) {
            const double range = range_around(&map, x, y, reach), off = fabs(*now++ - *less++);
            assert_true(off <= range + 1e-9);
            worst = fmax(worst, off);
            if (range > 0.0) share = fmax(share, off / range);
        }
    print_message("%-9s 1/%u, %-9s at most %.2f slices from the full resolution, %.0f %% of what the points "
                  "within %u pixels allow\n",
                  surface_name(method), reduction, set_names[set], worst, 100.0 * share, reach);
    free(full);
    surface_points_free(&p);
}

static void test_reach(void **state) {
    for (int set = 0; set < 2; set++)
        for (int method = SV_METHOD_MEAN; method <= SV_METHOD_MINIMUM; method++)
            for (uint32_t reduction = 2; reduction <= 4; reduction++) check_reach(method, set, reduction);
}

/* A smooth layer of depths; second derivatives at most 10 / 144 and 10 / 81, slopes 10 / 12 and 10 / 9. */
static double layer(double x, double y) {
    return 30.0 + 10.0 * sin(x / 12.0) * cos(y / 9.0);
}

/*
 * Derived, where every pixel is a point: a surface through the points is the layer itself at full resolution,
 * and the cells' means at a reduced one. A cell's mean is off by (r^2 - 1) / 24 second derivatives each way,
 * and what is linear between the cells by r^2 / 8 more; at the border, beyond the outermost centres, by (r -
 * 1) / 2 slopes.
 */
static void test_dense(void **state) {
    enum { SIDE = 48, PIXELS = SIDE * SIDE };
    const double bends = 10.0 / 144.0 + 10.0 / 81.0, slopes = 10.0 / 12.0 + 10.0 / 9.0;
    static uint8_t status[PIXELS];
    static double depth[PIXELS], surface[PIXELS];
    for (uint32_t i = 0; i < PIXELS; i++) {
        status[i] = 1;
        depth[i] = layer(i % SIDE, i / SIDE);
    }
    const sv_ref_map map = {.status = status, .depth = depth, .width = SIDE, .height = SIDE};
    for (uint32_t reduction = 2; reduction <= 4; reduction++) {
        const double r = reduction;
        const double inside = bends * ((r * r - 1.0) / 24.0 + r * r / 8.0), border = slopes * (r - 1.0) / 2.0;
        sv_ref_reduced reduced;
        assert_true(sv_ref_reduce(&map, reduction, false, &reduced));
        sv_ref_spread(reduced.map.depth, SIDE, SIDE, reduction, surface);
        double worst_inside = 0.0, worst = 0.0;
        for (uint32_t i = 0; i < PIXELS; i++) {
            const uint32_t x = i % SIDE, y = i / SIDE;
            const bool in = x >= reduction && y >= reduction && x + reduction < SIDE && y + reduction < SIDE;
            const double off = fabs(surface[i] - depth[i]);
            worst = fmax(worst, off);
            if (in) worst_inside = fmax(worst_inside, off);
        }
        print_message("dense, 1/%u: %.3f slices inside, bound %.3f; %.3f at the border, bound %.3f\n",
                      reduction, worst_inside, inside, worst, inside + border);
        assert_true(worst_inside <= inside);
        assert_true(worst <= inside + border);
        sv_ref_reduced_free(&reduced);
    }
}

/*
 * What a host gives up on points of a smooth layer, as a share of their range of depths: every method,
 * points scattered over 3 % of the pixels, and in patches. The largest differences stand where a step
 * between two patches, or a cell's worth of slope at the border, lands a few pixels aside. The bound is the
 * method's own.
 */
static void test_given_up(void **state) {
    for (int set = 0; set < 2; set++) {
        surface_points p = make_set(set, 128, 96);
        const size_t count = (size_t)p.width * p.height;
        double low = INFINITY, high = -INFINITY;
        for (size_t i = 0; i < count; i++) {
            if (!p.status[i]) continue;
            if (set == 0) p.far_end[i] = layer((double)(i % p.width), (double)(i / p.width));
            low = fmin(low, p.far_end[i]);
            high = fmax(high, p.far_end[i]);
        }
        for (int method = surface_next_of_points(-1); method >= 0; method = surface_next_of_points(method)) {
            surface_chain chain = {.method = method, .k = 23, .merge_grid = 8};
            const double *bound = sv_ref_method_of((uint32_t)method)->given_up;
            double *full = surface_expect(&p, &chain);
            for (int n = 0; n < 2; n++) {
                chain.reduction = n ? 4 : 2;
                double *less = surface_expect(&p, &chain), worst = 0.0, sum = 0.0;
                for (size_t i = 0; i < count; i++) {
                    worst = fmax(worst, fabs(full[i] - less[i]));
                    sum += fabs(full[i] - less[i]);
                }
                print_message(
                    "%-9s 1/%u, %-9s given up: %5.1f %% of the range at most, %4.1f %% on average, bound "
                    "%.0f %%\n",
                    surface_name(method), chain.reduction, set_names[set], 100.0 * worst / (high - low),
                    100.0 * sum / (double)count / (high - low), 100.0 * bound[n]);
                assert_true(worst <= bound[n] * (high - low));
                free(less);
            }
            free(full);
        }
        surface_points_free(&p);
    }
}

UNIT_MAIN(rig_setup, rig_teardown, cmocka_unit_test(test_definition), cmocka_unit_test(test_settings),
          cmocka_unit_test(test_no_fill_weight), cmocka_unit_test(test_reach), cmocka_unit_test(test_dense),
          cmocka_unit_test(test_given_up))
