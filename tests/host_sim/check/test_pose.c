/* SPDX-License-Identifier: MIT */
/* How a volume lies in the patient, held to hand-made directions: words, letters, world coordinates, and what
 * a camera at a named place sees, for every way a volume can lie along the patient's axes.
 * Requirement: R14. */
#include "render/camera.h"
#include "smartvis/probe.h"
#include "support/unit.h"
#include "volume/volume.h"

#include <math.h>

static void letters_and_words_name_the_directions(void **state) {
    static const struct {
        double direction[9];
        const char *letters, *words;
        bool mirrored;
    } known[] = {
        {{1, 0, 0, 0, 1, 0, 0, 0, 1}, "RAI", "x to the left, y to the back, z to the head", false},
        {{-1, 0, 0, 0, -1, 0, 0, 0, 1}, "LPI", "x to the right, y to the front, z to the head", false},
        {{-1, 0, 0, 0, 1, 0, 0, 0, 1}, "LAI", "x to the right, y to the back, z to the head", true},
        {{0, 0, 1, 1, 0, 0, 0, 1, 0}, "AIR", "x to the back, y to the head, z to the left", false},
        {{0, 0, -1, 0, 1, 0, -1, 0, 0}, "SAL", "x to the feet, y to the back, z to the right", true},
        {{0.8, 0.6, 0, -0.6, 0.8, 0, 0, 0, 1},
         "RAI",
         "x to the left (37 degrees off), y to the back (37 degrees off), z to the head",
         false},
    };
    for (size_t i = 0; i < sizeof known / sizeof *known; i++) {
        hs_pose pose = {0};
        char letters[4], words[200];
        memcpy(pose.direction, known[i].direction, sizeof pose.direction);
        hs_pose_letters(&pose, letters);
        hs_pose_words(&pose, words, sizeof words);
        assert_string_equal(letters, known[i].letters);
        assert_int_equal(hs_pose_is_mirrored(&pose), known[i].mirrored);
        assert_string_equal(words, known[i].words);
    }
}

static void letters_give_directions(void **state) {
    hs_pose pose;
    hs_pose_default(&pose);
    static const char *const none[] = {"", "RA", "RAII", "RRI", "RLI", "XAI", "RAX"};
    for (size_t i = 0; i < sizeof none / sizeof *none; i++)
        assert_false(hs_pose_from_letters(&pose, none[i]));
    for (int i = 0; i < 9; i++) assert_true(pose.direction[i] == (i % 4 == 0));
    assert_true(hs_pose_from_letters(&pose, "air"));
    static const double expected[9] = {0, 0, 1, 1, 0, 0, 0, 1, 0};
    for (int i = 0; i < 9; i++) assert_true(pose.direction[i] == expected[i]);
}

static void indices_lie_where_the_pose_says(void **state) {
    const hs_pose pose = {.origin = {10, 20, 30}, .direction = {0, 0, 1, 1, 0, 0, 0, -1, 0}};
    const double spacing[3] = {0.5, 2, 3}, index[3] = {4, 5, 6};
    double world[3];
    hs_pose_world(&pose, spacing, index, world);
    assert_true(world[0] == 10 + 3 * 6 && world[1] == 20 + 0.5 * 4 && world[2] == 30 - 2 * 5);
}

/* The camera's axes in the world: directions times rotation. */
static void world_axes(const hs_volume *volume, const hs_camera *camera, double out[9]) {
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++) {
            out[i * 3 + j] = 0;
            for (int k = 0; k < 3; k++)
                out[i * 3 + j] += volume->pose.direction[i * 3 + k] * camera->rotation[k * 3 + j];
        }
}

static void expect_column(const double axes[9], int column, double left, double back, double head) {
    const double expected[3] = {left, back, head};
    for (int k = 0; k < 3; k++)
        if (fabs(axes[k * 3 + column] - expected[k]) > 1e-12)
            fail_msg("column %d, row %d: %g, expected %g", column, k, axes[k * 3 + column], expected[k]);
}

/* What a doctor expects: from the front, the patient's left is on the right of the picture. */
static const struct {
    hs_from from;
    double right[3], down[3], depth[3]; /* the picture's axes, in left, back, head */
} views[] = {
    {HS_FROM_ANTERIOR, {1, 0, 0}, {0, 0, -1}, {0, 1, 0}},
    {HS_FROM_POSTERIOR, {-1, 0, 0}, {0, 0, -1}, {0, -1, 0}},
    {HS_FROM_LEFT, {0, 1, 0}, {0, 0, -1}, {-1, 0, 0}},
    {HS_FROM_RIGHT, {0, -1, 0}, {0, 0, -1}, {1, 0, 0}},
    {HS_FROM_SUPERIOR, {-1, 0, 0}, {0, 1, 0}, {0, 0, -1}},
    {HS_FROM_INFERIOR, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}},
};

static void named_places_show_the_patient_however_the_volume_lies(void **state) {
    static const char *const lies[] = {"RAI", "LAI", "RPI", "LPS", "AIR", "IAR", "SPL", "PSR", "RIA", "IRA"};
    for (size_t l = 0; l < sizeof lies / sizeof *lies; l++) {
        hs_volume volume = {.nx = 10, .ny = 20, .nz = 30, .spacing = {1, 1, 1}};
        assert_true(hs_pose_from_letters(&volume.pose, lies[l]));
        for (size_t v = 0; v < sizeof views / sizeof *views; v++) {
            hs_camera camera;
            double axes[9];
            hs_camera_look_from(&camera, &volume, views[v].from, 0, 0);
            world_axes(&volume, &camera, axes);
            expect_column(axes, 0, views[v].right[0], views[v].right[1], views[v].right[2]);
            expect_column(axes, 1, views[v].down[0], views[v].down[1], views[v].down[2]);
            expect_column(axes, 2, views[v].depth[0], views[v].depth[1], views[v].depth[2]);
        }
    }
}

static double det(const double *d) {
    return d[0] * (d[4] * d[8] - d[5] * d[7]) - d[1] * (d[3] * d[8] - d[5] * d[6]) +
           d[2] * (d[3] * d[7] - d[4] * d[6]);
}

/* From each face the beams run to the opposite one, and no picture is a mirror image. */
static void probes_look_into_the_volume(void **state) {
    static const double beams[HS_PROBE_COUNT][3] = {{0, 0, 1},  {0, 0, -1}, {0, 1, 0},
                                                    {0, -1, 0}, {1, 0, 0},  {-1, 0, 0}};
    for (int mirrored = 0; mirrored < 2; mirrored++)
        for (int probe = 0; probe < HS_PROBE_COUNT; probe++) {
            hs_volume volume = {.nx = 10, .ny = 20, .nz = 30, .spacing = {1, 2, 3}, .probe = (hs_probe)probe};
            hs_camera camera;
            double axes[9];
            assert_true(hs_pose_from_letters(&volume.pose, mirrored ? "LAI" : "RAI"));
            hs_camera_look(&camera, &volume, 0, 0);
            for (int k = 0; k < 3; k++) assert_true(camera.rotation[k * 3 + 2] == beams[probe][k]);
            world_axes(&volume, &camera, axes);
            assert_true(fabs(det(axes) - 1) < 1e-12);
            hs_camera_look(&camera, &volume, 33, -20);
            world_axes(&volume, &camera, axes);
            assert_true(fabs(det(axes) - 1) < 1e-12);
        }
}

static const uint32_t box_voxels[3] = {8, 16, 32};

static void tell(const hs_camera *camera, const hs_volume *volume, sv_frame *frame) {
    hs_told told;
    hs_camera_tell(camera, volume, box_voxels, &told);
    memcpy(frame->probe_rotation, told.rotation, sizeof told.rotation);
    memcpy(frame->probe_side, told.side, sizeof told.side);
    memcpy(frame->beam_apex_mm, told.apex_mm, sizeof told.apex_mm);
    frame->beam_sweep_mm = told.sweep_mm;
    frame->beams = told.beams;
}

/* The map by which slabs are made leads from the told apex, in voxels of the box, to the volume's own. */
static void the_apex_is_where_it_was(const hs_camera *camera, const hs_volume *volume,
                                     const sv_frame *frame) {
    const double box[3] = {camera->extent, camera->extent, camera->depth_extent};
    hs_box_map map;
    double part[3];
    hs_camera_box_map(camera, volume, &map);
    for (int k = 0; k < 3; k++) part[k] = (double)frame->beam_apex_mm[k] / box[k] + 0.5 / box_voxels[k];
    for (int k = 0; k < 3; k++) {
        const double index = map.origin[k] + part[0] * map.du[k] + part[1] * map.dv[k] + part[2] * map.dw[k];
        assert_true(fabs((index + 0.5) * volume->spacing[k] - volume->course.apex[k]) < 1e-4);
    }
    assert_true(frame->beams == SV_BEAMS_FAN && frame->beam_sweep_mm == 5.0f);
}

/* Looked at from the probe, its axes are the camera's. From elsewhere, beams that run into the volume run so
 * in the camera's axes, too, and the probe is where they come from. */
static void the_probe_is_where_the_beams_come_from(void **state) {
    static const hs_from places[] = {HS_FROM_PROBE, HS_FROM_ANTERIOR, HS_FROM_LEFT};
    for (int mirrored = 0; mirrored < 2; mirrored++)
        for (int probe = 0; probe < HS_PROBE_COUNT; probe++)
            for (int n = 0; n < 9; n++) {
                hs_volume volume = {.nx = 10, .ny = 20, .nz = 30, .spacing = {1, 2, 3}};
                hs_camera camera, from_probe;
                sv_frame frame = {.size = sizeof frame};
                char wrong[200];
                assert_true(hs_pose_from_letters(&volume.pose, mirrored ? "LAI" : "RAI"));
                hs_camera_look_from(&camera, &volume, places[n % 3], n / 3 * 40.0, n / 3 * -25.0);
                tell(&camera, &volume, &frame);
                for (int k = 0; k < 9; k++) assert_true(frame.probe_rotation[k] == 0.0f);
                hs_volume_scanned_from(&volume, (hs_probe)probe);
                hs_camera_look(&from_probe, &volume, 0, 0);
                hs_camera_look_from(&camera, &volume, places[n % 3], n / 3 * 40.0, n / 3 * -25.0);
                volume.course = (hs_course){.kind = HS_BEAMS_FAN, .apex = {4, 3, 2}, .sweep = 5};
                tell(&camera, &volume, &frame);
                the_apex_is_where_it_was(&camera, &volume, &frame);
                if (!sv_probe_holds(&frame, wrong, sizeof wrong)) fail_msg("%s", wrong);
                for (int row = 0; row < 3; row++)
                    for (int column = 0; column < 3; column++) {
                        double along = 0; /* of the camera's axis and the probe's, both in the volume */
                        for (int k = 0; k < 3; k++)
                            along += camera.rotation[k * 3 + row] * from_probe.rotation[k * 3 + column];
                        assert_true(fabs((double)frame.probe_rotation[row * 3 + column] - along) < 1e-6);
                        if (n == 0) assert_true(frame.probe_rotation[row * 3 + column] == (row == column));
                    }
            }
}

/* yaw turns to the picture's right and pitch up, also in a left-handed volume. */
static void turns_are_the_pictures(void **state) {
    for (int mirrored = 0; mirrored < 2; mirrored++) {
        hs_volume volume = {.nx = 10, .ny = 10, .nz = 10, .spacing = {1, 1, 1}};
        hs_camera straight, turned;
        assert_true(hs_pose_from_letters(&volume.pose, mirrored ? "LAI" : "RAI"));
        hs_camera_look(&straight, &volume, 0, 0);
        hs_camera_look(&turned, &volume, 30, 20);
        double right = 0, down = 0;
        for (int k = 0; k < 3; k++) {
            right += straight.rotation[k * 3] * turned.rotation[k * 3 + 2];
            down += straight.rotation[k * 3 + 1] * turned.rotation[k * 3 + 2];
        }
        assert_true(right > 0.4 && down < -0.3);
    }
}

/* The mark tells what is at the picture's right and at its top, whatever the volume's axes are. */
static void marks_tell_what_is_at_the_right(void **state) {
    static const struct {
        hs_from from;
        const char *mark;
    } marks[] = {{HS_FROM_ANTERIOR, "patient's left at the right, head at the top"},
                 {HS_FROM_POSTERIOR, "patient's right at the right, head at the top"},
                 {HS_FROM_LEFT, "patient's back at the right, head at the top"},
                 {HS_FROM_RIGHT, "patient's front at the right, head at the top"},
                 {HS_FROM_SUPERIOR, "patient's right at the right, front at the top"},
                 {HS_FROM_INFERIOR, "patient's left at the right, front at the top"}};
    static const char *const lies[] = {"RAI", "LAI", "SPL", "IRA"};
    for (size_t l = 0; l < sizeof lies / sizeof *lies; l++)
        for (size_t m = 0; m < sizeof marks / sizeof *marks; m++) {
            hs_volume volume = {.nx = 9, .ny = 9, .nz = 9, .spacing = {1, 1, 1}, .pose = {.stated = true}};
            hs_camera camera;
            char mark[64];
            assert_true(hs_pose_from_letters(&volume.pose, lies[l]));
            for (int turn = -1; turn <= 1; turn++) { /* up to 40 degrees the closest ends are the same */
                hs_camera_look_from(&camera, &volume, marks[m].from, 40 * turn, 0);
                hs_camera_mark(&camera, &volume, mark, sizeof mark);
                assert_string_equal(mark, marks[m].mark);
            }
        }
}

/* From the probe: x to the patient's right is at the picture's right. Nothing known, nothing said. */
static void marks_are_there_only_if_something_is_known(void **state) {
    hs_volume volume = {.nx = 9, .ny = 9, .nz = 9, .spacing = {1, 1, 1}, .pose = {.stated = true}};
    hs_beams beams = {0};
    hs_camera camera;
    char title[80];
    assert_true(hs_pose_from_letters(&volume.pose, "LIA"));
    hs_camera_look(&camera, &volume, 0, 0);
    hs_camera_title("scan", &camera, &volume, title, sizeof title);
    assert_string_equal(title, "scan, patient's right at the right, feet at the top");
    hs_camera_look(&camera, &volume, 45, 45);
    hs_camera_title("scan", &camera, &volume, title, sizeof title);
    assert_non_null(strstr(title, "at the top"));
    volume.pose.stated = false;
    hs_camera_title("scan", &camera, &volume, title, sizeof title);
    assert_string_equal(title, "scan");
    volume.beams = &beams;
    hs_camera_title("scan", &camera, &volume, title, sizeof title);
    assert_string_equal(title, "scan, sweep + at -y");
}

UNIT_MAIN(NULL, NULL, letters_and_words_name_the_directions, letters_give_directions,
          indices_lie_where_the_pose_says, named_places_show_the_patient_however_the_volume_lies,
          probes_look_into_the_volume, the_probe_is_where_the_beams_come_from, turns_are_the_pictures,
          marks_tell_what_is_at_the_right, marks_are_there_only_if_something_is_known)
