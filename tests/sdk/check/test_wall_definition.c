/* SPDX-License-Identifier: MIT */
/*
 * The surface told by the wall (docs/surface.md), as scalar C, on volumes whose answer is known: a wall,
 * fluid, and a fetus with bright bone. What moves or turns the scan must move or turn the surface; what
 * brightens it: test_wall_invariance.
 * Requirement: R1.
 */
#include "support/wall_fixture.h"

static void test_stands_between_wall_and_fetus(void **state) {
    scan s = scene();
    scan_run(&s);
    assert_int_equal(s.outcome, SV_WALL_SURFACE);
    assert_int_equal(s.facts.rays, RAYS);
    assert_in_range(s.facts.wall_rays, RAYS * 9 / 10, RAYS);
    assert_true(s.facts.wall > MUSCLE * 0.9 && s.facts.wall < MUSCLE * 1.25);
    uint32_t rays = 0;
    for (uint32_t y = 0; y < N; y++)
        for (uint32_t x = 0; x < N; x++) {
            const float depth = s.depth[y * N + x];
            if (skin(x, y) >= GAP + 6) continue; /* the ball's rim */
            rays++;
            assert_true(depth > WALL - 1.0f && depth <= (float)skin(x, y));
            assert_true(s.confidence[y * N + x] > 0.9f);
        }
    assert_in_range(rays, 200, 600);
}

/* Scans `from` through a permutation of its pixels. */
static scan turned(const scan *from, bool mirror_x, bool mirror_y, bool transpose) {
    scan s = scan_make(transpose ? from->height : from->width, transpose ? from->width : from->height,
                       from->slices);
    for (uint32_t z = 0; z < s.slices; z++)
        for (uint32_t y = 0; y < s.height; y++)
            for (uint32_t x = 0; x < s.width; x++) {
                const uint32_t u = mirror_x ? s.width - 1 - x : x, v = mirror_y ? s.height - 1 - y : y;
                s.voxels[at(&s, x, y, z)] = from->voxels[at(from, transpose ? v : u, transpose ? u : v, z)];
            }
    scan_run(&s);
    return s;
}

static void assert_turned(const scan *from, bool mirror_x, bool mirror_y, bool transpose) {
    scan s = turned(from, mirror_x, mirror_y, transpose);
    for (uint32_t y = 0; y < s.height; y++)
        for (uint32_t x = 0; x < s.width; x++) {
            const uint32_t u = mirror_x ? s.width - 1 - x : x, v = mirror_y ? s.height - 1 - y : y;
            const size_t here = (size_t)y * s.width + x,
                         there = (size_t)(transpose ? u : v) * from->width + (transpose ? v : u);
            assert_memory_equal(&s.depth[here], &from->depth[there], sizeof(float));
            assert_memory_equal(&s.confidence[here], &from->confidence[there], sizeof(float));
        }
}

/* A picture of 63 x 50 pixels is no whole number of cells: the cells must still be laid the same from both
 * sides. */
static void test_mirrored_and_transposed(void **state) {
    const uint32_t sizes[2][2] = {{N, N}, {63, 50}};
    for (int i = 0; i < 2; i++) {
        scan s = scan_make(sizes[i][0], sizes[i][1], N);
        draw(&s, WALL, GAP, true);
        scan_run(&s);
        assert_int_equal(s.outcome, SV_WALL_SURFACE);
        assert_turned(&s, true, false, false);
        assert_turned(&s, false, true, false);
        assert_turned(&s, false, false, true);
    }
}

static void test_room_in_front_moves_it(void **state) {
    enum { ROOM = 8 };
    scan s = scene(), far = scan_make(N, N, N + ROOM);
    memset(far.voxels, 255, (size_t)PIXELS * ROOM); /* not scanned: never read */
    memcpy(far.voxels + (size_t)PIXELS * ROOM, s.voxels, (size_t)PIXELS * N);
    for (size_t i = 0; i < PIXELS; i++) far.first[i] = ROOM;
    scan_run(&s);
    scan_run(&far);
    for (size_t i = 0; i < PIXELS; i++) {
        assert_true(fabsf(far.depth[i] - s.depth[i] - ROOM) < 1e-4f);
        assert_memory_equal(&far.confidence[i], &s.confidence[i], sizeof(float));
    }
}

static double mean_change(const scan *a, const scan *b) {
    double sum = 0.0;
    for (uint32_t y = 4; y < N - 4; y++)
        for (uint32_t x = 4; x < N - 4; x++) sum += fabs((double)(a->depth[y * N + x] - b->depth[y * N + x]));
    return sum / ((N - 8) * (N - 8));
}

/* Without tissue in front of the fetus none of the fetus may be cut. */
static void test_bare_fetus(void **state) {
    scan s = scan_make(N, N, N);
    draw(&s, 0, GAP, true);
    scan_run(&s);
    assert_int_equal(s.facts.wall_rays, 0);
    for (uint32_t y = 0; y < N; y++)
        for (uint32_t x = 0; x < N; x++)
            if (skin(x, y) < GAP + 6) assert_true(s.depth[y * N + x] <= (float)skin(x, y));
}

/* A bare fetus is not cut if its skin is dim and the tissue behind is bright, as with a head in black fluid:
 * no tissue lies in front of that fluid, so nothing hides the fetus. */
static void test_bare_and_dim(void **state) {
    enum { FRONT = 20, HOLLOW = 26, BACK = 34, DEEP = 42 };
    scan s = scan_make(N, N, N);
    for (uint32_t z = FRONT; z < N; z++)
        for (uint32_t y = 0; y < N; y++)
            for (uint32_t x = 0; x < N; x++) {
                const double level = z >= HOLLOW && z < BACK ? 0.0 : z >= BACK && z < DEEP ? BONE : FLESH;
                s.voxels[at(&s, x, y, z)] = (uint8_t)(level * grain(x, y, z) + 0.5);
            }
    scan_run(&s);
    assert_int_equal(s.outcome, SV_WALL_OPEN);
    assert_true(s.facts.gap_share < 0.12);
    for (size_t i = 0; i < PIXELS; i++) assert_true(s.depth[i] == 0.0f && s.confidence[i] == 0.0f);
}

/* Flesh begins where the scan does, with dark shadows beside it and a hollow in it: there is no wall, and no
 * fluid in front. */
static void test_touching(void **state) {
    scan s = scan_make(N, N, N);
    for (uint32_t z = 0; z < N; z++)
        for (uint32_t y = 0; y < N; y++)
            for (uint32_t x = N / 2; x < N; x++) {
                const bool hollow = x >= 50 && x < 58 && y >= 20 && y < 50 && z >= 20 && z < 30;
                s.voxels[at(&s, x, y, z)] = (uint8_t)((hollow ? FLUID : FLESH) * grain(x, y, z));
            }
    scan_run(&s);
    printf("begins in a wall: %.1f %%\n", 100.0 * s.facts.wall_rays / s.facts.rays);
    for (uint32_t y = 4; y < N - 4; y++)
        for (uint32_t x = N / 2 + 4; x < N - 4; x++) assert_true(s.depth[y * N + x] < 2.0f);
}

/* Runs the scan and checks that the outcome is `expected` and the maps are 0. */
static void assert_clips_nothing(scan *s, sv_wall_outcome expected) {
    scan_run(s);
    assert_int_equal(s->outcome, expected);
    for (size_t i = 0; i < (size_t)s->width * s->height; i++)
        assert_true(s->depth[i] == 0.0f && s->confidence[i] == 0.0f);
}

/* All is tissue, from dark to bright without a gap: there is no fluid for the surface. */
static void test_no_fluid(void **state) {
    scan s = scan_make(N, N, N);
    for (uint32_t z = 0; z < N; z++)
        for (uint32_t y = 0; y < N; y++)
            for (uint32_t x = 0; x < N; x++) {
                const double level = 40.0 + 40.0 * (double)(x + y + z) / N;
                s.voxels[at(&s, x, y, z)] = (uint8_t)(level * grain(x, y, z));
            }
    assert_clips_nothing(&s, SV_WALL_NO_FLUID);
}

/* The scene with fluid from dark at one side to more than half as bright as tissue at the other. */
static scan hazy(void) {
    scan s = scene();
    for (uint32_t z = WALL; z < N; z++)
        for (uint32_t y = 0; y < N; y++)
            for (uint32_t x = 0; x < N; x++) {
                uint8_t *const voxel = &s.voxels[at(&s, x, y, z)];
                if (*voxel < 2 * FLUID)
                    *voxel = (uint8_t)((10.0 + 40.0 * sqrt((double)y / N)) * grain(x, y, z));
            }
    return s;
}

/* Haze fills the histogram up to the tissue, but the surface lies in what is dark. */
static void test_haze(void **state) {
    scan s = hazy();
    scan_run(&s);
    assert_true(s.facts.gap_share > 0.9);
    assert_in_range(s.facts.wall_rays, RAYS * 3 / 4, RAYS);
    assert_int_equal(s.outcome, SV_WALL_SURFACE);
    for (uint32_t y = 0; y < N; y++)
        for (uint32_t x = 0; x < N; x++)
            if (skin(x, y) < GAP + 6)
                assert_true(s.depth[y * N + x] > WALL - 1.0f && s.depth[y * N + x] <= (float)skin(x, y));
}

/* Voxels are as long as a block, each with speckle of its own. Dark ones do not split the wall. */
static void test_speckle(void **state) {
    static const double speckle[8] = {0.3, 0.4, 0.6, 0.8, 1.0, 1.2, 1.6, 2.0};
    scan s = scene();
    for (size_t i = 0; i < (size_t)PIXELS * WALL; i++)
        s.voxels[i] = (uint8_t)(MUSCLE * speckle[(i * 2654435761u >> 16) % 8]);
    scan_run(&s);
    assert_int_equal(s.outcome, SV_WALL_SURFACE);
    uint32_t rays = 0;
    for (size_t i = 0; i < PIXELS; i++) rays += s.depth[i] > WALL - 1.0f;
    assert_in_range(rays, PIXELS * 98 / 100, PIXELS);
}

/* An empty sac: the surface lies in it, behind the wall and before the back. */
static void test_no_fetus(void **state) {
    scan s = scan_make(N, N, N);
    draw(&s, WALL, GAP, false);
    scan_run(&s);
    assert_int_equal(s.outcome, SV_WALL_SURFACE);
    for (size_t i = 0; i < PIXELS; i++) assert_true(s.depth[i] > WALL - 1.0f && s.depth[i] < 58.0f);
}

/* The wall is brighter than all behind it, and the body has no bone. Behind clear fluid it is kept all the
 * same. If more of the fluid lies behind it, nobody knows what to keep, and nothing is clipped. */
static void test_nothing_brighter_than_the_wall(void **state) {
    enum { LAKE = 34 }; /* slices from here on are fluid behind the body */
    scan s = scan_make(N, N, N);
    draw(&s, WALL, GAP, true);
    for (size_t i = 0; i < (size_t)PIXELS * N; i++)
        s.voxels[i] = (uint8_t)(i < (size_t)PIXELS * WALL ? 200 : s.voxels[i] > 60 ? 60 : s.voxels[i]);
    scan_run(&s);
    assert_int_equal(s.outcome, SV_WALL_SURFACE);
    assert_true(s.facts.fetus < 0.01);
    memset(s.voxels + (size_t)PIXELS * LAKE, FLUID / 2, (size_t)PIXELS * (N - LAKE));
    assert_clips_nothing(&s, SV_WALL_NO_FETUS);
    assert_true(s.facts.fetus < 0.01);
}

static void test_empty(void **state) {
    scan black = scan_make(9, 7, 20), flat = scan_make(9, 7, 20), outside = scene();
    memset(flat.voxels, 77, 9 * 7 * 20);
    for (size_t i = 0; i < PIXELS; i++) outside.first[i] = outside.end[i] = N / 2;
    assert_clips_nothing(&black, SV_WALL_EMPTY);
    assert_clips_nothing(&outside, SV_WALL_EMPTY);
    assert_clips_nothing(&flat, SV_WALL_EMPTY);
}

static void test_small(void **state) {
    const uint32_t sizes[][3] = {{1, 1, 1}, {1, 1, 64}, {2, 3, 64}, {64, 64, 1}, {64, 1, 40}, {5, 64, 3}};
    for (size_t i = 0; i < sizeof sizes / sizeof *sizes; i++) {
        scan s = scan_make(sizes[i][0], sizes[i][1], sizes[i][2]);
        draw(&s, WALL, GAP, true);
        scan_run(&s);
    }
}

/* Rays that were not scanned cost nothing: their neighbours decide. */
static void test_unscanned_rays(void **state) {
    scan s = scene(), holes = scene();
    for (uint32_t y = 3; y < N; y += 7)
        for (uint32_t x = 3; x < N; x += 7) holes.end[y * N + x] = 0;
    scan_run(&s);
    scan_run(&holes);
    assert_int_equal(holes.facts.rays, RAYS - 9 * 9 * 16); /* a pixel lies in the blocks of 4 x 4 rays */
    const double change = mean_change(&s, &holes);
    printf("a pixel in every 7 x 7 not scanned: %.3f slices\n", change);
    assert_true(change <= 1.0);
}

static void test_everything_scanned(void **state) {
    scan s = scene();
    scan_run(&s);
    float depth[PIXELS], confidence[PIXELS];
    sv_wall_outcome outcome;
    const sv_wall_volume v = {s.voxels, N, N, N, NULL, NULL, {0.0, 0.0, 0.0}, NULL};
    assert_true(
        sv_wall_surface(&v, NULL, depth, confidence, &outcome, NULL)); /* 120 mm / 64 is this spacing */
    assert_memory_equal(depth, s.depth, sizeof depth);
    assert_memory_equal(confidence, s.confidence, sizeof confidence);
}

static void assert_refused(sv_wall_volume v, const char *field, const char *value) {
    char text[160] = "";
    float map[4] = {7.0f, 7.0f, 7.0f, 7.0f};
    sv_wall_outcome outcome;
    assert_false(sv_wall_check(&v, text, sizeof text));
    assert_non_null(strstr(text, field));
    assert_non_null(strstr(text, value));
    assert_false(sv_wall_surface(&v, NULL, map, map, &outcome, NULL));
    assert_true(map[0] == 7.0f);
}

/* The weights of a pixel between four rays are rounded, and where all four are sure they may add up to more
 * than 1: hosts refuse such a map. */
static void test_confidence_is_in_range(void **state) {
    enum { SCANNED = 45 }; /* columns; outside of them the confidence is 1 */
    for (uint32_t side = 55; side < 75; side += 2) {
        scan s = scan_make(side, side, N);
        const size_t plane = (size_t)side * side;
        draw(&s, WALL, GAP, true);
        for (size_t i = 0; i < plane; i++) s.end[i] = i % side < SCANNED ? N : 0;
        const sv_wall_volume v = {s.voxels, side, side, N, s.first, s.end, {MM / 2.0, MM / 2.0, MM}, NULL};
        assert_true(sv_wall_surface(&v, NULL, s.depth, s.confidence, &s.outcome, NULL));
        assert_int_equal(s.outcome, SV_WALL_SURFACE);
        for (size_t i = 0; i < plane; i++) assert_true(s.confidence[i] >= 0.0f && s.confidence[i] <= 1.0f);
    }
}

static void test_bad_input(void **state) {
    const uint8_t voxels[8] = {0};
    const uint16_t first[4] = {0, 0, 2, 0}, end[4] = {2, 2, 1, 2}, beyond[4] = {2, 2, 3, 2}, none[4] = {0};
    const sv_wall_volume good = {voxels, 2, 2, 2, NULL, NULL, {1.0, 1.0, 1.0}, NULL};
    char text[160];
    assert_true(sv_wall_check(&good, text, sizeof text));
    sv_wall_volume v = good;
    v.voxels = NULL;
    assert_refused(v, "voxels", "NULL");
    v = good;
    v.width = 0;
    assert_refused(v, "width", "0");
    v = good;
    v.slices = 8193;
    assert_refused(v, "slices", "8193");
    v = good;
    v.spacing_mm[1] = -1.0;
    assert_refused(v, "spacing_mm[1]", "-1");
    v = good;
    v.spacing_mm[2] = (double)NAN;
    assert_refused(v, "spacing_mm[2]", "nan");
    v = good;
    v.first = first;
    assert_refused(v, "end", "NULL");
    v.end = end;
    assert_refused(v, "ray (0, 1)", "first 2, end 1");
    v.first = none;
    v.end = beyond;
    assert_refused(v, "ray (0, 1)", "end 3");
}

UNIT_MAIN(NULL, NULL, test_stands_between_wall_and_fetus, test_mirrored_and_transposed,
          test_room_in_front_moves_it, test_bare_fetus, test_bare_and_dim, test_touching, test_no_fluid,
          test_haze, test_speckle, test_no_fetus, test_nothing_brighter_than_the_wall, test_empty, test_small,
          test_unscanned_rays, test_everything_scanned, test_confidence_is_in_range, test_bad_input)
