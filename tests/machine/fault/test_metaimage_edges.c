/* SPDX-License-Identifier: MIT */
/* Both sides of every rule for MetaImage files that is about numbers and words of the header or the length of
 * the data: what just breaks it is refused by name, what just does not is read. (Orientation:
 * test_metaimage_pose; sequences and other formats: test_metaimage_sequence; damage: test_metaimage.) */
#include "support/metaimage_files.h"

#include <sys/stat.h>
#include <unistd.h>

#define TEXT                                                                                                 \
    "ObjectType = Image\nNDims = 3\nBinaryData = True\nElementSpacing = 1 1 1\nDimSize = 4 3 2\n"            \
    "ElementType = MET_USHORT\n"
#define LAST "ElementDataFile = LOCAL\n"

/* A header in which `line` takes the place of the line of its field, or comes last, and `bytes` of data. */
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
    (void)snprintf(text + at, sizeof text - at, "%s%s", line, is_last ? "" : LAST);
    uint8_t *data = unit_memory(bytes + 1);
    for (size_t i = 0; i < bytes; i++) data[i] = (uint8_t)(i * 37 + 5);
    files_write(name, text, data, bytes);
}

typedef struct {
    const char *broken;
    size_t broken_bytes;
    const char *told;
    const char *whole;
    size_t whole_bytes;
} rule;

static void expect_both_sides(const rule *rules, size_t count) {
    for (size_t i = 0; i < count; i++) {
        write_with("edge.mha", rules[i].broken, rules[i].broken_bytes);
        files_refused("edge.mha", rules[i].told);
        write_with("edge.mha", rules[i].whole, rules[i].whole_bytes);
        files_read("edge.mha", NULL);
    }
}

static void sizes(void **state) {
    static const rule rules[] = {
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
        {"ElementSpacing = 1 1 1e308\n", 48, "ElementSpacing is '1 1 1e308'", "ElementSpacing = 1 1 9e5\n",
         48},
        {"ElementSpacing = 1 1\n", 48, "three numbers", "ElementSpacing = 1 1 .5\n", 48},
    };
    expect_both_sides(rules, sizeof rules / sizeof *rules);
}

static void encodings(void **state) {
    static const rule rules[] = {
        {"ObjectType = Images\n", 48, "expected Image", "ObjectType = Image\n", 48},
        {"ElementType = MET_USHORTS\n", 48, "ElementType is 'MET_USHORTS', expected MET_UCHAR",
         "ElementType = MET_SHORT\n", 48},
        {"ElementType = MET_ULONG\n", 192, "192 bytes of data, expected 96", "ElementType = MET_ULONG\n", 96},
        {"ElementNumberOfChannels = 2\n", 96, "expected 1", "ElementNumberOfChannels = 1\n", 48},
        {"BinaryData = False\n", 48, "expected True", "BinaryData = 1\n", 48},
        {"BinaryData = Tru\n", 48, "expected True or False", "BinaryData = T\n", 48},
        {"BinaryDataByteOrderMSB = yes\n", 48, "expected True or False", "BinaryDataByteOrderMSB = true\n",
         48},
        {"ElementByteOrderMSB = 2\n", 48, "expected True or False", "ElementByteOrderMSB = 0\n", 48},
        {"BinaryDataByteOrderMSB = False\nElementByteOrderMSB = True\n", 48,
         ":8: ElementByteOrderMSB is 'True', expected the same as BinaryDataByteOrderMSB",
         "BinaryDataByteOrderMSB = True\nElementByteOrderMSB = True\n", 48},
        {"CompressedData = maybe\n", 48, "expected True or False", "CompressedData = False\n", 48},
    };
    expect_both_sides(rules, sizeof rules / sizeof *rules);
}

static void data(void **state) {
    static const rule rules[] = {
        {"Comment = x\n", 47, "47 bytes of data, expected 48", "Comment = x\n", 48},
        {"Comment = x\n", 49, "49 bytes of data, expected 48", "Comment = x\n", 48},
        {"HeaderSize = -1\n", 47, "bytes of data, expected 48", "HeaderSize = -1\n", 55},
        {"HeaderSize = -2\n", 48, "a number of bytes, or -1", "HeaderSize = 0\n", 48},
        {"ElementDataFile = LISTS\n", 48, "LOCAL or the name of one file", "ElementDataFile = Local\n", 48},
        {"ElementDataFile = a%d.raw\n", 48, "LOCAL or the name of one file", "ElementDataFile = local\n", 48},
    };
    expect_both_sides(rules, sizeof rules / sizeof *rules);
    /* HeaderSize may be larger than the text: what lies between is passed over. */
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
                {"zero.raw", "ElementDataFile 'zero.raw': cannot be read: not a regular file"},
                {"pipe.raw", "ElementDataFile 'pipe.raw': cannot be read: not a regular file"}};
    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
        char text[200];
        (void)snprintf(text, sizeof text,
                       "NDims = 3\nDimSize = 4 3 4\nElementType = MET_UCHAR\nElementDataFile = %s\n",
                       rows[i].name);
        files_write("near.mhd", text, NULL, 0);
        if (rows[i].told) {
            files_refused("near.mhd", rows[i].told);
            continue;
        }
        files_read("near.mhd", NULL);
    }
    assert_int_equal(close(file) | unlink(outside), 0);
}

/* Values that would leave a scan two grey levels are refused, unless a window says what is meant. */
static void values(void **state) {
    const hs_metaimage_options window = {.has_window = true, .window_low = 0, .window_high = 255};
    double voxels[24] = {-1.7e308, 1.7e308, 100};
    char text[300];
    (void)snprintf(text, sizeof text, "NDims = 3\nDimSize = 4 3 2\nElementType = MET_DOUBLE\n" LAST);
    files_write("far.mha", text, (uint8_t *)voxels, sizeof voxels);
    files_refused("far.mha", ":4: ElementDataFile 'LOCAL': values are -1.7e+308 .. 1.7e+308, expected -1e30");
    hs_volume volume = files_read("far.mha", &window);
    assert_int_equal(volume.voxels[1], 255);
    assert_int_equal(volume.voxels[2], 100);
}

/* The compressed stream's length, by one byte more and less, and the best that compression can do. */
static void compressed(void **state) {
    uint8_t plain[48];
    for (size_t i = 0; i < sizeof plain; i++) plain[i] = (uint8_t)(i * 37 + 5);
    size_t bytes;
    uint8_t *packed = files_deflate(plain, sizeof plain, &bytes);
    for (int more = -1; more <= 1; more++) {
        char text[600];
        (void)snprintf(text, sizeof text, TEXT "CompressedData = True\nCompressedDataSize = %zu\n" LAST,
                       (size_t)((long)bytes + more));
        files_write("packed.mha", text, packed, bytes);
        if (more != 0) {
            char told[96];
            (void)snprintf(told, sizeof told, ":8: CompressedDataSize is '%zu', but 'LOCAL' has %zu bytes",
                           (size_t)((long)bytes + more), bytes);
            files_refused("packed.mha", told);
            continue;
        }
        files_read("packed.mha", NULL);
    }
}

UNIT_MAIN(files_setup, files_teardown, cmocka_unit_test(sizes), cmocka_unit_test(encodings),
          cmocka_unit_test(data), cmocka_unit_test(data_files), cmocka_unit_test(values),
          cmocka_unit_test(compressed))
