/* SPDX-License-Identifier: MIT */
/*
 * What is said of a scan whose spacing is wrong, as a table: told (with the unit, the spacing that fits, or
 * that none does), asked (anything else), or silent. The sides of voxels by other factors, each alone,
 * exchanged and at random, leave mostly no fan; a factor for all sides leaves a fan a fan, and is seen where
 * no probe has such a one. Of what is right nothing is said, whatever its shape. By night all scans, with
 * twelve random scalings each, from a stated face and from none; real ones where they are at hand.
 * Requirement: R13.
 */
#include "smartvis/lengths.h"
#include "support/fan_fixture.h"
#include "support/scene_fixture.h"
#include "volume/fan_fit.h"
#include "volume/metaimage.h"

#include <math.h>
#include <sys/stat.h>

enum { RIGHT, TOLD, ASKED, SILENT, ANSWERS };
typedef struct {
    int of[ANSWERS];
} tally;

/* With these factors, and the face stated or not. */
static int answer_of(const hs_volume *given, const double by[3], bool stated) {
    hs_volume v = *given;
    char doubt[HS_DOUBT_BYTES], question[160];
    for (int k = 0; k < 3; k++) v.spacing[k] *= by[k];
    memset(v.probe_turn, 0, sizeof v.probe_turn);
    v.zeros_guessed = false; /* the voxels are shared: nothing is filled */
    if (stated) hs_volume_scanned_from(&v, given->probe);
    if (hs_volume_doubt(&v, doubt)) return TOLD;
    (void)hs_volume_find_beams(&v, NULL);
    hs_course_question(&v, question, sizeof question);
    if (strstr(question, "As a fan") || strstr(question, "no fan fits") || strstr(question, "right?"))
        return TOLD;
    return question[0] ? ASKED : SILENT;
}

static void try(const hs_volume *v, const double by[3], bool stated, tally *t) {
    const int answer = answer_of(v, by, stated);
    t->of[answer]++;
    if (answer == SILENT && getenv("SV_NIGHT"))
        print_message("    silent: %s, %g %g %g, %s\n", v->name, by[0], by[1], by[2],
                      stated ? "stated" : "not stated");
}

/* Two sides differ by a quarter and more: less hardly bends a fan. */
static bool is_uneven(const double by[3]) {
    const double least = fmin(by[0], fmin(by[1], by[2])), most = fmax(by[0], fmax(by[1], by[2]));
    return most > 1.25 * least;
}

static void try_shapes(const hs_volume *v, bool stated, int randoms, tally *t) {
    static const double by[][3] = {{2, 1, 1},   {1, 2, 1},   {1, 1, 2},   {0.5, 1, 1},
                                   {1, 0.5, 1}, {1, 1, 0.5}, {1, 2, 0.5}, {2, 0.5, 1}};
    uint32_t random = 77;
    for (size_t n = 0; n < sizeof by / sizeof *by; n++)
        if (randoms > 10 || n % 4 == 2) try(v, by[n], stated, t);
    for (int n = 0; n < randoms;) {
        double some[3];
        for (int k = 0; k < 3; k++) some[k] = exp(1.1 * (unit_random(&random) / 2147483648.0 - 1.0));
        if (!is_uneven(some)) continue;
        try(v, some, stated, t);
        n++;
    }
}

static void try_wholes(const hs_volume *v, bool stated, tally *t) {
    static const double by[] = {0.001, 0.1, 0.5, 2.0, 10.0};
    for (size_t n = 0; n < sizeof by / sizeof *by; n++)
        try(v, (const double[3]){by[n], by[n], by[n]}, stated, t);
}

/* A row of the table. True if the answers are as they must be; `whole`: nothing of another shape may be
 * silent. */
static bool look_at(const hs_volume *v, bool whole, int randoms, bool stated) {
    tally right = {{0}}, shapes = {{0}}, wholes = {{0}};
    right.of[answer_of(v, (const double[3]){1, 1, 1}, stated)]++;
    try_shapes(v, stated, randoms, &shapes);
    try_wholes(v, stated, &wholes);
    print_message("%-14s %-10s | %s | %3d %3d %3d | %3d %3d %3d\n", v->name, stated ? "stated" : "not stated",
                  right.of[SILENT]  ? "silent"
                  : right.of[ASKED] ? "asked "
                                    : "told  ",
                  shapes.of[TOLD], shapes.of[ASKED], shapes.of[SILENT], wholes.of[TOLD], wholes.of[ASKED],
                  wholes.of[SILENT]);
    return right.of[SILENT] && !(whole && shapes.of[SILENT]);
}

static bool look_twice(const hs_volume *v, bool whole, int randoms) {
    const bool first = look_at(v, whole, randoms, false);
    return look_at(v, whole, randoms, true) && first;
}

static bool look_at_probes(int randoms) {
    bool good = true;
    for (size_t n = 0; n < (randoms > 10 ? FANS : 1); n++) {
        double apex[3];
        hs_volume copy = fan_copy(&fan_shapes[n]),
                  v = fan_seen_from(&copy, &fan_shapes[n], HS_PROBE_LOW_Z, apex);
        (void)snprintf(v.name, sizeof v.name, "probe %zu", n + 1);
        good &= look_twice(&v, true, randoms);
        hs_volume_free(&v);
        hs_volume_free(&copy);
    }
    return good;
}

static bool look_at_scenes(int randoms) {
    static const char *const names[] = {"E01", "H03", "example"};
    bool good = true;
    for (size_t n = 0; n < sizeof names / sizeof *names; n++) {
        hs_scene_data data = make_scene(names[n], 96, 2, 0, 0);
        (void)snprintf(data.full.name, sizeof data.full.name, "%s", names[n]);
        good &= look_twice(&data.full, false, randoms);
    }
    return good;
}

/* In which a fan is seen, clearly: of these no wrong shape is passed over. */
static const char *const fans[] = {"real/fetus_12w.mha", "real/fetus_f48.mha", "real/fetus_f51.mha",
                                   "fetal_head_21w.mha", "fetal_head_22w.mha", "site_c/C01_full.mha",
                                   "site_c/C07_full.mha"};
static const char *const others[] = {"spine_phantom.mha", "site_b/D01_full.mha", "site_b/E02_full.mha"};

static bool look_at_files(const char *const *scans, size_t count, bool whole, int randoms) {
    const char *source = getenv("SV_SOURCE_DIR");
    bool good = true;
    for (size_t n = 0; n < count; n++) {
        struct stat status;
        hs_volume v;
        const char *const path = unit_text("%s/../shared/data/%s", source ? source : ".", scans[n]);
        if (stat(path, &status) != 0) continue;
        must(hs_metaimage_read(path, NULL, &v, &err));
        const char *slash = strrchr(scans[n], '/');
        (void)snprintf(v.name, sizeof v.name, "%.14s", slash ? slash + 1 : scans[n]);
        v.probe = HS_PROBE_LOW_Z;
        good &= look_twice(&v, whole, randoms);
        hs_volume_free(&v);
    }
    return good;
}

static void wrong_spacing_is_not_passed_over(void **state) {
    const bool night = getenv("SV_NIGHT") != NULL;
    const int randoms = night ? 12 : 3;
    print_message(
        "scan, its face          | right  | one side, two: told asked silent | all sides: the same\n");
    bool good = look_at_probes(randoms);
    if (night) good &= look_at_scenes(randoms);
    if (night) good &= look_at_files(fans, sizeof fans / sizeof *fans, true, randoms);
    if (night) good &= look_at_files(others, sizeof others / sizeof *others, false, randoms);
    assert_true(good);
}

/* A plugin is told the apex and the volume, not the radius, which is larger where the volume begins at the
 * face's rim: both say where the lines meet by what both know. */
static void plugin_and_host_say_one_distance(void **state) {
    (void)state;
    hs_volume v = {.nx = 100, .ny = 100, .nz = 80, .spacing = {0.5, 0.5, 0.5}, .probe = HS_PROBE_LOW_Z};
    v.course = (hs_course){.kind = HS_BEAMS_FAN, .face = 38.0, .apex = {25.0, 25.0, -30.0}};
    const sv_format format = {
        .size = sizeof format, .width = 100, .height = 100, .slices = 80, .spacing_mm = {0.5f, 0.5f, 0.5f}};
    const sv_frame frame = {.size = sizeof frame,
                            .beams = SV_BEAMS_FAN,
                            .probe_rotation = {1, 0, 0, 0, 1, 0, 0, 0, 1},
                            .beam_apex_mm = {24.75f, 24.75f, -30.25f}}; /* from the first voxel's centre */
    char host[160], plugin[SV_LENGTHS_TEXT_BYTES];
    hs_course_question(&v, host, sizeof host);
    assert_true(sv_lengths_doubt_frame(&format, &frame, plugin, sizeof plugin));
    assert_string_equal(plugin, "the scan is 50 mm wide, and its lines meet 30 mm before the volume: is the "
                                "spacing right?");
    assert_true(host[0] == 'T' && strncmp(host + 1, plugin + 1, strlen(plugin + 1)) == 0);
}

UNIT_MAIN(NULL, NULL, wrong_spacing_is_not_passed_over, plugin_and_host_say_one_distance)
