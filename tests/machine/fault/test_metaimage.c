/* SPDX-License-Identifier: MIT */
/* MetaImage files that are wrong: each is refused with file, field and value. Run under ASan, nothing may
 * leak. */
#include "support/metaimage_files.h"

#include <math.h>
#include <sys/stat.h>
#include <unistd.h>

#define GOOD_TEXT                                                                                            \
    "ObjectType = Image\nNDims = 3\nBinaryData = True\nElementSpacing = 1 1 1\nDimSize = 4 3 2\n"            \
    "ElementType = MET_USHORT\nElementDataFile = LOCAL\n"

enum { GOOD_BYTES = 4 * 3 * 2 * 2 };

static uint8_t good_data[GOOD_BYTES];

static void fill_good_data(void) {
    for (size_t i = 0; i < GOOD_BYTES; i++) good_data[i] = (uint8_t)(i * 37 + 5);
}

/* A text without the lines that start with `without`, and with `line` (may be "") before the last one. */
static void write_edited(const char *name, const char *without, const char *line) {
    char text[2048] = "";
    size_t at = 0;
    for (const char *s = GOOD_TEXT; *s; s = strchr(s, '\n') + 1) {
        const size_t n = (size_t)(strchr(s, '\n') - s) + 1;
        if (strncmp(s, "ElementDataFile", 15) == 0)
            at += (size_t)snprintf(text + at, sizeof text - at, "%s", line);
        const size_t w = strlen(without);
        if (w && strncmp(s, without, w) == 0 && s[w] == ' ') continue;
        at += (size_t)snprintf(text + at, sizeof text - at, "%.*s", (int)n, s);
    }
    files_write(name, text, good_data, GOOD_BYTES);
}

/* Those of test_metaimage_edges have a file beside them that is read. */
static void values_out_of_range_are_named(void **state) {
    static const struct {
        const char *field, *value, *told;
    } bad[] = {
        {"NDims", "3.0", "NDims is '3.0'"},
        {"NDims", "-3", "NDims is '-3'"},
        {"NDims", "99999999999999999999999", "NDims is '99999999999999999999999'"},
        {"DimSize", "65535 65535 65535",
         "DimSize is '65535 65535 65535', expected one number per dimension, each 1 .. 2048"},
        {"DimSize", "4 -1 2", "DimSize is '4 -1 2'"},
        {"DimSize", "4 3 4294967298", "DimSize is '4 3 4294967298'"},                     /* 2 + 2^32 */
        {"DimSize", "4 3 18446744073709551618", "DimSize is '4 3 18446744073709551618'"}, /* 2 + 2^64 */
        {"DimSize", "4 3", "DimSize is '4 3'"},
        {"DimSize", "4x 3 2", "DimSize is '4x 3 2'"},
        {"DimSize", "", "DimSize is ''"},
        {"ElementType", "met_ushort", "ElementType is 'met_ushort'"},
        {"ElementType", "MET_UCHAR_ARRAY", "ElementType is 'MET_UCHAR_ARRAY'"},
        {"ElementSpacing", "1 -2 1", "ElementSpacing is '1 -2 1'"},
        {"ElementSpacing", "1 nan 1", "ElementSpacing is '1 nan 1'"},
        {"ElementSpacing", "0x1.4p0 1 1", "ElementSpacing is '0x1.4p0 1 1'"},
        {"HeaderSize", "18446744073709551615", "0 bytes of data, expected 48"},
        {"ElementDataFile", "", "ElementDataFile is ''"},
        {"ElementDataFile", "none.raw",
         "ElementDataFile 'none.raw': cannot be read: No such file or directory"},
        {"ElementDataFile", ".", "ElementDataFile '.': cannot be read: not a regular file"},
    };
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        char line[128];
        (void)snprintf(line, sizeof line, "%s = %s\n", bad[i].field, bad[i].value);
        write_edited("bad.mha", bad[i].field, line);
        files_refused("bad.mha", bad[i].told);
    }
    write_edited("bad.mha", "NDims", "NDims = 4\n");
    files_refused("bad.mha", "DimSize is '4 3 2', expected a fourth size of 1");
}

static void missing_and_repeated_fields_are_named(void **state) {
    static const char *const needed[] = {"NDims", "DimSize", "ElementType", "ElementDataFile"};
    for (size_t i = 0; i < sizeof needed / sizeof *needed; i++) {
        char told[64];
        (void)snprintf(told, sizeof told, "%s is missing", needed[i]);
        write_edited("missing.mha", needed[i], "");
        if (i == 3)
            files_write("missing.mha", "NDims = 3\nDimSize = 4 3 2\nElementType = MET_USHORT\n", NULL, 0);
        files_refused("missing.mha", told);
    }
    static const char *const repeated[] = {"ObjectType = Image\n", "NDims = 3\n",
                                           "BinaryData = True\n",  "ElementSpacing = 1 1 1\n",
                                           "DimSize = 4 3 2\n",    "ElementType = MET_USHORT\n"};
    for (unsigned i = 0; i < sizeof repeated / sizeof *repeated; i++) {
        char told[96];
        (void)snprintf(told, sizeof told, ":7: %.*s is given a second time, first in line %u",
                       (int)strcspn(repeated[i], " "), repeated[i], i + 1);
        write_edited("twice.mha", "", repeated[i]);
        files_refused("twice.mha", told);
    }
}

/* Every prefix of a file with its data inside, raw and compressed, but the whole one. */
static void every_truncation_is_refused(void **state) {
    size_t packed_bytes;
    uint8_t *packed = files_deflate(good_data, GOOD_BYTES, &packed_bytes);
    for (int compressed = 0; compressed < 2; compressed++) {
        char file[1024];
        const size_t text = (size_t)snprintf(file, sizeof file, "%s%s",
                                             compressed ? "CompressedData = True\n" : "", GOOD_TEXT);
        const size_t data = compressed ? packed_bytes : GOOD_BYTES;
        assert_true(text + data < sizeof file);
        memcpy(file + text, compressed ? packed : good_data, data);
        for (size_t n = 0; n < text + data; n++) {
            files_write("cut.mha", NULL, file, n);
            const bool whole_lines = n < text && (n == 0 || file[n - 1] == '\n');
            files_refused("cut.mha", whole_lines ? "ElementDataFile is missing" : NULL);
            if (n >= text) files_refused("cut.mha", "ElementDataFile 'LOCAL'");
        }
        files_write("cut.mha", NULL, file, text + data);
        files_read("cut.mha", NULL); /* and the whole one is right */
    }
}

static void data_files_of_another_length_are_refused(void **state) {
    uint8_t data[GOOD_BYTES + 1] = {0};
    files_write("length.mhd",
                "NDims = 3\nDimSize = 4 3 2\nElementType = MET_USHORT\nElementDataFile = length.raw\n", NULL,
                0);
    for (size_t n = 0; n <= GOOD_BYTES + 1; n++) {
        if (n == GOOD_BYTES) continue;
        char told[96];
        (void)snprintf(
            told, sizeof told,
            ":4: ElementDataFile 'length.raw': %zu bytes of data, expected 48 (DimSize 4 3 2 of MET_USHORT)",
            n);
        files_write("length.raw", NULL, data, n);
        files_refused("length.mhd", told);
    }
}

/* Adler-32 guards the voxels, so a changed byte is noticed wherever it is. */
static void every_damaged_byte_of_compressed_data_is_noticed(void **state) {
    size_t bytes;
    uint8_t *packed = files_deflate(good_data, GOOD_BYTES, &bytes);
    for (size_t i = 0; i < bytes; i++) {
        packed[i] ^= 0xff;
        files_write("damaged.mha", "CompressedData = True\n" GOOD_TEXT, packed, bytes);
        files_refused("damaged.mha", "ElementDataFile 'LOCAL': CompressedData");
        packed[i] ^= 0xff;
    }
}

/* Compressed streams that are whole but not what the header says. */
static void compressed_streams_must_fit_the_header(void **state) {
    uint8_t *zeros = unit_memory(10u << 20);
    size_t bytes;
    uint8_t *packed = files_deflate(zeros, 10u << 20, &bytes); /* a bomb: 10 MB in 10 KB */
    assert_true(bytes < 11000);
    files_write("bomb.mha", "CompressedData = True\n" GOOD_TEXT, packed, bytes);
    files_refused("bomb.mha", "CompressedData holds more than the 48 voxel bytes expected");
    files_write("greedy.mha",
                "CompressedData = True\nNDims = 3\nDimSize = 2048 1024 1024\nElementType = "
                "MET_UCHAR\nElementDataFile = LOCAL\n",
                packed, bytes);
    files_refused("greedy.mha", "compressed bytes cannot hold DimSize 2048 1024 1024 of MET_UCHAR");
    files_write("short.mha",
                "CompressedData = True\nNDims = 3\nDimSize = 2048 1024 5\nElementType = "
                "MET_UCHAR\nElementDataFile = LOCAL\n",
                packed, bytes);
    files_read("short.mha", NULL); /* 10 MB exactly: read */

    packed = files_deflate(good_data, GOOD_BYTES - 1, &bytes);
    files_write("short.mha", "CompressedData = True\n" GOOD_TEXT, packed, bytes);
    files_refused("short.mha", "CompressedData ends after 47 voxel bytes, expected 48");

    packed = files_deflate(good_data, GOOD_BYTES, &bytes);
    uint8_t trailed[256] = {0};
    memcpy(trailed, packed, bytes);
    files_write("trail.mha", "CompressedData = True\n" GOOD_TEXT, trailed, bytes + 3);
    files_refused("trail.mha", "3 bytes follow after the compressed data");
    files_write("size.mha", "CompressedData = True\nCompressedDataSize = -5\n" GOOD_TEXT, packed, bytes);
    files_refused("size.mha", "CompressedDataSize is '-5', expected a number of bytes");
    files_write("size.mha", "CompressedData = True\nHeaderSize = -1\n" GOOD_TEXT, packed, bytes);
    files_refused("size.mha", "HeaderSize is '-1'");
    files_write("plain.mha", "CompressedData = True\n" GOOD_TEXT, good_data, GOOD_BYTES);
    files_refused("plain.mha", "CompressedData is damaged");
}

static void infinite_voxels_are_named(void **state) {
    static const char text[] =
        "NDims = 3\nDimSize = 3 2 2\nElementType = MET_FLOAT\nElementDataFile = LOCAL\n";
    float data[12] = {1, 2, 3, 0, 0, INFINITY};
    files_write("inf.mha", text, data, sizeof data);
    files_refused("inf.mha", "voxel (2, 1, 0) is 'inf', expected a finite number");
    const float flat[12] = {0};
    files_write("flat.mha", text, flat, sizeof flat);
    files_refused("flat.mha", "every voxel is 0: no range to map to 8 bit");
}

static void what_is_no_metaimage_is_refused(void **state) {
    static const uint8_t png[] = {0x89, 'P', 'N', 'G', '\r', '\n', 0x1a, '\n',
                                  0,    0,   0,   13,  'I',  'H',  'D',  'R'};
    files_write("a.png", NULL, png, sizeof png);
    files_refused("a.png",
                  "is a picture; host_sim reads MetaImage (.mha, .mhd): one file has all slices of a volume");
    files_write("a.tif", NULL, "II*\0\10\0\0\0", 8);
    files_refused("a.tif",
                  "is a TIFF file; host_sim reads MetaImage (.mha, .mhd): 'smartvis clip' of the Python");
    files_write("a.mha", NULL, "\0\0\1\0", 4);
    files_refused("a.mha", ":1: holds a zero byte");
    files_refused(".", "is a folder; 'smartvis clip' of the Python package reads one with a DICOM series");
    files_write("zero.mha", "NDims = 3\n", "\0\0\0\0", 4);
    files_refused("zero.mha", ":2: holds a zero byte");
    enum { MAX_HEADER = 1 << 24 }; /* bytes that a header may have */
    char *long_text = unit_memory(MAX_HEADER + 1);
    memset(long_text, 'x', MAX_HEADER);
    long_text[MAX_HEADER] = '\0';
    files_write("long.mha", "Comment = ", long_text, MAX_HEADER);
    files_refused("long.mha", "ElementDataFile is missing in the first 16777216 bytes");
    files_write("long.mha", "Comment = ", long_text, 70000);
    files_refused("long.mha", "ElementDataFile is missing");
    const size_t text = strlen("Comment = \n" GOOD_TEXT);
    memcpy(long_text + MAX_HEADER - text, "\n" GOOD_TEXT, strlen("\n" GOOD_TEXT));
    files_write("long.mha", "Comment = ", long_text, MAX_HEADER - strlen("Comment = "));
    FILE *more = fopen(files_path("long.mha"), "ab");
    assert_non_null(more);
    assert_int_equal(fwrite(good_data, 1, GOOD_BYTES, more), GOOD_BYTES);
    assert_int_equal(fclose(more), 0);
    files_read("long.mha", NULL); /* the longest text that is read */
    files_refused("absent.mha", "No such file or directory");
    assert_int_equal(mkfifo(files_path("fifo.mha"), 0600), 0);
    (void)alarm(20); /* a reader that waits for a writer would wait for ever */
    files_refused("fifo.mha", "not a regular file");
    (void)alarm(0);
}

/* Fields that are not used may say who was scanned: they must not come out, not even from a broken file. */
static void skipped_values_stay_out_of_messages(void **state) {
    static const char *const broken[] = {"PatientName = Doe^Jane\nPatientID: 4711-Doe\nNDims = 2\n",
                                         "Comment = Doe^Jane\nDoe^Jane 4711\n",
                                         "Name = Doe^Jane\nComment = x\n"};
    for (size_t i = 0; i < 3; i++) {
        write_edited("patient.mha", i == 2 ? "ElementType" : "NDims", broken[i]);
        hs_error err = {0};
        hs_volume volume;
        assert_false(hs_metaimage_read(files_path("patient.mha"), NULL, &volume, &err));
        assert_null(strstr(err.text, "Doe"));
        assert_null(strstr(err.text, "4711"));
        assert_null(strchr(err.text, '\n'));
    }
}

static void messages_stay_one_printable_line(void **state) {
    write_edited("odd.mha", "ElementType",
                 "ElementType = MET_\x1b[31m\a\xff much longer than any name of a type could ever be in a "
                 "header of this format\n");
    files_refused("odd.mha", "ElementType is 'MET_?[31m?? much longer");
    files_refused("odd.mha", "...', expected");
}

static int setup(void **state) {
    fill_good_data();
    return files_setup(state);
}

UNIT_MAIN(setup, files_teardown, cmocka_unit_test(values_out_of_range_are_named),
          cmocka_unit_test(missing_and_repeated_fields_are_named),
          cmocka_unit_test(every_truncation_is_refused),
          cmocka_unit_test(data_files_of_another_length_are_refused),
          cmocka_unit_test(every_damaged_byte_of_compressed_data_is_noticed),
          cmocka_unit_test(compressed_streams_must_fit_the_header),
          cmocka_unit_test(infinite_voxels_are_named), cmocka_unit_test(what_is_no_metaimage_is_refused),
          cmocka_unit_test(skipped_values_stay_out_of_messages),
          cmocka_unit_test(messages_stay_one_printable_line))
