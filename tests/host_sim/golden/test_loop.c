/* SPDX-License-Identifier: MIT */
/* The scan loop: pictures and depths that can be computed by hand. (Frames that create nothing:
 * test_loop_memory.) */
#include "show/loop_pictures.h"
#include "support/loop_fixture.h"

#include <math.h>

/* Depth of the map over the centre of pixel x: bilinear between map pixels, constant beyond the outer
 * ones. */
static double tilted_depth(double d, int x) {
    const double at = (x + 0.5) * LOW / PICTURE - 0.5;
    return d + fmin(fmax(at, 0), LOW - 1);
}

static void the_format_covers_the_volume(void **state) {
    const fixture *f = *state;
    const hs_loop_options o = options_with(NULL, 0);
    hs_loop *loop = make_loop(f, &o);
    const hs_slab_layout *l = hs_loop_layout(loop);
    assert_int_equal(l->width, LOW);
    assert_int_equal(l->height, LOW);
    assert_int_equal(l->slices, LOW);
    assert_int_equal(hs_slab_count(l), 3);
    assert_int_equal(hs_slab_length(l, 2), 4);
    assert_true(l->row_pitch >= l->tiles_x * l->tile_w && l->row_pitch % 64 == 0);
}

/* N voxels a side: a third of them are LOW. */
static void a_pixel_is_a_millimetre_where_the_source_allows_it(void **state) {
    static const struct {
        double spacing;
        uint32_t asked, across;
    } cases[] = {{1, 0, N},           {2, 0, N},     {0.75, 0, 36},  {0.5, 0, 24}, {0.375, 0, 18},
                 {1.0 / 3.0, 0, LOW}, {0.1, 0, LOW}, {0.75, 20, 20}, {0.1, N, N}};
    const fixture *f = *state;
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        hs_volume volume = make_layers(false);
        const hs_volume *one[] = {&volume};
        const hs_source source = {.volumes = one, .count = 1};
        hs_loop_options o = options_with(NULL, 0);
        o.lowres = cases[i].asked;
        for (int a = 0; a < 3; a++) volume.spacing[a] = cases[i].spacing;
        assert_int_equal(hs_loop_lowres(&source, &o), cases[i].across);
        hs_loop *loop = make_loop_from(&f->cl, &source, NULL, &o);
        assert_int_equal(hs_loop_layout(loop)->width, cases[i].across);
        assert_int_equal(hs_loop_layout(loop)->slices, cases[i].across);
    }
}

static void a_flat_plane_clips_where_it_lies(void **state) {
    const fixture *f = *state;
    static const double depths[] = {-3, 0, 0.4, 2.25, 5, 9.75, 12.25, 31};
    for (size_t i = 0; i < sizeof depths / sizeof depths[0]; i++) {
        const sv_param_value value = {.id = DEPTH, .value = depths[i]};
        const hs_loop_options o = options_with(&value, 1);
        hs_loop *loop = make_loop(f, &o);
        hs_view view = view_of(loop, 0);
        assert_true(view.maps.frame.clipped);
        const float end = end_of_ray(depths[i]);
        for (size_t p = 0; p < (size_t)PICTURE * PICTURE; p++) {
            assert_true(view.termination[p] == end);
            assert_true(view.full_termination[p] == OCCLUDER);
            assert_int_equal(view.result[4 * p], red_at(end, &o.dvr));
            assert_int_equal(view.full[4 * p], red_at(OCCLUDER, &o.dvr));
        }
        for (size_t r = 0; r < (size_t)LOW * LOW; r++) {
            assert_true(view.maps.depth[r] == (float)depths[i]);
            assert_int_equal(view.maps.status[r], SV_POINT_INITIAL);
        }
    }
}

/* Which way x runs, and that map and picture lie over each other to a fraction of a pixel. */
static void check_tilted(hs_loop *loop, const hs_loop_options *o, double depth) {
    hs_view view = view_of(loop, 0);
    assert_true(view.maps.frame.clipped);
    for (int y = 0; y < PICTURE; y++)
        for (int x = 0; x < PICTURE; x++) {
            const float end = end_of_ray(tilted_depth(depth, x));
            const size_t p = (size_t)y * PICTURE + (size_t)x;
            if (view.termination[p] != end)
                fail_msg("x %d: the ray ends at %g, expected %g", x, (double)view.termination[p],
                         (double)end);
            assert_int_equal(view.result[4 * p], red_at(end, &o->dvr));
        }
}

static void every_carrier_and_queue_gives_the_picture_of_a_tilted_plane(void **state) {
    const fixture *f = *state;
    static const struct {
        uint32_t carrier;
        bool own_queue;
    } ways[] = {{SV_CARRIER_HOST, false},
                {SV_CARRIER_HOST, true},
                {SV_CARRIER_BUFFER, false},
                {SV_CARRIER_IMAGE, false}};
    const sv_param_value values[2] = {{.id = DEPTH, .value = 1}, {.id = SHAPE, .value = 1}};
    for (size_t i = 0; i < sizeof ways / sizeof ways[0]; i++) {
        hs_loop_options o = options_with(values, 2);
        o.carrier = ways[i].carrier;
        o.own_queue = ways[i].own_queue;
        hs_loop *loop = make_loop(f, &o);
        check_tilted(loop, &o, 1);
    }
}

/* The left half of the map is a plane, the right half has no surface: the host draws the one and does not
 * clip the other. Between the middle pixels of the map a picture interpolates. */
static void a_partial_map_clips_where_it_has_a_surface(void **state) {
    const fixture *f = *state;
    hs_plugin *partial = open_plugin("partial");
    for (int own = 0; own < 2; own++) {
        const sv_param_value value = {.id = DEPTH, .value = 5};
        const hs_loop_options o = options_on(own, &value, 1);
        hs_loop *loop = make_loop_of(f, partial, &o);
        hs_view view = view_of(loop, 0);
        char note[160];
        assert_true(view.maps.frame.clipped);
        assert_int_equal(view.maps.frame.outcome, SV_PARTIAL);
        assert_int_equal(hs_loop_plugin_error(loop)->code, HS_OK);
        assert_string_equal(hs_frame_note(&view.maps.frame, "", note, sizeof note),
                            "Clipped in part: 128 of 256 rays have no clipping surface and show everything.");
        for (int y = 0; y < LOW; y++)
            for (int x = 0; x < LOW; x++) assert_true(view.maps.depth[y * LOW + x] == (x < LOW / 2 ? 5 : 0));
        for (int y = 0; y < PICTURE; y++)
            for (int x = 0; x < PICTURE; x++) {
                const float at = ((float)x + 0.5f) * LOW / PICTURE - 0.5f,
                            end = view.termination[y * PICTURE + x];
                if (at <= LOW / 2 - 1) assert_true(end == FETUS);
                if (at >= LOW / 2) assert_true(end == OCCLUDER);
            }
        hs_loop_result r;
        must(hs_loop_run(loop, HS_SETTING_SMARTVIS, NULL, &r, &err));
        assert_int_equal(r.clipped_frames, FRAMES);
        assert_int_equal(r.partial_frames, FRAMES);
        assert_int_equal(r.note_frames + r.failed_frames, 0);
    }
}

/* A positive status of begin is a success: what counts is the outcome of end. */
static void a_note_of_begin_changes_nothing(void **state) {
    const fixture *f = *state;
    const sv_param_value value = {.id = DEPTH, .value = 5};
    const hs_loop_options o = options_with(&value, 1);
    char note[160];
    hs_plugin *noting = open_plugin("note_early");
    hs_loop *loop = make_loop_of(f, noting, &o);
    hs_view view = view_of(loop, 0);
    assert_int_equal(view.maps.frame.outcome, SV_OK);
    assert_null(hs_frame_note(&view.maps.frame, "", note, sizeof note));
    assert_true(view.maps.frame.clipped && view.termination[0] == FETUS);
}

/* What is clipped although the plugin doubts it is never shown as a success. */
static void a_doubtful_surface_is_called_so(void **state) {
    const fixture *f = *state;
    const sv_param_value value = {.id = DEPTH, .value = 5};
    const hs_loop_options o = options_with(&value, 1);
    hs_loop_result r;
    char note[160];
    hs_plugin *doubtful = open_plugin("confidence_doubtful");
    hs_loop *loop = make_loop_of(f, doubtful, &o);
    hs_view view = view_of(loop, 0);
    assert_true(view.maps.frame.clipped && view.maps.frame.outcome == SV_OK);
    assert_string_equal(hs_frame_note(&view.maps.frame, "", note, sizeof note),
                        "Clipped although doubtful (14 %, sure from 30 %): the fetus may be cut.");
    must(hs_loop_run(loop, HS_SETTING_SMARTVIS, NULL, &r, &err));
    assert_int_equal(r.doubtful_frames, FRAMES);
}

/* ------------------------------------------------------------------------------ the loop -- */

static void results_add_up(void **state) {
    const fixture *f = *state;
    const sv_param_value value = {.id = DEPTH, .value = 5};
    const hs_loop_options o = options_with(&value, 1);
    hs_loop *loop = make_loop(f, &o);
    for (int s = 0; s < HS_SETTING_COUNT; s++) {
        hs_loop_result r;
        must(hs_loop_run(loop, (hs_setting)s, NULL, &r, &err));
        assert_int_equal(r.frames, FRAMES);
        assert_int_equal(r.clipped_frames, s == HS_SETTING_SMARTVIS ? FRAMES : 0);
        assert_int_equal(r.stats.points, s == HS_SETTING_SMARTVIS ? LOW * LOW : 0);
        for (int stage = 0; stage < HS_STAGE_COUNT; stage++) {
            assert_true(r.stage[stage].p95 >= r.stage[stage].median);
            assert_true(r.stage[HS_STAGE_LOOP].p95 >= r.stage[stage].median);
        }
        assert_true(r.volumes_per_second == 1e3 / r.stage[HS_STAGE_LOOP].median);
        assert_true(r.plugin_share >= 0 && r.plugin_share < 1);
        assert_false(r.has_plugin_stages); /* this plugin has no smartvis.timing/1 */
    }
}

static void a_sequence_shows_its_volumes_in_turn(void **state) {
    const fixture *f = *state;
    static fixture g; /* what is given back at the end refers to it */
    g = *f;
    g.source = (hs_source){.volumes = g.both, .count = 2};
    const hs_loop_options o = options_with(NULL, 0);
    hs_loop *loop = make_loop_of(&g, NULL, &o);
    for (uint32_t i = 0; i < 4; i++) {
        hs_view view = view_of(loop, i);
        const float end = i % 2 ? 0 : OCCLUDER;
        assert_true(view.termination[0] == end);
        assert_int_equal(view.result[0], i % 2 ? red_at(FETUS, &o.dvr) : red_at(OCCLUDER, &o.dvr));
    }
}

/* A scan writes its next volume where the last one was. What was transparent everywhere becomes tissue:
 * neither the voxels nor the renderer's grid of maxima may be those of the frame before. */
static void a_live_scan_is_uploaded_anew(void **state) {
    const fixture *f = *state;
    hs_volume scan = make_layers(false);
    const hs_volume *volumes[1] = {&scan};
    static fixture g; /* what is given back at the end refers to it */
    g = *f;
    g.source = (hs_source){.volumes = volumes, .count = 1};
    hs_loop_options o = options_with(NULL, 0);
    o.live = true;
    memset(scan.voxels, 10, hs_volume_count(&scan));
    hs_loop *loop = make_loop_of(&g, NULL, &o);
    static const uint8_t levels[3] = {10, 255, 10};
    for (uint32_t i = 0; i < 3; i++) {
        memset(scan.voxels, levels[i], hs_volume_count(&scan));
        hs_view view = view_of(loop, i);
        assert_true(view.termination[0] == (levels[i] == 255 ? 0 : N));
        assert_int_equal(view.result[0], levels[i] == 255 ? red_at(FETUS, &o.dvr) : 0);
        assert_true(view.maps.frame.ms[HS_STAGE_UPLOAD] > 0);
    }
}

static void an_orbit_keeps_one_box_and_lies_around_its_yaw(void **state) {
    const fixture *f = *state;
    hs_loop_options o = options_with(NULL, 0);
    o.frames = 3;
    o.yaw = 5;
    o.orbit = 40;
    assert_true(hs_loop_yaw(&o, 0) == -15 && hs_loop_yaw(&o, 1) == 5 && hs_loop_yaw(&o, 2) == 25);
    hs_loop *loop = make_loop_of(f, NULL, &o);
    hs_view views[3];
    for (uint32_t i = 0; i < 3; i++) views[i] = view_of(loop, i);
    for (uint32_t i = 1; i < 3; i++) {
        assert_true(views[i].maps.camera.extent == views[0].maps.camera.extent);
        assert_true(views[i].maps.camera.depth_extent == views[0].maps.camera.depth_extent);
        assert_true(memcmp(views[i].maps.camera.rotation, views[0].maps.camera.rotation,
                           sizeof views[0].maps.camera.rotation) != 0);
    }
    /* Seen 25 degrees from the side, a cube of 48 mm is 48 (cos 25 + sin 25) mm across. */
    const double across = N * (cos(25 * acos(-1) / 180) + sin(25 * acos(-1) / 180));
    assert_true(views[0].maps.camera.extent >= across - 1e-6 && views[0].maps.camera.extent < across + 1);
}

static void the_ground_truth_is_rendered_with_the_same_camera(void **state) {
    const fixture *f = *state;
    static fixture g; /* what is given back at the end refers to it */
    g = *f;
    static const hs_volume *truths[1];
    truths[0] = &f->bright;
    g.source.truths = truths;
    const hs_loop_options o = options_with(NULL, 0);
    hs_loop *loop = make_loop(&g, &o);
    hs_view view = view_of(loop, 0);
    assert_non_null(view.truth);
    assert_int_equal(view.truth[0], red_at(FETUS, &o.dvr));
}

UNIT_MAIN(set_up, tear_down, the_format_covers_the_volume, a_pixel_is_a_millimetre_where_the_source_allows_it,
          a_flat_plane_clips_where_it_lies, every_carrier_and_queue_gives_the_picture_of_a_tilted_plane,
          a_partial_map_clips_where_it_has_a_surface, a_doubtful_surface_is_called_so,
          a_note_of_begin_changes_nothing, results_add_up, a_sequence_shows_its_volumes_in_turn,
          a_live_scan_is_uploaded_anew, an_orbit_keeps_one_box_and_lies_around_its_yaw,
          the_ground_truth_is_rendered_with_the_same_camera)
