/* SPDX-License-Identifier: MIT */
/* MetaImage files that are wrong: each is refused with file, field and value, and beside what just breaks a
 * rule stands what just does not. (Orientation: test_metaimage_pose; sequences and other formats:
 * test_metaimage_sequence.) Run under ASan, nothing may leak.
 * Requirement: R12. */
#include "support/metaimage_files.h"

#include <math.h>
#include <sys/stat.h>
#include <unistd.h>

#define TEXT                                                                                                 \
    "ObjectType = Image\nNDims = 3\nBinaryData = True\nElementSpacing = 1 1 1\nDimSize = 4 3 2\n"            \
    "ElementType = MET_USHORT\n"
#define LAST   "ElementDataFile = LOCAL\n"
#define PACKED "CompressedData = True\n" TEXT LAST

enum { GOOD_BYTES = 4 * 3 * 2 * 2 };

static uint8_t good_data[GOOD_BYTES];

/* A header in which `line` takes the place of the line of its field, or comes last, and `bytes` of data. A
 * line without an end leaves its field out. */
static void write_with(const char *name, const char *line, size_t bytes) {
    char text[1024] = "";
    size_t at = 0;
    const size_t field = strcspn(line, " ");
    const bool is_last = strncmp(line, LAST, field) == 0;
    for (const char *s = TEXT; *s; s = strchr(s, '\n') + 1) {
        const size_t n = (size_t)(strchr(s, '\n') - s) + 1;
        if (field > 0 && strncmp(s, line, field) == 0 && s[field] == ' ') continue;
        at += (size_t)snprintf(text + at, sizeof text - at, "%.*s", (int)n, s);
    }
    (void)snprintf(text + at, sizeof text - at, "%s%s", strchr(line, '\n') ? line : "", is_last ? "" : LAST);
    uint8_t *data = unit_memory(bytes + 1);
    for (size_t i = 0; i < bytes; i++) data[i] = (uint8_t)(i * 37 + 5);
    files_write(name, text, data, bytes);
}

typedef struct {
    const char *broken;
    size_t broken_bytes;
    const char *told;
    const char *whole; /* NULL: none is given */
    size_t whole_bytes;
} rule;

static const rule rules[] = {
    {"NDims", 48, "NDims is missing", NULL, 0},
    {"DimSize", 48, "DimSize is missing", NULL, 0},
    {"ElementType", 48, "ElementType is missing", NULL, 0},
    {"ElementDataFile", 0, "ElementDataFile is missing", NULL, 0},
    /* Sizes. */
    {"NDims = 2\n", 48, "NDims is '2', expected 3 (a volume) or 4 (a sequence of volumes)", "NDims = 3\n",
     48},
    {"NDims = 5\n", 48, "NDims is '5'", "NDims = 03\n", 48},
    {"NDims = 3 4\n", 48, "NDims is '3 4'", "NDims =   3\n", 48},
    {"DimSize = 2049 1 1\n", 4098, "each 1 .. 2048", "DimSize = 2048 1 1\n", 4096},
    {"DimSize = 0 3 2\n", 0, "each 1 .. 2048", "DimSize = 1 3 2\n", 12},
    {"DimSize = 2048 1025 1024\n", 48, "is '2048 1025 1024', expected at most 2147483648 voxels",
     "DimSize = 4 3 2\n", 48},
    {"DimSize = 4 3 2 1\n", 48, "as many numbers as NDims", "DimSize = 4 3 2 \n", 48},
    {"DimSize = 4 3 +2\n", 48, "DimSize is '4 3 +2'", "DimSize = 4 3 002\n", 48},
    {"ElementSpacing = 0 1 1\n", 48, "ElementSpacing is '0 1 1', expected three numbers above 0 (mm)",
     "ElementSpacing = 1e-6 1 1\n", 48},
    {"ElementSpacing = 9e-7 1 1\n", 48, "1e-6 .. 1e6", "ElementSpacing = 1 1e-6 1\n", 48},
    {"ElementSpacing = 1 1 1e309\n", 48, "above 0", "ElementSpacing = 1 1 1e6\n", 48},
    {"ElementSpacing = 1 1 1e308\n", 48, "ElementSpacing is '1 1 1e308'", "ElementSpacing = 1 1 9e5\n", 48},
    {"ElementSpacing = 1 1\n", 48, "three numbers", "ElementSpacing = 1 1 .5\n", 48},
    {"NDims = 3.0\n", 48, "NDims is '3.0'", NULL, 0},
    {"NDims = -3\n", 48, "NDims is '-3'", NULL, 0},
    {"NDims = 4\n", 48, "DimSize is '4 3 2', expected a fourth size of 1", NULL, 0},
    {"NDims = 99999999999999999999999\n", 48, "NDims is '99999999999999999999999'", NULL, 0},
    {"DimSize = 65535 65535 65535\n", 48,
     "DimSize is '65535 65535 65535', expected one number per dimension, each 1 .. 2048", NULL, 0},
    {"DimSize = 4 -1 2\n", 48, "DimSize is '4 -1 2'", NULL, 0},
    {"DimSize = 4 3 4294967298\n", 48, "DimSize is '4 3 4294967298'", NULL, 0}, /* 2 + 2^32 */
    {"DimSize = 4 3 18446744073709551618\n", 48, "DimSize is '4 3 18446744073709551618'", NULL,
     0}, /* 2 + 2^64 */
    {"DimSize = 4 3\n", 48, "DimSize is '4 3'", NULL, 0},
    {"DimSize = 4x 3 2\n", 48, "DimSize is '4x 3 2'", NULL, 0},
    {"DimSize = \n", 48, "DimSize is ''", NULL, 0},
    {"ElementSpacing = 1 -2 1\n", 48, "ElementSpacing is '1 -2 1'", NULL, 0},
    {"ElementSpacing = 1 nan 1\n", 48, "ElementSpacing is '1 nan 1'", NULL, 0},
    {"ElementSpacing = 0x1.4p0 1 1\n", 48, "ElementSpacing is '0x1.4p0 1 1'", NULL, 0},
    /* Encodings. */
    {"ObjectType = Images\n", 48, "expected Image", "ObjectType = Image\n", 48},
    {"ElementType = MET_USHORTS\n", 48, "ElementType is 'MET_USHORTS', expected MET_UCHAR",
     "ElementType = MET_SHORT\n", 48},
    {"ElementType = MET_ULONG\n", 192, "192 bytes of data, expected 96", "ElementType = MET_ULONG\n", 96},
    {"ElementNumberOfChannels = 2\n", 96, "expected 1", "ElementNumberOfChannels = 1\n", 48},
    {"BinaryData = False\n", 48, "expected True", "BinaryData = 1\n", 48},
    {"BinaryData = Tru\n", 48, "expected True or False", "BinaryData = T\n", 48},
    {"BinaryDataByteOrderMSB = yes\n", 48, "expected True or False", "BinaryDataByteOrderMSB = true\n", 48},
    {"ElementByteOrderMSB = 2\n", 48, "expected True or False", "ElementByteOrderMSB = 0\n", 48},
    {"BinaryDataByteOrderMSB = False\nElementByteOrderMSB = True\n", 48,
     ":8: ElementByteOrderMSB is 'True', expected the same as BinaryDataByteOrderMSB",
     "BinaryDataByteOrderMSB = True\nElementByteOrderMSB = True\n", 48},
    {"CompressedData = maybe\n", 48, "expected True or False", "CompressedData = False\n", 48},
    {"ElementType = met_ushort\n", 48, "ElementType is 'met_ushort'", NULL, 0},
    {"ElementType = MET_UCHAR_ARRAY\n", 48, "ElementType is 'MET_UCHAR_ARRAY'", NULL, 0},
    /* Data. */
    {"Comment = x\n", 47, "47 bytes of data, expected 48", "Comment = x\n", 48},
    {"Comment = x\n", 49, "49 bytes of data, expected 48", "Comment = x\n", 48},
    {"HeaderSize = -1\n", 47, "bytes of data, expected 48", "HeaderSize = -1\n", 55},
    {"HeaderSize = -2\n", 48, "a number of bytes, or -1", "HeaderSize = 0\n", 48},
    {"ElementDataFile = LISTS\n", 48, "LOCAL or the name of one file", "ElementDataFile = Local\n", 48},
    {"ElementDataFile = a%d.raw\n", 48, "a name without %", "ElementDataFile = local\n", 48},
    {"HeaderSize = 18446744073709551615\n", 48, "0 bytes of data, expected 48", NULL, 0},
    {"ElementDataFile = \n", 48, "ElementDataFile is ''", NULL, 0},
};

static void both_sides_of_every_rule(void **state) {
    for (const rule *r = rules; r < rules + sizeof rules / sizeof *rules; r++) {
        write_with("edge.mha", r->broken, r->broken_bytes);
        files_refused("edge.mha", r->told);
        if (!r->whole) continue;
        write_with("edge.mha", r->whole, r->whole_bytes);
        files_read("edge.mha", NULL);
    }
}

static void no_field_is_there_twice(void **state) {
    unsigned line = 1;
    for (const char *s = TEXT; *s; s = strchr(s, '\n') + 1, line++) {
        char told[96], twice[512];
        const int length = (int)(strchr(s, '\n') - s) + 1;
        (void)snprintf(told, sizeof told, ":7: %.*s is given a second time, first in line %u",
                       (int)strcspn(s, " "), s, line);
        (void)snprintf(twice, sizeof twice, TEXT "%.*s" LAST, length, s);
        files_write("twice.mha", twice, good_data, GOOD_BYTES);
        files_refused("twice.mha", told);
    }
}

/* HeaderSize may be larger than the text: what lies between is passed over. */
static void long_headers(void **state) {
    write_with("edge.mha", "HeaderSize = 40\n", 48);
    files_refused("edge.mha", "the length of the text at least");
    const size_t text = strlen(TEXT "HeaderSize = 200\n" LAST);
    write_with("edge.mha", "HeaderSize = 200\n", 200 - text + 48);
    files_read("edge.mha", NULL);
    write_with("edge.mha", "HeaderSize = 200\n", 200 - text + 47);
    files_refused("edge.mha", "47 bytes of data, expected 48");
}

/* A header reaches into its own folder and below, and nowhere else. Links may lead to another file of the
 * folder, and not out of it; what is no file is not waited for. */
static void data_files(void **state) {
    static const uint8_t voxels[48] = {1};
    char outside[] = "/tmp/sv_outside_XXXXXX", up[32];
    const int file = mkstemp(outside);
    assert_int_equal(write(file, voxels, sizeof voxels), sizeof voxels);
    (void)snprintf(up, sizeof up, "up%s", outside + strlen("/tmp"));
    files_write("near.raw", NULL, voxels, sizeof voxels);
    files_write("short.raw", NULL, voxels, sizeof voxels - 1);
    files_write("empty.raw", NULL, voxels, 0);
    files_write("..near.raw", NULL, voxels, sizeof voxels);
    assert_int_equal(symlink("near.raw", files_path("in.raw")), 0);
    assert_int_equal(symlink(".", files_path("here")), 0);
    assert_int_equal(symlink(outside, files_path("out.raw")), 0);
    assert_int_equal(symlink("/tmp", files_path("up")), 0);
    assert_int_equal(symlink("/dev/zero", files_path("zero.raw")), 0);
    assert_int_equal(mkfifo(files_path("pipe.raw"), 0600), 0);
    static const char below[] = "expected a file in the header's folder or below";
    const struct {
        const char *name, *told; /* NULL: it is read */
    } rows[] = {{"near.raw", NULL},
                {"./near.raw", NULL},
                {"..near.raw", NULL},
                {"in.raw", NULL},
                {"here/near.raw", NULL},
                {"../near.raw", below},
                {"./../near.raw", below},
                {"..", below},
                {"/near.raw", below},
                {"out.raw", "ElementDataFile 'out.raw': cannot be read: a link leads out of the header's"},
                {up, "cannot be read: a link leads out of the header's folder"},
                {"short.raw",
                 ":4: ElementDataFile 'short.raw': 47 bytes of data, expected 48 (DimSize 4 3 4 of "
                 "MET_UCHAR)"},
                {"empty.raw", ":4: ElementDataFile 'empty.raw': 0 bytes of data, expected 48"},
                {"none.raw", "ElementDataFile 'none.raw': cannot be read: No such file or directory"},
                {".", "ElementDataFile '.': cannot be read: not a regular file"},
                {"zero.raw", "ElementDataFile 'zero.raw': cannot be read: not a regular file"},
                {"pipe.raw", "ElementDataFile 'pipe.raw': cannot be read: not a regular file"}};
    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
        const char *const text = unit_text(
            "NDims = 3\nDimSize = 4 3 4\nElementType = MET_UCHAR\nElementDataFile = %s\n", rows[i].name);
        files_write("near.mhd", text, NULL, 0);
        if (rows[i].told)
            files_refused("near.mhd", rows[i].told);
        else
            files_read("near.mhd", NULL);
    }
    assert_int_equal(close(file) | unlink(outside), 0);
}

/* Where a folder is given, header and data lie in it, wherever their names lead. */
static void only_in_a_folder(void **state) {
    (void)state;
    assert_int_equal(mkdir(files_path("held"), 0700), 0);
    write_with("held/in.mha", "NDims = 3\n", 48);
    write_with("away.mha", "NDims = 3\n", 48);
    assert_int_equal(symlink("../away.mha", files_path("held/out.mha")), 0);
    assert_int_equal(symlink("in.mha", files_path("held/link.mha")), 0);
    assert_int_equal(symlink("held/in.mha", files_path("into.mha")), 0);
    const char *const folder = unit_text("%s", files_path("held"));
    const hs_metaimage_options within = {.folder = folder};
    (void)files_read("held/in.mha", &within);
    (void)files_read("held/link.mha", &within);
    (void)files_read("into.mha", &within);
    const char *const refused[] = {"held/out.mha", "away.mha"};
    for (size_t i = 0; i < sizeof refused / sizeof *refused; i++) {
        hs_error err = {0};
        hs_volume volume;
        (void)files_read(refused[i], NULL);
        assert_false(hs_metaimage_read(files_path(refused[i]), &within, &volume, &err));
        unit_told(err, HS_ERR_INPUT, "it lies outside of the folder that was opened");
    }
    static const char *const names[] = {"held/in.mha", "held/out.mha", "held/link.mha"};
    for (size_t i = 0; i < sizeof names / sizeof *names; i++)
        assert_int_equal(unlink(files_path(names[i])), 0);
    assert_int_equal(rmdir(folder), 0);
}

/* Values that would leave a scan two grey levels are refused, unless a window says what is meant. */
static void values(void **state) {
    static const char real[] = "NDims = 3\nDimSize = 4 3 2\nElementType = MET_DOUBLE\n" LAST;
    const hs_metaimage_options window = {.has_window = true, .window_low = 0, .window_high = 255};
    double voxels[24] = {-1.7e308, 1.7e308, 100};
    files_write("far.mha", real, voxels, sizeof voxels);
    files_refused("far.mha", ":4: ElementDataFile 'LOCAL': values are -1.7e+308 .. 1.7e+308, expected -1e30");
    hs_volume volume = files_read("far.mha", &window);
    assert_int_equal(volume.voxels[1], 255);
    assert_int_equal(volume.voxels[2], 100);
    voxels[18] = INFINITY;
    files_write("inf.mha", real, voxels, sizeof voxels);
    files_refused("inf.mha", "voxel (2, 1, 1) is 'inf', expected a finite number");
    const double flat[24] = {0};
    files_write("flat.mha", real, flat, sizeof flat);
    files_refused("flat.mha", "every voxel is 0: no range to map to 8 bit");
}

/* The compressed stream's length, by one byte more and less, and the best that compression can do. */
static void compressed(void **state) {
    size_t bytes;
    uint8_t *packed = files_deflate(good_data, GOOD_BYTES, &bytes);
    for (int more = -1; more <= 1; more++) {
        const char *const text = unit_text(TEXT "CompressedData = True\nCompressedDataSize = %zu\n" LAST,
                                           (size_t)((long)bytes + more));
        files_write("packed.mha", text, packed, bytes);
        const char *const told = unit_text(":8: CompressedDataSize is '%zu', but 'LOCAL' has %zu bytes",
                                           (size_t)((long)bytes + more), bytes);
        if (more != 0)
            files_refused("packed.mha", told);
        else
            files_read("packed.mha", NULL);
    }
}

/* Every prefix of a file with its data inside, raw and compressed, but the whole one. */
static void every_truncation_is_refused(void **state) {
    size_t packed_bytes;
    uint8_t *packed = files_deflate(good_data, GOOD_BYTES, &packed_bytes);
    for (int compressed = 0; compressed < 2; compressed++) {
        char file[1024];
        const size_t text = (size_t)snprintf(file, sizeof file, "%s", compressed ? PACKED : TEXT LAST);
        const size_t data = compressed ? packed_bytes : GOOD_BYTES;
        assert_true(text + data < sizeof file);
        memcpy(file + text, compressed ? packed : good_data, data);
        for (size_t n = 0; n < text + data; n++) {
            files_write("cut.mha", NULL, file, n);
            const bool whole_lines = n > 0 && n < text && file[n - 1] == '\n';
            files_refused("cut.mha", whole_lines ? "ElementDataFile is missing" : n ? NULL : "is empty");
            if (n >= text) files_refused("cut.mha", "ElementDataFile 'LOCAL'");
        }
        files_write("cut.mha", NULL, file, text + data);
        files_read("cut.mha", NULL); /* and the whole one is right */
    }
}

/* Adler-32 guards the voxels, so a changed byte is noticed wherever it is. */
static void every_damaged_byte_of_compressed_data_is_noticed(void **state) {
    size_t bytes;
    uint8_t *packed = files_deflate(good_data, GOOD_BYTES, &bytes);
    for (size_t i = 0; i < bytes; i++) {
        packed[i] ^= 0xff;
        files_write("damaged.mha", PACKED, packed, bytes);
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
    files_write("bomb.mha", PACKED, packed, bytes);
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
    files_write("short.mha", PACKED, packed, bytes);
    files_refused("short.mha", "CompressedData ends after 47 voxel bytes, expected 48");

    packed = files_deflate(good_data, GOOD_BYTES, &bytes);
    uint8_t trailed[256] = {0};
    memcpy(trailed, packed, bytes);
    files_write("trail.mha", PACKED, trailed, bytes + 3);
    files_refused("trail.mha", "3 bytes follow after the compressed data");
    files_write("size.mha", "CompressedDataSize = -5\n" PACKED, packed, bytes);
    files_refused("size.mha", "CompressedDataSize is '-5', expected a number of bytes");
    files_write("size.mha", "HeaderSize = -1\n" PACKED, packed, bytes);
    files_refused("size.mha", "HeaderSize is '-1'");
    files_write("plain.mha", PACKED, good_data, GOOD_BYTES);
    files_refused("plain.mha", "CompressedData is damaged");
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
    const size_t text = strlen("Comment = \n" TEXT LAST);
    memcpy(long_text + MAX_HEADER - text, "\n" TEXT LAST, strlen("\n" TEXT LAST));
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
    static const char *const broken[] = {"NDims = 2\nPatientName = Doe^Jane\nPatientID: 4711-Doe\n",
                                         "Comment = Doe^Jane\nDoe^Jane 4711\n",
                                         "ElementType = x\nName = Doe^Jane\nComment = x\n"};
    for (size_t i = 0; i < 3; i++) {
        write_with("patient.mha", broken[i], GOOD_BYTES);
        hs_error err = {0};
        hs_volume volume;
        assert_false(hs_metaimage_read(files_path("patient.mha"), NULL, &volume, &err));
        assert_null(strstr(err.text, "Doe"));
        assert_null(strstr(err.text, "4711"));
        assert_null(strchr(err.text, '\n'));
    }
}

static void messages_stay_one_printable_line(void **state) {
    write_with("odd.mha",
               "ElementType = MET_\x1b[31m\a\xff much longer than any name of a type could ever be in a "
               "header of this format\n",
               GOOD_BYTES);
    files_refused("odd.mha", "ElementType is 'MET_?[31m?? much longer");
    files_refused("odd.mha", "...', expected");
}

static int setup(void **state) {
    for (size_t i = 0; i < GOOD_BYTES; i++) good_data[i] = (uint8_t)(i * 37 + 5);
    return files_setup(state);
}

UNIT_MAIN(setup, files_teardown, both_sides_of_every_rule, no_field_is_there_twice, long_headers, data_files,
          only_in_a_folder, values, compressed, every_truncation_is_refused,
          every_damaged_byte_of_compressed_data_is_noticed, compressed_streams_must_fit_the_header,
          what_is_no_metaimage_is_refused, skipped_values_stay_out_of_messages,
          messages_stay_one_printable_line)
