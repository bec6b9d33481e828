/* SPDX-License-Identifier: MIT */
/* A case with its truth, as a turned camera sees it (wall_case_tilt): where voxels, ends of rays and
 * labels come to lie, and what is told of the probe. */
#include "judge/judge.h"
#include "support/unit.h"

#include <math.h>

enum { N = 40, PLANE = N * N, BACK = 24, HIDES = 8, FIRST = 2 };

static size_t at(uint32_t x, uint32_t y, uint32_t z) {
    return ((size_t)z * N + y) * N + x;
}

/* A back from slice BACK on, of which the half with x < N / 2 is the fetus; grain before it; and what hides
 * in slices HIDES to HIDES + 3, which the truth lacks. All was scanned from slice FIRST on. */
static wall_case make(void) {
    wall_case c = {.name = "back", .nx = N, .ny = N, .nz = N, .spacing_mm = {0.8, 0.8, 0.8}};
    c.told = (sv_frame){.beams = SV_BEAMS_FAN,
                        .probe_rotation = {1, 0, 0, 0, 1, 0, 0, 0, 1},
                        .probe_side = {0, 0, -1},
                        .beam_apex_mm = {16, 18, -40},
                        .beam_sweep_mm = 7};
    c.full = malloc((size_t)PLANE * N);
    c.clean = malloc((size_t)PLANE * N);
    c.first = malloc(PLANE * sizeof *c.first);
    c.end = malloc(PLANE * sizeof *c.end);
    c.label = malloc(PLANE);
    c.truth = malloc(PLANE * sizeof *c.truth);
    assert_true(c.full && c.clean && c.first && c.end && c.label && c.truth);
    for (uint32_t z = 0; z < N; z++)
        for (uint32_t i = 0; i < PLANE; i++) {
            const uint8_t grain = (uint8_t)((i * 2654435761u + z * 40503u) >> 28);
            c.clean[(size_t)z * PLANE + i] = z >= BACK ? 250 : grain;
            c.full[(size_t)z * PLANE + i] = z >= BACK || (z >= HIDES && z < HIDES + 4) ? 250 : grain;
        }
    for (uint32_t i = 0; i < PLANE; i++) {
        c.first[i] = FIRST;
        c.end[i] = N;
        c.label[i] = i % N < N / 2 ? 2 : 1;
        c.truth[i] = hs_eval_ray_end(c.clean, PLANE, N, i, 0);
        assert_true(c.truth[i] == BACK);
    }
    return c;
}

static wall_case turned(double about_x, double about_y) {
    wall_case c = make();
    must(wall_case_tilt(&c, (double[]){about_x, about_y}, &err));
    return c;
}

/* A quarter turn about x puts voxels on voxels: y becomes z, and z runs against y. So do probe and beams. */
static void quarter_turn(void **state) {
    wall_case c = make(), t = turned(90.0, 0.0);
    for (uint32_t z = 1; z + 1 < N; z++)
        for (uint32_t y = 1; y + 1 < N; y++)
            for (uint32_t x = 1; x + 1 < N; x++) {
                if (y == FIRST) continue; /* rounding decides */
                const bool scanned = z >= t.first[at(x, y, 0)] && z < t.end[at(x, y, 0)];
                assert_int_equal(scanned, y > FIRST);
                if (!scanned) continue;
                assert_int_equal(t.full[at(x, y, z)], c.full[at(x, N - 1 - z, y)]);
                assert_int_equal(t.clean[at(x, y, z)], c.clean[at(x, N - 1 - z, y)]);
            }
    static const float rotation[9] = {1, 0, 0, 0, 0, 1, 0, -1, 0}, side[3] = {0, -1, 0};
    static const float apex[3] = {16, -40, 0.8f * (N - 1) - 18};
    for (int i = 0; i < 9; i++) assert_float_equal(t.told.probe_rotation[i], rotation[i], 1e-5);
    for (int i = 0; i < 3; i++) assert_float_equal(t.told.probe_side[i], side[i], 1e-5);
    for (int i = 0; i < 3; i++) assert_float_equal(t.told.beam_apex_mm[i], apex[i], 1e-4);
    assert_true(t.told.beams == SV_BEAMS_FAN && t.told.beam_sweep_mm > 6.9f);
    wall_case_free(&c);
    wall_case_free(&t);
}

/* Turned a little, the back rises to one side by the tangent; labels stay on what they were on. */
static void small_turn(void **state) {
    const double middle = 0.5 * (N - 1), degrees = 12.0, angle = degrees * acos(-1.0) / 180.0;
    wall_case t = turned(0.0, degrees);
    uint32_t rays = 0;
    for (uint32_t y = 4; y < N - 4; y++)
        for (uint32_t x = 4; x < N - 4; x++) {
            const size_t ray = (size_t)y * N + x;
            if (t.label[ray] == 0) continue;
            const double back = middle + (BACK - middle) / cos(angle) + tan(angle) * (x - middle);
            assert_true(fabs((double)t.truth[ray] - back) < 1.5);
            const double across = cos(angle) * (x - middle) + sin(angle) * ((double)t.truth[ray] - middle);
            if (fabs(across) > 2.0) assert_int_equal(t.label[ray], across < 0.0 ? 2 : 1);
            rays++;
        }
    assert_in_range(rays, 700, 1024);
    wall_case_free(&t);
}

UNIT_MAIN(NULL, NULL, quarter_turn, small_turn)
