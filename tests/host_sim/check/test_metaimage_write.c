/* SPDX-License-Identifier: MIT */
/* hs_metaimage_write: files that read back, texts as 3D Slicer needs them, and failures that leave nothing
 * behind. */
#include "support/metaimage_files.h"
#include "volume/metaimage_write.h"

#include <math.h>
#include <signal.h>
#include <sys/resource.h>
#include <sys/stat.h>

enum { NX = 6, NY = 5, NZ = 4, COUNT = NX * NY * NZ };

static uint8_t bytes[COUNT];
static uint16_t words[COUNT];
static float floats[COUNT];

static int setup(void **state) {
    for (size_t i = 0; i < COUNT; i++) {
        bytes[i] = (uint8_t)(i * 2 + 3);
        words[i] = (uint16_t)(i * 546 % 65000);
        floats[i] = (float)i * 0.25f - 7.0f;
    }
    return files_setup(state);
}

enum { U8, U16, F32, KINDS };
static const hs_met_type types[KINDS] = {HS_MET_UCHAR, HS_MET_USHORT, HS_MET_FLOAT};

static hs_metaimage_format format_of(int kind, uint32_t dims, bool compress) {
    return (hs_metaimage_format){.type = types[kind],
                                 .dims = dims,
                                 .size = {NX, NY, NZ},
                                 .spacing = {0.5, 0.1, 1.0 / 3.0},
                                 .compress = compress};
}

/* The data of the format's type. */
static const void *data_of(const hs_metaimage_format *format) {
    const void *const data[KINDS] = {bytes, words, floats};
    int kind = U8;
    while (kind < F32 && types[kind] != format->type) kind++;
    return data[kind];
}

static void write_ok(const char *name, const hs_metaimage_format *format) {
    must(hs_metaimage_write(files_path(name), format, data_of(format), &err));
}

/* Read with a window that makes the 8-bit value known: u8 as it is, u16 by 256 levels
 * of 257, floats by their step. */
static void formats_read_back(void **state) {
    static const hs_metaimage_options options[] = {
        {.padding = HS_PADDING_ALL},
        {.padding = HS_PADDING_ALL, .has_window = true, .window_low = 0, .window_high = 65535},
        {.padding = HS_PADDING_ALL,
         .has_window = true,
         .window_low = -7.0,
         .window_high = -7.0 + 255 * 0.25}};
    for (int kind = U8; kind <= F32; kind++) {
        for (int variant = 0; variant < 2; variant++) {
            const hs_metaimage_format format = format_of(kind, 3, variant);
            write_ok("a.mha", &format);
            hs_volume volume = files_read("a.mha", &options[kind]);
            assert_int_equal(volume.nx, NX);
            assert_int_equal(volume.ny, NY);
            assert_int_equal(volume.nz, NZ);
            /* 17 digits: the very same double */
            assert_true(volume.spacing[0] == 0.5 && volume.spacing[1] == 0.1 &&
                        volume.spacing[2] == 1.0 / 3.0);
            for (size_t i = 0; i < COUNT; i++) {
                const uint8_t expected[] = {bytes[i], (uint8_t)((words[i] + 128) / 257), (uint8_t)i};
                assert_int_equal(volume.voxels[i], expected[kind]);
            }
        }
    }
    assert_int_equal(files_count(), 1); /* no temporary file is left */
}

static size_t read_file(const char *name, char *out, size_t room) {
    FILE *file = fopen(files_path(name), "rb");
    assert_non_null(file);
    const size_t n = fread(out, 1, room - 1, file);
    out[n] = '\0';
    assert_int_equal(fclose(file), 0);
    return n;
}

/* Text and bytes of a depthmap, a volume of one slice, to the letter. */
static void a_depthmap_is_written_as_stated(void **state) {
    hs_metaimage_format format = format_of(F32, 3, false);
    format.size[2] = 1;
    format.spacing[1] = 0.25;
    format.spacing[2] = 2;
    write_ok("depth.mha", &format);
    static const char expected[] =
        "ObjectType = Image\nNDims = 3\nBinaryData = True\nBinaryDataByteOrderMSB = False\n"
        "CompressedData = False\nTransformMatrix = 1 0 0 0 1 0 0 0 1\nOffset = 0 0 0\nCenterOfRotation = 0 0 "
        "0\n"
        "AnatomicalOrientation = ???\nElementSpacing = 0.5 0.25 2\nDimSize = 6 5 1\nElementType = "
        "MET_FLOAT\nElementDataFile = LOCAL\n";
    char file[1024];
    const size_t n = read_file("depth.mha", file, sizeof file);
    assert_int_equal(n, strlen(expected) + NX * NY * sizeof(float));
    assert_memory_equal(file, expected, strlen(expected));
    assert_memory_equal(file + strlen(expected), floats, NX * NY * sizeof(float));
}

static void refused_of(const char *path, const hs_metaimage_format *format, const void *data,
                       const char *told) {
    hs_error err = {0};
    const int before = files_count();
    assert_false(hs_metaimage_write(path, format, data, &err));
    unit_told(err, HS_ERR_OUTPUT, path);
    unit_told(err, HS_ERR_OUTPUT, told);
    assert_int_equal(files_count(), before); /* nothing is left behind */
}

static void refused(const char *path, const hs_metaimage_format *format, const char *told) {
    refused_of(path, format, data_of(format), told);
}

static void arrays_that_cannot_be_written_are_named(void **state) {
    hs_metaimage_format format = format_of(U8, 3, false);
    format.dims = 5;
    refused(files_path("x.mha"), &format, "NDims is 5, expected 3 or 4");
    format = format_of(U8, 3, false);
    format.size[1] = 0;
    refused(files_path("x.mha"), &format, "DimSize along axis 1 is 0");
    format = format_of(F32, 3, false);
    format.size[0] = format.size[1] = format.size[2] = UINT32_MAX; /* 2^98 bytes */
    refused(files_path("x.mha"), &format, "DimSize along axis 1 is 4294967295");
    format = format_of(U8, 3, false);
    format.spacing[2] = NAN;
    refused(files_path("x.mha"), &format, "ElementSpacing along axis 2 is nan");
    format.spacing[2] = 0;
    refused(files_path("x.mha"), &format, "ElementSpacing along axis 2 is 0");
    format = format_of(U8, 3, false);
    refused_of(files_path("x.mha"), &format, NULL, "no data given");
    format = format_of(U8, 3, false);
    format.type = (hs_met_type)HS_MET_TYPES;
    refused(files_path("x.mha"), &format, "ElementType 10");
}

static void places_that_cannot_be_written_are_named(void **state) {
    const hs_metaimage_format format = format_of(U8, 3, false);
    refused(files_path("x.png"), &format, "should end in .mha");
    refused(files_path(".mha"), &format, "should end in .mha");
    refused(files_path("absent/x.mha"), &format, "No such file or directory");
    assert_int_equal(mkdir(files_path("folder.mha"), 0700), 0);
    refused(files_path("folder.mha"), &format, "not a regular file");
    assert_int_equal(rmdir(files_path("folder.mha")), 0);
}

/* A disk that fills up, by a limit on the size of files: the earlier file stays as it was. */
static void a_full_disk_leaves_the_earlier_file(void **state) {
    const hs_metaimage_format before = format_of(U8, 3, false);
    write_ok("full.mha", &before);
    (void)signal(SIGXFSZ, SIG_IGN); /* so that write reports EFBIG */
    struct rlimit limit, small;
    assert_int_equal(getrlimit(RLIMIT_FSIZE, &limit), 0);
    small = limit;
    small.rlim_cur = 400; /* the text fits, the data does not */
    assert_int_equal(setrlimit(RLIMIT_FSIZE, &small), 0);
    const hs_metaimage_format later = format_of(F32, 3, false);
    refused(files_path("full.mha"), &later, "File too large");
    assert_int_equal(setrlimit(RLIMIT_FSIZE, &limit), 0);
    hs_volume volume = files_read("full.mha", NULL);
    assert_memory_equal(volume.voxels, bytes, COUNT);
}

UNIT_MAIN(setup, files_teardown, formats_read_back, a_depthmap_is_written_as_stated,
          arrays_that_cannot_be_written_are_named, places_that_cannot_be_written_are_named,
          a_full_disk_leaves_the_earlier_file)
