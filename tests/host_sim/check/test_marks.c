/* SPDX-License-Identifier: MIT */
/* A user's marks on a depthmap: rays of 40 slices of 1 mm whose runs of tissue are known. */
#include "support/host_fixture.h"

#include "loop/marks.h"

#include <math.h>
#include <string.h>

enum { SIDE = 12, DEEP = 40, FLUID = 10, TISSUE = 200 };

static uint8_t voxels[DEEP * SIDE * SIDE];
static float depth[SIDE * SIDE];
static const uint32_t n[3] = {SIDE, SIDE, DEEP};

/* Skin in slices 0 .. 4, a cord in 12 .. 17, a face from 25 on. */
static hs_volume cord_before_face(hs_camera *camera) {
    for (int z = 0; z < DEEP; z++)
        memset(voxels + z * SIDE * SIDE, z < 5 || (z >= 12 && z < 18) || z >= 25 ? TISSUE : FLUID,
               SIDE * SIDE);
    const hs_volume volume = {
        .nx = SIDE, .ny = SIDE, .nz = DEEP, .spacing = {1.0, 1.0, 1.0}, .voxels = voxels};
    hs_camera_look(camera, &volume, 0.0, 0.0);
    for (int i = 0; i < SIDE * SIDE; i++) depth[i] = 8.0f;
    return volume;
}

static void apply_all(const hs_mark *marks, uint32_t count) {
    hs_camera camera;
    const hs_volume volume = cord_before_face(&camera);
    must(hs_marks_apply(marks, count, &volume, &camera, n, depth, &err));
}

static void apply(double z, double radius, uint32_t keep) {
    apply_all(&(hs_mark){{6.0, 6.0, z}, radius, keep}, 1);
}

/* Every ray within the radius has `inside`, all others what they had. */
static void assert_disc(double radius, float inside) {
    for (int y = 0; y < SIDE; y++)
        for (int x = 0; x < SIDE; x++)
            assert_float_equal(depth[y * SIDE + x], hypot(x - 6, y - 6) <= radius ? inside : 8.0f, 0.0f);
}

static void test_remove_goes_to_the_next_tissue(void **state) {
    apply(12.0, 3.0, 0);
    assert_disc(3.0, 24.0f);
}

static void test_remove_leaves_the_last_tissue(void **state) {
    apply_all((const hs_mark[]){{{6.0, 6.0, 12.0}, 3.0, 0}, {{6.0, 6.0, 25.0}, 3.0, 0}}, 2);
    assert_disc(3.0, 24.0f);
}

/* What a mark may reach without it: the face is within two radii of the cord. */
static void test_a_stroke_takes_one_layer(void **state) {
    const hs_mark stroke[] = {{{6.0, 6.0, 12.0}, 7.0, 0}, {{6.0, 6.0, 13.0}, 7.0, 0}};
    hs_camera camera;
    const hs_volume volume = cord_before_face(&camera);
    memset(voxels + 36 * SIDE * SIDE, FLUID, 2 * SIDE * SIDE); /* the face ends, and something is behind it */
    must(hs_marks_apply(stroke, 2, &volume, &camera, n, depth, &err));
    assert_disc(7.0, 24.0f);
    cord_before_face(&camera);
    memset(voxels + 36 * SIDE * SIDE, FLUID, 2 * SIDE * SIDE);
    const hs_mark both[] = {stroke[0], {{6.0, 6.0, 24.0}, 7.0, 0}}; /* a second one, where the face is seen */
    must(hs_marks_apply(both, 2, &volume, &camera, n, depth, &err));
    assert_disc(7.0, 37.0f);
}

static void test_remove_works_where_it_is_seen(void **state) {
    apply(30.0, 3.0, 0); /* the cord is seen, 18 mm before the mark */
    assert_disc(3.0, 8.0f);
}

static void test_keep_brings_back_the_skin(void **state) {
    apply(2.0, 2.0, 1);
    assert_disc(2.0, 0.0f);
}

static void test_keep_after_remove(void **state) {
    apply_all((const hs_mark[]){{{6.0, 6.0, 12.0}, 3.0, 0}, {{6.0, 6.0, 15.0}, 3.0, 1}}, 2);
    assert_disc(3.0, 11.0f);
}

/* From behind the same mark is at the same place of the volume, seen at the other end of the rays. */
static void test_marks_turn_with_the_volume(void **state) {
    hs_camera camera;
    const hs_volume volume = cord_before_face(&camera);
    hs_camera_look(&camera, &volume, 180.0, 0.0);
    const hs_mark mark = {{6.0, 6.0, 17.0}, 1.0, 0};
    for (int i = 0; i < SIDE * SIDE; i++) depth[i] = 18.0f; /* behind the face, which ends at 15 of 40 */
    must(hs_marks_apply(&mark, 1, &volume, &camera, n, depth, &err));
    for (int y = 0; y < SIDE; y++)
        for (int x = 0; x < SIDE; x++) /* the skin begins at 35; x is reversed: 11 - 6 */
            assert_float_equal(depth[y * SIDE + x], hypot(x - 5, y - 6) <= 1.0 ? 34.0f : 18.0f, 0.0f);
}

/* What was cut last before the face is the cord, whose end is slice 17; what was cut first is the skin. */
static void test_what_was_cut_last(void **state) {
    hs_camera camera;
    const hs_volume volume = cord_before_face(&camera);
    hs_mark mark = {{6.0, 6.0, 30.0}, 3.0, 1};
    for (int i = 0; i < SIDE * SIDE; i++) depth[i] = 24.0f;
    assert_true(hs_marks_find_cut(&mark, &volume, &camera, n, depth));
    assert_true(mark.place[0] == 6.0 && mark.place[1] == 6.0 && fabs(mark.place[2] - 17.0) < 1e-9);
    for (int i = 0; i < SIDE * SIDE; i++) depth[i] = 2.0f; /* inside the skin */
    assert_true(hs_marks_find_cut(&mark, &volume, &camera, n, depth) && fabs(mark.place[2] - 2.0) < 1e-9);
    for (int i = 0; i < SIDE * SIDE; i++) depth[i] = 0.0f;
    assert_false(hs_marks_find_cut(&mark, &volume, &camera, n, depth));
    mark.place[0] = -2.0; /* beside the map */
    assert_false(hs_marks_find_cut(&mark, &volume, &camera, n, depth));
}

static void test_what_is_no_mark(void **state) {
    hs_camera camera;
    hs_error err = {0};
    const hs_volume volume = cord_before_face(&camera);
    const hs_mark bad[2] = {{{6.0, 6.0, 12.0}, 0.0, 0}, {{NAN, 6.0, 12.0}, 3.0, 0}};
    for (int i = 0; i < 2; i++) {
        assert_false(hs_marks_apply(&bad[i], 1, &volume, &camera, n, depth, &err));
        assert_int_equal(err.code, HS_ERR_USAGE);
    }
    assert_false(hs_marks_apply(bad, HS_MARKS_MAX + 1, &volume, &camera, n, depth, &err));
    assert_disc(0.0, 8.0f);
}

UNIT_MAIN(NULL, NULL, test_remove_goes_to_the_next_tissue, test_remove_leaves_the_last_tissue,
          test_a_stroke_takes_one_layer, test_remove_works_where_it_is_seen, test_keep_brings_back_the_skin,
          test_keep_after_remove, test_marks_turn_with_the_volume, test_what_was_cut_last,
          test_what_is_no_mark)
