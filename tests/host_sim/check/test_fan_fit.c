/* SPDX-License-Identifier: MIT */
/*
 * The beams that are found in the outline of a scan, against those that made it: Cartesian copies of probe
 * geometry, whose formula is that of a Kretz file, cropped, coarse, and from every face of the volume. What
 * is no fan is none.
 */
#include "support/fan_fixture.h"
#include "support/host_fixture.h"
#include "support/scene_fixture.h"
#include "volume/fan_fit.h"
#include "volume/metaimage.h"

#include <math.h>
#include <sys/stat.h>

/* Where the beam runs through a place, along the axes of the volume. */
static void beam_at(const double turn[9], const double apex[3], double sweep, const double place[3],
                    double out[3]) {
    double l[3] = {0}, along[3];
    for (int k = 0; k < 3; k++)
        for (int m = 0; m < 3; m++) l[k] += turn[m * 3 + k] * (place[m] - apex[m]);
    const double w = l[2] - sweep, h = hypot(l[1], w), c = h + sweep, r = hypot(l[0], c);
    along[0] = l[0] / r;
    along[1] = c / r * l[1] / h;
    along[2] = c / r * w / h;
    for (int m = 0; m < 3; m++) {
        out[m] = 0.0;
        for (int k = 0; k < 3; k++) out[m] += turn[m * 3 + k] * along[k];
    }
}

/* The largest angle between the beams that were found and the true ones, over what was scanned, degrees. */
static double worst_angle(const hs_volume *v, const double axes[9], const double apex[3], double sweep) {
    double found[9] = {0}, worst = 0.0;
    for (int i = 0; i < 9; i++)
        for (int k = 0; k < 3; k++) found[i] += axes[i / 3 * 3 + k] * v->probe_turn[k * 3 + i % 3];
    for (size_t n = 0; n < hs_volume_count(v); n += 997) {
        if (v->voxels[n] == 0) continue;
        const double place[3] = {((double)(n % v->nx) + 0.5) * v->spacing[0],
                                 ((double)(n / v->nx % v->ny) + 0.5) * v->spacing[1],
                                 ((double)(n / v->nx / v->ny) + 0.5) * v->spacing[2]};
        double a[3], b[3];
        beam_at(axes, apex, sweep, place, a);
        beam_at(found, v->course.apex, v->course.sweep, place, b);
        worst = fmax(worst, acos(fmin(1.0, a[0] * b[0] + a[1] * b[1] + a[2] * b[2])) * 57.2957795);
    }
    return worst;
}

/* The border is known to half a voxel, so half of it lies within a quarter of one, and an edge some 60 voxels
 * long tells its direction to less than a degree. By day every face twice, of other fans. */
static void fans_are_found(void **state) {
    for (size_t n = 0; n < FANS; n++) {
        hs_volume copy = fan_copy(&fan_shapes[n]);
        for (int face = 0; face < HS_PROBE_COUNT; face++) {
            if ((n + (size_t)face) % 3 != 0 && !getenv("SV_NIGHT")) continue;
            double apex[3], axes[9];
            char words[160];
            hs_volume v = fan_seen_from(&copy, &fan_shapes[n], (hs_probe)face, apex);
            (void)hs_volume_find_beams(&v, NULL);
            hs_course_words(&v, words, sizeof words);
            if (v.course.kind != HS_BEAMS_FAN || (int)v.probe != face || !v.course.found)
                fail_msg("geometry %zu, face %d: %s", n, face, words);
            hs_probe_axes(&v, v.probe, axes);
            const double angle = worst_angle(&v, axes, apex, fan_shapes[n].axis);
            if (angle > 1.0 || v.course.misfit > 0.3 * fan_shapes[n].spacing)
                fail_msg("geometry %zu, face %d: %g degrees, misfit %g mm: %s", n, face, angle,
                         v.course.misfit, words);
            hs_volume_free(&v);
        }
        (void)hs_volume_find_beams(&copy, NULL); /* as its file says it */
        assert_true(copy.course.kind == HS_BEAMS_FAN && copy.course.misfit == 0.0);
        assert_true(copy.course.sweep == fan_shapes[n].axis);
        hs_volume_free(&copy);
    }
}

/* A stated face is believed: a fan that narrows to another one is asked about. Without a known spacing it
 * tells a face and no place. */
static void what_is_stated_counts(void **state) {
    double apex[3];
    char question[160];
    hs_volume copy = fan_copy(&fan_shapes[0]), v = fan_seen_from(&copy, &fan_shapes[0], HS_PROBE_LOW_Y, apex);
    hs_volume_scanned_from(&v, HS_PROBE_LOW_Z);
    (void)hs_volume_find_beams(&v, NULL);
    hs_course_question(&v, question, sizeof question);
    assert_true(v.course.kind == HS_BEAMS_PARALLEL && v.probe == HS_PROBE_LOW_Z);
    assert_string_equal(question, "The scan narrows towards -y: is the probe there? --probe -y");
    hs_volume_scanned_from(&v, HS_PROBE_LOW_Y);
    (void)hs_volume_find_beams(&v, NULL);
    hs_course_question(&v, question, sizeof question);
    assert_true(v.course.kind == HS_BEAMS_FAN && !v.course.found);
    assert_string_equal(question, "");
    memset(v.probe_turn, 0, sizeof v.probe_turn);
    v.spacing_unsaid = true;
    (void)hs_volume_find_beams(&v, NULL);
    hs_course_question(&v, question, sizeof question);
    assert_int_equal(v.course.kind, HS_BEAMS_UNKNOWN);
    assert_string_equal(question, "The scan narrows towards -y: is the probe there? --probe -y");
    hs_volume_free(&v);
    hs_volume_free(&copy);
}

static void say_as_before(hs_volume *v, const hs_volume *before) {
    v->probe = before->probe;
    memcpy(v->probe_turn, before->probe_turn, sizeof v->probe_turn);
    v->pose = before->pose;
    v->spacing_unsaid = before->spacing_unsaid;
}

/* Takes some voxels from the middle of the far side, which the outline along the other axes does not show. */
static void dent(hs_volume *v) {
    const size_t plane = (size_t)v->nx * v->ny;
    for (uint32_t y = v->ny * 2 / 5; y < v->ny * 3 / 5; y++)
        for (uint32_t x = v->nx * 2 / 5; x < v->nx * 3 / 5; x++) {
            uint8_t *const column = v->voxels + (size_t)y * v->nx + x;
            uint32_t end = v->nz;
            while (end > 0 && column[(end - 1) * plane] == 0) end--;
            for (uint32_t i = 0; i < 4 && end > 0; i++) column[--end * plane] = 0;
        }
}

/* As a scanner keeps what it knows of its probe: of the same outline a fit is kept, with all its bits. */
static void a_fit_is_kept(void **state) {
    double apex[3];
    hs_fits fits = {0};
    hs_volume copy = fan_copy(&fan_shapes[0]), v = fan_seen_from(&copy, &fan_shapes[0], HS_PROBE_LOW_Y, apex);
    const hs_volume unknown = v;
    assert_true(hs_volume_find_beams(&v, &fits));
    const hs_volume first = v;
    for (size_t i = 0; i < hs_volume_count(&v); i++) v.voxels[i] = v.voxels[i] ? 77 : 0; /* the next volume */
    say_as_before(&v, &unknown);
    assert_false(hs_volume_find_beams(&v, &fits));
    assert_true(v.course.kind == HS_BEAMS_FAN && v.probe == HS_PROBE_LOW_Y);
    assert_memory_equal(&v.course, &first.course, sizeof v.course);
    assert_memory_equal(v.probe_turn, first.probe_turn, sizeof v.probe_turn);
    assert_false(v.probe == unknown.probe);
    hs_volume_scanned_from(&v,
                           HS_PROBE_LOW_Z); /* other words on the probe, another spacing, another outline */
    assert_true(hs_volume_find_beams(&v, &fits));
    v.spacing[2] *= 1.01;
    assert_true(hs_volume_find_beams(&v, &fits));
    const hs_volume known = v;
    assert_false(hs_volume_find_beams(&v, &fits));
    v.pose.direction[0] = -1.0; /* mirrored */
    assert_true(hs_volume_find_beams(&v, &fits));
    say_as_before(&v, &known);
    v.spacing_unsaid = true;
    assert_true(hs_volume_find_beams(&v, &fits));
    say_as_before(&v, &known); /* of which the fit is kept, too */
    assert_false(hs_volume_find_beams(&v, &fits));
    dent(&v);
    assert_true(hs_volume_find_beams(&v, &fits));
    memset(v.voxels, 0, (size_t)v.nx * v.ny * (v.nz / 2));
    assert_true(hs_volume_find_beams(&v, &fits));
    assert_false(hs_volume_find_beams(&v, &fits));
    v.probe = v.probe == HS_PROBE_LOW_Y ? HS_PROBE_HIGH_Y : HS_PROBE_LOW_Y; /* that alone */
    assert_true(hs_volume_find_beams(&v, &fits));
    hs_fits_free(&fits);
    hs_volume_free(&v);
    hs_volume_free(&copy);
}

/* Where the outline tells nothing, the apex that the file says is told on; a fan in the outline is fitted. */
static void an_apex_that_is_said_counts_where_nothing_is_found(void **state) {
    static const double said[3] = {30.0, 20.0, 150.0};
    hs_error err = {0};
    hs_volume v;
    assert_true(hs_volume_init(&v, 64, 48, 96, &err));
    for (size_t i = 0; i < hs_volume_count(&v); i++) v.voxels[i] = 100;
    v.apex_said = true;
    memcpy(v.apex, said, sizeof said);
    (void)hs_volume_find_beams(&v, NULL);
    assert_int_equal(v.course.kind, HS_BEAMS_UNKNOWN); /* without a side */
    hs_volume_scanned_from(&v, HS_PROBE_HIGH_Z);
    (void)hs_volume_find_beams(&v, NULL);
    assert_int_equal(v.course.kind, HS_BEAMS_FAN);
    assert_memory_equal(v.course.apex, said, sizeof said);
    assert_true(v.course.sweep == 0.0 && v.course.face == 54.0 && v.course.misfit == 0.0);
    v.spacing_unsaid = true;
    (void)hs_volume_find_beams(&v, NULL);
    assert_int_equal(v.course.kind, HS_BEAMS_PARALLEL);
    hs_volume_free(&v);

    double apex[3];
    hs_volume copy = fan_copy(&fan_shapes[0]),
              fan = fan_seen_from(&copy, &fan_shapes[0], HS_PROBE_LOW_Y, apex);
    hs_volume_scanned_from(&fan, HS_PROBE_LOW_Y);
    fan.apex_said = true;
    memcpy(fan.apex, said, sizeof said);
    (void)hs_volume_find_beams(&fan, NULL);
    assert_true(fan.course.kind == HS_BEAMS_FAN && fan.course.misfit > 0.0);
    hs_volume_free(&fan);
    hs_volume_free(&copy);
}

/* A full box, an empty one, a ball, a turned box. */
static bool is_inside(int kind, double x, double y, double z) {
    const double c = 0.9, s = 0.43589;
    return kind == 0   ? true
           : kind == 1 ? false
           : kind == 2 ? x * x + y * y + z * z < 0.2
           : kind == 4 ? fabs(x) < 0.45 && fabs(y) < 0.12 + 0.35 * (0.45 - x) * (0.45 - x) &&
                             fabs(z) < 0.1 + 0.4 * (0.45 - x) * (0.45 - x) /* a horn */
                       : fabs(c * x - s * y) < 0.3 && fabs(s * x + c * y) < 0.25 && fabs(z) < 0.4;
}

static hs_volume shaped(int kind) {
    hs_volume v;
    must(hs_volume_init(&v, 80, 70, 60, &err));
    for (size_t n = 0; n < hs_volume_count(&v); n++)
        v.voxels[n] = is_inside(kind, (double)(n % 80) / 80 - 0.5, (double)(n / 80 % 70) / 70 - 0.5,
                                (double)(n / 5600) / 60 - 0.5);
    return v;
}

static void others_are_none(void **state) {
    for (int kind = 0; kind < 4; kind++)
        for (int stated = 0; stated < 2; stated++) {
            hs_volume v = shaped(kind);
            if (stated) hs_volume_scanned_from(&v, HS_PROBE_HIGH_X);
            (void)hs_volume_find_beams(&v, NULL);
            if (v.course.kind != (stated ? HS_BEAMS_PARALLEL : HS_BEAMS_UNKNOWN))
                fail_msg("kind %d: beams are %d, misfit %g", kind, v.course.kind, v.course.misfit);
            hs_volume_free(&v);
        }
}

/* A box whose sides are oblique narrows to the probe like a fan. But its outline runs beside the fan that
 * comes closest, by a millimetre and more on a tenth of it, and its beams are parallel. */
static void oblique_box_is_parallel(void **state) {
    static const double axis[3] = {0, 0, 1}; /* of the beams, column 2 of the turn */
    char words[160];
    hs_scene_data data = make_scene("H03", 96, 2, 0, 0);
    hs_volume *v = &data.full;
    v->course = (hs_course){0};
    memset(v->probe_turn, 0, sizeof v->probe_turn);
    (void)hs_volume_find_beams(v, NULL);
    hs_course_words(v, words, sizeof words);
    assert_string_equal(words, "parallel, from -z, which the scan narrows to");
    for (int k = 0; k < 3; k++) assert_near(v->probe_turn[3 * k + 2], axis[k], 0.02);
}

/* What is said of a scan whose lengths are multiplied by these. */
static const char *asked_of(hs_volume *v, const double by[3], double fits[3]) {
    static char question[160];
    const double own[3] = {v->spacing[0], v->spacing[1], v->spacing[2]};
    for (int k = 0; k < 3; k++) v->spacing[k] *= by[k];
    (void)hs_volume_find_beams(v, NULL);
    hs_course_question(v, question, sizeof question);
    memset(v->probe_turn, 0, sizeof v->probe_turn);
    for (int k = 0; k < 3; k++) {
        fits[k] = v->course.fits[k] / own[k];
        v->spacing[k] = own[k];
    }
    return question;
}

/* Every second slice alone: voxels whose sides differ. */
static void thin_out(hs_volume *v) {
    const size_t slice = (size_t)v->nx * v->ny;
    v->nz /= 2;
    v->spacing[2] *= 2.0;
    for (size_t z = 1; z < v->nz; z++) memcpy(v->voxels + z * slice, v->voxels + 2 * z * slice, slice);
}

/* One axis doubled or halved, two exchanged: the outline tells the ratios that were. All of them: it is
 * asked. */
static void wrong_spacing_is_told(void **state) {
    static const double by[][3] = {{2, 1, 1},   {1, 2, 1},   {1, 1, 2},   {0.5, 1, 1},
                                   {1, 0.5, 1}, {1, 1, 0.5}, {1, 2, 0.5}, {2, 1, 0.5},
                                   {1.045, 1.914, 0.5} /* of no two exchanged: its ends are a tenth apart */};
    static const size_t which[] = {0, 1, 5};
    const size_t geometries = getenv("SV_NIGHT") ? sizeof which / sizeof *which : 1;
    for (size_t g = 0; g < geometries; g++) {
        hs_volume v = fan_copy(&fan_shapes[which[g]]);
        const double twice[3] = {2, 2, 2}, half[3] = {0.5, 0.5, 0.5};
        double fits[3];
        hs_beams_free(v.beams);
        v.beams = NULL;
        memset(v.probe_turn, 0, sizeof v.probe_turn);
        thin_out(&v);
        for (size_t n = 0; n < sizeof by / sizeof *by; n++) {
            const char *said = asked_of(&v, by[n], fits);
            bool right = strncmp(said, "As a fan this fits with ", 24) == 0;
            for (int k = 0; k < 3; k++) right &= fabs(fits[k] / fits[(k + 1) % 3] - 1.0) < 0.02;
            if (!right)
                fail_msg("geometry %zu, %g %g %g: %g %g %g, %s", which[g], by[n][0], by[n][1], by[n][2],
                         fits[0], fits[1], fits[2], said);
        }
        assert_non_null(strstr(asked_of(&v, twice, fits), "is the spacing right?"));
        if (g == 0) /* half of another is a fan as of a probe that is not held on the belly */
            assert_non_null(strstr(asked_of(&v, half, fits), "is the spacing right?"));
        assert_string_equal(asked_of(&v, (const double[3]){1, 1, 1}, fits), "");
        hs_volume_free(&v);
    }
}

/* The array of a library that counts [x, y, z], written by one that counts [z, y, x]. */
static hs_volume transposed(const hs_volume *v) {
    hs_volume out;
    must(hs_volume_init(&out, v->nz, v->ny, v->nx, &err));
    memcpy(out.spacing, v->spacing, sizeof out.spacing);
    for (size_t n = 0, z = 0; z < v->nz; z++)
        for (size_t y = 0; y < v->ny; y++)
            for (size_t x = 0; x < v->nx; x++) out.voxels[(x * out.ny + y) * out.nx + z] = v->voxels[n++];
    return out;
}

/* It keeps the spacing that it had, and is asked about, though the face that the scan narrows to is none of
 * those that fit best with it. */
static void a_transposed_scan_is_asked_about(void **state) {
    hs_scene_data data = make_scene("D01", 96, 2, 0, 0);
    double fits[3];
    data.full.course = (hs_course){0};
    thin_out(&data.full);
    hs_volume v = transposed(&data.full);
    const char *said = asked_of(&v, (const double[3]){1, 1, 1}, fits);
    assert_string_equal(said, "As a fan this fits with 2.5 x 1.25 x 1.25 mm: is the spacing right? --spacing "
                              "2.5,1.25,1.25");
    hs_volume_free(&v);
}

/* A ball is none from any face, and tells nothing of its spacing. What narrows to the stated face and is no
 * fan with any one axis mended is a doubt. */
static void a_stated_face_without_a_fan_is_doubted(void **state) {
    hs_volume v = shaped(2);
    char question[160];
    double apex[3], fits[3];
    hs_volume_scanned_from(&v, HS_PROBE_HIGH_X);
    (void)hs_volume_find_beams(&v, NULL);
    hs_course_question(&v, question, sizeof question);
    assert_string_equal(question, "");
    hs_volume_free(&v);

    hs_volume copy = fan_copy(&fan_shapes[0]);
    v = fan_seen_from(&copy, &fan_shapes[0], HS_PROBE_HIGH_X, apex);
    hs_volume_scanned_from(&v, HS_PROBE_HIGH_X);
    const char *asked = asked_of(&v, (const double[3]){2.3, 1.0, 1.7}, fits);
    if (!strstr(asked, "As a fan this fits with")) fail_msg("'%s'", asked);
    hs_volume_free(&v);
    hs_volume_free(&copy);

    v = shaped(4);
    hs_volume_scanned_from(&v, HS_PROBE_HIGH_X);
    (void)hs_volume_find_beams(&v, NULL);
    hs_course_question(&v, question, sizeof question);
    if (!strstr(question, "From +x no fan fits what was scanned")) fail_msg("'%s'", question);
    hs_volume_free(&v);
}

/* One level in all corners that somebody said was scanned: it may be what lies outside of a fan. Where it was
 * looked for, or a corner has an echo, nothing is asked. */
static void corners_of_one_level_are_asked_about(void **state) {
    char question[160];
    hs_volume v = shaped(2);
    for (size_t n = 0; n < hs_volume_count(&v); n++) v.voxels[n] = v.voxels[n] ? (uint8_t)(80 + n % 41) : 12;
    for (int kind = 0; kind < 3; kind++) {
        v.zeros_guessed = kind == 1;
        if (kind == 2) v.voxels[5] = 13;
        (void)hs_volume_find_beams(&v, NULL);
        hs_course_question(&v, question, sizeof question);
        const bool asked = strstr(question, "hold one grey level") && strstr(question, "--padding auto");
        if (asked != (kind == 0) || (kind > 0 && question[0])) fail_msg("kind %d: '%s'", kind, question);
    }
    hs_volume_free(&v);
}

static size_t zeros_of(const hs_volume *v) {
    size_t count = 0;
    for (size_t i = 0; i < hs_volume_count(v); i++) count += v->voxels[i] == 0;
    return count;
}

/* Fluid that was written as 0 was scanned, wherever it lies in the fan, in a volume that shares the beams,
 * too. Where a part of the scan was cut off nobody knows what was scanned, and what the file says counts. */
static void black_fluid_was_scanned(void **state) {
    enum { WHOLE_SCAN, CUT, SAID };
    for (int kind = WHOLE_SCAN; kind <= SAID; kind++) {
        double apex[3];
        hs_volume copy = fan_copy(&fan_shapes[0]),
                  v = fan_seen_from(&copy, &fan_shapes[0], HS_PROBE_LOW_Z, apex);
        const size_t outside = zeros_of(&v);
        for (size_t i = 0; i < hs_volume_count(&v); i++) {
            const double x = (double)(i % v.nx) / v.nx, y = (double)(i / v.nx % v.ny) / v.ny,
                         z = (double)(i / v.nx / v.ny) / v.nz;
            const bool pocket = hypot(x - 0.5, y - 0.45) < 0.1 && fabs(z - 0.5) < 0.2;
            if (pocket || (kind == CUT && x < 0.5 && z > 0.6)) v.voxels[i] = 0;
        }
        const size_t before = zeros_of(&v);
        hs_volume next;
        must(hs_volume_init(&next, v.nx, v.ny, v.nz, &err));
        memcpy(next.voxels, v.voxels, hs_volume_count(&v));
        memcpy(next.spacing, v.spacing, sizeof v.spacing);
        v.zeros_guessed = next.zeros_guessed = kind != SAID;
        (void)hs_volume_find_beams(&v, NULL);
        hs_volume_share_beams(&next, &v);
        assert_true(before > outside + 1000);
        assert_int_equal(zeros_of(&v), kind == WHOLE_SCAN ? outside : before);
        assert_memory_equal(next.voxels, v.voxels, hs_volume_count(&v));
        hs_volume_free(&next);
        hs_volume_free(&v);
        hs_volume_free(&copy);
    }
}

/* Real scans, where they are at hand: some are turned in their box, one ends within the fan. */
static void real_scans(void **state) {
    static const char *const scans[] = {"fetal_head_21w.mha", "fetal_head_22w.mha", "fetal_head_23w.mha",
                                        "real/fetus_12w.mha", "real/fetus_f48.mha", "real/fetus_f51.mha"};
    const char *source = getenv("SV_SOURCE_DIR");
    int found = 0;
    for (size_t i = 0; i < sizeof scans / sizeof *scans; i++) {
        struct stat status;
        hs_volume v;
        const char *const path = unit_text("%s/../shared/data/%s", source ? source : ".", scans[i]);
        if (stat(path, &status) != 0) continue;
        found++;
        must(hs_metaimage_read(path, NULL, &v, &err));
        (void)hs_volume_find_beams(&v, NULL);
        if (v.course.kind != HS_BEAMS_FAN || v.probe != HS_PROBE_LOW_Z || v.course.misfit > 0.2)
            fail_msg("%s: kind %d, misfit %g", v.name, v.course.kind, v.course.misfit);
        double fits[3]; /* the first one is turned in its box */
        if (i == 0 && !strstr(asked_of(&v, (const double[3]){1, 1, 2}, fits), "As a fan this fits with"))
            fail_msg("%s: nobody asks about a doubled spacing", v.name);
        hs_volume_free(&v);
    }
    if (found == 0) skip();
    const char *const hardly = unit_text("%s/../shared/data/site_b/E02_full.mha", source ? source : ".");
    char question[160];
    struct stat status;
    hs_volume v;
    if (stat(hardly, &status) != 0) return;
    must(hs_metaimage_read(hardly, NULL, &v, &err)); /* beams that hardly part, of another make of scenes */
    (void)hs_volume_find_beams(&v, NULL);
    hs_course_question(&v, question, sizeof question);
    assert_string_equal(question, "");
    hs_volume_free(&v);
}

UNIT_MAIN(NULL, NULL, fans_are_found, what_is_stated_counts, a_fit_is_kept,
          an_apex_that_is_said_counts_where_nothing_is_found, others_are_none, oblique_box_is_parallel,
          wrong_spacing_is_told, a_transposed_scan_is_asked_about, a_stated_face_without_a_fan_is_doubted,
          corners_of_one_level_are_asked_about, black_fluid_was_scanned, real_scans)
