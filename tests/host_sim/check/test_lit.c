/* SPDX-License-Identifier: MIT */
/*
 * The lit look's kernels against the scalar definition (ref_lit.h). Noise makes many decisions close, and a
 * close one may go either way; so of a picture's pixels 99 of 100 are within a level, and all together within
 * half a level (root of the mean square).
 */
#include "support/dvr_fixture.h"
#include "support/ref_lit.h"

#include <math.h>

#define LEVEL       1.01 /* of rounding to bytes, and of the kernels' floats */
#define FAR_SHARE   0.01
#define FAR_SQUARES 0.5

/* A picture of the volume with this map, and with a random confidence if `with_confidence`. */
static void compare(const hs_cl *cl, test_random *random, const hs_volume *volume, const hs_camera *camera,
                    hs_dvr_settings s, const float *map, bool with_confidence, const char *where) {
    float confidence[MAP_W * MAP_H];
    for (uint32_t i = 0; i < MAP_W * MAP_H; i++) confidence[i] = (float)test_uniform(random, 0.0, 1.0);
    s.look = HS_LOOK_LIT;
    s.light[0] = (float)test_uniform(random, -90.0, 90.0);
    s.light[1] = (float)test_uniform(random, -60.0, 60.0);
    const ref_depthmap used = {.depth = map,
                               .confidence = with_confidence ? confidence : NULL,
                               .width = MAP_W,
                               .height = MAP_H,
                               .slices = MAP_S};
    dvr_picture p = dvr_render(cl, volume, camera, &s, used.depth, used.confidence);
    ref_lit_volume lit = ref_lit_make(volume, &s);
    double squares = 0.0, worst = 0.0;
    size_t far_off = 0, pixels = (size_t)s.width * s.height;
    for (size_t i = 0; i < pixels; i++) {
        double rgb[3], off = 0.0;
        ref_lit_pixel(volume, &lit, camera, &s, &used, (uint32_t)(i % s.width), (uint32_t)(i / s.width), rgb);
        for (size_t c = 0; c < 3; c++) {
            assert_true(isfinite(rgb[c]));
            const double d = fabs((double)p.rgba[4 * i + c] - rgb[c]);
            off = fmax(off, d);
            squares += d * d;
        }
        assert_int_equal(p.rgba[4 * i + 3], 255);
        far_off += off > LEVEL;
        worst = fmax(worst, off);
    }
    const double rms = sqrt(squares / (3.0 * (double)pixels));
    if ((double)far_off > FAR_SHARE * (double)pixels || rms > FAR_SQUARES)
        fail_msg("%s: %zu of %zu pixels are off, RMS %.3f, worst %.1f levels", where, far_off, pixels, rms,
                 worst);
}

static void matches_definition(void **state) {
    const hs_cl *cl = *state;
    /* A third of the pairs, another one with packets than with single rays: the definition takes its time. */
    const size_t turn = cl->lanes > 1 ? 0 : 1;
    for (size_t scene = 0; scene < SCENES; scene++)
        for (size_t view = 0; view < VIEWS; view++) {
            if ((scene + view) % 3 != turn) continue;
            test_random random = {(uint32_t)(4000 + scene * 97 + view)};
            hs_camera camera;
            hs_dvr_settings s;
            float map[MAP_W * MAP_H];
            hs_volume volume = dvr_lay_out(&random, scene, view, 2.0f, &camera, &s, map);
            const char *const where = unit_text("scene %zu, view %zu", scene, view);
            compare(*state, &random, &volume, &camera, s, dvr_views[view].map == MAP_NONE ? NULL : map,
                    scene % 2 == 0, where);
        }
}

/* Larger volumes are halved, and light's cubes hold more than one voxel: odd axes, seen at an angle. */
static void matches_definition_when_halved(void **state) {
    static const uint32_t sizes[2][3] = {{101, 64, 77}, {33, 181, 58}};
    static const int patterns[2] = {TEST_SPARSE, TEST_SMOOTH};
    const double spacing[3] = {0.5, 0.5, 0.6};
    for (size_t i = 0; i < 2; i++)
        for (size_t view = 1; view < 5; view++) {
            test_random random = {(uint32_t)(5000 + i * 97 + view)};
            hs_volume volume = test_volume(&random, patterns[i], sizes[i], spacing);
            hs_camera camera;
            hs_camera_look(&camera, &volume, 20.0 * (double)view - 31.0, 14.0 * (double)i);
            float map[MAP_W * MAP_H];
            dvr_fill_map(&random, dvr_views[view].map, map);
            const char *const where = unit_text("halved volume %zu, view %zu", i, view);
            compare(*state, &random, &volume, &camera, dvr_settings_of(&dvr_views[view]),
                    dvr_views[view].map == MAP_NONE ? NULL : map, view % 2 == 0, where);
        }
}

HOST_MAIN(matches_definition, matches_definition_when_halved)
