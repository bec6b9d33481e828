/* SPDX-License-Identifier: MIT */
/* Scan conversion against its scalar definition, its slabs (any split, tiling, pitch and offset), and the
 * scanned range of every ray: the first and the last voxel that is not 0, however little of the slabs is
 * looked at. */
#include "support/host_fixture.h"
#include "support/ref_dvr.h"
#include "support/ref_scan_convert.h"

#include <math.h>

typedef struct {
    uint32_t size[3];
    double spacing[3];
    double yaw, pitch;
    int pattern;
    uint32_t lowres[3];
} convert_case;

/* Edges of about 3, 2, 2.6, 1, 0.4 and 9 source voxels; cameras still, turned and on quarter turns; odd
 * shapes. Boxes whose voxels are those of the source, and wider than it. */
static const convert_case cases[] = {
    {{60, 60, 60}, {1.0, 1.0, 1.0}, 0.0, 0.0, TEST_NOISE, {20, 20, 20}},
    {{61, 50, 47}, {1.0, 1.0, 1.0}, 0.0, 0.0, TEST_SPARSE, {20, 20, 15}},
    {{60, 60, 60}, {1.0, 1.0, 1.0}, 30.0, 20.0, TEST_NOISE, {21, 21, 25}},
    {{63, 47, 55}, {0.5, 0.5, 0.5}, 90.0, 0.0, TEST_SPARSE, {19, 19, 19}},
    {{40, 25, 31}, {1.0, 0.7, 1.3}, -47.0, 63.0, TEST_SPARSE, {13, 11, 9}},
    {{40, 25, 31}, {1.0, 0.7, 2.3}, 15.0, -63.0, TEST_SPARSE, {23, 21, 29}},
    {{20, 20, 20}, {1.0, 1.0, 1.0}, 0.0, 0.0, TEST_CHECKER, {20, 20, 20}},
    {{20, 20, 20}, {1.0, 1.0, 1.0}, 10.0, 5.0, TEST_SMOOTH, {50, 50, 50}},
    {{70, 70, 70}, {1.0, 1.0, 1.0}, 45.0, -35.0, TEST_NOISE, {9, 7, 8}},
    {{1, 1, 1}, {1.0, 1.0, 1.0}, 0.0, 0.0, TEST_FULL, {1, 1, 1}},
    {{1, 5, 9}, {1.0, 1.0, 1.0}, 20.0, 31.0, TEST_NOISE, {7, 6, 5}},
    {{9, 1, 40}, {1.0, 1.0, 1.0}, 0.0, 0.0, TEST_NOISE, {3, 3, 13}},
    {{30, 30, 30}, {1.0, 1.0, 1.0}, 12.0, 34.0, TEST_EMPTY, {10, 10, 10}},
    {{49, 49, 49}, {1.0, 1.0, 1.0}, -90.0, 180.0, TEST_FULL, {17, 17, 17}},
    {{60, 60, 60}, {1.0, 1.0, 1.0}, 0.0, 0.0, TEST_NOISE, {24, 24, 28}},
    {{41, 39, 43}, {1.0, 1.0, 1.0}, -25.0, 40.0, TEST_SPARSE, {25, 25, 25}},
    {{66, 41, 52}, {0.8, 0.8, 0.8}, 89.0, 3.0, TEST_NOISE, {27, 27, 29}},
    {{60, 60, 62}, {0.625, 0.625, 0.625}, 0.0, 0.0, TEST_NOISE, {38, 38, 39}},
    {{70, 66, 69}, {1.0, 1.0, 1.0}, 33.0, 12.0, TEST_SPARSE, {41, 41, 41}},
    {{64, 64, 64}, {0.5, 0.5, 0.55}, 30.0, 20.0, TEST_FAN, {27, 27, 27}},
    {{41, 70, 53}, {0.5, 0.5, 0.55}, 45.0, 35.0, TEST_FAN, {51, 51, 49}},
    {{90, 33, 20}, {0.5, 0.5, 0.55}, -20.0, 80.0, TEST_FAN, {27, 27, 18}},
    {{64, 64, 64}, {0.5, 0.5, 0.55}, 137.0, -61.0, TEST_CORNER, {33, 33, 30}},
    {{41, 70, 53}, {0.5, 0.5, 0.55}, 180.0, 3.0, TEST_CORNER, {21, 21, 18}},
    {{21, 21, 17}, {0.7, 0.7, 0.7}, 0.0, 0.0, TEST_SPARSE, {21, 21, 17}},
    {{20, 14, 16}, {1.0, 1.0, 1.0}, 0.0, 0.0, TEST_SPARSE, {20, 20, 16}},
    {{20, 14, 16}, {1.0, 1.0, 1.0}, 90.0, 0.0, TEST_NOISE, {16, 16, 20}},
    {{20, 13, 16}, {1.0, 1.0, 1.0}, 0.0, 0.0, TEST_SPARSE, {20, 20, 16}},
};
#define CASES (sizeof cases / sizeof cases[0])

static hs_slab_layout plain_layout(const uint32_t lowres[3]) {
    hs_slab_layout layout = {lowres[0], lowres[1], lowres[2], lowres[2], 1, lowres[0], lowres[1], lowres[0]};
    return layout;
}

static hs_volume make_case(const convert_case *c, uint32_t seed, hs_camera *camera) {
    test_random random = {seed};
    hs_volume volume = test_volume(&random, c->pattern, c->size, c->spacing);
    hs_camera_look(camera, &volume, c->yaw, c->pitch);
    return volume;
}

/* Of slices one behind the other, as plain_layout has them. */
static void check_ranges(const hs_slab_layout *l, const uint8_t *voxels, const cl_ushort2 *ranges,
                         size_t index) {
    const size_t rays = (size_t)l->width * l->height;
    for (size_t ray = 0; ray < rays; ray++) {
        uint32_t first = 0, end = l->slices;
        while (first < end && voxels[first * rays + ray] == 0) first++;
        while (first < end && voxels[(end - 1) * rays + ray] == 0) end--;
        if (ranges[ray].s[0] != first || ranges[ray].s[1] != end)
            fail_msg("case %zu, ray %zu: scanned %u .. %u, expected %u .. %u", index, ray, ranges[ray].s[0],
                     ranges[ray].s[1], first, end);
    }
}

/*
 * Nearest: the same bytes, unless a sample lies within 1e-4 voxel of the border between two voxels (positions
 * have 16 fraction bits and are the sum of four rounded terms: at most 6e-5). Trilinear: float sums, 0.01
 * level and half a level of rounding. Halved: the same bytes, unless a fraction lies within 2e-3 of the
 * border between two 1/256 (positions are good to 2e-6 halved voxel, 5e-4 of a 1/256): 4e-3 of the samples
 * for each axis, and 1.3e-2 for all is the limit. Voxels with a closer decision are counted: each of three
 * axes has a border within 1e-4 of 2e-4 of the samples, so 6e-4 of a voxel's samples are expected, and 1e-3,
 * with 2 % for the faces, is the limit.
 */
static void check_against_reference(const hs_cl *cl, size_t index) {
    const convert_case *c = &cases[index];
    hs_camera camera;
    hs_volume volume = make_case(c, (uint32_t)(31 + index), &camera);
    const hs_slab_layout layout = plain_layout(c->lowres);
    const size_t count = (size_t)layout.width * layout.height * layout.slices;
    const test_slabs made = test_convert(cl, &volume, &camera, &layout, 0, count);
    const uint8_t *out = made.voxels;
    int grid[3];
    check_ranges(&layout, out, made.ranges, index);
    const ref_way way = ref_grid(&volume, &camera, &layout, grid);
    size_t close = 0;
    for (size_t i = 0; i < count; i++) {
        ref_lowres expected = ref_convert_voxel(&volume, &camera, &layout, (uint32_t)(i % layout.width),
                                                (uint32_t)(i / layout.width % layout.height),
                                                (uint32_t)(i / layout.width / layout.height));
        if (expected.margin < 1e-4) {
            close++;
            continue;
        }
        bool same = way != REF_TRILINEAR || out[i] == 0 || expected.value == 0
                        ? out[i] == expected.value
                        : fabs(out[i] - fmax(expected.mean, 1.0)) <= 0.51;
        if (!same) {
            fail_msg("case %zu, voxel %zu: %d, expected %d (mean %.4f, margin %.2g)", index, i, out[i],
                     expected.value, expected.mean, expected.margin);
        }
    }
    const double likely = way == REF_HALVED ? 1.3e-2 : 1e-3;
    if ((double)close > (0.02 + likely * grid[0] * grid[1] * grid[2]) * (double)count)
        fail_msg("case %zu: %zu of %zu voxels skipped", index, close, count);
}

static void test_matches_definition(void **state) {
    for (size_t i = 0; i < CASES; i++) check_against_reference(*state, i);
}

/* All ways of sampling must have been tested, with still and turned cameras. */
static void test_cases_cover_all_ways(void **state) {
    int still[3] = {0}, turned[3] = {0}, shared = 0;
    for (size_t i = 0; i < CASES; i++) {
        hs_camera camera;
        hs_volume volume = make_case(&cases[i], 1, &camera);
        const hs_slab_layout layout = plain_layout(cases[i].lowres);
        int grid[3];
        const ref_way way = ref_grid(&volume, &camera, &layout, grid);
        const bool straight = cases[i].yaw == 0.0 && cases[i].pitch == 0.0;
        (straight ? still : turned)[way]++;
        shared += way == REF_HALVED && grid[0] > 1 && grid[1] > 1 && grid[2] > 1;
    }
    assert_true(still[REF_HALVED] >= 2 && turned[REF_HALVED] >= 3 && shared >= 1);
    assert_true(still[REF_NEAREST] >= 1 && turned[REF_NEAREST] >= 2);
    assert_true(still[REF_TRILINEAR] + turned[REF_TRILINEAR] >= 4);
}

/* A mean over the box: on a linear field it is the value at the box' centre. */
static void test_linear_field_keeps_its_place(void **state) {
    const uint32_t size[3] = {60, 60, 60}, lowres[3] = {20, 20, 20};
    hs_volume volume;
    must(hs_volume_init(&volume, size[0], size[1], size[2], &err));
    for (size_t i = 0; i < hs_volume_count(&volume); i++) {
        volume.voxels[i] = (uint8_t)(10 + i % 60 + 2 * (i / 60 % 60) + i / 3600);
    }
    const double angles[2][2] = {{0.0, 0.0}, {25.0, -15.0}};
    for (int view = 0; view < 2; view++) {
        hs_camera camera;
        hs_camera_look(&camera, &volume, angles[view][0], angles[view][1]);
        const hs_slab_layout layout = plain_layout(lowres);
        uint8_t *out = test_convert(*state, &volume, &camera, &layout, 0, 8000).voxels;
        for (uint32_t i = 0; i < 8000; i++) {
            const double box[3] = {(i % 20 + 0.5) / 20.0, (i / 20 % 20 + 0.5) / 20.0, (i / 400 + 0.5) / 20.0};
            double p[3];
            ref_position(&volume, &camera, box, p);
            bool well_inside = true;
            for (int k = 0; k < 3; k++) well_inside = well_inside && p[k] > 4.0 && p[k] < 55.0;
            if (!well_inside) continue;
            /* Straight, samples are voxel centres: exact. Turned, each is off by up to half a
             * voxel per axis, 2 levels of gradient at most, averaged over 27: below 0.75 level,
             * and half a level of rounding. */
            double bound = view == 0 ? 0.5 : 1.25, expected = 10.0 + p[0] + 2.0 * p[1] + p[2];
            if (fabs(out[i] - expected) > bound)
                fail_msg("view %d, voxel %u: %d, expected %.3f", view, i, out[i], expected);
        }
    }
    hs_volume_free(&volume);
}

/* Byte of voxel (x, y) of slice s in a slab, from the drawing in smartvis_plugin.h. */
static size_t slab_byte(const hs_slab_layout *l, uint32_t x, uint32_t y, uint32_t s) {
    return ((size_t)(s / l->tiles_x) * l->tile_h + y) * l->row_pitch + (size_t)(s % l->tiles_x) * l->tile_w +
           x;
}

static void check_layout_case(const hs_cl *cl, size_t index, const hs_slab_layout *l, size_t offset) {
    hs_camera camera;
    hs_volume volume = make_case(&cases[index], 7, &camera);
    const hs_slab_layout plain = plain_layout(cases[index].lowres);
    const size_t count = (size_t)plain.width * plain.height * plain.slices;
    uint8_t *expected = test_convert(cl, &volume, &camera, &plain, 0, count).voxels;
    const size_t stride = hs_slab_bytes(l, l->slab_slices) + 13; /* 13 bytes nobody may touch */
    const test_slabs made = test_convert(cl, &volume, &camera, l, offset, stride);
    const uint8_t *out = made.voxels;
    if (made.ranges) check_ranges(l, expected, made.ranges, index);
    const size_t bytes = offset + stride * hs_slab_count(l);
    uint8_t *want = unit_memory(bytes);
    memset(want, TEST_GUARD, bytes);
    uint32_t first = 0;
    for (uint32_t slab = 0; slab < hs_slab_count(l); slab++) {
        for (uint32_t s = 0; s < hs_slab_length(l, slab); s++) {
            for (uint32_t y = 0; y < l->height; y++) {
                for (uint32_t x = 0; x < l->width; x++) {
                    want[offset + slab * stride + slab_byte(l, x, y, s)] =
                        expected[((size_t)(first + s) * l->height + y) * l->width + x];
                }
            }
        }
        first += hs_slab_length(l, slab);
    }
    assert_int_equal(first, l->slices);
    for (size_t i = 0; i < bytes; i++) {
        if (out[i] != want[i]) fail_msg("case %zu, byte %zu: %d, expected %d", index, i, out[i], want[i]);
    }
}

/* Every split into slabs and every tiling holds the same voxels, and nothing else is written. */
static void test_layouts(void **state) {
    const size_t chosen[] = {0, 1, 2, 5, 7, 9, 19, 22};
    for (size_t i = 0; i < sizeof chosen / sizeof chosen[0]; i++) {
        const uint32_t *n = cases[chosen[i]].lowres;
        const hs_slab_layout layouts[] = {
            {n[0], n[1], n[2], 1, 1, n[0], n[1], n[0]},
            {n[0], n[1], n[2], n[2], 3, n[0], n[1], 3 * n[0]},
            {n[0], n[1], n[2], (n[2] + 2) / 3, 2, n[0] + 5, n[1] + 1, 2 * n[0] + 10},
            {n[0], n[1], n[2], (n[2] + 1) / 2, 5, n[0] + 16, n[1], 5 * (n[0] + 16) + 7},
            {n[0], n[1], n[2], n[2], n[2] + 2, n[0], n[1] + 3, (n[2] + 2) * n[0] + 1},
        };
        for (size_t j = 0; j < sizeof layouts / sizeof layouts[0]; j++) {
            check_layout_case(*state, chosen[i], &layouts[j], j % 2 ? 0 : 37);
        }
    }
}

static void assert_refused(const hs_cl *cl, hs_slab_layout layout, const char *field) {
    must_not(hs_scan_converter_create(cl, &layout, &err), HS_ERR_USAGE, field);
}

static void test_impossible_layouts_are_refused(void **state) {
    assert_refused(*state, (hs_slab_layout){0, 8, 8, 8, 1, 8, 8, 8}, "width");
    assert_refused(*state, (hs_slab_layout){8, 8, 0, 1, 1, 8, 8, 8}, "slices");
    assert_refused(*state, (hs_slab_layout){8, 8, 8, 9, 1, 8, 8, 8}, "slab_slices");
    assert_refused(*state, (hs_slab_layout){8, 8, 8, 0, 1, 8, 8, 8}, "slab_slices");
    assert_refused(*state, (hs_slab_layout){8, 8, 8, 8, 0, 8, 8, 8}, "tiles_x");
    assert_refused(*state, (hs_slab_layout){8, 8, 8, 8, 2, 7, 8, 16}, "tile_w");
    assert_refused(*state, (hs_slab_layout){8, 8, 8, 8, 2, 8, 7, 16}, "tile_h");
    assert_refused(*state, (hs_slab_layout){8, 8, 8, 8, 2, 8, 8, 15}, "row_pitch");
}

/* A replaced volume gives what a fresh one gives, host buffers that come again and ones that push others
 * out too. */
static void test_replace(void **state) {
    enum { VOLUMES = 11 };
    const convert_case *c = &cases[2];
    hs_error err = {HS_OK, ""};
    hs_volume volumes[VOLUMES];
    uint8_t *expected[VOLUMES];
    hs_camera camera;
    const hs_slab_layout layout = plain_layout(c->lowres);
    const size_t count = (size_t)layout.width * layout.height * layout.slices;
    for (uint32_t i = 0; i < VOLUMES; i++) {
        volumes[i] = make_case(c, 100 + i, &camera);
        expected[i] = test_convert(*state, &volumes[i], &camera, &layout, 0, count).voxels;
    }
    hs_device_volume *source = hs_device_volume_create(*state, &volumes[0], &err);
    hs_scan_converter *converter = hs_scan_converter_create(*state, &layout, &err);
    if (!source || !converter) fail_msg("%s", err.text);
    cl_mem slab = test_buffer(*state, count, NULL);
    uint8_t *out = unit_memory(count);
    for (uint32_t turn = 0; turn < 3 * VOLUMES; turn++) {
        uint32_t i = turn < VOLUMES ? turn : turn * 7 % 5; /* all once, then a few in turn */
        if (!hs_device_volume_replace(source, &volumes[i], &err) ||
            !hs_scan_convert_slab(converter, source, &camera, 0, slab, 0, NULL, &err)) {
            fail_msg("%s", err.text);
        }
        test_read(*state, slab, count, out);
        assert_memory_equal(out, expected[i], count);
    }
    hs_volume other = volumes[0];
    other.nx--;
    assert_false(hs_device_volume_replace(source, &other, &err));
    assert_int_equal(err.code, HS_ERR_INPUT);
    clReleaseMemObject(slab);
    hs_scan_converter_destroy(converter);
    hs_device_volume_destroy(source);
}

HOST_MAIN(test_matches_definition, test_cases_cover_all_ways, test_linear_field_keeps_its_place, test_layouts,
          test_impossible_layouts_are_refused, test_replace)
