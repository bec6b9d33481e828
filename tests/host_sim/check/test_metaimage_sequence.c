/* SPDX-License-Identifier: MIT */
/* Sequences in MetaImage files: read volume by volume with what is said about each of them, and never taken
 * for something else. Every rule has a file that breaks it and one that just does not. */
#include "support/metaimage_files.h"

#define FRAMES "Kinds = domain domain domain list\n"
#define MATRIX "0 -1 0 10.5 1 0 0 20 0 0 1 30 0 0 0 1"

enum { VOXELS = 8 };

/* `frames` volumes of 2 x 2 x 2 voxels, of which number f holds 10 f + 1 .. 10 f + 8. */
static void write_sequence(const char *name, const char *lines, int frames) {
    uint8_t data[16 * VOXELS];
    for (int i = 0; i < frames * VOXELS; i++) data[i] = (uint8_t)(i / VOXELS * 10 + i % VOXELS + 1);
    files_volume(name, unit_text("2 2 2 %d", frames), "MET_UCHAR", lines, data, (size_t)frames * VOXELS);
}

static void volumes_come_one_after_the_other(void **state) {
    static const char *const kinds[] = {"", FRAMES, "Kinds = space space space time\n"};
    for (size_t k = 0; k < 3; k++) {
        hs_error err = {0};
        write_sequence("four.mha", kinds[k], 4);
        hs_metaimage *file = hs_metaimage_open(files_path("four.mha"), NULL, &err);
        assert_non_null(file);
        assert_int_equal(hs_metaimage_volumes(file), 4);
        assert_int_equal(hs_metaimage_left_out(file), 0);
        for (int f = 0; f < 4; f++) {
            hs_volume volume = {0};
            assert_true(hs_metaimage_read_at(file, (uint32_t)f, &volume, &err));
            assert_int_equal(volume.nz, 2);
            for (int i = 0; i < VOXELS; i++) assert_int_equal(volume.voxels[i], f * 10 + i + 1);
            const hs_frame_fields *fields = hs_metaimage_fields(file, (uint32_t)f);
            assert_false(fields && fields->has_time);
            hs_volume_free(&volume);
        }
        hs_metaimage_close(file);
    }
    files_refused("four.mha", "DimSize is 2 2 2 4: a sequence of 4 volumes, expected one volume");
}

static void what_is_said_of_a_volume_is_kept(void **state) {
    hs_error err = {0};
    write_sequence("said.mha",
                   FRAMES "Seq_Frame0000_Timestamp = 1.25\nSeq_Frame0000_ImageStatus = OK\n"
                          "Seq_Frame0001_ProbeToTrackerTransform = " MATRIX "\n"
                          "Seq_Frame0001_ProbeToTrackerTransformStatus = OUT_OF_VIEW\n"
                          "Seq_Frame0001_Operator = Doe^Jane\nSeq_Frame0001_Timestamp = 1.5\n",
                   2);
    hs_metaimage *file = hs_metaimage_open(files_path("said.mha"), NULL, &err);
    assert_non_null(file);
    hs_frame_fields f = *hs_metaimage_fields(file, 0);
    assert_true(f.has_time && f.time == 1.25 && f.transform_count == 0);
    f = *hs_metaimage_fields(file, 1);
    assert_true(f.has_time && f.time == 1.5);
    assert_int_equal(f.transform_count, 1);
    assert_string_equal(f.transforms[0].name, "ProbeToTracker");
    assert_string_equal(f.transforms[0].status, "OUT_OF_VIEW");
    static const double matrix[16] = {0, -1, 0, 10.5, 1, 0, 0, 20, 0, 0, 1, 30, 0, 0, 0, 1};
    for (int i = 0; i < 16; i++) assert_true(f.transforms[0].matrix[i] == matrix[i]);
    hs_metaimage_close(file);
}

static void a_file_of_invalid_volumes_is_refused(void **state) {
    write_sequence("none.mha",
                   FRAMES "Seq_Frame0000_ImageStatus = INVALID\nSeq_Frame0001_ImageStatus = INVALID\n", 2);
    files_refused("none.mha", "ImageStatus is INVALID for every volume");
}

/* Lines that break a rule, and lines that just do not. */
static void every_rule_has_a_file_on_either_side(void **state) {
    static const struct {
        const char *broken, *told, *whole;
    } rules[] = {
        {"Kinds = domain domain list\n", "Kinds is 'domain domain list', expected domain domain domain list",
         FRAMES},
        {"Kinds = domain domain domain domain\n", "expected domain domain domain list",
         "Kinds = domain domain domain time\n"},
        {"Kinds = list domain domain domain\n", "expected domain domain domain list", FRAMES},
        {"Kinds = domain domain domain list list\n", "expected domain domain domain list", FRAMES},
        {"Kinds =\n", "Kinds is ''", FRAMES},
        {"Seq_Frame0002_Timestamp = 1\n", "Seq_Frame0002_Timestamp: is about a volume behind the last one",
         "Seq_Frame0001_Timestamp = 1\n"},
        {"Seq_Frame_Timestamp = 1\n", "expected a name Seq_Frame<number>_<what>",
         "Seq_Frame1_Timestamp = 1\n"},
        {"Seq_Frame0001 = 1\n", "expected a name Seq_Frame<number>_<what>", "Seq_Frame0001_X = 1\n"},
        {"Seq_Frame18446744073709551617_X = 1\n", "is about a volume behind the last one",
         "Seq_Frame00000000000000001_X = 1\n"},
        {"Seq_Frame0001_Timestamp = soon\n",
         "Seq_Frame0001_Timestamp is 'soon', expected a number of seconds",
         "Seq_Frame0001_Timestamp = -1e3\n"},
        {"Seq_Frame0001_Timestamp = 1 s\n", "expected a number of seconds", "Seq_Frame0001_Timestamp = 1 \n"},
        {"Seq_Frame0001_Timestamp = inf\n", "expected a number of seconds",
         "Seq_Frame0001_Timestamp = 1e300\n"},
        {"Seq_Frame0001_ImageStatus = FINE\n", "is 'FINE', expected OK or INVALID",
         "Seq_Frame0001_ImageStatus = OK\n"},
        {"Seq_Frame0001_ATransform = 1 0 0 0 0 1 0 0 0 0 1 0 0 0 0\n", "expected 16 numbers",
         "Seq_Frame0001_ATransform = 1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1\n"},
        {"Seq_Frame0001_ATransform = " MATRIX " 0\n", "expected 16 numbers",
         "Seq_Frame0001_ATransform = " MATRIX "\n"},
        {"Seq_Frame0001_ATransform = 1 0 0 nan 0 1 0 0 0 0 1 0 0 0 0 1\n", "expected 16 numbers",
         "Seq_Frame0001_ATransform = 1 0 0 1e9 0 1 0 0 0 0 1 0 0 0 0 1\n"},
        {"Seq_Frame0001_ATransform = 1 0 0 0 0 1 0 0 0 0 1 0 0 0 1 1\n",
         "expected a matrix whose last row is 0 0 0 1",
         "Seq_Frame0001_ATransform = 1 0 0 0 0 1 0 0 0 0 1 1 0 0 0 1\n"},
        {"Seq_Frame0001_ATransformStatus = ok\n", "expected OK, INVALID or another word in capitals",
         "Seq_Frame0001_ATransformStatus = OUT_OF_VIEW\n"},
        {"Seq_Frame0001_ATransformStatus = AAAAAAAAAAAAAAAAAAAAAAAA\n", "another word in capitals",
         "Seq_Frame0001_ATransformStatus = AAAAAAAAAAAAAAAAAAAAAAA\n"},
        {"Seq_Frame0001_A-BTransform = " MATRIX "\n", "expected a name of letters, digits and _",
         "Seq_Frame0001_A_BTransform = " MATRIX "\n"},
        {"Seq_Frame0001_aaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaTransform = " MATRIX "\n",
         "at most 47",
         "Seq_Frame0001_aaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaTransform = " MATRIX "\n"},
        {"Seq_Frame0001_Timestamp = 1\nSeq_Frame0001_Timestamp = 1\n",
         ":4: Seq_Frame0001_Timestamp is given a second time, first in line 3",
         "Seq_Frame0000_Timestamp = 1\nSeq_Frame0001_Timestamp = 1\n"},
    };
    for (size_t i = 0; i < sizeof rules / sizeof *rules; i++) {
        hs_error err = {0};
        write_sequence("rule.mha", rules[i].broken, 2);
        files_refused("rule.mha", rules[i].told);
        write_sequence("rule.mha", rules[i].whole, 2);
        hs_metaimage *file = hs_metaimage_open(files_path("rule.mha"), NULL, &err);
        if (!file) fail_msg("%s", err.text);
        hs_metaimage_close(file);
    }
}

static void the_number_of_transforms_is_bounded(void **state) {
    char lines[2048] = FRAMES;
    for (int t = 0; t < 9; t++) {
        hs_error err = {0};
        const size_t at = strlen(lines);
        (void)snprintf(lines + at, sizeof lines - at, "Seq_Frame0000_T%dTransform = " MATRIX "\n", t);
        write_sequence("many.mha", lines, 2);
        hs_metaimage *file = hs_metaimage_open(files_path("many.mha"), NULL, &err);
        assert_int_equal(file != NULL, t < 8);
        hs_metaimage_close(file);
    }
    files_refused("many.mha", "Seq_Frame0000_T8Transform: more than 8 transforms of one volume");
}

static void sizes_of_sequences_are_checked(void **state) {
    static const struct {
        const char *size, *told;
    } bad[] = {{"2 2 2 0", "expected a fourth size of 1 .. 100000 volumes"},
               {"2 2 2 100001", "a fourth size"},
               {"2 2 2", "a fourth size"},
               {"2 2 2 2 2", "as many numbers as NDims"},
               {"2 2 2 3", "16 bytes of data, expected 24 (DimSize 2 2 2 3 of MET_UCHAR)"},
               {"2 2 2 1", "16 bytes of data, expected 8 (DimSize 2 2 2 1 of MET_UCHAR)"},
               {"2048 1024 1024 100000", "16 bytes of data, expected 214748364800000"}};
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        static const uint8_t data[16] = {1};
        const char *const text = unit_text(
            "NDims = 4\nDimSize = %s\nElementType = MET_UCHAR\nElementDataFile = LOCAL\n", bad[i].size);
        files_write("size.mha", text, data, sizeof data);
        files_refused("size.mha", bad[i].told);
    }
}

/* A PLUS sequence of tracked pictures looks like a volume but for its Kinds, or its fields. What PLUS
 * reconstructs is called a list, too, but lies in space and has no fields of frames. */
static void sequences_of_pictures_are_refused_by_name(void **state) {
    static const char pictures[] = "this is a sequence of pictures, whose third axis is time";
    static const struct {
        const char *lines, *told; /* NULL: it is read */
    } rows[] = {
        {"Kinds = domain domain list\n", pictures},
        {"Kinds = domain domain time\n", pictures},
        {"Seq_Frame0000_Patient = Doe^Jane\n", pictures},
        {"Kinds = domain domain domain\n", NULL},
        {"ElementSpacing = 0.5 0.5 0.5\nKinds = domain domain list\n", NULL},
        {"Offset = 0 0 29\nKinds = domain domain list\n", NULL},
        {"ElementSpacing = 0.5 0.5 0.5\nKinds = domain domain list\nSeq_Frame0000_Timestamp = 1\n",
         "Seq_Frame0000_Timestamp: this is a sequence of pictures"},
        /* One that a peer cut out of a sequence, with all that was said of its volumes. */
        {"Kinds = domain domain domain list\nSeq_Frame0000_ImageStatus = INVALID\nSeq_Frame0007_Timestamp = "
         "1\n",
         NULL},
        {"Kinds = vector domain domain\n", "Kinds is 'vector domain domain', expected domain domain domain"},
    };
    static const uint8_t data[8] = {1, 2, 3, 4, 5, 6, 7, 8};
    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
        hs_error err = {0};
        hs_volume volume = {0};
        files_volume("plus.mha", "2 2 2", "MET_UCHAR", rows[i].lines, data, sizeof data);
        if (rows[i].told) files_refused("plus.mha", rows[i].told);
        assert_int_equal(hs_metaimage_read(files_path("plus.mha"), NULL, &volume, &err), !rows[i].told);
        assert_null(strstr(err.text, "Doe"));
        hs_volume_free(&volume);
    }
}

/* Told by what is in the file. The name says nothing. */
static void other_formats_are_named(void **state) {
    uint8_t nifti[352] = {0x5c, 1}, swapped[352] = {0, 0, 1, 0x5c}, nifti2[544] = {0x1c, 2};
    uint8_t dicom[140] = {0}, late[140] = {0}, analyze[348] = {0x5c, 1};
    static const uint8_t bare[] = {8, 0, 5, 0, 'C', 'S', 10, 0, 'I', 'S', 'O'};
    memcpy(nifti + 344, "n+1", 4);
    memcpy(swapped + 344, "n+1", 4);
    memcpy(nifti2 + 4, "n+2", 4);
    memcpy(dicom + 128, "DICM", 5);
    memcpy(late + 127, "DICM", 5);
    const struct {
        const char *name;
        const void *data;
        size_t bytes;
        const char *told;
    } rows[] = {
        {"a.mha", "NRRD0005\n# Complete", 19,
         "is an NRRD file; host_sim reads MetaImage (.mha, .mhd): 'smartvis clip' of the Python"},
        {"b.mha", nifti, sizeof nifti, "is a NIfTI file"},
        {"b.mha", swapped, sizeof swapped, "is a NIfTI file"},
        {"b.mha", nifti2, sizeof nifti2, "is a NIfTI file"},
        {"c.mha", dicom, sizeof dicom,
         "is a DICOM file; host_sim reads MetaImage (.mha, .mhd): 'smartvis clip' of the"},
        {"c.mha", bare, sizeof bare, "is a DICOM file"},
        {"d.hdr", analyze, sizeof analyze, "is an Analyze file"},
        {"h.mha", "\0\5\x16\7\0\2", 6, "is what macOS keeps beside a file"},
        {"h.mha", "version https://git-lfs.github.com/spec/v1\n", 43, "is a pointer of Git LFS"},
        {"h.mha", "\n<!DOCTYPE html>\n", 17, "is a web page"},
        {"h.mha", "<HTML>", 6, "is a web page"},
        {"h.mha", " {\"error\": 404}", 15, "is JSON"},
        {"h.mha", "\0\0\0 ftypisom", 12, "is a video"},
        {"h.mha", "\xef\xbb\xbfNDims = 3\n", 13, "is text with a byte order mark"},
        {"h.mha", "7z\xbc\xaf\x27\x1c", 6, "is a file compressed as a whole"},
        {"h.mha", "", 0, "is empty; host_sim reads MetaImage (.mha, .mhd): copy it anew"},
        /* Just not: the size alone, the mark elsewhere, a text that begins like one. */
        {"e.mha", analyze, sizeof analyze, "this is no MetaImage header"},
        {"e.mha", late, sizeof late, "holds a zero byte"},
        {"e.mha", "NRR\n", 4, "this is no MetaImage header"},
    };
    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
        files_write(rows[i].name, NULL, rows[i].data, rows[i].bytes);
        files_refused(rows[i].name, rows[i].told);
    }
    files_gzip("f.nii.gz", nifti, sizeof nifti); /* as nearly all of them are */
    files_refused("f.nii.gz", "is a NIfTI file");
    files_gzip("g.mha", "NDims = 3\n", 10);
    files_refused("g.mha", "is a file compressed as a whole");
}

UNIT_MAIN(files_setup, files_teardown, volumes_come_one_after_the_other, what_is_said_of_a_volume_is_kept,
          a_file_of_invalid_volumes_is_refused, every_rule_has_a_file_on_either_side,
          the_number_of_transforms_is_bounded, sizes_of_sequences_are_checked,
          sequences_of_pictures_are_refused_by_name, other_formats_are_named)
