/* SPDX-License-Identifier: MIT */
#include "commands/commands.h"

#include "commands/run.h"
#include "core/cli.h"
#include "core/options.h"
#include "core/text.h"
#include "loop/sequence.h"
#include "loop/source_options.h"
#include "volume/fan_fit.h"
#include "volume/metaimage_write.h"

#include <math.h>
#include <stdio.h>

static void print_pose(const hs_volume *v) {
    char words[200], letters[4], doubt[HS_DOUBT_BYTES];
    hs_pose_words(&v->pose, words, sizeof words);
    hs_pose_letters(&v->pose, letters);
    if (v->pose.stated)
        hs_print(stdout, "  in the patient: %s (%s)\n", words, letters);
    else
        (void)printf("  in the patient: not said\n");
    if (hs_pose_doubt(&v->pose, doubt)) hs_print(stdout, "  %s\n", doubt);
    if (hs_pose_is_mirrored(&v->pose))
        (void)printf("  the axes are left-handed: pictures are drawn with x reversed, as the patient is\n");
    hs_print(stdout, "  first voxel at (%g, %g, %g) mm%s\n", v->pose.origin[0], v->pose.origin[1],
             v->pose.origin[2], v->pose.stated ? " (left, back, head)" : "");
}

static void print_course(const hs_volume *v) {
    char words[160], question[160];
    hs_course_words(v, words, sizeof words);
    hs_course_question(v, question, sizeof question);
    (void)printf("  beams: %s\n", words);
    if (question[0]) (void)printf("  %s\n", question);
}

/* `from`: how values became levels; NULL: they always were. */
static void print_volume(const hs_volume *v, const hs_levels *from) {
    char size[HS_SIZE_BYTES], doubt[HS_DOUBT_BYTES], outside[80] = "";
    const size_t count = hs_volume_count(v);
    uint8_t low = 255, high = 0;
    for (size_t i = 0; i < count; i++) {
        const uint8_t level = v->voxels[i];
        if (level > 0 && level < low) low = level;
        if (level > high) high = level;
    }
    hs_volume_size_words(v, size);
    hs_print(stdout, "  %s\n", size);
    if (hs_volume_doubt(v, doubt)) hs_print(stdout, "  %s\n", doubt);
    print_pose(v);
    print_course(v);
    if (from) hs_levels_words(from, outside, sizeof outside);
    (void)printf("  %.2f %% of the voxels were not scanned%s", 100 * hs_unscanned_share(v), outside);
    if (high > 0)
        (void)printf("; the others hold %d .. %d\n", low, high);
    else
        (void)printf("\n");
}

#define DEGREES 57.29577951308232

static void print_angles(const char *what, const double *table, uint32_t count) {
    (void)printf("  %u %s over %.1f degrees%s%s\n", count, what, fabs(table[count - 1] - table[0]) * DEGREES,
                 table[0] > table[count - 1] ? ", from high to low" : "",
                 hs_beams_even(table, count) ? "" : ", in uneven steps");
}

static void print_beams(const hs_beams *b) {
    (void)printf("  scanned by a probe: %u samples of %g mm from %g mm on; the sweep's axis at %g mm\n",
                 b->samples, b->pitch, b->start, b->axis);
    print_angles("lines", b->theta, b->lines);
    print_angles("planes", b->phi, b->planes);
    (void)printf("  %s: a choice, the file does not say (--mirror for the other)\n  the Cartesian copy:\n",
                 hs_beams_side_name(b));
}

typedef struct {
    hs_source_files files;
    const char *cartesian; /* file to write, or NULL */
    uint32_t number; /* of the volume that is asked for, from 1 on; 0: all are read, the first is told */
    bool help;
} request;

static bool write_cartesian(const char *path, const hs_volume *v, hs_error *err) {
    const hs_metaimage_format format = {.type = HS_MET_UCHAR,
                                        .dims = 3,
                                        .size = {v->nx, v->ny, v->nz},
                                        .spacing = {v->spacing[0], v->spacing[1], v->spacing[2]},
                                        .pose = &v->pose};
    return hs_metaimage_write(path, &format, v->voxels, err);
}

/* What the file says about its volumes, of which `number` is described. */
static void print_sequence(const hs_sequence *s, uint32_t number) {
    const hs_source_origin *origins = hs_sequence_origins(s);
    const uint32_t volumes = hs_sequence_count(s), left_out = hs_sequence_left_out(s);
    const hs_frame_fields *first = &origins[0].fields, *last = &origins[volumes - 1].fields;
    if (volumes == 1 && left_out == 0) return;
    (void)printf("  a sequence of %u volumes", volumes);
    if (left_out > 0) (void)printf(", beside %u that are left out: their ImageStatus is INVALID", left_out);
    if (first->has_time && last->has_time && last->time > first->time)
        (void)printf("; %g s from the first to the last", last->time - first->time);
    for (uint32_t t = 0; t < first->transform_count; t++)
        hs_print(stdout, "%s%s", t ? ", " : "; transforms: ", first->transforms[t].name);
    (void)printf("\n  number %u:\n", number);
}

/* All volumes are read, so that a file that is damaged further on is told, unless one is asked for. */
static bool print_file(const char *path, const request *r, hs_error *err) {
    hs_sequence *s = hs_sequence_open(&path, 1, &r->files, err);
    hs_volume volume = {0};
    if (!s) return false;
    const uint32_t volumes = hs_sequence_count(s), number = r->number > 0 ? r->number : 1;
    bool ok =
        number <= volumes || hs_fail(err, HS_ERR_USAGE, "--number %u: %s has %u", r->number, path, volumes);
    for (uint32_t i = 1; ok && r->number == 0 && i < volumes; i++) ok = hs_sequence_read(s, i, &volume, err);
    ok = ok && hs_sequence_read(s, number - 1, &volume, err) &&
         (!r->cartesian || write_cartesian(r->cartesian, &volume, err));
    if (ok) {
        hs_print(stdout, "%s\n", path);
        print_sequence(s, number);
        (void)hs_volume_find_beams(&volume, NULL);
        if (volume.beams) print_beams(volume.beams);
        print_volume(&volume, hs_sequence_levels(s));
    }
    hs_volume_free(&volume);
    hs_sequence_close(s);
    return ok;
}

#define AT(field) offsetof(request, field)
static const hs_option options[] = {
    HS_FLAG("mirror", AT(files.kretz.mirrored),
            "Kretz files: positive sweep angles lie at +y (default: at -y)"),
    HS_SOURCE_SPACING_ROW(AT(files)),
    HS_SOURCE_PROBE_ROW(AT(files.metaimage)),
    HS_IN(COUNT, "number", "N", AT(number), 1, 65536,
          "volume N of a sequence, 1 is the first (default: all are read, the first is told)"),
    HS_TEXT("cartesian", "FILE.mha", AT(cartesian),
            "Kretz files: writes the Cartesian copy of that volume; of one FILE only"),
    HS_OPTIONS_END,
};

static const char usage[] =
    "Usage: host_sim info [options] FILE...\n"
    "Prints what MetaImage and Kretz volumes (also in DICOM) are: size, spacing, how they lie in\n"
    "the patient, the share of unscanned voxels; of a sequence, how many volumes\n"
    "there are, and this of the first one; of a probe its geometry. Nothing that names a person\n"
    "is printed.\n\n";

/* What is for Kretz files would do nothing with others. */
static bool check_files(const request *r, int count, char **files, hs_error *err) {
    const char *option = r->files.kretz.mirrored        ? "--mirror"
                         : r->files.kretz.spacing > 0.0 ? "--spacing"
                                                        : NULL;
    if (count == 0) return hs_fail(err, HS_ERR_USAGE, "no FILE given");
    if (r->cartesian && (count > 1 || !hs_kretz_is_file(files[0])))
        return hs_fail(err, HS_ERR_USAGE, "--cartesian %s: is for one Kretz file", r->cartesian);
    for (int i = 0; option && i < count; i++)
        if (!hs_kretz_is_file(files[i]))
            return hs_fail(err, HS_ERR_USAGE, "%s: is for Kretz files, %s is none", option, files[i]);
    return true;
}

int hs_cmd_info(int argc, char **argv) {
    hs_error err = {0};
    request r = {0};
    int first = argc;
    if (!hs_options_read(argc, argv, options, &r, &first, &r.help, &err)) return hs_cli_fail("info", &err);
    if (r.help) return hs_options_help(usage, options, "");
    if (!check_files(&r, argc - first, argv + first, &err)) return hs_cli_fail("info", &err);
    for (int i = first; i < argc; i++)
        if (!print_file(argv[i], &r, &err)) return hs_cli_fail("info", &err);
    return HS_OK;
}
