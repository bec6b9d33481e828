/* SPDX-License-Identifier: MIT */
/*
 * A Kretz file in the scan loop: a sequence of 25 volumes is read ahead and never kept, every frame shows its
 * own volume, and a file that fails on the way is an error of the frame. Volume n has echoes of 10 + 9 n all
 * over.
 */
#include "loop/slabs.h"
#include "result/result_write.h"
#include "support/kretz_files.h"
#include "support/sequence_fixture.h"
#include "volume/kretz.h"

#include <unistd.h>

enum { VOLUMES = 25, SAMPLES = 96, LINES = 80, PLANES = 64 };

static uint8_t levels[VOLUMES]; /* 10 + 9 n */

/* Writes the file and returns its path, which stays good. */
static const char *write_sequence(uint32_t volumes) {
    static char path[256];
    double theta[LINES], phi[PLANES];
    for (int j = 0; j < LINES; j++) theta[j] = 0.012 * j - 0.006 * (LINES - 1);
    for (int k = 0; k < PLANES; k++) phi[k] = 0.006 * (PLANES - 1) - 0.012 * k;
    const hs_beams beams = {.samples = SAMPLES,
                            .lines = LINES,
                            .planes = PLANES,
                            .pitch = 0.5,
                            .start = 20.0,
                            .axis = -8.0,
                            .theta = theta,
                            .phi = phi};
    uint8_t *voxels = malloc(SAMPLES * LINES * PLANES);
    assert_non_null(voxels);
    hs_kretz_writer writer;
    hs_error err = {0};
    (void)snprintf(path, sizeof path, "%s", files_path("sequence.vol"));
    bool ok = hs_kretz_write_open(&writer, path, &beams, volumes, &err);
    for (uint32_t n = 0; ok && n < volumes; n++) {
        memset(voxels, levels[n], SAMPLES * LINES * PLANES);
        ok = hs_kretz_write_volume(&writer, voxels, &err);
    }
    if (!ok || !hs_kretz_write_commit(&writer, &err)) fail_msg("%s", err.text);
    free(voxels);
    return path;
}

static const hs_source_files coarse = {.kretz = {.spacing = 3.0}};

static hs_source *open_one(const char *path, const hs_source_files *how) {
    return open_source(&path, 1, how);
}

/* A round takes no more memory than a few volumes; the file has 25. */
static void memory_stays_flat(void **state) {
    const char *path = write_sequence(VOLUMES);
    const size_t before = resident_bytes();
    hs_source *source = open_one(path, NULL);
    assert_int_equal(source->count, VOLUMES);
    expect_flat_memory(source, levels, before);
}

static void volumes_come_in_any_order(void **state) {
    for (uint32_t volumes = 2; volumes <= 7; volumes++)
        expect_any_order(open_one(write_sequence(volumes), &coarse), levels);
}

/* A stream is closed while its thread reads. */
static void a_stream_ends_at_once(void **state) {
    const char *path = write_sequence(VOLUMES);
    const void *mark = unit_mark();
    for (int turn = 0; turn < 10; turn++) {
        open_one(path, &coarse);
        unit_return(mark);
    }
}

static void every_frame_shows_its_volume(void **state) {
    hs_source *source = open_one(write_sequence(VOLUMES), &coarse);
    expect_every_frame_shows_its_volume(*state, source, levels);
}

/* The file loses its end while it is played: the frames that are gone are errors, what is left is there. */
static void a_failing_file_is_told(void **state) {
    const char *path = write_sequence(VOLUMES);
    hs_source *source = open_one(path, &coarse);
    expect_volume(source, levels, 1);
    assert_int_equal(truncate(path, 20 * SAMPLES * LINES * PLANES), 0);
    expect_failure(source, levels, 22, "sequence.vol", "became shorter");
}

static void expect_refusal(const char *const *paths, uint32_t count, const hs_source_files *how, hs_code code,
                           const char *told) {
    hs_source source;
    hs_error err = {0};
    assert_false(hs_source_open_files(&source, paths, count, how, &err));
    unit_told(err, code, told);
    assert_null(source.file);
    assert_null(source.stream);
}

static void what_does_not_fit_is_refused(void **state) {
    const char *path = write_sequence(3);
    const hs_source_files window = {.metaimage = {.has_window = true, .window_low = 0, .window_high = 9}};
    expect_refusal(&path, 1, &window, HS_ERR_USAGE, "a window was given");
    const hs_source_files maps = {.scanned = {"a.mha", "b.mha"}};
    expect_refusal(&path, 1, &maps, HS_ERR_USAGE, "says itself what was scanned");
    const hs_source_files probe = {.metaimage = {.has_probe = true, .probe = HS_PROBE_HIGH_Y}};
    expect_refusal(&path, 1, &probe, HS_ERR_USAGE, "where the probe is, +y was given");
    const hs_source_files fine = {.kretz = {.spacing = 0.01}};
    expect_refusal(&path, 1, &fine, HS_ERR_USAGE, "spacing of 0.01 mm");
}

/* A ray may leave a fan and come back: beside its range, the value 0 tells what lies between. */
static void gaps_are_told_by_the_padding_value(void **state) {
    fixture *f = *state;
    const hs_slab_layout layout = {16, 16, 16, 6, 1, 16, 16, 64};
    for (int gaps = 0; gaps < 2; gaps++) {
        hs_error err = {0};
        sv_format format = {.size = sizeof format};
        hs_slabs *slabs =
            hs_slabs_create(&f->cl, &layout, SV_CARRIER_BUFFER, HS_FAN_RANGES, gaps, NULL, &err);
        if (!slabs) fail_msg("%s", err.text);
        hs_slabs_describe_format(slabs, &format);
        assert_int_equal(format.flags, SV_FORMAT_SCANNED);
        assert_int_equal(format.padding_value, gaps ? 0 : SV_NO_PADDING);
        hs_slabs_destroy(slabs);
    }
}

/* Results on a Cartesian file: its voxels, as they were read. */
static void cartesian_voxels_are_handed_on(void **state) {
    kretz_plan plan = kretz_good();
    kretz_drop(&plan, 0xC200, 1);
    kretz_drop(&plan, 0xC200, 2);
    kretz_drop(&plan, 0xC300, 1);
    kretz_drop(&plan, 0xC300, 2);
    kretz_find(&plan, 0x0001, 0x0100)->value[0] = 1;
    kretz_file("cartesian.vol", &plan);
    hs_source *source = open_one(files_path("cartesian.vol"), NULL);
    hs_error err = {0};
    hs_result_voxels *voxels = hs_result_voxels_open(source, &err);
    if (!voxels || !hs_result_voxels_turn(voxels, 0)) {
        fail_msg("%s", err.text);
        return;
    }
    const uint8_t *bytes = hs_result_voxels_next(voxels, KRETZ_VOXELS);
    for (uint32_t i = 0; i < KRETZ_VOXELS; i++) assert_int_equal(bytes[i], i + 1);
    hs_result_voxels_close(voxels);
}

static int kretz_set_up(void **state) {
    for (uint32_t n = 0; n < VOLUMES; n++) levels[n] = (uint8_t)(10 + 9 * n);
    return sequence_set_up(state);
}

UNIT_MAIN(kretz_set_up, sequence_tear_down, cmocka_unit_test(memory_stays_flat),
          cmocka_unit_test(volumes_come_in_any_order), cmocka_unit_test(a_stream_ends_at_once),
          cmocka_unit_test(every_frame_shows_its_volume), cmocka_unit_test(a_failing_file_is_told),
          cmocka_unit_test(what_does_not_fit_is_refused),
          cmocka_unit_test(gaps_are_told_by_the_padding_value),
          cmocka_unit_test(cartesian_voxels_are_handed_on))
