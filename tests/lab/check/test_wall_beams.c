/* SPDX-License-Identifier: MIT */
/*
 * Method wall along the beams (docs/surface.md): where the grid lies, one answer for every camera, and one
 * for a volume as long as it is the same. That the kernels
 * follow the definition is test_wall's.
 */
#include "ref/ref_wall_steps.h"
#include "support/scene_fixture.h"
#include "support/wall_compare.h"
#include "support/wall_fixture.h"
#include "wall_grid.h"

enum { COLUMNS = 60, ROWS = 50, LAYERS = 40 };

static const float STRAIGHT[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1}, FROM_LEFT[9] = {0, 0, 1, 0, 1, 0, -1, 0, 0};

/* Levels that grow linearly along all axes, so that they tell a place. */
static double level_of(double x, double y, double z) {
    return 5.0 + 1.5 * x + 1.0 * y + 2.0 * z;
}

/* The place of a sample by the formula of smartvis_plugin.h, in voxels of 1 mm; the middle of the volume lies
 * at the radius `middle` from the apex. */
static void place_of(const sv_beams *b, const sv_wall_layout *grid, double middle, const uint32_t at[3],
                     double out[3]) {
    const double sweep = (double)b->sweep_mm, beam_mm = SV_WALL_GRID_MM / grid->columns;
    const double th = (at[0] + 0.5 - grid->columns / 2.0) * beam_mm / middle;
    const double ph = (at[1] + 0.5 - grid->rows / 2.0) * beam_mm / (middle - sweep);
    const double r = fmax(middle - SV_WALL_GRID_MM / 2.0, 0.0) + at[2] * SV_WALL_GRID_MM / grid->layers;
    const double h = r * cos(th) - sweep;
    const double p[3] = {r * sin(th), h * sin(ph), sweep + h * cos(ph)};
    for (int a = 0; a < 3; a++) {
        out[a] = (double)b->apex_mm[a];
        for (int i = 0; i < 3; i++) out[a] += (double)b->rotation[3 * a + i] * p[i];
    }
}

/* Every sample within the blocks has their level there. Blocks are two voxels of 1 mm along z, one across. */
static void check_grid(const sv_beams *b, double middle) {
    const sv_wall_settings s = sv_wall_settings_default();
    const double mm[3] = {1.0, 1.0, 1.0};
    const sv_wall_layout camera = sv_wall_layout_of(COLUMNS, ROWS, 2 * LAYERS, mm, &s);
    const sv_wall_layout layout = sv_wall_grid_layout(&s);
    const size_t plane = (size_t)layout.columns * layout.rows;
    sv_wall_grid grid;
    sv_wall_blocks blocks, beams;
    uint32_t seen = 0;
    assert_int_equal(camera.columns, COLUMNS);
    assert_int_equal(camera.layers, LAYERS);
    assert_true(sv_wall_blocks_allocate(&camera, &blocks) &&
                sv_wall_grid_of(&camera, &layout, mm, b, &s, &grid));
    for (size_t i = 0; i < (size_t)COLUMNS * ROWS * LAYERS; i++)
        blocks.levels[i] = (uint8_t)(level_of((double)(i % COLUMNS), (double)(i / COLUMNS % ROWS),
                                              (double)(i / COLUMNS / ROWS)) +
                                     0.5);
    assert_true(sv_wall_gather(&blocks, &grid, &layout, &beams));
    for (uint32_t i = 0; i < plane * layout.layers; i++) {
        const uint32_t at[3] = {i % layout.columns, i / layout.columns % layout.rows, (uint32_t)(i / plane)};
        double p[3];
        place_of(b, &layout, middle, at, p);
        const double z = (p[2] - 0.5) / 2.0;
        const bool inside = p[0] > 0.1 && p[0] < COLUMNS - 1.1 && p[1] > 0.1 && p[1] < ROWS - 1.1 &&
                            z > 0.1 && z < LAYERS - 1.1;
        const bool outside = p[0] < -0.6 || p[0] > COLUMNS - 0.4 || p[1] < -0.6 || p[1] > ROWS - 0.4 ||
                             z < -0.6 || z > LAYERS - 0.4;
        const double error = beams.levels[i] - level_of(p[0], p[1], z);
        /* levels are rounded twice, and places to a sixteenth of a block */
        if (inside && !(fabs(error) <= 1.0 + 4.5 / 16.0 + 0.05))
            fail_msg("sample %u %u %u at %g %g %g: level %u", at[0], at[1], at[2], p[0], p[1], p[2],
                     beams.levels[i]);
        if (outside && beams.levels[i] != 0)
            fail_msg("sample %u %u %u at %g %g %g: level %u", at[0], at[1], at[2], p[0], p[1], p[2],
                     beams.levels[i]);
        seen += inside;
    }
    print_message("%u samples lie in the volume\n", seen);
    assert_true(seen > 3000); /* a sample has 18 mm^3 */
    sv_wall_blocks_destroy(&blocks);
    sv_wall_blocks_destroy(&beams);
}

static void test_grid_follows_the_fan(void **state) {
    /* the middle of the volume is at 29.5, 24.5, 39.5 */
    sv_beams b = {.kind = SV_BEAMS_FAN, .apex_mm = {29.5f, 24.5f, -60.5f}, .sweep_mm = 15.0f};
    memcpy(b.rotation, STRAIGHT, sizeof STRAIGHT);
    check_grid(&b, 100.0);
    b.sweep_mm = -20.0f;
    check_grid(&b, 100.0);
    memcpy(b.rotation, FROM_LEFT, sizeof FROM_LEFT);
    memcpy(b.apex_mm, (const float[]){-60.5f, 24.5f, 39.5f}, sizeof b.apex_mm);
    check_grid(&b, 90.0);
    const float aside[9] = {0.8f, 0.0f, 0.6f, 0.0f, 1.0f, 0.0f, -0.6f, 0.0f, 0.8f};
    memcpy(b.rotation, aside, sizeof aside);
    memcpy(b.apex_mm, (const float[]){29.5f - 0.6f * 70.0f, 24.5f, 39.5f - 0.8f * 70.0f}, sizeof b.apex_mm);
    check_grid(&b, 70.0);
}

/* Beams come from in front: a fan whose axis or apex lies behind the volume's middle says as much as parallel
 * beams. */
static void test_a_fan_from_behind_is_none(void **state) {
    static const float fans[][2] = {{-60.5f, 150.0f}, {200.0f, 0.0f}, {140.0f, -200.0f}}; /* apex, sweep */
    const sv_wall_settings s = sv_wall_settings_default();
    const double mm[3] = {1.0, 1.0, 1.0};
    const sv_wall_layout camera = sv_wall_layout_of(COLUMNS, ROWS, 2 * LAYERS, mm, &s);
    const sv_wall_layout layout = sv_wall_grid_layout(&s);
    sv_beams parallel = {.kind = SV_BEAMS_PARALLEL};
    memcpy(parallel.rotation, STRAIGHT, sizeof STRAIGHT);
    for (size_t n = 0; n < sizeof fans / sizeof *fans; n++) {
        sv_wall_grid wanted, grid;
        sv_beams b = parallel;
        b.kind = SV_BEAMS_FAN;
        memcpy(b.apex_mm, (const float[]){29.5f, 24.5f, fans[n][0]}, sizeof b.apex_mm);
        b.sweep_mm = fans[n][1];
        memset(&wanted, 0, sizeof wanted);
        memset(&grid, 0, sizeof grid);
        assert_true(sv_wall_grid_of(&camera, &layout, mm, &parallel, &s, &wanted));
        assert_true(sv_wall_grid_of(&camera, &layout, mm, &b, &s, &grid));
        assert_memory_equal(&grid, &wanted, sizeof grid);
    }
}

static void test_untold_beams_have_no_grid(void **state) {
    const sv_wall_settings s = sv_wall_settings_default();
    const double mm[3] = {1.0, 1.0, 1.0};
    const sv_wall_layout camera = sv_wall_layout_of(COLUMNS, ROWS, LAYERS, mm, &s);
    sv_wall_grid grid;
    assert_false(sv_wall_grid_of(&camera, &camera, mm, &(const sv_beams){.side = {0, 0, -1}}, &s, &grid));
}

/* The scan as a camera sees it that looks along the volume's x, from the probe's left: z becomes its x. */
static void look_from_left(const scan *from, scan *to) {
    for (uint32_t z = 0; z < N; z++)
        for (uint32_t y = 0; y < N; y++)
            for (uint32_t x = 0; x < N; x++)
                to->voxels[at(to, z, y, N - 1 - x)] = from->voxels[at(from, x, y, z)];
}

/* From the side a ray meets no wall, but fluid or the fetus: bare the beams nothing hides it. */
static void test_every_camera_has_the_same_answer(void **state) {
    sv_beams straight = {0}, turned = {0};
    memcpy(straight.rotation, STRAIGHT, sizeof STRAIGHT);
    memcpy(turned.rotation, FROM_LEFT, sizeof FROM_LEFT);
    for (int i = 0; i < 3; i++) {
        turned.rotation[3 * i] = 0.0f; /* the probe's x is the camera's -z, and its z the camera's x */
        turned.rotation[3 * i + 2] = i == 0 ? 1.0f : 0.0f;
    }
    turned.rotation[6] = -1.0f;
    for (int hidden = 0; hidden < 2; hidden++) {
        scan s = scan_make(N, N, N), t = scan_make(N, N, N), u = scan_make(N, N, N);
        draw(&s, hidden ? WALL : 0, GAP, true);
        look_from_left(&s, &t);
        look_from_left(&s, &u);
        s.beams = &straight;
        t.beams = &turned;
        scan_run(&s);
        scan_run(&t);
        scan_run(&u);
        print_message("gaps %.3f and %.3f, fetus %.3f and %.3f; not told: outcome %d, gaps %.3f\n",
                      s.facts.gap_share, t.facts.gap_share, s.facts.fetus, t.facts.fetus, (int)u.outcome,
                      u.facts.gap_share);
        assert_int_equal(s.outcome, hidden ? SV_WALL_SURFACE : SV_WALL_OPEN);
        assert_int_equal(t.outcome, s.outcome);
        assert_true(fabs(t.facts.fetus - s.facts.fetus) < 0.02 &&
                    fabs(t.facts.gap_share - s.facts.gap_share) < 0.02);
        if (hidden) assert_int_not_equal(u.outcome, SV_WALL_SURFACE);
    }
}

/* A frame of a volume; `finish`: to its end. */
static sv_status frame_of(rig *r, stage *t, const scan *s, bool same, bool finish) {
    rig_result out = rig_result_make(N, N);
    sv_status status = SV_OK;
    stage_fill(t, s->voxels, NULL);
    t->frame_flags = same ? SV_FRAME_SAME_VOLUME : 0;
    if (finish) {
        status = rig_frame(r, t, NULL, 0, &out);
    } else {
        const sv_frame frame = stage_frame(t, NULL, 0);
        const sv_slab slab = stage_slab(t, 0);
        assert_int_equal(r->plugin->begin(r->plugin, &frame), SV_OK);
        assert_int_equal(r->plugin->slab(r->plugin, &slab), SV_OK);
    }
    return status;
}

static sv_confidence_report report_of(const rig *r) {
    sv_confidence_report out = {.size = sizeof out};
    const sv_ext_confidence *const ext = r->plugin->get_extension(r->plugin, SV_EXT_CONFIDENCE);
    assert_int_equal(ext->read(r->plugin, NULL, &out), SV_OK);
    return out;
}

/* The answer is that of the volume, until a frame shows another one: so it costs nothing while a camera
 * turns, and no other camera changes it. A frame that came to no end told nothing. */
static void test_an_answer_holds_for_its_volume(void **state) {
    rig *const r = *state;
    scan hidden = scene(), bare = scan_make(N, N, N);
    draw(&bare, 0, GAP, true);
    const rig_format f = {.width = N,
                          .height = N,
                          .slices = N,
                          .slab_slices = N,
                          .padding = SV_NO_PADDING,
                          .carrier = SV_CARRIER_HOST,
                          .fixed = {{rig_param(r, "method"), 0, rig_enum(r, "method", "wall")}}};
    stage *t = rig_stage(r, &f, hidden.voxels);
    for (int a = 0; a < 3; a++) t->format.spacing_mm[a] = (float)MM;
    sv_beams beams = {.side = {0, 0, -1}};
    memcpy(beams.rotation, STRAIGHT, sizeof STRAIGHT);
    rig_tell(t, &beams);
    assert_int_equal(r->plugin->activate(r->plugin, &t->format), SV_OK);
    assert_int_equal(frame_of(r, t, &bare, true, true), SV_NO_SURFACE); /* there was no frame before */
    assert_int_equal(frame_of(r, t, &hidden, false, true), SV_OK);
    assert_int_equal(frame_of(r, t, &bare, true, true), SV_OK);
    assert_int_equal(frame_of(r, t, &bare, false, true), SV_NO_SURFACE);
    const sv_confidence_report said = report_of(r);
    assert_true(said.found < said.wanted);
    assert_int_equal(frame_of(r, t, &hidden, true, true), SV_NO_SURFACE);
    const sv_confidence_report kept = report_of(r);
    assert_true(kept.reason == said.reason && kept.found == said.found && kept.wanted == said.wanted);
    (void)frame_of(r, t, &hidden, false, false);
    assert_int_equal(frame_of(r, t, &hidden, true, true), SV_OK);
    /* A frame that tells no beams leaves no answer along them: the next one that does is asked anew. */
    rig_tell(t, &(const sv_beams){.side = {0, 0, 0}});
    (void)frame_of(r, t, &hidden, true, true);
    rig_tell(t, &beams);
    assert_int_equal(frame_of(r, t, &bare, true, true), SV_NO_SURFACE);
}

/* A probe that is turned by three angles, in degrees: about its z, then x, then the volume's y. */
static void turn(const double degrees[3], float rotation[9], float side[3]) {
    double s[3], c[3];
    for (int i = 0; i < 3; i++)
        s[i] = sin(degrees[i] * atan(1.0) / 45.0), c[i] = cos(degrees[i] * atan(1.0) / 45.0);
    const double r[9] = {c[2] * c[0] + s[2] * s[1] * s[0],
                         s[2] * s[1] * c[0] - c[2] * s[0],
                         s[2] * c[1],
                         c[1] * s[0],
                         c[1] * c[0],
                         -s[1],
                         c[2] * s[1] * s[0] - s[2] * c[0],
                         s[2] * s[0] + c[2] * s[1] * c[0],
                         c[2] * c[1]};
    for (int i = 0; i < 9; i++) rotation[i] = (float)r[i];
    for (int i = 0; i < 3; i++) side[i] = -rotation[3 * i + 2];
}

/* Makes all behind the wall dim, and most fluid lie behind that: no fetus is seen. */
static void hide_fetus(uint8_t *volume, uint32_t side) {
    enum { BEHIND_WALL = 28, LAKE = 44, DIM = 64, LAKE_LEVEL = 2 };
    const size_t plane = (size_t)side * side;
    for (size_t i = plane * BEHIND_WALL; i < plane * side; i++)
        if (volume[i] > 0) volume[i] = i >= plane * LAKE ? LAKE_LEVEL : volume[i] > DIM ? DIM : volume[i];
}

/* Frames that tell the beams: the grid along them has its own blocks, and its own answer. */
static void test_kernels_follow_the_definition(void **state) {
    static const struct {
        double degrees[3], apex_mm[3], sweep_mm;
    } fans[] = {{{0, 0, 0}, {40, 40, -30}, 12},     {{0, 0, 0}, {40, 40, -70}, -20},
                {{30, 0, 40}, {-30, 40, -10}, 0},   {{0, 25, -35}, {60, 80, -40}, 15},
                {{90, 0, 180}, {40, 40, 160}, 9},   {{0, 0, 90}, {-20, 40, 50}, 100000},
                {{0, -90, 0}, {40, -60, 40}, -9e4}, {{10, 10, 10}, {0, 0, -9e4}, 0},
                {{0, 0, 0}, {40, 40, 40}, 5},       {{0, 0, 180}, {40, 40, -30}, 12},
                {{45, 60, 45}, {0, 0, 0}, 0}};
    uint32_t answers[SV_WALL_OPEN + 1] = {0};
    for (uint32_t n = 0; n < 3 * sizeof fans / sizeof *fans; n++) {
        const uint32_t fan = n / 3;
        if (n % 3 == 2 - fan % 2 && !getenv("SV_NIGHT")) continue;
        const float mm =
            n % 3 == 2 ? 1.7f : 1.05f; /* of which blocks are single voxels, which are smoothed */
        sv_beams beams = {.kind = fan % 4 == 3 ? SV_BEAMS_PARALLEL : SV_BEAMS_FAN};
        turn(fans[fan].degrees, beams.rotation, beams.side);
        for (int a = 0; a < 3 && beams.kind == SV_BEAMS_FAN; a++)
            beams.apex_mm[a] = (float)fans[fan].apex_mm[a];
        if (beams.kind == SV_BEAMS_FAN) beams.sweep_mm = (float)fans[fan].sweep_mm;
        const wall_shape s = {.width = 84,
                              .height = 84,
                              .slices = 84,
                              .slab_slices = 24,
                              .padding = n % 3 ? SV_NO_PADDING : 0,
                              .spacing_mm = {mm, mm, mm},
                              .beams = &beams};
        sv_wall_outcome unasked = SV_WALL_OPEN;
        if (n % 3) {
            uint8_t *noise = wall_layered_noise(84, 84, 84, 30, 20, n);
            (void)wall_compare_outcome(*state, &s, noise, "beams", &unasked);
            answers[unasked]++;
            continue;
        }
        hs_scene_data data = make_scene(fan == 1   ? "H11"
                                        : fan % 2  ? "E01"
                                        : fan == 6 ? "H10"
                                                   : "D02",
                                        84, 2, 1, 0);
        if (fan == 0) hide_fetus(data.full.voxels, 84);
        (void)wall_compare_outcome(*state, &s, data.full.voxels, "beams", &unasked);
        answers[unasked]++;
    }
    print_message("answers: %u %u %u %u %u %u\n", answers[0], answers[1], answers[2], answers[3], answers[4],
                  answers[5]);
    for (int outcome = 0; outcome <= SV_WALL_OPEN; outcome++)
        if (outcome != SV_WALL_EMPTY) assert_true(answers[outcome] > 0);
}

enum { GEL_SIDE = 84 };

/* What of a scan lies nearer to the apex than `radius` becomes gel; then the scan as a camera sees it that
 * looks along x from the probe's left, if it is asked for. */
static uint8_t *with_gel(const uint8_t *volume, const sv_beams *b, double mm, double radius, bool left) {
    const size_t plane = (size_t)GEL_SIDE * GEL_SIDE;
    uint8_t *const out = unit_memory(plane * GEL_SIDE);
    for (size_t i = 0; i < plane * GEL_SIDE; i++) {
        const size_t x = i % GEL_SIDE, y = i / GEL_SIDE % GEL_SIDE, z = i / plane;
        const double off[3] = {(double)x * mm - (double)b->apex_mm[0], (double)y * mm - (double)b->apex_mm[1],
                               (double)z * mm - (double)b->apex_mm[2]};
        const bool gel = sqrt(off[0] * off[0] + off[1] * off[1] + off[2] * off[2]) < radius;
        out[left ? (GEL_SIDE - 1 - x) * plane + y * GEL_SIDE + z : i] = gel && volume[i] > 2 ? 2 : volume[i];
    }
    return out;
}

/* Gel of up to 10 mm before the wall, seen from before it and from its side, where few rays begin with it. */
static void test_gel_along_the_beams(void **state) {
    const double mm = 1.05;
    const hs_scene_data data = make_scene("E01", GEL_SIDE, 2, 1, 0);
    for (uint32_t n = 0; n < 4; n++) {
        sv_beams fan = {.kind = SV_BEAMS_FAN, .side = {0, 0, -1}, .apex_mm = {44, 44, -70}};
        sv_beams left = {.kind = SV_BEAMS_FAN, .side = {-1, 0, 0}, .apex_mm = {-70, 44, 43.15f}};
        memcpy(fan.rotation, STRAIGHT, sizeof STRAIGHT);
        memcpy(left.rotation, FROM_LEFT, sizeof FROM_LEFT);
        uint8_t *volume = with_gel(data.full.voxels, &fan, mm, n / 2 ? 80.0 : 75.0, n % 2);
        const wall_shape s = {.width = GEL_SIDE,
                              .height = GEL_SIDE,
                              .slices = GEL_SIDE,
                              .slab_slices = 24,
                              .padding = 0,
                              .spacing_mm = {(float)mm, (float)mm, (float)mm},
                              .beams = n % 2 ? &left : &fan};
        assert_true(wall_compare(*state, &s, volume, n % 2 ? "gel, from the left" : "gel"));
    }
}

UNIT_MAIN_OF(NULL, NULL, cmocka_unit_test(test_grid_follows_the_fan),
             cmocka_unit_test(test_untold_beams_have_no_grid),
             cmocka_unit_test(test_a_fan_from_behind_is_none),
             cmocka_unit_test(test_every_camera_has_the_same_answer),
             RIG_TEST(test_an_answer_holds_for_its_volume), RIG_TEST(test_kernels_follow_the_definition),
             RIG_TEST(test_gel_along_the_beams))
