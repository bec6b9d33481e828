/* SPDX-License-Identifier: MIT */
/* The camera: axes, the box around the volume, and the map from the box to voxel indices. */
#include "support/host_fixture.h"

#include "render/camera.h"
#include "support/near.h"

#include <math.h>

/* Doubles of size 1 .. 1000, a dozen operations each: 1e-12 is a hundred times their rounding. */
#define TOLERANCE 1e-12

static hs_volume shape(uint32_t nx, uint32_t ny, uint32_t nz, double sx, double sy, double sz) {
    hs_volume volume = {.nx = nx, .ny = ny, .nz = nz, .spacing = {sx, sy, sz}};
    return volume;
}

static void test_straight_view_is_the_volume(void **state) {
    const hs_volume volume = shape(10, 20, 30, 1.0, 0.5, 2.0);
    hs_camera camera;
    hs_camera_look(&camera, &volume, 0.0, 0.0);
    for (int i = 0; i < 9; i++) assert_true(camera.rotation[i] == (i % 4 == 0 ? 1.0 : 0.0));
    assert_near(camera.extent, 10.0, TOLERANCE); /* max(10 * 1, 20 * 0.5) mm */
    assert_near(camera.depth_extent, 60.0, TOLERANCE);
    hs_box_map map;
    hs_camera_box_map(&camera, &volume, &map);
    /* Slice s of 30 has its centre at (s + 0.5) / 30: voxel index s exactly. */
    for (int s = 0; s < 30; s++)
        assert_near(map.origin[2] + (s + 0.5) / 30.0 * map.dw[2], s, TOLERANCE * 100.0);
    assert_near(map.origin[0], -0.5, TOLERANCE);
    assert_near(map.du[0], 10.0, TOLERANCE);
    assert_near(map.origin[1], -0.5, TOLERANCE);
    assert_near(map.dv[1], 20.0, TOLERANCE);
}

/* Columns are an orthonormal right-handed frame, and the view direction is the documented one. */
static void test_axes(void **state) {
    const hs_volume volume = shape(8, 8, 8, 1.0, 1.0, 1.0);
    for (double yaw = -270.0; yaw <= 360.0; yaw += 22.5) {
        for (double pitch = -180.0; pitch <= 180.0; pitch += 15.0) {
            hs_camera camera;
            hs_camera_look(&camera, &volume, yaw, pitch);
            const double *r = camera.rotation;
            for (int a = 0; a < 3; a++) {
                for (int b = 0; b < 3; b++) {
                    assert_near(r[a] * r[b] + r[3 + a] * r[3 + b] + r[6 + a] * r[6 + b], a == b, TOLERANCE);
                }
            }
            assert_near(r[0] * (r[4] * r[8] - r[5] * r[7]) - r[1] * (r[3] * r[8] - r[5] * r[6]) +
                            r[2] * (r[3] * r[7] - r[4] * r[6]),
                        1.0, TOLERANCE);
            const double y = yaw * 3.14159265358979323846 / 180.0, p = pitch * 3.14159265358979323846 / 180.0;
            assert_near(r[2], sin(y) * cos(p), TOLERANCE);
            assert_near(r[5], -sin(p), TOLERANCE);
            assert_near(r[8], cos(y) * cos(p), TOLERANCE);
        }
    }
}

/* Quarter turns have no residue, so that such views stay aligned with the voxels. */
static void test_quarter_turns_are_exact(void **state) {
    const hs_volume volume = shape(8, 9, 10, 1.0, 1.0, 1.0);
    for (int yaw = -4; yaw <= 4; yaw++) {
        for (int pitch = -4; pitch <= 4; pitch++) {
            hs_camera camera;
            hs_camera_look(&camera, &volume, yaw * 90.0, pitch * 90.0);
            for (int i = 0; i < 9; i++) {
                double v = camera.rotation[i];
                assert_true(v == 0.0 || v == 1.0 || v == -1.0);
            }
        }
    }
}

/* Every corner of the volume lies in the box, and some corner on each of its depth faces: it is the
 * smallest. */
static void test_box_holds_the_volume(void **state) {
    const hs_volume volume = shape(40, 25, 31, 1.0, 0.7, 2.3);
    const double size[3] = {40.0, 25.0 * 0.7, 31.0 * 2.3};
    test_random random = {9};
    for (int round = 0; round < 50; round++) {
        hs_camera camera;
        hs_camera_look(&camera, &volume, test_uniform(&random, -180.0, 180.0),
                       test_uniform(&random, -90.0, 90.0));
        hs_camera_roll(&camera, &volume, round % 2 ? test_uniform(&random, -180.0, 180.0) : 0.0);
        double reach[3] = {0.0, 0.0, 0.0};
        for (int corner = 0; corner < 8; corner++) {
            for (int axis = 0; axis < 3; axis++) {
                double along = 0.0;
                for (int k = 0; k < 3; k++) {
                    along += camera.rotation[k * 3 + axis] * size[k] * (corner >> k & 1 ? 0.5 : -0.5);
                }
                reach[axis] = fmax(reach[axis], fabs(along));
            }
        }
        assert_near(2.0 * fmax(reach[0], reach[1]), camera.extent, 1e-10);
        assert_near(2.0 * reach[2], camera.depth_extent, 1e-10);
    }
}

/* A quarter roll clockwise: what was to the right is below, and the camera looks where it looked. */
static void test_roll_is_clockwise(void **state) {
    const hs_volume volume = shape(10, 20, 60, 1.0, 1.0, 1.0);
    hs_camera straight, rolled;
    hs_camera_look(&straight, &volume, 30.0, -20.0);
    rolled = straight;
    hs_camera_roll(&rolled, &volume, 90.0);
    for (int k = 0; k < 3; k++) {
        const double *was = straight.rotation + (size_t)k * 3, *is = rolled.rotation + (size_t)k * 3;
        assert_near(is[1], was[0], 1e-15);
        assert_near(is[0], -was[1], 1e-15);
        assert_near(is[2], was[2], 0.0);
    }
    assert_near(rolled.extent, straight.extent, 1e-12);
}

static void test_merged_box_holds_both(void **state) {
    const hs_volume volume = shape(10, 20, 60, 1.0, 1.0, 1.0);
    hs_camera front, side;
    hs_camera_look(&front, &volume, 0.0, 0.0); /* 20 wide, 60 deep */
    hs_camera_look(&side, &volume, 90.0, 0.0); /* 60 wide, 10 deep */
    hs_camera_merge_box(&side, &front);
    assert_near(side.extent, 60.0, TOLERANCE * 100.0);
    assert_near(side.depth_extent, 60.0, TOLERANCE * 100.0);
    assert_true(side.rotation[2] == 1.0); /* the view itself is kept */
}

UNIT_MAIN(NULL, NULL, test_straight_view_is_the_volume, test_axes, test_quarter_turns_are_exact,
          test_box_holds_the_volume, test_roll_is_clockwise, test_merged_box_holds_both)
