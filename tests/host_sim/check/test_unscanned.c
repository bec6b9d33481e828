/* SPDX-License-Identifier: MIT */
/* Slices and depthmap of a volume of which a part was scanned: nothing is drawn beside that part.
 * Requirement: R4. */
#include "support/host_fixture.h"

#include "loop/view.h"
#include "show/picture_slices.h"

#include <string.h>

enum { SIDE = 12, DEEP = 40, FIRST = 10, CELL = 120, CUT = 20 };

static uint8_t voxels[DEEP * SIDE * SIDE], rgba[CELL * CELL * 4], state[CELL * CELL];
static float depth[SIDE * SIDE], confidence[SIDE * SIDE];

/* Scanned from x = 6 and slice FIRST on. All rays start at slice CUT, but for two columns, at slice 4. */
static hs_volume half_a_scan(hs_maps *maps) {
    for (int i = 0; i < DEEP * SIDE * SIDE; i++)
        voxels[i] = i % SIDE >= 6 && i / (SIDE * SIDE) >= FIRST ? 200 : 0;
    const hs_volume volume = {
        .nx = SIDE, .ny = SIDE, .nz = DEEP, .spacing = {1.0, 1.0, 1.0}, .voxels = voxels};
    *maps =
        (hs_maps){.width = SIDE, .height = SIDE, .slices = DEEP, .depth = depth, .confidence = confidence};
    hs_camera_look(&maps->camera, &volume, 0.0, 0.0);
    for (int i = 0; i < SIDE * SIDE; i++) depth[i] = i % SIDE == 2 || i % SIDE == 9 ? 4.0f : CUT;
    memset(confidence, 0, sizeof confidence); /* a band as wide as it may be */
    return volume;
}

static uint32_t colour(int i, int j) {
    const uint8_t *p = rgba + 4 * (j * CELL + i);
    return (uint32_t)p[0] << 16 | (uint32_t)p[1] << 8 | p[2];
}

static void test_slices(void **unused) {
    hs_maps maps;
    const hs_volume volume = half_a_scan(&maps);
    uint32_t lines = 0, bands = 0;
    const hs_slice_scene scene = {
        .volume = &volume, .maps = &maps, .at = {0.5, 0.5, 0.5}, .side = {1.0, 1.0, 1.0}, .band_mm = 8.0};
    hs_slice_fill(&scene, HS_SLICE_ACROSS, CELL, rgba, state);
    for (int j = 0; j < CELL; j++)
        for (int i = 0; i < CELL; i++) {
            const bool scanned = i >= CELL / 2 && j >= CELL * FIRST / DEEP;
            const uint32_t seen = colour(i, j);
            assert_int_equal(state[j * CELL + i] != HS_SLICE_UNSCANNED, scanned);
            if (!scanned) assert_int_equal(seen, 0);
            lines += seen == HS_SLICE_LINE;
            bands += scanned && seen != HS_SLICE_LINE && (seen >> 16) != (seen & 255u);
        }
    assert_in_range(lines, 60, 400);
    assert_in_range(bands, 1000, CELL * CELL / 2);
    for (int j = CELL * FIRST / DEEP; j < CELL / 2 - 4; j++) /* nor along what was scanned */
        assert_true(colour(CELL / 2, j) != HS_SLICE_LINE);
}

/* Seven layers at x = 3 to 9, a millimetre apart, of which three lie beside what was scanned. */
static void test_thick_slice(void **unused) {
    hs_maps maps;
    const hs_volume volume = half_a_scan(&maps);
    hs_slice_scene scene = {
        .volume = &volume, .maps = &maps, .at = {6.5 / SIDE, 0.5, 0.5}, .side = {1.0, 1.0, 1.0}};
    const int scanned = CELL / 2 * CELL + CELL * 7 / 10; /* behind all starts of rays */
    for (int n = 1; n <= 7; n += 2) {
        scene.thick_mm = n;
        hs_slice_fill(&scene, HS_SLICE_ALONG, CELL, rgba, state);
        assert_int_equal(rgba[4 * scanned], (200 * (n / 2 + 1) + n / 2) / n);
        assert_int_equal(colour(CELL / 8, CELL / 2), 0);
    }
    scene.thick_mm = 0.0;
    hs_slice_fill(&scene, HS_SLICE_ALONG, CELL, rgba, state);
    assert_int_equal(rgba[4 * scanned], 200);
}

static void test_depthmap(void **unused) {
    hs_maps maps;
    const hs_volume volume = half_a_scan(&maps);
    hs_maps_scan(&maps, &volume);
    for (int i = 0; i < SIDE * SIDE; i++) {
        const float expected = i % SIDE < 6 ? -1.0f : i % SIDE == 9 ? 0.0f : CUT;
        assert_float_equal(depth[i], expected, 0.0f);
    }
}

UNIT_MAIN(NULL, NULL, test_slices, test_thick_slice, test_depthmap)
