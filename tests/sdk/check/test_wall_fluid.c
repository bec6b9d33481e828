/* SPDX-License-Identifier: MIT */
/*
 * What the surface told by the wall (docs/surface.md) takes for fluid, as scalar C: levels without a valley
 * that are two classes all the same; a bladder, which the wall encloses; the fluid in front of a finger; and
 * a limb that lies against the wall.
 */
#include "ref/ref_wall_steps.h"
#include "support/wall_fixture.h"

/* Tissue that fades from one side to the other has no mode of its own, and a quarter of the rays begin in
 * fluid. But fluid and tissue lie too far apart to be one class. */
static void test_fading_tissue(void **state) {
    scan s = scene();
    for (uint32_t z = 0; z < N; z++)
        for (uint32_t y = 0; y < N; y++)
            for (uint32_t x = 0; x < N; x++) {
                uint8_t *const voxel = &s.voxels[at(&s, x, y, z)];
                if (z < WALL && x >= 3 * N / 4) *voxel = (uint8_t)(FLUID * grain(x, y, z));
                if (*voxel > 2 * FLUID) *voxel = (uint8_t)(10.0 + *voxel * square((double)y / N));
            }
    scan_run(&s);
    printf("fading: gap share %.2f\n", s.facts.gap_share);
    assert_true(s.facts.wall_rays < s.facts.rays * 8 / 10);
    assert_int_equal(s.outcome, SV_WALL_SURFACE);
}

enum { BLADDER = 6, BACK = 12, SAC = 22, DEEPER = 6 };

/* A bladder of slices BLADDER .. BACK - 1 before the sac, and what lies behind it in the wall, which is
 * brighter, as behind all fluid. */
static scan with_bladder(void) {
    scan s = scan_make(N, N, N);
    draw(&s, SAC, GAP + DEEPER, true);
    for (uint32_t z = BLADDER; z < SAC; z++)
        for (uint32_t y = 0; y < N; y++)
            for (uint32_t x = 0; x < N; x++) {
                if (square((double)x - 28.0) + square((double)y - 33.0) > square(16.0)) continue;
                const double level = z < BACK ? FLUID : 1.1 * MUSCLE;
                s.voxels[at(&s, x, y, z)] = (uint8_t)(level * grain(x, y, z));
            }
    return s;
}

/* The tissue behind the bladder is judged like wall, so the surface lies behind that. */
static void test_bladder(void **state) {
    scan s = with_bladder();
    scan_run(&s);
    assert_int_equal(s.outcome, SV_WALL_SURFACE);
    uint32_t rays = 0;
    for (uint32_t y = 0; y < N; y++)
        for (uint32_t x = 0; x < N; x++) {
            if (skin(x, y) >= GAP + 6) continue; /* the ball's rim */
            const float depth = s.depth[y * N + x];
            assert_true(depth > SAC - 1.0f && depth <= (float)(skin(x, y) + DEEPER));
            rays++;
        }
    assert_in_range(rays, 200, 600);
}

/* Returns the flags of the middle of five by five cells, each of two by two rays. All is wall but the cells
 * of `open`, which are fluid, and the middle, whose tissue lies behind fluid. */
static uint8_t enclosed_in_middle(const int *open, int opens) {
    enum { CELLS = 5, SIDE = 2 * CELLS, LAYERS = 3, PLANE = SIDE * SIDE, MIDDLE = 2 * CELLS + 2 };
    uint8_t levels[LAYERS * PLANE];
    uint16_t first[PLANE] = {0}, end[PLANE];
    sv_wall_layout l = {.columns = SIDE, .rows = SIDE, .layers = LAYERS, .cells = {CELLS, CELLS}};
    const sv_wall_blocks blocks = {
        .columns = SIDE, .rows = SIDE, .layers = LAYERS, .relative = levels, .first = first, .end = end};
    const uint8_t bright[LAYERS * CELLS * CELLS] = {0};
    const sv_wall_evidence none = {0}; /* nothing is the fetus */
    const sv_wall_scan judged = {.layout = &l, .blocks = &blocks, .brightness = bright};
    for (size_t i = 0; i < LAYERS * PLANE; i++) levels[i] = SV_WALL_TISSUE + 1;
    for (size_t i = 0; i < PLANE; i++) {
        const size_t cell = i / SIDE / 2 * CELLS + i % SIDE / 2;
        end[i] = LAYERS;
        if (cell / CELLS % 4 && cell % CELLS % 4)
            levels[PLANE + i] = FLUID; /* behind it the rays are no wall */
        for (int k = 0; k < opens; k++)
            if ((int)cell == open[k]) levels[2 * PLANE + i] = FLUID;
    }
    uint8_t *const around = sv_wall_surroundings_map(&judged, &none);
    assert_non_null(around);
    assert_int_equal(around[CELLS * CELLS + MIDDLE], 0); /* fluid */
    const uint8_t is = around[2 * CELLS * CELLS + MIDDLE];
    assert_int_equal(is & ~SV_WALL_ENCLOSED, 0);
    free(around);
    return is;
}

/* The wall encloses tissue that it reaches from three sides: fluid to one side changes nothing, fluid to two
 * sides does. Fluid at the corners does not. */
static void test_enclosed(void **state) {
    static const int sides[] = {11, 13, 7, 17, 11}, corners[] = {6, 8, 16, 18, 0, 24};
    assert_int_equal(enclosed_in_middle(NULL, 0), SV_WALL_ENCLOSED);
    assert_int_equal(enclosed_in_middle(corners, 6), SV_WALL_ENCLOSED);
    for (size_t i = 0; i < 4; i++) {
        assert_int_equal(enclosed_in_middle(&sides[i], 1), SV_WALL_ENCLOSED);
        assert_int_equal(enclosed_in_middle(&sides[i], 2), 0);
    }
}

/* A finger stands out of the ball by less than tau_mm. Its neighbours weigh more, so the far end of the
 * knob's range lies behind its tip, but the surface does not. */
static void test_finger(void **state) {
    enum { LENGTH = 3, X = 26, Y = 35 };
    scan s = scene();
    const uint32_t tip = skin(X, Y) - LENGTH;
    for (uint32_t z = tip; z < tip + LENGTH; z++)
        for (uint32_t y = Y - 1; y <= Y + 1; y++)
            for (uint32_t x = X - 1; x <= X + 1; x++)
                s.voxels[at(&s, x, y, z)] = (uint8_t)(FLESH * grain(x, y, z));
    sv_wall_settings settings = sv_wall_settings_default();
    settings.q = 0.0;
    scan_run_with(&s, &settings);
    assert_int_equal(s.outcome, SV_WALL_SURFACE);
    const float above = s.depth[Y * N + X], beside = s.depth[Y * N + X + 4];
    printf("finger: tip in slice %u, surface %.2f, beside it %.2f\n", tip, (double)above, (double)beside);
    assert_true(above > WALL && above <= (float)tip && beside > (float)tip);
}

enum { LIMB_FROM = 17, LIMB_TO = 28, LIMB_LEVEL = 99 };

/* A limb of slices LIMB_FROM .. LIMB_TO - 1 across the scan, little brighter than the wall. It is behind
 * fluid but where it lies against the wall, from column `from` to column `to`. */
static scan with_limb(uint32_t from, uint32_t to) {
    scan s = scan_make(N, N, N);
    draw(&s, LIMB_FROM - 5, GAP + 6, true);
    for (uint32_t z = LIMB_FROM - 5; z < LIMB_TO; z++)
        for (uint32_t y = 26; y < 38; y++)
            for (uint32_t x = 8; x < 56; x++) {
                const double level = z >= LIMB_FROM ? LIMB_LEVEL : x >= from && x < to ? MUSCLE : FLUID;
                s.voxels[at(&s, x, y, z)] = (uint8_t)(level * grain(x, y, z));
            }
    return s;
}

/* Counts the rays through the middle of the limb, of 8 x 8, on which the surface lies behind the limb. */
static uint32_t rays_behind_limb(uint32_t from, uint32_t to, const sv_wall_settings *settings) {
    scan s = with_limb(from, to);
    scan_run_with(&s, settings);
    assert_int_equal(s.outcome, SV_WALL_SURFACE);
    uint32_t rays = 0;
    for (uint32_t y = 28; y < 36; y++)
        for (uint32_t x = 28; x < 36; x++) rays += s.depth[y * N + x] >= LIMB_TO - 1;
    return rays;
}

/* If fluid flanks the part against the wall, that is judged like the parts on both sides. If it has fluid on
 * one side only, it is judged so to a lesser degree. By itself it is judged like the wall. */
static void test_limb(void **state) {
    sv_wall_settings all = sv_wall_settings_default();
    all.opening_mm = 0.0; /* it fills some of what is looked at */
    sv_wall_settings both_sides = all;
    both_sides.one_side = 0.0;
    assert_int_equal(rays_behind_limb(24, 40, &both_sides), 0);
    assert_int_equal(rays_behind_limb(24, 40, &all), 0);
    assert_in_range(rays_behind_limb(24, 56, &both_sides), 48, 64);
    assert_in_range(rays_behind_limb(24, 56, &all), 0, 4);
}

enum { LINE = 26, BETWEEN = 28, LINE_LEVEL = 75, DIM = 34 };

/* Counts the rays, of 8 x 8, on which the surface lies in front of a thin line of tissue, which is no
 * brighter than the wall. Between it and the ball, which has bone, lie six slices of `level`. */
static uint32_t rays_before_line(double level, const sv_wall_settings *settings) {
    scan s = scene();
    for (uint32_t y = 25; y < 45; y++)
        for (uint32_t x = 16; x < 36; x++)
            for (uint32_t z = LINE; z < skin(x, y) && z < GAP + 12; z++)
                s.voxels[at(&s, x, y, z)] =
                    (uint8_t)((z < BETWEEN ? LINE_LEVEL : level) * grain(x, y, z) + 0.5);
    scan_run_with(&s, settings);
    assert_int_equal(s.outcome, SV_WALL_SURFACE);
    uint32_t rays = 0;
    for (uint32_t y = 31; y < 39; y++)
        for (uint32_t x = 22; x < 30; x++) rays += s.depth[y * N + x] <= LINE;
    printf("line before %.0f: %u of 64 rays are clipped in front of it\n", level, rays);
    return rays;
}

/* Fluid parts an occluder from the fetus. What is dim does not part skin from bone. */
static void test_dim_between_skin_and_bone(void **state) {
    sv_wall_settings no_dim = sv_wall_settings_default();
    no_dim.dim = 1.0; /* whatever is no tissue is certain fluid */
    assert_int_equal(rays_before_line(DIM, NULL), 64);
    assert_int_equal(rays_before_line(FLUID, NULL), 0);
    assert_int_equal(rays_before_line(DIM, &no_dim), 0);
}

UNIT_MAIN(NULL, NULL, test_fading_tissue, test_bladder, test_enclosed, test_finger, test_limb,
          test_dim_between_skin_and_bone)
