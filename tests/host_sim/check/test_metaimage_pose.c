/* SPDX-License-Identifier: MIT */
/* What a MetaImage file says about how its volume lies: every name of a field, what counts if two disagree,
 * and for every rule a value that breaks it and one that just does not. */
#include "support/metaimage_files.h"

/* A volume of 2 x 2 x 2 voxels; `lines` may replace the dimensions. */
static void write_lines(const char *name, const char *lines, int dims) {
    static const uint8_t data[8] = {1, 2, 3, 4, 5, 6, 7, 8};
    files_volume(name, dims == 4 ? "2 2 2 1" : "2 2 2", "MET_UCHAR", lines, data, sizeof data);
}

static hs_volume read_lines(const char *lines, int dims) {
    write_lines("pose.mha", lines, dims);
    return files_read("pose.mha", NULL);
}

static void expect_pose(const char *lines, int dims, const char *letters, bool stated,
                        const char *contradicted) {
    hs_volume v = read_lines(lines, dims);
    char own[4];
    hs_pose_letters(&v.pose, own);
    if (strcmp(own, letters) != 0) fail_msg("'%s' gives %s, expected %s", lines, own, letters);
    if (v.pose.stated != stated) fail_msg("'%s' is%s stated", lines, v.pose.stated ? "" : " not");
    assert_string_equal(v.pose.contradicted, contradicted);
}

static void only_the_matrix_counts(void **state) {
    expect_pose("", 3, "RAI", false, "");
    expect_pose("TransformMatrix = 1 0 0 0 1 0 0 0 1\n", 3, "RAI", false, "");
    expect_pose("TransformMatrix = 1 0 0 0 1 0 0 0 1\nAnatomicalOrientation = ???\n", 3, "RAI", false, "");
    expect_pose("TransformMatrix = 0 1 0 0 0 1 1 0 0\n", 3, "AIR", true, "");
    expect_pose("Rotation = -1 0 0 0 -1 0 0 0 1\n", 3, "LPI", true, "");
    expect_pose("Orientation = -1 0 0 0 -1 0 0 0 1\n", 3, "LPI", true, "");
    expect_pose("TransformMatrix = -1 0 0 0 -1 0 0 0 1\nAnatomicalOrientation = lpi\n", 3, "LPI", true, "");
    /* What ITK and PLUS write for whatever says nothing. */
    expect_pose("AnatomicalOrientation = RAI\nTransformMatrix = 1 0 0 0 1 0 0 0 1\n", 3, "RAI", false, "");
    expect_pose("AnatomicalOrientation = LPS\nTransformMatrix = 1 0 0 0 1 0 0 0 1\n", 3, "RAI", false, "LPS");
    /* Letters alone, which ITK and 3D Slicer read over. */
    expect_pose("AnatomicalOrientation = RAI\n", 3, "RAI", false, "");
    expect_pose("AnatomicalOrientation = lps\n", 3, "RAI", false, "LPS");
    /* "???" says that nobody knew, whatever the matrix is; and so do our own results, as ITK writes them
     * anew. */
    expect_pose("TransformMatrix = 0 1 0 0 0 1 1 0 0\nAnatomicalOrientation = ???\n", 3, "AIR", false, "");
    expect_pose("TransformMatrix = 0 1 0 0 0 1 1 0 0\nAnatomicalOrientation = AIR\nITK_FileNotes = SmartVis: "
                "not the axes of a patient\n",
                3, "AIR", false, "");
    /* ITK's four dimensions, and those of programs that write three. */
    expect_pose("TransformMatrix = 0 1 0 0 0 0 1 0 1 0 0 0 0 0 0 1\nAnatomicalOrientation = ????\n", 4, "AIR",
                false, "");
    expect_pose("TransformMatrix = 1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1\nAnatomicalOrientation = ????\n", 4, "RAI",
                false, "");
    expect_pose("TransformMatrix = 0 1 0 0 0 1 1 0 0\nAnatomicalOrientation = AIR\n", 4, "AIR", true, "");
    expect_pose("TransformMatrix = 0 1 0 0 0 1 1 0 0\nAnatomicalOrientation = AIR?\n", 4, "AIR", true, "");
}

static void directions_and_offsets_are_taken_as_they_are(void **state) {
    static const char *const names[] = {"Offset", "Position", "Origin"};
    for (size_t i = 0; i < 3; i++) {
        const char *const lines =
            unit_text("%s = 1.5 -2 1e3\nTransformMatrix = 0.8 0.6 0 -0.6 0.8 0 0 0 1\n", names[i]);
        hs_volume v = read_lines(lines, 3);
        /* One axis' direction after the other in the file; ours are columns. */
        static const double expected[9] = {0.8, -0.6, 0, 0.6, 0.8, 0, 0, 0, 1};
        for (int k = 0; k < 9; k++) assert_true(v.pose.direction[k] == expected[k]);
        assert_true(v.pose.origin[0] == 1.5 && v.pose.origin[1] == -2 && v.pose.origin[2] == 1000);
    }
    hs_volume v = read_lines("Offset = 1 2 3 4\nElementSpacing = 1 2 3 0.05\n", 4);
    assert_true(v.pose.origin[2] == 3 && v.spacing[2] == 3);
    v = read_lines("DistanceUnits = cm\nOffset = 1 2 3\nElementSpacing = 1 2 3\n", 3);
    assert_true(v.pose.origin[2] == 30 && v.spacing[2] == 30);
}

static void the_probe_stands_where_the_near_end_is(void **state) {
    static const struct {
        const char *value;
        hs_probe probe;
    } known[] = {{"MFA", HS_PROBE_LOW_Z},  {"UFA", HS_PROBE_LOW_Y},  {"UNA", HS_PROBE_HIGH_Y},
                 {"FMD", HS_PROBE_LOW_X},  {"NMA", HS_PROBE_HIGH_X}, {"MAF", HS_PROBE_LOW_Z},
                 {"MAN", HS_PROBE_HIGH_Z}, {"X", HS_PROBE_LOW_Z},    {"XX", HS_PROBE_LOW_Z}};
    for (size_t i = 0; i < sizeof known / sizeof *known; i++) {
        hs_volume v = read_lines(unit_text("UltrasoundImageOrientation = %s\n", known[i].value), 3);
        assert_int_equal(v.probe, known[i].probe);
    }
}

/* A line that breaks a rule, and one that just does not. */
static void every_rule_has_a_file_on_either_side(void **state) {
    static const struct {
        int dims;
        const char *broken, *told, *whole;
    } rules[] = {
        {3, "TransformMatrix = 1 0 0 0 1 0 0 0\n", "TransformMatrix is '1 0 0 0 1 0 0 0', expected 9 numbers",
         "TransformMatrix = 1 0 0 0 1 0 0 0 1\n"},
        {3, "TransformMatrix = 1 0 0 0 1 0 0 0 1 0\n", "expected 9 numbers",
         "TransformMatrix = 1 0 0 0 1 0 0 0 1 \n"},
        {3, "TransformMatrix = 1 0 0 0 one 0 0 0 1\n", "expected 9 numbers",
         "TransformMatrix = 1 0 0 0 1e0 0 0 0 1\n"},
        {3, "TransformMatrix = 1 0 0 0 nan 0 0 0 1\n", "expected 9 numbers",
         "TransformMatrix = 1 0 0 0 1 0 0 0 -1\n"},
        {3, "TransformMatrix = 1 0 0 0 1.001 0 0 0 1\n", "three directions of length 1 at right angles",
         "TransformMatrix = 1 0 0 0 1.0004 0 0 0 1\n"},
        {3, "TransformMatrix = 1 0.002 0 0 1 0 0 0 1\n", "three directions of length 1 at right angles",
         "TransformMatrix = 1 0.0009 0 0 1 0 0 0 1\n"},
        {3, "TransformMatrix = 1 0 0 1 0 0 0 0 1\n", "three directions",
         "TransformMatrix = 0 1 0 1 0 0 0 0 1\n"},
        {3, "TransformMatrix = 0 0 0 0 0 0 0 0 0\n", "three directions",
         "TransformMatrix = 0 0 1 0 1 0 1 0 0\n"},
        {3, "Rotation = 2 0 0 0 2 0 0 0 2\n", "Rotation is '2 0 0 0 2 0 0 0 2'",
         "Rotation = 1 0 0 0 1 0 0 0 1\n"},
        {4, "TransformMatrix = 1 0 0 0 1 0 0 0 1 0\n", "expected 16 numbers, or 9",
         "TransformMatrix = 1 0 0 0 1 0 0 0 1\n"},
        {4, "TransformMatrix = 1 0 0 1 0 1 0 0 0 0 1 0 0 0 0 1\n",
         "a fourth axis that has no part in the others",
         "TransformMatrix = 1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1\n"},
        {4, "TransformMatrix = 1 0 0 0 0 1 0 0 0 0 1 0 0 1 0 1\n", "a fourth axis",
         "TransformMatrix = 1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1\n"},
        {3, "Offset = 1 2\n", "Offset is '1 2', expected 3 numbers (mm)", "Offset = 1 2 3\n"},
        {3, "Position = 1 2 3 4\n", "Position is '1 2 3 4', expected 3 numbers (mm)", "Position = 1 2 3\n"},
        {3, "Origin = 1 2 inf\n", "Origin is '1 2 inf'", "Origin = 1 2 1e300\n"},
        {4, "Offset = 1 2 3 4 5\n", "expected 4 numbers, or 3 (mm)", "Offset = 1 2 3\n"},
        {3, "AnatomicalOrientation = RA\n", "AnatomicalOrientation is 'RA', expected three letters",
         "AnatomicalOrientation = RAS\n"},
        {3, "AnatomicalOrientation = RAIS\n", "expected three letters", "AnatomicalOrientation = RAI\n"},
        {3, "AnatomicalOrientation = RLI\n", "one of R L, one of A P", "AnatomicalOrientation = ILA\n"},
        {3, "AnatomicalOrientation = RA?\n", "or ???", "AnatomicalOrientation = ???\n"},
        {4, "AnatomicalOrientation = RAI??\n", "three letters", "AnatomicalOrientation = RAI?\n"},
        {3, "UltrasoundImageOrientation = MF\n", "UltrasoundImageOrientation is 'MF'",
         "UltrasoundImageOrientation = MFA\n"},
        {3, "UltrasoundImageOrientation = MNF\n", "one of N F", "UltrasoundImageOrientation = MNA\n"},
        {3, "UltrasoundImageOrientation = mfa\n", "one of M U", "UltrasoundImageOrientation = UFD\n"},
        {3, "UltrasoundImageOrientation = UFA\nUltrasoundApex = 1 2\n", "UltrasoundApex is '1 2', expected",
         "UltrasoundImageOrientation = UFA\nUltrasoundApex = 1 2 3\n"},
        {3, "UltrasoundApex = 1 2 3\n", "beside UltrasoundImageOrientation",
         "UltrasoundApex = 1 2 3\nUltrasoundImageOrientation = UFA\n"},
        {3, "ElementSpacing = 1 1 1 1\n", "as many numbers as NDims", "ElementSpacing = 1 1 1\n"},
        {3, "ElementSpacing = 1 1 1mm\n", "three numbers above 0 (mm)", "ElementSpacing = 1 1 1 \n"},
        {4, "ElementSpacing = 1 1 1 x\n", "a fourth number", "ElementSpacing = 1 1 1\n"},
        {4, "ElementSpacing = 1 1 1 1 1\n", "as many numbers as NDims", "ElementSpacing = 1 1 1 0\n"},
        {3, "DistanceUnits = furlong\n", "DistanceUnits is 'furlong', expected mm, cm, m, um or ?",
         "DistanceUnits = MM\n"},
        {3, "DistanceUnits = m\nElementSpacing = 1 1 1e4\n", "1e-6 .. 1e6",
         "DistanceUnits = m\nElementSpacing = 1 1 999\n"},
        {3, "DistanceUnits = m\nOffset = 1 2 1e307\n", "smaller numbers",
         "DistanceUnits = ?\nOffset = 1 2 1e307\n"},
        {3, "Offset = 1 2 3\nOrigin = 1 2 3\n", ":4: Origin is given a second time, first in line 3",
         "Offset = 1 2 3\nCenterOfRotation = 1 2 3\n"},
        {3, "TransformMatrix = 1 0 0 0 1 0 0 0 1\nRotation = 1 0 0 0 1 0 0 0 1\n",
         "Rotation is given a second time", "TransformMatrix = 1 0 0 0 1 0 0 0 1\n"},
    };
    for (size_t i = 0; i < sizeof rules / sizeof *rules; i++) {
        write_lines("rule.mha", rules[i].broken, rules[i].dims);
        files_refused("rule.mha", rules[i].told);
        read_lines(rules[i].whole, rules[i].dims);
    }
}

UNIT_MAIN(files_setup, files_teardown, only_the_matrix_counts, directions_and_offsets_are_taken_as_they_are,
          the_probe_stands_where_the_near_end_is, every_rule_has_a_file_on_either_side)
