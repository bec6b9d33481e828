/* SPDX-License-Identifier: MIT */
#include "support/sequence_fixture.h"

#include "support/metaimage_files.h"

#include <malloc.h>
#include <unistd.h>

#ifdef __SANITIZE_ADDRESS__
/* What is freed is used again at once, so that memory in use is what the test says it is. */
const char *__asan_default_options(void); /* NOLINT(bugprone-reserved-identifier): the sanitizer's name */
const char *__asan_default_options(void) {
    return "quarantine_size_mb=0:thread_local_quarantine_size_kb=0";
}
#endif

int sequence_set_up(void **state) {
    (void)mallopt(M_MMAP_THRESHOLD, 1 << 17); /* what is freed goes back to the system, and hides nothing */
    return files_setup(state) == 0 ? set_up(state) : -1;
}

int sequence_tear_down(void **state) {
    const int loop = tear_down(state), files = files_teardown(state);
    return loop || files;
}

size_t resident_bytes(void) {
    size_t pages[2] = {0};
    FILE *file = fopen("/proc/self/statm", "r");
    assert_non_null(file);
    assert_int_equal(fscanf(file, "%zu %zu", &pages[0], &pages[1]), 2);
    (void)fclose(file);
    return pages[1] * (size_t)sysconf(_SC_PAGESIZE);
}

void expect_volume(const hs_source *source, const uint8_t *levels, uint32_t index) {
    hs_error err = {0};
    const hs_volume *v = hs_source_bring(source, index, &err);
    if (!v) {
        fail_msg("%s", err.text);
        return;
    }
    const uint8_t level = levels[index % source->count], *voxels = v->beams ? v->beams->voxels : v->voxels;
    const size_t count = v->beams ? hs_beams_count(v->beams) : hs_volume_count(v);
    for (size_t i = 0; i < count; i++)
        if (voxels[i] != level)
            fail_msg("%s: voxel %zu of volume %u is %u, expected %u", v->name, i, index, voxels[i], level);
}

void expect_any_order(const hs_source *source, const uint8_t *levels) {
    uint32_t at = 0;
    for (uint32_t turn = 0; turn < 60; turn++) {
        at = (at * 5 + turn * 3 + 1) % source->count;
        expect_volume(source, levels, at);
    }
}

/* AddressSanitizer keeps a byte for every eight. */
#ifdef __SANITIZE_ADDRESS__
#define SHADOW 9 / 8
#else
#define SHADOW 1
#endif

void expect_flat_memory(const hs_source *source, const uint8_t *levels, size_t before) {
    const hs_volume *shape = hs_source_shape(source);
    const size_t bytes = hs_volume_count(shape) + (shape->beams ? hs_beams_count(shape->beams) : 0);
    size_t maximum = 0;
    assert_non_null(source->stream);
    assert_true(bytes > 1u << 20 && source->count > 2 * SEQUENCE_MAX_VOLUMES);
    for (uint32_t i = 0; i < source->count + 5; i++) {
        expect_volume(source, levels, i);
        const size_t now = resident_bytes();
        if (now > maximum) maximum = now;
    }
    if (maximum > before + SEQUENCE_MAX_VOLUMES * bytes * SHADOW)
        fail_msg("%s: %zu bytes more in memory, a volume has %zu", shape->name, maximum - before, bytes);
}

void expect_failure(const hs_source *source, const uint8_t *levels, uint32_t index, const char *file,
                    const char *told) {
    for (int turn = 0; turn < 3; turn++) {
        hs_error err = {0};
        assert_null(hs_source_bring(source, index, &err));
        unit_told(err, HS_ERR_INPUT, file);
        unit_told(err, HS_ERR_INPUT, told);
        expect_volume(source, levels, 1);
    }
}

static void expect_level(hs_loop *loop, uint32_t index, uint8_t level) {
    hs_view view = view_of(loop, index);
    uint8_t maximum = 0;
    for (size_t p = 0; p < (size_t)view.width * view.height; p++)
        if (view.full[4 * p] > maximum) maximum = view.full[4 * p];
    assert_int_equal(maximum, level);
}

void expect_every_frame_shows_its_volume(const fixture *f, const hs_source *source, const uint8_t *levels) {
    hs_loop_options options = options_with(NULL, 0);
    hs_error err = {0};
    hs_loop_result result;
    options.frames = source->count + 5;
    options.dvr.threshold_low =
        0.0f; /* the first voxel that was scanned is opaque: its grey is the picture's */
    options.dvr.threshold_high = 1e-3f;
    hs_loop *loop = make_loop_from(&f->cl, source, f->plugin, &options);
    if (!hs_loop_run(loop, HS_SETTING_SMARTVIS, NULL, &result, &err)) {
        fail_msg("%s", err.text);
        return;
    }
    assert_int_equal(result.failed_frames, 0);
    for (uint32_t i = 0; i < source->count; i += 6) expect_level(loop, i, levels[i]);
}
