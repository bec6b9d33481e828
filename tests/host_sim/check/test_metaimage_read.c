/* SPDX-License-Identifier: MIT */
/* MetaImage files that are right: every voxel type, byte order and carrier, the mapping to
 * 8 bit, the text's liberties. */
#include "support/metaimage_files.h"
#include "volume/metaimage_write.h"

#include <math.h>

enum { NX = 5, NY = 4, NZ = 3, COUNT = NX * NY * NZ };

/* A type: how a value becomes bytes, and the range the test spreads its values over. */
typedef enum { SIGNED, UNSIGNED, FLOAT } kind;
static const struct {
    const char *name;
    kind kind;
    unsigned bytes;
    double low, high;
} types[] = {
    {"MET_CHAR", SIGNED, 1, -128, 127},
    {"MET_UCHAR", UNSIGNED, 1, 0, 255},
    {"MET_SHORT", SIGNED, 2, -32768, 32767},
    {"MET_USHORT", UNSIGNED, 2, 0, 65535},
    {"MET_INT", SIGNED, 4, -2147483648.0, 2147483647.0},
    {"MET_UINT", UNSIGNED, 4, 0, 4294967295.0},
    {"MET_LONG", SIGNED, 4, -2147483648.0, 2147483647.0},
    {"MET_ULONG", UNSIGNED, 4, 7, 4294967295.0},
    {"MET_LONG_LONG", SIGNED, 8, -9007199254740992.0, 9007199254740992.0}, /* 2^53: exact in double */
    {"MET_ULONG_LONG", UNSIGNED, 8, 3, 9007199254740992.0},
    {"MET_FLOAT", FLOAT, 4, -12.5, 3.0e4},
    {"MET_DOUBLE", FLOAT, 8, -1e30, 1e30},
};

/* Voxel i of the test volume, as the type holds it. 7 is coprime to 60: all of the range, in no simple
 * order. */
static double voxel_value(size_t t, size_t i) {
    const double f = (double)(i * 7 % COUNT) / (COUNT - 1);
    const double v = types[t].low * (1.0 - f) + types[t].high * f;
    if (types[t].kind == FLOAT) return types[t].bytes == 4 ? (double)(float)v : v;
    return trunc(v);
}

/* What the stated mapping makes of it, in long double and straight from its words. */
static uint8_t mapped(size_t t, size_t i) {
    const double v = voxel_value(t, i);
    if (types[t].kind == UNSIGNED && types[t].bytes == 1) return (uint8_t)v;
    const long double low = voxel_value(t, 0), high = types[t].kind == FLOAT && types[t].bytes == 4
                                                          ? (long double)(float)types[t].high
                                                          : (long double)types[t].high;
    return (uint8_t)floorl(((long double)v - low) / (high - low) * 255.0L + 0.5L);
}

static void put_value(size_t t, double value, bool big, uint8_t *out) {
    uint64_t bits;
    if (types[t].kind == FLOAT && types[t].bytes == 4) {
        const float f = (float)value;
        uint32_t b;
        memcpy(&b, &f, 4);
        bits = b;
    } else if (types[t].kind == FLOAT) {
        memcpy(&bits, &value, 8);
    } else {
        bits = types[t].kind == SIGNED ? (uint64_t)(int64_t)value : (uint64_t)value;
    }
    for (unsigned b = 0; b < types[t].bytes; b++)
        out[big ? types[t].bytes - 1 - b : b] = (uint8_t)(bits >> (8 * b));
}

/* Writes the volume of type t as "v.mha" or as "v.mhd" with "v.bin", and returns the name to read. */
static const char *write_case(size_t t, bool big, bool local, bool compressed, bool tell_size) {
    uint8_t data[COUNT * 8];
    const size_t bytes = COUNT * types[t].bytes;
    for (size_t i = 0; i < COUNT; i++) put_value(t, voxel_value(t, i), big, data + i * types[t].bytes);
    size_t stored = bytes;
    uint8_t *packed = compressed ? files_deflate(data, bytes, &stored) : NULL;
    char text[512], size_line[64] = "";
    if (tell_size) (void)snprintf(size_line, sizeof size_line, "CompressedDataSize = %zu\n", stored);
    (void)snprintf(text, sizeof text,
                   "ObjectType = Image\nNDims = 3\nBinaryData = True\n%s = %s\nCompressedData = "
                   "%s\n%sDimSize = %d %d %d\n"
                   "ElementSpacing = 0.5 0.25 2\nElementType = %s\nElementDataFile = %s\n",
                   local ? "BinaryDataByteOrderMSB" : "ElementByteOrderMSB", big ? "True" : "False",
                   compressed ? "True" : "False", size_line, NX, NY, NZ, types[t].name,
                   local ? "LOCAL" : "v.bin");
    if (local) {
        files_write("v.mha", text, compressed ? packed : data, stored);
    } else {
        files_write("v.mhd", text, NULL, 0);
        files_write("v.bin", NULL, compressed ? packed : data, stored);
    }
    return local ? "v.mha" : "v.mhd";
}

static void every_type_order_and_carrier(void **state) {
    const hs_metaimage_options as_stored = {.padding = HS_PADDING_ALL};
    for (size_t t = 0; t < sizeof types / sizeof *types; t++) {
        for (unsigned variant = 0; variant < 12; variant++) {
            const bool big = variant & 1, local = variant & 2, compressed = variant >= 4, tell = variant >= 8;
            hs_volume volume = files_read(write_case(t, big, local, compressed, tell), &as_stored);
            assert_int_equal(volume.nx, NX);
            assert_int_equal(volume.ny, NY);
            assert_int_equal(volume.nz, NZ);
            assert_true(volume.spacing[0] == 0.5 && volume.spacing[1] == 0.25 && volume.spacing[2] == 2.0);
            assert_string_equal(volume.name, local ? "v.mha" : "v.mhd");
            for (size_t i = 0; i < COUNT; i++)
                if (volume.voxels[i] != mapped(t, i))
                    fail_msg("%s, variant %u, voxel %zu: %u, expected %u", types[t].name, variant, i,
                             volume.voxels[i], mapped(t, i));
        }
    }
}

/* 5 x 5 x 5 bytes: 77, a zero on the border and one in the centre. */
static void write_two_zeros(void) {
    uint8_t data[125];
    memset(data, 77, sizeof data);
    data[0] = data[62] = 0;
    files_volume("zeros.mha", "5 5 5", "MET_UCHAR", "", data, sizeof data);
}

static void padding_decides_what_a_zero_is(void **state) {
    write_two_zeros();
    static const uint8_t expected[3][2] = {
        [HS_PADDING_AUTO] = {0, 1}, [HS_PADDING_NONE] = {1, 1}, [HS_PADDING_ALL] = {0, 0}};
    for (int padding = HS_PADDING_AUTO; padding <= HS_PADDING_ALL; padding++) {
        const hs_metaimage_options opt = {.padding = (hs_padding)padding};
        hs_volume volume = files_read("zeros.mha", padding == HS_PADDING_AUTO ? NULL : &opt);
        assert_int_equal(volume.voxels[0], expected[padding][0]);
        assert_int_equal(volume.voxels[62], expected[padding][1]);
        assert_int_equal(volume.voxels[1], 77);
    }
}

/* Window 100 .. 300 over 200 values: 255 / 200 per unit. */
static void a_window_maps_and_clamps(void **state) {
    static const uint16_t values[] = {0, 99, 100, 140, 180, 299, 300, 65535};
    static const uint8_t expected[] = {0, 0, 0, 51, 102, 254, 255, 255};
    files_volume("w.mha", "8 1 1", "MET_USHORT", "", values, sizeof values);
    const hs_metaimage_options opt = {
        .padding = HS_PADDING_ALL, .has_window = true, .window_low = 100.0, .window_high = 300.0};
    hs_volume volume = files_read("w.mha", &opt);
    assert_memory_equal(volume.voxels, expected, sizeof expected);

    static const uint8_t bytes[] = {9, 10, 11, 20, 60, 61, 200, 255}; /* a window counts for MET_UCHAR, too */
    static const uint8_t of_bytes[] = {0, 0, 5, 51, 255, 255, 255, 255};
    files_volume("w.mha", "8 1 1", "MET_UCHAR", "", bytes, sizeof bytes);
    const hs_metaimage_options narrow = {
        .padding = HS_PADDING_ALL, .has_window = true, .window_low = 10.0, .window_high = 60.0};
    volume = files_read("w.mha", &narrow);
    assert_memory_equal(volume.voxels, of_bytes, sizeof of_bytes);
}

static void a_window_that_is_none_is_refused(void **state) {
    write_two_zeros();
    const double bad[][2] = {{5, 5}, {6, 5}, {NAN, 5}, {0, INFINITY}};
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        const hs_metaimage_options opt = {.padding = HS_PADDING_AUTO,
                                          .has_window = true,
                                          .window_low = bad[i][0],
                                          .window_high = bad[i][1]};
        hs_volume volume;
        must_not(hs_metaimage_read(files_path("zeros.mha"), &opt, &volume, &err), HS_ERR_USAGE,
                 "zeros.mha: window is");
    }
}

/* Texts that mean the same as the plain one: 2 x 2 x 2 bytes 10 .. 17. */
static void the_text_may_be_written_in_many_ways(void **state) {
    static const uint8_t data[] = {10, 11, 12, 13, 14, 15, 16, 17};
    static const char *const texts[] = {
        "NDims = 3\r\nDimSize = 2 2 2\r\nElementType = MET_UCHAR\r\nElementDataFile = LOCAL\r\n",
        "\n\n  NDims=3\n\t\nDimSize   =  2\t2  2   \nElementType=MET_UCHAR\nElementDataFile=LOCAL\n",
        "NDims: 3\nDimSize: 2 2 2\nElementType: MET_UCHAR\nElementDataFile: Local\n",
        "Comment = a = b : c\nComment = again\nNDims = 4\nDimSize = 2 2 2 1\nElementSpacing = 1 1 1 "
        "1\nElementType = MET_UCHAR\n"
        "TransformMatrix = 0 1 0 1 0 0 0 0 -1\nOffset = -3 4 1e3\nElementNumberOfChannels = "
        "1\nElementDataFile = LOCAL\n",
        "ElementType = MET_UCHAR\nDimSize = 2 2 2\nCompressedData = 0\nBinaryData = true\nNDims = "
        "3\nElementMin = 4\n"
        "BinaryDataByteOrderMSB = False\nElementByteOrderMSB = False\nElementSize = 1 1 1\nElementDataFile = "
        "local\n",
        "NDims = 3\nDimSize = 2 2 2\nElementType = MET_UCHAR\nHeaderSize = -1\nElementDataFile = LOCAL\n",
        "NDims = 3\nDimSize = 2 2 2\nElementType = MET_UCHAR\nHeaderSize = 0\nElementDataFile = LOCAL\n"};
    for (size_t i = 0; i < sizeof texts / sizeof *texts; i++) {
        files_write("text.mha", texts[i], data, sizeof data);
        hs_volume volume = files_read("text.mha", NULL);
        assert_int_equal(hs_volume_count(&volume), sizeof data);
        assert_memory_equal(volume.voxels, data, sizeof data);
        assert_true(volume.spacing[0] == 1.0 && volume.spacing[2] == 1.0);
    }
}

static void header_size_skips_bytes_of_the_data_file(void **state) {
    static const uint8_t data[] = {1, 2, 3, 4, 5, 21, 22, 23};
    files_write("skip.raw", NULL, data, sizeof data);
    static const char *const sizes[] = {"5", "-1"};
    for (int i = 0; i < 2; i++) {
        const char *const text =
            unit_text("NDims = 3\nDimSize = 3 1 1\nElementType = MET_UCHAR\nHeaderSize = %s\nElementSize = "
                      "3 4 5\nElementDataFile = skip.raw",
                      sizes[i]);
        files_write("skip.mhd", text, NULL, 0);
        hs_volume volume = files_read("skip.mhd", NULL);
        assert_memory_equal(volume.voxels, data + 5, 3);
        assert_true(volume.spacing[1] == 4.0); /* ElementSize stands in for ElementSpacing */
    }
    files_write(
        "gap.mha",
        "NDims = 3\nDimSize = 3 1 1\nElementType = MET_UCHAR\nHeaderSize = 100\nElementDataFile = LOCAL\n",
        NULL, 0);
    uint8_t padded[103];
    FILE *file = fopen(files_path("gap.mha"), "rb");
    assert_non_null(file);
    const size_t text_bytes = fread(padded, 1, sizeof padded, file);
    assert_int_equal(fclose(file), 0);
    memset(padded + text_bytes, 'x', 100 - text_bytes);
    memcpy(padded + 100, data, 3);
    files_write("gap.mha", NULL, padded, sizeof padded);
    hs_volume volume = files_read("gap.mha", NULL);
    assert_memory_equal(volume.voxels, data, 3);
}

/* More voxels than one chunk of the reader holds, and more compressed bytes than one of its buffers. */
static void large_volumes_cross_the_readers_buffers(void **state) {
    enum { SIDE = 70 };
    const size_t count = (size_t)SIDE * SIDE * SIDE;
    uint16_t *values = unit_memory(count * sizeof *values);
    uint32_t seed = 1;
    for (size_t i = 0; i < count; i++) {
        seed = seed * 1664525u + 1013904223u;
        values[i] = (uint16_t)(seed >> 16);
    }
    values[0] = 0;
    values[1] = 65535;
    const hs_metaimage_format format = {
        .type = HS_MET_USHORT, .dims = 3, .size = {SIDE, SIDE, SIDE}, .spacing = {1, 1, 1}, .compress = true};
    must(hs_metaimage_write(files_path("large.mha"), &format, values, &err));
    const hs_metaimage_options as_stored = {.padding = HS_PADDING_ALL};
    hs_volume volume = files_read("large.mha", &as_stored);
    for (size_t i = 0; i < count; i++)
        assert_int_equal(volume.voxels[i], (values[i] + 128) / 257); /* 65535 / 255 = 257 */
}

UNIT_MAIN(files_setup, files_teardown, every_type_order_and_carrier, padding_decides_what_a_zero_is,
          a_window_maps_and_clamps, a_window_that_is_none_is_refused, the_text_may_be_written_in_many_ways,
          header_size_skips_bytes_of_the_data_file, large_volumes_cross_the_readers_buffers)
