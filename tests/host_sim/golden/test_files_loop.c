/* SPDX-License-Identifier: MIT */
/*
 * Several files in the scan loop, 25 of one volume each, and a Kretz file of 25: they are read ahead and
 * never kept, one file is open at a time, sequences may stand among others, and a file that fails on the way
 * is an error of the frame. Volume n has one level all over.
 */
#include "loop/slabs.h"
#include "result/result_write.h"
#include "support/kretz_files.h"
#include "support/sequence_fixture.h"

#include <dirent.h>
#include <unistd.h>

enum { VOLUMES = 25, NX = 128, NY = 120, NZ = 96, VOXELS = NX * NY * NZ };

enum { SAMPLES = 96, LINES = 80, PLANES = 64 };

static const hs_source_files all_scanned = {.metaimage = {.padding = HS_PADDING_NONE}};
static const hs_source_files coarse = {.metaimage = {.padding = HS_PADDING_NONE}, .kretz = {.spacing = 3.0}};

static uint8_t levels[VOLUMES]; /* 10 + 9 n */

/* Paths of files that were written; good until the next list is begun. */
typedef struct {
    const char *path[VOLUMES];
    uint32_t count;
} list;

static void add_path(list *files, const char *name) {
    files->path[files->count++] = files_path(name);
}

/* A file of `volumes` volumes from volume `n` on, each at its own place in the patient. */
static void add_file(list *files, uint32_t n, uint32_t volumes, uint32_t nz, const char *more) {
    const size_t count = (size_t)NX * NY * nz;
    uint8_t *voxels = malloc(volumes * count);
    assert_non_null(voxels);
    for (uint32_t v = 0; v < volumes; v++) memset(voxels + v * count, levels[n + v], count);
    const char *const name = unit_text("file%02u.mha", n), *const one = unit_text("%d %d %u", NX, NY, nz);
    const char *const lines = unit_text("Offset = %u 0 0%s\n%s", n, volumes > 1 ? " 0" : "", more);
    files_volume(name, volumes > 1 ? unit_text("%s %u", one, volumes) : one, "MET_UCHAR", lines, voxels,
                 volumes * count);
    free(voxels);
    add_path(files, name);
}

static list *write_files(uint32_t nz) {
    static list files;
    files.count = 0;
    for (uint32_t n = 0; n < VOLUMES; n++) add_file(&files, n, 1, nz, "");
    return &files;
}

static list *write_kretz(uint32_t volumes) {
    static list files;
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
    files.count = 0;
    add_path(&files, "sequence.vol");
    bool ok = hs_kretz_write_open(&writer, files.path[0], &beams, volumes, &err);
    for (uint32_t n = 0; ok && n < volumes; n++) {
        memset(voxels, levels[n], SAMPLES * LINES * PLANES);
        ok = hs_kretz_write_volume(&writer, voxels, &err);
    }
    if (!ok || !hs_kretz_write_commit(&writer, &err)) fail_msg("%s", err.text);
    free(voxels);
    return &files;
}

static hs_source *open_list(const list *files) {
    return open_source(files->path, files->count, &coarse);
}

static uint32_t open_files(void) {
    uint32_t count = 0;
    DIR *folder = opendir("/proc/self/fd");
    assert_non_null(folder);
    while (readdir(folder)) count++;
    (void)closedir(folder);
    return count;
}

/* A round takes no more memory than a few volumes. */
static void memory_stays_flat(void **state) {
    for (int kretz = 0; kretz < 2; kretz++) {
        const list *files = kretz ? write_kretz(VOLUMES) : write_files(NZ);
        const uint32_t open_before = open_files();
        const size_t before = resident_bytes();
        const void *mark = unit_mark();
        hs_source *source = open_source(files->path, files->count, &all_scanned);
        assert_int_equal(source->count, VOLUMES);
        expect_flat_memory(source, levels, before);
        unit_return(mark);
        assert_int_equal(open_files(), open_before);
    }
}

/* Each with the name and the place of its own file, of which one is open at a time. */
static void volumes_come_in_any_order(void **state) {
    const list *files = write_files(2);
    const uint32_t open_before = open_files();
    hs_source *source = open_list(files);
    expect_any_order(source, levels);
    for (uint32_t at = VOLUMES; at-- > 0;) {
        hs_error err = {0};
        const hs_volume *volume = hs_source_bring(source, at, &err);
        const hs_source_origin *origin = hs_source_origin_of(source, at);
        const char *const name = unit_text("file%02u.mha", at);
        assert_true(volume && open_files() <= open_before + 1);
        assert_string_equal(volume->name, name);
        assert_true(volume->pose.origin[0] == at);
        assert_string_equal(origin->path, files->path[at]);
        assert_int_equal(origin->index, 0);
        assert_string_equal(hs_source_shape(source)->name, "file00.mha");
    }
    for (uint32_t volumes = 2; volumes <= 7; volumes++)
        expect_any_order(open_list(write_kretz(volumes)), levels);
}

static void sequences_may_stand_among_them(void **state) {
    static list files;
    files.count = 0;
    add_file(&files, 0, 1, 2, "");
    add_file(&files, 1, 4, 2, "Seq_Frame0001_Timestamp = 7\n");
    add_file(&files, 5, 2, 2, "");
    hs_source *source = open_list(&files);
    assert_int_equal(source->count, 7);
    for (uint32_t i = 0; i < 16; i++) {
        const uint32_t n = i % 7;
        expect_volume(source, levels, i);
        assert_int_equal(hs_source_origin_of(source, i)->index, n == 0 ? 0 : n < 5 ? n - 1 : n - 5);
        assert_int_equal(hs_source_origin_of(source, i)->fields.has_time, n == 2);
    }
}

/* Types that are mapped to 8 bit: each file from its own range, which is looked for once. */
static void ranges_are_kept(void **state) {
    static const uint8_t data[2][8] = {{0, 0, 10, 0, 20, 0, 40, 0}, {0, 1, 0, 2, 0, 3, 0, 5}};
    static const uint8_t expected[2][4] = {{1, 64, 128, 255}, {1, 64, 128, 255}};
    list files = {.count = 0};
    for (uint32_t f = 0; f < 2; f++) {
        files_volume(f ? "b.mha" : "a.mha", "2 2 1", "MET_USHORT", "", data[f], 8);
        add_path(&files, f ? "b.mha" : "a.mha");
    }
    hs_source *source = open_list(&files);
    for (uint32_t i = 0; i < 9; i++) {
        hs_error err = {0};
        const hs_volume *volume = hs_source_bring(source, i, &err);
        assert_non_null(volume);
        assert_memory_equal(volume->voxels, expected[i % 2], 4);
    }
}

static void every_frame_shows_its_volume(void **state) {
    expect_every_frame_shows_its_volume(*state, open_list(write_files(40)), levels);
    expect_every_frame_shows_its_volume(*state, open_list(write_kretz(VOLUMES)), levels);
}

/* Files that go, or become others, while the sequence is played are errors of their frames alone. */
static void a_file_that_changes_is_told(void **state) {
    const list *files = write_files(2);
    hs_source *source = open_list(files);
    expect_volume(source, levels, 1);
    assert_int_equal(unlink(files->path[14]), 0);
    expect_failure(source, levels, 14, "file14.mha", "cannot be read");
    list other = {.count = 0};
    add_file(&other, 17, 1, 3, "");
    expect_failure(source, levels, 17, "file17.mha", "is not as it was before: the file changed");
    other.count = 0;
    add_file(&other, 20, 2, 2, "");
    expect_failure(source, levels, 20, "file20.mha", "is not as it was before: the file changed");
    expect_volume(source, levels, 18);
    files =
        write_kretz(VOLUMES); /* loses its end: the frames that are gone are errors, what is left is there */
    source = open_list(files);
    expect_volume(source, levels, 1);
    assert_int_equal(truncate(files->path[0], 20 * SAMPLES * LINES * PLANES), 0);
    expect_failure(source, levels, 22, "sequence.vol", "became shorter");
}

static void expect_refusal_of(const list *files, const hs_source_files *how, hs_code code, const char *told) {
    hs_source source;
    hs_error err = {0};
    assert_false(hs_source_open_files(&source, files->path, files->count, how, &err));
    unit_told(err, code, told);
    assert_null(source.file);
    assert_null(source.sequence);
    assert_null(source.stream);
}

static void expect_refusal(const list *files, const char *told) {
    expect_refusal_of(files, NULL, HS_ERR_INPUT, told);
}

static void what_does_not_fit_is_refused(void **state) {
    list files = {.count = 0};
    add_file(&files, 0, 1, 2, "");
    add_file(&files, 1, 1, 3, "");
    expect_refusal(&files, "128 x 120 x 3 voxels, but");
    files.count = 1;
    add_file(&files, 2, 1, 2, "ElementSpacing = 1 2 1\n");
    expect_refusal(&files, "spacing 2 mm along axis 1");
    files.count = 1;
    add_file(&files, 3, 1, 2, "TransformMatrix = -1 0 0 0 -1 0 0 0 1\n");
    expect_refusal(&files, "a sequence has one orientation");
}

/* Probes of one geometry go together; of another not, even if the Cartesian copies are alike. */
static void geometries_are_compared(void **state) {
    kretz_plan plan = kretz_good();
    list files = {.count = 0};
    add_path(&files, "a.vol");
    add_path(&files, "b.vol");
    kretz_file("a.vol", &plan);
    kretz_find(&plan, 0xD000, 1)->value[0] = 2;
    kretz_file("b.vol", &plan);
    hs_source *source = open_list(&files);
    hs_error err = {0};
    assert_int_equal(source->count, 2);
    for (uint32_t i = 0; i < 6; i++) {
        const hs_volume *volume = hs_source_bring(source, i, &err);
        assert_non_null(volume);
        assert_int_equal(volume->beams->voxels[0], 1 + i % 2);
    }
    kretz_find(&plan, 0xC300, 2)->value[1] += 0.001; /* the middle line */
    kretz_file("b.vol", &plan);
    expect_refusal(&files, "b.vol: was scanned in another geometry than");
}

static void what_a_kretz_file_says_itself_is_refused(void **state) {
    const list *file = write_kretz(3);
    const hs_source_files window = {.metaimage = {.has_window = true, .window_low = 0, .window_high = 9}};
    expect_refusal_of(file, &window, HS_ERR_USAGE, "a window was given");
    const hs_source_files maps = {.metaimage = {.scanned = {"a.mha", "b.mha"}}};
    expect_refusal_of(file, &maps, HS_ERR_USAGE, "says itself what was scanned");
    const hs_source_files probe = {.metaimage = {.has_probe = true, .probe = HS_PROBE_HIGH_Y}};
    expect_refusal_of(file, &probe, HS_ERR_USAGE, "where the probe is, +y was given");
    const hs_source_files fine = {.kretz = {.spacing = 0.01}};
    expect_refusal_of(file, &fine, HS_ERR_USAGE, "spacing of 0.01 mm");
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
    list file = {.count = 0};
    add_path(&file, "cartesian.vol");
    hs_source *source = open_source(file.path, 1, NULL);
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

static int set_up_levels(void **state) {
    for (uint32_t n = 0; n < VOLUMES; n++) levels[n] = (uint8_t)(10 + 9 * n);
    return sequence_set_up(state);
}

UNIT_MAIN(set_up_levels, sequence_tear_down, memory_stays_flat, volumes_come_in_any_order,
          sequences_may_stand_among_them, ranges_are_kept, every_frame_shows_its_volume,
          a_file_that_changes_is_told, what_does_not_fit_is_refused, geometries_are_compared,
          what_a_kretz_file_says_itself_is_refused, gaps_are_told_by_the_padding_value,
          cartesian_voxels_are_handed_on)
