/* SPDX-License-Identifier: MIT */
/*
 * Scan conversion against the exact mean of the source over every voxel's box, for a still and for turned
 * cameras: speckle in a fan, as a probe sees it. `build/sv_bench --only convert` prints the same for the
 * benchmark's volume.
 *
 * The bounds follow from the weights. A trilinear sample of the halved volume has the weights of a box of two
 * voxels convolved with a tent: [3, 3, 1, 1] / 8 along an axis where it lies a quarter between two of them,
 * as it does straight on. The box itself has [1, 1, 1] / 3. The difference of the two in three axes has a
 * root sum of squares of 0.134, so noise of a standard deviation of s is off by 0.134 s. Turned, the sample
 * lies anywhere between; next to a halved voxel it is the mean of eight voxels where the box has 27, and at
 * the edge of what was scanned it is the mean of eight nearest voxels: sqrt(1 / 8 - 1 / 27) s = 0.297 s at
 * most. s is 26 levels here: 0.297 * 26 = 7.7 RMS, 6.2 in the mean and 19.9 for 99 % of a normal
 * distribution.
 */
#include "eval/eval_box.h"
#include "support/host_fixture.h"

#include <math.h>

enum { SIZE = 72, SPREAD = 90 }; /* grey levels, even: a standard deviation of 26 */

/* Half as wide a fan at the front as at the back and 0 around it, or all of it scanned. */
static hs_volume make_volume(bool fan) {
    test_random random = {5};
    hs_error err = {0};
    hs_volume v;
    assert_true(hs_volume_init(&v, SIZE, SIZE, SIZE, &err));
    for (uint32_t i = 0; i < SIZE * SIZE * SIZE; i++) {
        const double x = i % SIZE - 0.5 * (SIZE - 1), z = i / (SIZE * SIZE);
        const bool scanned = !fan || fabs(x) < 0.25 * SIZE + 0.25 * z;
        const uint32_t noise = test_next(&random) % (SPREAD + 1);
        v.voxels[i] = (uint8_t)(scanned ? 70 + noise : 0);
    }
    return v;
}

static hs_box_error error_of(const hs_cl *cl, const hs_volume *v, double yaw, double pitch, double span) {
    hs_error err = {0};
    hs_camera camera;
    hs_box_error out;
    hs_camera_look(&camera, v, yaw, pitch);
    const uint32_t across = (uint32_t)lround(camera.extent / span),
                   deep = (uint32_t)lround(camera.depth_extent / span);
    const hs_slab_layout l = {across, across, deep, deep, 1, across, across, across};
    const size_t count = (size_t)across * across * deep;
    uint8_t *voxels = malloc(count);
    assert_non_null(voxels);
    cl_mem slab = test_buffer(cl, count, NULL);
    hs_device_volume *source = hs_device_volume_create(cl, v, &err);
    hs_scan_converter *converter = hs_scan_converter_create(cl, &l, &err);
    if (!source || !converter || !hs_scan_convert_slab(converter, source, &camera, 0, slab, 0, NULL, &err))
        fail_msg("%s", err.text);
    test_read(cl, slab, count, voxels);
    if (!hs_box_error_measure(v, &camera, &l, voxels, 7, &out, &err)) fail_msg("%s", err.text);
    clReleaseMemObject(slab);
    hs_scan_converter_destroy(converter);
    hs_device_volume_destroy(source);
    free(voxels);
    return out;
}

/* Of the voxels at the fan's edge, whose box is cut, some are scanned in one and not in the other: a layer
 * one voxel thick at most, and half a voxel in the mean. */
static void means_are_near_the_exact_ones(void **state) {
    static const struct {
        double yaw, pitch, span, limit; /* limit: of the RMS, of the noise's standard deviation */
        bool fan;
    } views[] = {{0, 0, 3, 0.134, false},  {0, 0, 3, 0.297, true},  {30, 20, 3, 0.297, true},
                 {45, 35, 3, 0.297, true}, {90, 0, 3, 0.297, true}, {-20, 80, 3.1, 0.297, true},
                 {15, 5, 4, 0.297, true}};
    for (size_t i = 0; i < sizeof views / sizeof *views; i++) {
        hs_volume v = make_volume(views[i].fan);
        const hs_box_error e = error_of(*state, &v, views[i].yaw, views[i].pitch, views[i].span);
        print_message(
            "%3g, %3g degrees, %g voxels%s: mean %.2f, RMS %.2f, 99 %% %.2f levels; %zu voxels, %zu "
            "disputed\n",
            views[i].yaw, views[i].pitch, views[i].span, views[i].fan ? ", a fan" : "", e.mean, e.rms, e.p99,
            e.voxels, e.disputed);
        assert_true(e.voxels > 500);
        assert_true(e.rms <= views[i].limit * 26.3 + 0.1); /* the noise's own spread, and rounding */
        assert_true(e.mean <= 6.2 && e.p99 <= 19.9);
        assert_true((double)e.disputed <= 0.05 * (double)e.voxels);
        hs_volume_free(&v);
    }
}

/* The measure can tell: a volume that is five levels too bright is five levels off. */
static void a_wrong_volume_is_told(void **state) {
    (void)state;
    hs_error err = {0};
    hs_volume v;
    hs_camera camera;
    hs_box_error e;
    uint8_t voxels[64];
    assert_true(hs_volume_init(&v, 12, 12, 12, &err));
    memset(v.voxels, 100, 12 * 12 * 12);
    memset(voxels, 105, sizeof voxels);
    voxels[7] = 0;
    hs_camera_look(&camera, &v, 0, 0);
    const hs_slab_layout l = {4, 4, 4, 4, 1, 4, 4, 4};
    assert_true(hs_box_error_measure(&v, &camera, &l, voxels, 1, &e, &err));
    assert_int_equal(e.voxels, 63);
    assert_int_equal(e.disputed, 1);
    assert_true(fabs(e.mean - 5) < 1e-9 && fabs(e.p99 - 5) < 1e-9 && fabs(e.rms - 5) < 1e-9);
    hs_volume_free(&v);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(means_are_near_the_exact_ones),
                                       cmocka_unit_test(a_wrong_volume_is_told)};
    return cmocka_run_group_tests(tests, test_open_device, test_close_device);
}
