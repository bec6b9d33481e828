/* SPDX-License-Identifier: MIT */
/*
 * The lit look and the clipping surface: a cut through tissue is grey and has the depthmap's normal, skin
 * behind a cut through fluid stays skin, and ghosting leaves the fetus readable whatever stands before it.
 */
#include "support/lit_shapes.h"

#include <math.h>

enum { EDGE = 64, SIDE = 32, PICTURE = 64 };
#define FACE 40 /* the fetus' skin: a plane */

/* An occluder in slices 10 .. 23, the fetus from FACE on; between them fluid. */
static hs_volume two_layers(void) {
    hs_volume v;
    hs_error err = {0};
    if (!hs_volume_init(&v, EDGE, EDGE, EDGE, &err)) fail_msg("%s", err.text);
    for (uint32_t i = 0; i < EDGE * EDGE * EDGE; i++) {
        const uint32_t z = i / (EDGE * EDGE);
        v.voxels[i] = z >= FACE ? 200 : z >= 10 && z < 24 ? 150 : 5;
    }
    for (int k = 0; k < 3; k++) v.spacing[k] = 1.0;
    return v;
}

static hs_dvr_settings lit_settings(void) {
    hs_dvr_settings s;
    hs_dvr_defaults(&s);
    s.look = HS_LOOK_LIT;
    s.width = s.height = PICTURE;
    return s;
}

/* A map that begins at `depth` slices in the middle and grows by `slope` slices a slice to the right. */
static void fill_map(float *map, double depth, double slope) {
    for (uint32_t i = 0; i < SIDE * SIDE; i++)
        map[i] = (float)(depth + slope * ((i % SIDE + 0.5) * EDGE / SIDE - 0.5 * EDGE));
}

static void draw(const hs_cl *cl, const hs_dvr_settings *s, const float *map, const float *confidence,
                 uint8_t *rgba) {
    hs_error err = {0};
    hs_camera camera;
    hs_volume v = two_layers();
    hs_camera_look(&camera, &v, 0, 0);
    hs_device_volume *source = hs_device_volume_create(cl, &v, &err);
    hs_dvr *dvr = source ? hs_dvr_create(cl, s, &err) : NULL;
    hs_start_depths start = {.width = SIDE, .height = SIDE, .slices = EDGE};
    start.depth = test_buffer(cl, SIDE * SIDE * sizeof *map, map);
    if (confidence) start.confidence = test_buffer(cl, SIDE * SIDE * sizeof *map, confidence);
    cl_mem to = test_buffer(cl, PICTURE * PICTURE * 4, NULL);
    if (!dvr || !hs_dvr_render(dvr, source, &camera, &start, to, NULL, NULL, &err)) fail_msg("%s", err.text);
    test_read(cl, to, PICTURE * PICTURE * 4, rgba);
    clReleaseMemObject(to);
    clReleaseMemObject(start.depth);
    if (start.confidence) clReleaseMemObject(start.confidence);
    hs_dvr_destroy(dvr);
    hs_device_volume_destroy(source);
    hs_volume_free(&v);
}

/* The middle of the picture, where neither the volume's faces nor the map's edges matter. */
static size_t middle(void) {
    return 4 * ((size_t)PICTURE * (PICTURE / 2) + PICTURE / 2);
}

/* Red over blue: what makes skin warm. */
static double warmth(const uint8_t *pixel) {
    return (double)pixel[0] / (double)pixel[2];
}

static void a_cut_is_grey_and_skin_is_not(void **state) {
    static uint8_t cut[PICTURE * PICTURE * 4], skin[PICTURE * PICTURE * 4];
    static float map[SIDE * SIDE];
    const hs_dvr_settings s = lit_settings();
    fill_map(map, 48, 0); /* inside the fetus */
    draw(*state, &s, map, NULL, cut);
    fill_map(map, 31, 0); /* in the fluid before it */
    draw(*state, &s, map, NULL, skin);
    const uint8_t *c = cut + middle(), *k = skin + middle();
    const double t = (FACE + 0.0) / EDGE, expected = lit_brightness(&s, (const double[]){0, 0, -1}, t, -1.0);
    assert_true(warmth(k) > 1.5);
    assert_true(warmth(c) < 1.0 + 0.5 * (warmth(k) - 1.0));
    /* The skin behind fluid is the very skin of docs/rendering.md. */
    assert_true(fabs((k[0] + k[1] + k[2]) / 765.0 - expected) < 0.01);
}

/* A cut's light is that of the map's normal, which here faces the lamp or turns away; the tissue's own
 * gradient is the same in all three. */
static void a_cut_has_the_normal_of_the_map(void **state) {
    static uint8_t picture[3][PICTURE * PICTURE * 4];
    static float map[SIDE * SIDE];
    static const double slopes[3] = {-0.5, 0.0, 0.5};
    hs_dvr_settings s = lit_settings();
    double seen[3];
    s.light[0] = 60.0f; /* from the right: a surface that grows deeper to the right faces it */
    s.light[1] = 0.0f;
    for (int i = 0; i < 3; i++) {
        fill_map(map, 50, slopes[i]);
        draw(*state, &s, map, NULL, picture[i]);
        const uint8_t *p = picture[i] + middle();
        seen[i] = p[0] + p[1] + p[2];
        /* docs/rendering.md, Diffuse light: normal (slope, 0, -1), lamp (sin 60, 0, -cos 60). */
    }
    for (int i = 0; i < 3; i++) {
        const double length = sqrt(1.0 + slopes[i] * slopes[i]), nz = -1.0 / length;
        const double facing = (slopes[i] * sin(1.0471975511965976) + 0.5) / length;
        const double light = 0.24 - 0.24 * nz + 0.58 * fmax(facing, 0.0), straight = 0.48 + 0.58 * 0.5;
        assert_true(fabs(seen[i] / seen[1] - light / straight) < 0.02);
    }
}

/* However unsure the plugin is, the fetus keeps at least 65 % of its own light, and the veil adds at most its
 * own share. */
static void ghosting_leaves_the_fetus_readable(void **state) {
    static uint8_t hard[PICTURE * PICTURE * 4], ghost[PICTURE * PICTURE * 4];
    static float map[SIDE * SIDE], confidence[SIDE * SIDE];
    hs_dvr_settings s = lit_settings();
    double veiled = 0.0;
    fill_map(map, 31, 0);
    draw(*state, &s, map, NULL, hard);
    s.ghost_offset = s.ghost_width = 10.0f;
    for (uint32_t i = 0; i < SIDE * SIDE; i++) confidence[i] = (float)(i % SIDE) / (SIDE - 1);
    draw(*state, &s, map, confidence, ghost);
    for (size_t i = 0; i < sizeof hard; i++) {
        if (i % 4 == 3) continue;
        assert_true(ghost[i] >= 0.65 * hard[i] - 1.0);
        assert_true(ghost[i] <= 0.65 * hard[i] + 0.35 * 255.0 * 0.7 + 0.35 * hard[i] + 1.0);
        veiled = fmax(veiled, fabs((double)ghost[i] - (double)hard[i]));
    }
    assert_true(veiled > 20.0); /* the occluder shows */
}

HOST_MAIN(cmocka_unit_test(a_cut_is_grey_and_skin_is_not), cmocka_unit_test(a_cut_has_the_normal_of_the_map),
          cmocka_unit_test(ghosting_leaves_the_fetus_readable))
