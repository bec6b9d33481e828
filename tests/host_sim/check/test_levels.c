/* SPDX-License-Identifier: MIT */
/* What of a file was scanned, whatever lies outside; grey in several channels; sizes that are not said, or
 * not those of a scan.
 * Requirement: R13. */
#include "support/metaimage_files.h"
#include "volume/levels.h"

#include <math.h>

enum { N = 24, COUNT = N * N * N };
#define SIZE "24 24 24"

/* A fan that widens along z; scanned values are 20 .. 119. */
static bool in_fan(size_t i) {
    const double x = (double)(i % N) - 11.5, y = (double)(i / N % N) - 11.5, z = (double)(i / N / N);
    return hypot(x, y) < 4.0 + 0.3 * z && hypot(hypot(x, y), z) < 21.0;
}

static double scanned_value(size_t i) {
    return 20.0 + (double)(i * 37 % 100);
}

static void write_fan(const char *name, hs_met_type type, double outside, uint32_t channels, bool coloured) {
    static uint8_t data[COUNT * 4 * 3];
    const size_t width = hs_met_type_bytes(type);
    const char *const lines = unit_text("ElementNumberOfChannels = %u\n", channels);
    for (size_t i = 0; i < COUNT; i++)
        for (uint32_t c = 0; c < channels; c++) {
            const double v = (in_fan(i) ? scanned_value(i) : outside) + (coloured && c == 1 && in_fan(i));
            uint8_t *to = data + (i * channels + c) * width;
            const float f = (float)v;
            const uint16_t u = type == HS_MET_USHORT ? (uint16_t)v : 0;
            if (type == HS_MET_FLOAT) memcpy(to, &f, sizeof f);
            if (type == HS_MET_USHORT) memcpy(to, &u, sizeof u);
            if (type == HS_MET_UCHAR) *to = (uint8_t)v;
        }
    files_volume(name, SIZE, hs_met_type_name(type), lines, data, COUNT * channels * width);
}

/* Levels from the scanned values alone, 1 at least; of bytes as they are. */
static void expect_fan(const char *name, hs_met_type type) {
    hs_volume v = files_read(name, NULL);
    for (size_t i = 0; i < COUNT; i++) {
        const double level = type == HS_MET_UCHAR
                                 ? scanned_value(i)
                                 : fmax(floor((scanned_value(i) - 20.0) / 99.0 * 255.0 + 0.5), 1.0);
        if (v.voxels[i] != (in_fan(i) ? (uint8_t)level : 0))
            fail_msg("%s: voxel %zu is %u, scanned: %d, value %g", name, i, v.voxels[i], in_fan(i),
                     scanned_value(i));
    }
}

static void whatever_lies_outside_was_not_scanned(void **state) {
    static const struct {
        hs_met_type type;
        double outside;
    } files[] = {{HS_MET_UCHAR, 0},           {HS_MET_UCHAR, 16},        {HS_MET_UCHAR, 255},
                 {HS_MET_USHORT, 0},          {HS_MET_USHORT, 4096},     {HS_MET_FLOAT, -999},
                 {HS_MET_FLOAT, (double)NAN}, {HS_MET_FLOAT, -INFINITY}, {HS_MET_FLOAT, 0}};
    for (size_t i = 0; i < sizeof files / sizeof *files; i++) {
        write_fan("fan.mha", files[i].type, files[i].outside, 1, false);
        expect_fan("fan.mha", files[i].type);
    }
    /* With maps of what was scanned, whatever else is in the file does not count. */
    static uint16_t first[N * N], end[N * N];
    for (size_t i = 0; i < N * N; i++) {
        for (first[i] = 0; first[i] < N && !in_fan(i + (size_t)first[i] * N * N);) first[i]++;
        for (end[i] = first[i]; end[i] < N && in_fan(i + (size_t)end[i] * N * N);) end[i]++;
    }
    files_volume("first.mha", "24 24 1", "MET_USHORT", "", first, sizeof first);
    files_volume("end.mha", "24 24 1", "MET_USHORT", "", end, sizeof end);
    write_fan("fan.mha", HS_MET_FLOAT, -999, 1, false);
    const hs_metaimage_options maps = {.scanned = {files_path("first.mha"), files_path("end.mha")}};
    hs_volume v = files_read("fan.mha", &maps);
    uint8_t high = 0;
    for (size_t i = 0; i < COUNT; i++) {
        assert_int_equal(v.voxels[i] > 0, in_fan(i));
        high = v.voxels[i] > high ? v.voxels[i] : high;
    }
    assert_int_equal(high, 255);
}

/* A layer of one value is no outside, nor is a box that is all scanned. */
static void what_was_scanned_stays(void **state) {
    static uint8_t layers[COUNT];
    for (size_t i = 0; i < COUNT; i++) layers[i] = i / N / N < 8 ? 100 : i / N / N < 16 ? 10 : 200;
    files_volume("layers.mha", SIZE, "MET_UCHAR", "", layers, sizeof layers);
    hs_volume v = files_read("layers.mha", NULL);
    assert_memory_equal(v.voxels, layers, sizeof layers);
    /* The darkest of other values than 0, here on a face, is not scanned only if a corner holds it. */
    for (int corner = 0; corner < 2; corner++) {
        for (size_t i = 0; i < COUNT; i++) {
            const size_t x = i % N, y = i / N % N, z = i / N / N;
            layers[i] = x == 0 && y / 8 == 1 ? 156 : (uint8_t)(i * 7 % 100);
            if (corner && x < 2 && y < 2 && z < 2) layers[i] = 156; /* -100 */
        }
        files_volume("signed.mha", SIZE, "MET_CHAR", "", layers, sizeof layers);
        v = files_read("signed.mha", NULL);
        assert_int_equal(v.voxels[8 * N], corner ? 0 : 1);
    }
}

typedef struct {
    double corner[8]; /* of the octants' outside; NaN: no two voxels are alike */
    bool reads_rear;
} box;

enum { SIDE = 16 };

static bool read_box(void *context, uint64_t at, size_t count, double *out, hs_error *err) {
    box *b = context;
    for (uint64_t i = at; i < at + count; i++) {
        const uint64_t x = i % SIDE, y = i / SIDE % SIDE, z = i / SIDE / SIDE;
        const double outside = b->corner[x / 8 + y / 8 * 2 + z / 8 * 4];
        const bool scanned = x >= 4 && x < 12 && y >= 4 && y < 12;
        *out++ = scanned || isnan(outside) ? (double)(100 + i) : outside;
        b->reads_rear |= z >= SIDE / 2;
    }
    return true;
}

/* Beside zeros, which need no search, another constant counts; the rear is read only if the front has one. */
static void a_constant_beside_zeros_is_found(void **state) {
    static const struct {
        double front[4], rear;
        bool zero; /* means not scanned already */
        double outside;
        bool found, reads_rear;
    } cases[] = {
        {{16, 16, 16, 16}, 16, true, 16, true, true}, {{16, 16, 16, 0}, 16, true, 16, true, true},
        {{0, 0, 16, 0}, 16, true, 16, true, true},    {{16, 0, 0, 0}, 16, true, 16, true, true},
        {{0, 0, 0, 0}, 16, true, 0, false, false},    {{0, 0, 0, 0}, 0, false, 0, true, true},
        {{0, 0, 0, NAN}, 0, true, 0, false, false},   {{NAN, NAN, NAN, NAN}, 16, true, 0, false, false}};
    static const uint32_t size[3] = {SIDE, SIDE, SIDE};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        box b = {{0}, false};
        hs_levels levels;
        for (int c = 0; c < 8; c++) b.corner[c] = c < 4 ? cases[i].front[c] : cases[i].rear;
        hs_levels_begin(&levels);
        must(hs_levels_find_outside(&levels, size, cases[i].zero, read_box, &b, &err));
        if (levels.has_outside != cases[i].found || b.reads_rear != cases[i].reads_rear ||
            (levels.has_outside && levels.outside != cases[i].outside))
            fail_msg("case %zu: found %d, %g; the rear was read: %d", i, levels.has_outside, levels.outside,
                     b.reads_rear);
    }
}

static void grey_in_channels_is_grey(void **state) {
    for (uint32_t channels = 3; channels <= 4; channels++) {
        write_fan("grey.mha", HS_MET_UCHAR, 0, channels, false);
        expect_fan("grey.mha", HS_MET_UCHAR);
        write_fan("colour.mha", HS_MET_UCHAR, 0, channels, true);
        files_refused("colour.mha", "is in colour: its ");
    }
}

static void a_size_is_said_or_doubted(void **state) {
    static const struct {
        double spacing;
        const char *told; /* NULL: nothing */
    } sizes[] = {{1.25, NULL},
                 {4.16, NULL},
                 {0.00125, "The volume is 0.12 mm wide: is its spacing in metres?"},
                 {0.125, "is its spacing in centimetres?"},
                 {1250, "The volume is 1.2e+05 mm wide: is its spacing in micrometres?"},
                 {5, "is its spacing right?"},
                 {0.4, "The volume is 38.4 mm wide and 19.2 mm along z: is the spacing right?"}};
    const double sides[][3] = {{0.00125, 0.00125, 2.5}, {1.25, 1.25, 0.05}};
    hs_volume v = {.nx = 96, .ny = 60, .nz = 48};
    char doubt[HS_DOUBT_BYTES], size[HS_SIZE_BYTES];
    for (size_t i = 0; i < sizeof sizes / sizeof *sizes; i++) {
        for (int a = 0; a < 3; a++) v.spacing[a] = sizes[i].spacing;
        assert_int_equal(hs_volume_doubt(&v, doubt), sizes[i].told != NULL);
        if (sizes[i].told) assert_non_null(strstr(doubt, sizes[i].told));
    }
    for (size_t i = 0; i < sizeof sides / sizeof *sides; i++) {
        memcpy(v.spacing, sides[i], sizeof v.spacing);
        assert_true(hs_volume_doubt(&v, doubt) && strstr(doubt, "times as long as another"));
    }
    const hs_volume map = {.nx = 96, .ny = 96, .nz = 1, .spacing = {1, 1, 1}};
    assert_false(hs_volume_doubt(&map, doubt));
    const hs_metaimage_options given = {.has_spacing = true, .spacing = {1, 2, 3}};
    write_fan("fan.mha", HS_MET_UCHAR, 0, 1, false);
    hs_volume unsaid = files_read("fan.mha", NULL);
    hs_volume said = files_read("fan.mha", &given);
    assert_true(unsaid.spacing_unsaid && !said.spacing_unsaid && said.spacing[1] == 2.0);
    assert_true(hs_volume_doubt(&unsaid, doubt) && strstr(doubt, "--spacing X,Y,Z"));
    hs_volume_size_words(&unsaid, size);
    assert_string_equal(size, "24 x 24 x 24 voxels of unknown size: spacing not said");
}

UNIT_MAIN(files_setup, files_teardown, whatever_lies_outside_was_not_scanned, what_was_scanned_stays,
          a_constant_beside_zeros_is_found, grey_in_channels_is_grey, a_size_is_said_or_doubted)
