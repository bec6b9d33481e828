/* SPDX-License-Identifier: MIT */
/*
 * A MetaImage sequence in the scan loop: 25 volumes are read ahead and never kept, in order and in any other,
 * plain and compressed, as bytes and mapped to 8 bit. Two volumes of the file are invalid: they are left out
 * and shift neither times nor transforms. Volume n of the valid ones has one value all over.
 */
#include "support/metaimage_files.h"
#include "support/sequence_fixture.h"

#include <unistd.h>

enum { VOLUMES = 25, IN_FILE = VOLUMES + 2, FIRST_INVALID = 3, SECOND_INVALID = 11 };
enum { NX = 128, NY = 120, NZ = 96, VOXELS = NX * NY * NZ };

/* How a sequence is stored. */
typedef struct {
    const char *name;
    bool wide; /* MET_USHORT, mapped from its own range; else MET_UCHAR */
    bool compressed;
} kind;

static const kind kinds[] = {{"bytes.mha", false, false},
                             {"wide.mha", true, false},
                             {"packed.mha", false, true},
                             {"wide_packed.mha", true, true}};
enum { KINDS = sizeof kinds / sizeof *kinds };

static const hs_source_files all_scanned = {.metaimage = {.padding = HS_PADDING_NONE}};

/* Where valid volume `n` stands in the file. */
static uint32_t frame_of(uint32_t n) {
    const uint32_t behind_first = n + (n >= FIRST_INVALID);
    return behind_first + (behind_first >= SECOND_INVALID);
}

/* What the host makes of volume n: 10 + 9 n as it is; 100 n from 0 .. 2400; a 0 that was scanned is 1. Good
 * until the next call. */
static const uint8_t *levels_of(const kind *k) {
    static uint8_t levels[VOLUMES];
    for (uint32_t n = 0; n < VOLUMES; n++)
        levels[n] = (uint8_t)(k->wide ? n * 255.0 / (VOLUMES - 1) + 0.5 : 10 + 9 * n);
    if (k->wide) levels[0] = 1;
    return levels;
}

/* The file's text up to the data. An invalid volume says so, every other one has its time and transform. */
static size_t write_text(char *text, size_t room, const kind *k, uint32_t nz) {
    int at = snprintf(text, room,
                      "NDims = 4\nDimSize = %d %d %u %d\nKinds = domain domain domain list\n"
                      "CompressedData = %s\n",
                      NX, NY, nz, IN_FILE, k->compressed ? "True" : "False");
    for (int f = 0; f < IN_FILE; f++) {
        const bool invalid = f == FIRST_INVALID || f == SECOND_INVALID;
        at += snprintf(text + at, room - (size_t)at,
                       "Seq_Frame%04d_ProbeToTrackerTransform = 1 0 0 %d 0 1 0 0 0 0 1 0 0 0 0 1\n"
                       "Seq_Frame%04d_Timestamp = %g\nSeq_Frame%04d_ImageStatus = %s\n",
                       f, f, f, 0.5 * f, f, invalid ? "INVALID" : "OK");
    }
    at += snprintf(text + at, room - (size_t)at, "ElementType = %s\nElementDataFile = LOCAL\n",
                   k->wide ? "MET_USHORT" : "MET_UCHAR");
    assert_true((size_t)at < room);
    return (size_t)at;
}

/* All volumes of the file; an invalid one has the largest value there is. */
static uint8_t *make_voxels(const kind *k, uint32_t nz, size_t *bytes) {
    const size_t width = k->wide ? 2 : 1, volume = (size_t)NX * NY * nz * width;
    *bytes = volume * IN_FILE;
    uint8_t *data = unit_memory(*bytes);
    memset(data, 255, *bytes);
    for (uint32_t n = 0; n < VOLUMES; n++) {
        const unsigned value = k->wide ? 100 * n : 10 + 9 * n;
        uint8_t *at = data + volume * frame_of(n);
        for (size_t i = 0; i < volume; i++) at[i] = (uint8_t)(value >> 8 * (i % width));
    }
    return data;
}

/* Writes the file with `more` bytes behind it and returns its path, good until the next call. */
static const char *write_sequence(const kind *k, uint32_t nz, size_t more) {
    static char path[256], text[16384];
    size_t bytes;
    const void *mark = unit_mark();
    uint8_t *data = make_voxels(k, nz, &bytes);
    if (k->compressed) {
        data = files_deflate(data, bytes, &bytes);
    }
    (void)snprintf(path, sizeof path, "%s", files_path(k->name));
    FILE *file = fopen(path, "wb");
    assert_non_null(file);
    const size_t length = write_text(text, sizeof text, k, nz);
    assert_int_equal(fwrite(text, 1, length, file), length);
    assert_int_equal(fwrite(data, 1, bytes, file), bytes);
    for (size_t i = 0; i < more; i++) assert_int_equal(fputc(0, file), 0);
    assert_int_equal(fclose(file), 0);
    unit_return(mark);
    return path;
}

static hs_source *open_one(const char *path) {
    return open_source(&path, 1, &all_scanned);
}

/* A round takes no more memory than a few volumes; the file has 25. */
static void memory_stays_flat(void **state) {
    for (size_t which = 0; which < KINDS; which++) {
        const char *path = write_sequence(&kinds[which], NZ, 0);
        const void *mark = unit_mark();
        const size_t before = resident_bytes();
        hs_source *source = open_one(path);
        assert_int_equal(source->count, VOLUMES);
        expect_flat_memory(source, levels_of(&kinds[which]), before);
        unit_return(mark);
    }
}

static void volumes_come_in_any_order(void **state) {
    for (size_t which = 0; which < KINDS; which++)
        expect_any_order(open_one(write_sequence(&kinds[which], 2, 0)), levels_of(&kinds[which]));
}

static void what_is_said_stays_with_its_volume(void **state) {
    for (size_t which = 0; which < KINDS; which++) {
        const char *path = write_sequence(&kinds[which], 2, 0);
        hs_source *source = open_one(path);
        assert_int_equal(source->left_out, 2);
        for (uint32_t i = 0; i < VOLUMES + 1; i++) {
            const hs_source_origin *origin = hs_source_origin_of(source, i);
            const uint32_t frame = frame_of(i % VOLUMES);
            assert_string_equal(origin->path, path);
            assert_int_equal(origin->index, i % VOLUMES);
            assert_true(origin->fields.has_time && origin->fields.time == 0.5 * frame);
            assert_int_equal(origin->fields.transform_count, 1);
            assert_true(origin->fields.transforms[0].matrix[3] == frame);
            assert_false(origin->fields.invalid);
        }
    }
}

/* A stream is closed while its thread reads. */
static void a_stream_ends_at_once(void **state) {
    const char *path = write_sequence(&kinds[3], NZ / 4, 0);
    const void *mark = unit_mark();
    for (int turn = 0; turn < 5; turn++) {
        open_one(path);
        unit_return(mark);
    }
}

static void every_frame_shows_its_volume(void **state) {
    hs_source *source = open_one(write_sequence(&kinds[2], 40, 0));
    expect_every_frame_shows_its_volume(*state, source, levels_of(&kinds[2]));
}

/* The file loses its end while it is played. */
static void a_failing_file_is_told(void **state) {
    const char *path = write_sequence(&kinds[0], NZ, 0);
    hs_source *source = open_one(path);
    expect_volume(source, levels_of(&kinds[0]), 1);
    assert_int_equal(truncate(path, 20 * (off_t)VOXELS), 0);
    expect_failure(source, levels_of(&kinds[0]), 22, kinds[0].name, "it became shorter");
}

/* Compressed bytes that are wrong are met when they are inflated: the volumes before them are played. */
static void damaged_data_is_told(void **state) {
    const kind *k = &kinds[2];
    const char *path = write_sequence(k, NZ, 0);
    FILE *file = fopen(path, "r+b");
    assert_non_null(file);
    assert_int_equal(fseeko(file, -20000, SEEK_END), 0);
    for (int i = 0; i < 200; i++) assert_int_equal(fputc(0xFF, file), 0xFF);
    assert_int_equal(fclose(file), 0);
    hs_source *source = open_one(path);
    expect_failure(source, levels_of(k), VOLUMES - 1, k->name, "CompressedData is damaged");
}

/* That the data ends behind the last volume is checked with it. */
static void trailing_data_is_told(void **state) {
    const kind *k = &kinds[2];
    hs_source *source = open_one(write_sequence(k, 2, 3));
    expect_failure(source, levels_of(k), VOLUMES - 1, k->name, "3 bytes follow after the compressed data");
    expect_volume(source, levels_of(k), VOLUMES - 2);
}

/* A compressed file that is cut while it is read, and whole again later: what was half read is no state to go
 * on from. Noise, so that its bytes come in many pieces. */
static void a_read_that_failed_starts_anew(void **state) {
    enum { SIDE = 64, VOLUME = SIDE * SIDE * SIDE };
    static const char text[] = "NDims = 4\nDimSize = 64 64 64 2\nElementType = MET_UCHAR\n"
                               "CompressedData = True\nElementDataFile = LOCAL\n";
    static uint8_t data[2 * VOLUME];
    uint32_t random = 1;
    for (size_t i = 0; i < sizeof data; i++)
        data[i] = (uint8_t)((random = random * 1664525u + 1013904223u) >> 24 | 1u);
    size_t bytes;
    uint8_t *packed = files_deflate(data, sizeof data, &bytes);
    files_write("noise.mha", text, packed, bytes);
    hs_error err = {0};
    hs_volume volume = {0};
    hs_metaimage *file = hs_metaimage_open(files_path("noise.mha"), NULL, &err);
    assert_non_null(file);
    assert_int_equal(truncate(files_path("noise.mha"), 200000), 0);
    assert_false(hs_metaimage_read_at(file, 1, &volume, &err));
    assert_non_null(strstr(err.text, "it became shorter"));
    assert_null(volume.voxels);
    files_write("noise.mha", text, packed, bytes);
    for (uint32_t i = 2; i-- > 0;) {
        if (!hs_metaimage_read_at(file, i, &volume, &err)) fail_msg("%s", err.text);
        assert_memory_equal(volume.voxels, data + i * VOLUME, VOLUME);
    }
    hs_volume_free(&volume);
    hs_metaimage_close(file);
}

UNIT_MAIN(sequence_set_up, sequence_tear_down, memory_stays_flat, volumes_come_in_any_order,
          what_is_said_stays_with_its_volume, a_stream_ends_at_once, every_frame_shows_its_volume,
          a_failing_file_is_told, damaged_data_is_told, trailing_data_is_told, a_read_that_failed_starts_anew)
