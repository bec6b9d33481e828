/* SPDX-License-Identifier: MIT */
/* The artefacts of the hard cases against numbers computed by hand: haze, thick slices, dark corners,
 * soft edges, a turned camera. */
#include "scene/scene_field.h"
#include "scene/scene_solid.h"
#include "support/scene_fixture.h"

enum { N = 64 };

static size_t at(const hs_field *f, uint32_t x, uint32_t y, uint32_t z) {
    return hs_field_index(f, x, y, z);
}

/* Wall to slice 20, then fluid, 0.5 mm a voxel; the wall scatters at -30 dB, the fluid not at all. */
static hs_field *wall_and_fluid(void) {
    hs_field *f = one_tissue_field(N, 0.5f, HS_TISSUE_FLUID);
    for (size_t i = 0; i < hs_field_slice(f) * 20; i++) {
        f->tissue[i] = HS_TISSUE_WALL;
        f->diffuse[i] = hs_level(-30.0f);
    }
    return f;
}

/* 10 dB below the wall where it ends, and 1.5 dB less a mm: at slice z the way is (z - 20 + 1/2) / 2 mm. */
static void haze_falls_from_the_wall(void **state) {
    hs_scene_spec spec = empty_spec();
    spec.haze = (hs_haze_spec){true, -10.0f, 1.5f, 0.0f, 8.0f};
    hs_field *f = wall_and_fluid();
    for (uint32_t z = 0; z < N; z++) f->tissue[at(f, 3, 4, z)] = HS_TISSUE_FLUID; /* a beam without wall */
    for (uint32_t z = 0; z < N; z++) f->diffuse[at(f, 3, 4, z)] = HS_LEVEL_SILENT;
    hs_scene_haze(f, &spec);
    assert_non_null(f->haze_end);
    for (uint32_t z = 0; z < N; z += 3) {
        const double expected = z < 20 ? -30.0 : -40.0 - 1.5 * 0.5 * ((double)z - 20.0 + 0.5);
        assert_near(level_db(f->diffuse[at(f, 30, 40, z)]), expected, 0.05);
        assert_int_equal(f->diffuse[at(f, 3, 4, z)], HS_LEVEL_SILENT);
    }
    /* A display of 60 dB shows T_L = 40.5 at -50.47 dB; with 4 dB for speckle: 14.47 dB and 9.65 mm
     * behind the wall. */
    assert_near(f->haze_end[30 + N * 40], 10.0 + 14.47 / 1.5, 0.05);
}

/* Patches of 4 mm, up to 6 dB: even over short ways, uneven over long ones, and without a drift. */
static void haze_has_patches(void **state) {
    hs_scene_spec spec = empty_spec();
    spec.haze = (hs_haze_spec){true, -10.0f, 0.05f, 6.0f, 4.0f};
    hs_field *f = wall_and_fluid();
    hs_scene_haze(f, &spec);
    assert_non_null(f->haze_end);
    double mean = 0.0, square = 0.0, step = 0.0, largest = 0.0;
    int count = 0;
    for (uint32_t z = 24; z < N; z++)
        for (uint32_t y = 0; y < N; y++)
            for (uint32_t x = 1; x < N; x++, count++) {
                const double falls = -40.0 - 0.05 * 0.5 * ((double)z - 20.0 + 0.5);
                const double patch = level_db(f->diffuse[at(f, x, y, z)]) - falls;
                const double beside = level_db(f->diffuse[at(f, x - 1, y, z)]) - falls;
                mean += patch;
                square += patch * patch;
                step += (patch - beside) * (patch - beside);
                largest = fmax(largest, fabs(patch));
            }
    const double deviation = sqrt(square / count);
    assert_near(mean / count, 0.0, 0.3);
    assert_true(largest <= 6.05 && largest > 4.5);
    /* Corners are uniform: 6 / sqrt 3 dB there, and less between them. */
    assert_true(deviation > 1.2 && deviation < 3.46);
    assert_true(sqrt(step / count) < 0.5 * deviation); /* half a millimetre on */
}

/* The second moment of the amplitude along an axis around a point, as a standard deviation in mm. */
static double spread(const hs_field *f, int axis, uint32_t z) {
    double sum = 0.0, square = 0.0;
    for (uint32_t i = 0; i < N; i++) {
        const double d = 0.5 * ((double)i - 32.0);
        const double a = (double)hs_level_amplitude(f->envelope[axis ? at(f, 32, i, z) : at(f, i, 32, z)]);
        sum += a;
        square += a * d * d;
    }
    return sqrt(square / sum);
}

/* Points at three depths: across the image plane 1 mm wide at the focus, sqrt 2 mm a Rayleigh length off
 * it, sqrt 5 at two; within the plane as before. What the kernel leaves out beyond 3 deviations is 1.4
 * %. */
static void slices_are_thick_off_the_focus(void **state) {
    static const uint32_t depth[3] = {32, 16, 0};
    hs_scene_spec spec = empty_spec();
    spec.speckle = (hs_speckle_spec){true, 0.0f, 0.5f, 16.25f, 1000.0f};
    for (int thick = 0; thick < 2; thick++) {
        spec.slice = (hs_slice_spec){thick == 1, 1.0f, 16.25f, 8.0f};
        hs_field *f = one_tissue_field(N, 0.5f, HS_TISSUE_FLUID);
        for (int i = 0; i < 3; i++) f->coherent[at(f, 32, 32, depth[i])] = hs_level(50.0f);
        make_speckle(f, &spec);
        assert_false(atomic_load(&f->out_of_memory));
        for (int i = 0; i < 3; i++) {
            const double expected = thick ? sqrt(1.0 + (double)(i * i)) : 0.5;
            assert_near(spread(f, 1, depth[i]), expected, 0.03 * expected);
            assert_near(spread(f, 0, depth[i]), 0.5, 0.015);
        }
    }
}

/* To the lower right, from 4 mm off the middle on, whole 8 mm further: along the diagonal the middle of
 * pixel 32 + k is (k + 1/2) / 2 * sqrt 2 mm away. */
static void a_corner_is_dark(void **state) {
    hs_scene_spec spec = empty_spec();
    spec.corner = (hs_corner_spec){true, 45.0f, 4.0f, 8.0f, 20.0f};
    hs_field *f = one_tissue_field(N, 0.5f, HS_TISSUE_SOFT);
    for (size_t i = 0; i < hs_field_slice(f) * N; i++) f->diffuse[i] = f->coherent[i] = 0;
    hs_scene_dark_corner(f, &spec);
    for (uint32_t k = 0; k < 32; k++) {
        const double t = fmin(fmax((0.5 * (k + 0.5) * sqrt(2.0) - 4.0) / 8.0, 0.0), 1.0);
        const double loss = 20.0 * t * t * (3.0 - 2.0 * t);
        for (uint32_t z = 0; z < N; z += 21) {
            assert_near(level_db(f->diffuse[at(f, 32 + k, 32 + k, z)]), -loss, 0.05);
            assert_near(level_db(f->coherent[at(f, 32 + k, 32 + k, z)]), -loss, 0.05);
            assert_int_equal(f->diffuse[at(f, 31 - k, 31 - k, z)], 0);
        }
    }
}

/* The field of a scene behind the echo step. */
static hs_field *echo_of(const char *text) {
    hs_scene_spec spec;
    hs_solid_list solids = {0};
    must(hs_scene_read_text("soft.json", text, &spec, &err));
    hs_field *f = one_tissue_field(N, spec.extent_mm / N, HS_TISSUE_FLUID);
    must(hs_field_add_style(f, &err));
    must(hs_scene_solids(&spec, 1, &solids, &err));
    must(hs_scene_raster(f, &spec, &solids, NULL, &err));
    hs_scene_echo(f, &spec);
    hs_solid_list_free(&solids);
    return f;
}

/* A ball of 10 mm radius in a volume of 32 mm, whose far pole is at 26 mm. It is 6 dB dimmer than
 * placenta, -31 dB, and its scatterers grow over 4 mm: a share of d / 4 of the power at d mm inside. Its
 * interface is 3.5 MHz, 4 mm, 1560 m/s: k d = 2 pi 4 3.5 / 1.56 = 56.4, -35.0 dB. */
static void edges_are_soft(void **state) {
    static const char scene[] =
        "{ \"name\": \"s\", \"title\": \"s\", \"seed\": 1, \"extent_mm\": 32, \"frequency_mhz\": 3.5,\n"
        "  \"sac\": { \"centre_mm\": [16, 16, 16], \"radii_mm\": [400, 400, 400] }, \"artefacts\": [],\n"
        "  \"structures\": [{ \"type\": \"occluder\", \"tissue\": \"placenta\", \"centre_mm\": [16, 16, "
        "16],\n"
        "    \"radii_mm\": [10, 10, 10]%s }] }";
    char text[sizeof scene + 64];
    (void)snprintf(text, sizeof text, scene, "");
    hs_field *hard = echo_of(text);
    (void)snprintf(text, sizeof text, scene, ", \"echo_db\": -6, \"soft_mm\": 4");
    hs_field *soft = echo_of(text);
    assert_memory_equal(hard->tissue, soft->tissue,
                        (size_t)N * N * N); /* the truth is that of the whole ball */
    for (uint32_t z = 34; z < 52; z++) {
        const double inside = 26.0 - 0.5 * ((double)z + 0.5), share = fmin(inside / 4.0, 1.0);
        assert_near(level_db(hard->diffuse[at(hard, 32, 32, z)]), -31.0, 0.02);
        /* A share is in 255 steps, and the distance to an ellipsoid of the first order. */
        assert_near(level_db(soft->diffuse[at(soft, 32, 32, z)]), -37.0 + 10.0 * log10(share), 0.35);
    }
    const double less =
        level_db(hard->coherent[at(hard, 32, 32, 51)]) - level_db(soft->coherent[at(soft, 32, 32, 51)]);
    assert_near(less, 20.0 * log10(6.2831853 * 4.0 * 3.5 / 1.56), 0.05);
    assert_int_equal(soft->diffuse[at(soft, 32, 32, 53)], hard->diffuse[at(hard, 32, 32, 53)]);
}

/* A quarter turn about y is a change of axes: the camera's x runs against the beams, its z along the
 * scene's x. */
static void a_turned_camera_sees_the_same_scan(void **state) {
    enum { SIDE = 48 };
    hs_error err = {0};
    hs_scene_data straight = make_scene("E03", SIDE, 2, 0, 0);
    hs_scene *scene = hs_scene_open("E03", &err);
    assert_non_null(scene);
    const char *const turned =
        unit_text("{\"camera_deg\": [0, 90, 0],%s", strchr(hs_scene_json(scene), '{') + 1);
    hs_scene_close(scene);
    const hs_scene_data side = make_text_scene(turned, SIDE);
    size_t tissues = 0;
    for (size_t z = 0; z < SIDE; z++)
        for (size_t y = 0; y < SIDE; y++)
            for (size_t x = 0; x < SIDE; x++) {
                const size_t of_side = (z * SIDE + y) * SIDE + x,
                             of_straight = ((SIDE - 1 - x) * SIDE + y) * SIDE + z;
                assert_int_equal(side.full.voxels[of_side], straight.full.voxels[of_straight]);
                tissues += side.tissue[of_side] != straight.tissue[of_straight];
            }
    static const double turn[9] = {0, 0, -1, 0, 1, 0, 1, 0, 0};
    for (int k = 0; k < 9; k++) {
        assert_near(side.full.probe_turn[k], turn[k], 1e-6);
        assert_near(straight.full.probe_turn[k], k % 4 == 0, 0.0);
    }
    assert_true(tissues < 5); /* a point on a border may fall to either side */
    for (size_t i = 0; i < (size_t)SIDE * SIDE; i++) check_scene_pixel(&side, i);
}

/* At 30 degrees: the fetus' middle, at (60, 60, 70), lies on the ray that it ought to. With m = 60 and
 * the camera's axes x = (cos, 0, -sin), z = (sin, 0, cos), its place is (60 - 10 sin 30, 60, 60 + 10 cos
 * 30). */
static void a_turned_camera_stands_where_it_says(void **state) {
    enum { SIDE = 120 };
    static const char text[] =
        "{ \"name\": \"c\", \"title\": \"c\", \"seed\": 1, \"extent_mm\": 120, \"camera_deg\": [0, 30, 0],\n"
        "  \"sac\": { \"centre_mm\": [60, 60, 60], \"radii_mm\": [400, 400, 400] }, \"artefacts\": [],\n"
        "  \"structures\": [{ \"type\": \"occluder\", \"tissue\": \"placenta\", \"centre_mm\": [60, 60, "
        "70],\n"
        "    \"radii_mm\": [8, 8, 8] }] }";
    hs_scene_data d = make_text_scene(text, SIDE);
    double sum[3] = {0, 0, 0}, count = 0.0;
    const double middle[3] = {55.0, 60.0, 60.0 + 10.0 * cos(3.14159265 / 6.0)};
    for (size_t i = 0; i < (size_t)SIDE * SIDE * SIDE; i++) {
        const double p[3] = {0.5 + (double)(i % SIDE), 0.5 + (double)(i / SIDE % SIDE),
                             0.5 + (double)(i / ((size_t)SIDE * SIDE))};
        double far = 0.0;
        for (int a = 0; a < 3; a++) far += (p[a] - middle[a]) * (p[a] - middle[a]);
        /* The picture of it stands where its tissue does; a voxel at its border is a mean. */
        if (far < 6.2 * 6.2) assert_true(d.full.voxels[i] > 40);
        if (far > 9.8 * 9.8) assert_true(d.full.voxels[i] <= 40);
        if (d.tissue[i] != HS_TISSUE_PLACENTA) continue;
        for (int a = 0; a < 3; a++) sum[a] += p[a];
        count += 1.0;
    }
    assert_near(count, 4.0 / 3.0 * 3.14159265 * 512.0, 30.0);
    for (int a = 0; a < 3; a++) assert_near(sum[a] / count, middle[a], 0.05);
    /* It lies 10 mm along the beams from the middle. */
    for (int a = 0; a < 3; a++) assert_near(10.0 * d.full.probe_turn[a * 3 + 2], middle[a] - 60.0, 1e-5);
}

UNIT_MAIN(NULL, NULL, haze_falls_from_the_wall, haze_has_patches, slices_are_thick_off_the_focus,
          a_corner_is_dark, edges_are_soft, a_turned_camera_sees_the_same_scan,
          a_turned_camera_stands_where_it_says)
