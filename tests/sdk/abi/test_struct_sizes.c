/* SPDX-License-Identifier: MIT */
/*
 * The built plugin keeps the rules on `size`: a struct longer than its own (a newer host's) is accepted and
 * the part it does not know is left alone; a struct shorter than version 1.0 is refused with SV_ERR_SIZE,
 * without a byte written.
 */
#include "smartvis_plugin.h"

#include <dlfcn.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

enum { WIDTH = 16, HEIGHT = 8, SLICES = 4, RAYS = WIDTH * HEIGHT, EXTRA = 24, MARK = 0xA5 };

/* A struct with a tail that only a newer host knows. */
#define GROWN(type)                                                                                          \
    union {                                                                                                  \
        type head;                                                                                           \
        unsigned char bytes[sizeof(type) + EXTRA];                                                           \
    }

typedef struct {
    void *library;
    const sv_entry *entry;
    sv_host host;
    const sv_plugin *plugin;
    unsigned char volume[RAYS * SLICES];
    float depth[RAYS];
} fixture;

static void assert_tail_untouched(const unsigned char *bytes, size_t from) {
    for (size_t i = 0; i < EXTRA; i++) assert_int_equal(bytes[from + i], MARK);
}

static sv_format small_format(void) {
    return (sv_format){.size = sizeof(sv_format),
                       .width = WIDTH,
                       .height = HEIGHT,
                       .slices = SLICES,
                       .max_slab_slices = SLICES,
                       .voxel_type = SV_VOXEL_U8,
                       .carrier = SV_CARRIER_HOST,
                       .padding_value = SV_NO_PADDING,
                       .tiles_x = 1,
                       .tile_w = WIDTH,
                       .tile_h = HEIGHT,
                       .row_pitch = WIDTH};
}

static sv_frame one_frame(void) {
    return (sv_frame){.size = sizeof(sv_frame)};
}

static sv_slab whole_slab(const fixture *f) {
    return (sv_slab){
        .size = sizeof(sv_slab), .slice_count = SLICES, .memory = f->volume, .bytes = sizeof(f->volume)};
}

static sv_result depth_result(fixture *f) {
    return (sv_result){.size = sizeof(sv_result), .depth = f->depth};
}

static int open_library(void **state) {
    const char *folder = getenv("SV_BUILD_DIR");
    char path[1024];
    snprintf(path, sizeof(path), "%s/smartvis.so", folder ? folder : "build");
    fixture *f = calloc(1, sizeof(*f));
    if (!f) return -1;
    *state = f;
    f->library = dlopen(path, RTLD_NOW | RTLD_LOCAL);
    if (!f->library) {
        fprintf(stderr, "%s\n", dlerror());
        return -1;
    }
    f->entry = dlsym(f->library, SV_ENTRY_SYMBOL);
    f->host = (sv_host){.size = sizeof(sv_host), .abi_minor = SV_ABI_MINOR, .name = "test", .version = "0"};
    return f->entry && f->entry->create(&f->host, f->entry->descriptor(0)->id, &f->plugin) == SV_OK ? 0 : -1;
}

static int close_library(void **state) {
    fixture *f = *state;
    f->plugin->destroy(f->plugin);
    dlclose(f->library);
    free(f);
    return 0;
}

static int open_active(void **state) {
    if (open_library(state) != 0) return -1;
    fixture *f = *state;
    const sv_format format = small_format();
    return f->plugin->activate(f->plugin, &format) == SV_OK ? 0 : -1;
}

static int close_active(void **state) {
    fixture *f = *state;
    f->plugin->deactivate(f->plugin);
    return close_library(state);
}

/* What a host reads before it trusts anything else. */
static void test_entry(void **state) {
    const fixture *f = *state;
    assert_int_equal(f->entry->abi_major, SV_ABI_MAJOR);
    assert_int_equal(f->entry->abi_minor, SV_ABI_MINOR);
    assert_int_equal(f->entry->size, sizeof(sv_entry));
    assert_int_equal(f->plugin->size, sizeof(sv_plugin));
    assert_true(f->entry->count >= 1);
    for (uint32_t i = 0; i < f->entry->count; i++)
        assert_int_equal(f->entry->descriptor(i)->size, sizeof(sv_descriptor));
    assert_null(f->entry->descriptor(f->entry->count));
    assert_null(f->entry->descriptor(UINT32_MAX));
}

static void test_host(void **state) {
    const fixture *f = *state;
    const char *id = f->entry->descriptor(0)->id;
    GROWN(sv_host) host;
    memset(&host, MARK, sizeof(host));
    host.head = f->host;
    host.head.size = sizeof(host);
    host.head.abi_minor = SV_ABI_MINOR + 1;
    const sv_plugin *plugin = NULL;
    assert_int_equal(f->entry->create(&host.head, id, &plugin), SV_OK);
    plugin->destroy(plugin);

    /* Any non-NULL value will do: an error must overwrite it. */
    plugin = f->plugin;
    host.head.size = sizeof(sv_host) - 1;
    assert_int_equal(f->entry->create(&host.head, id, &plugin), SV_ERR_SIZE);
    assert_null(plugin);
    host.head.size = 0;
    assert_int_equal(f->entry->create(&host.head, id, &plugin), SV_ERR_SIZE);
}

static void test_param_info(void **state) {
    const fixture *f = *state;
    assert_true(f->plugin->param_count(f->plugin) > 0);
    GROWN(sv_param_info) info;
    memset(&info, MARK, sizeof(info));
    info.head.size = sizeof(info);
    assert_int_equal(f->plugin->param_info(f->plugin, 0, &info.head), SV_OK);
    assert_tail_untouched(info.bytes, sizeof(sv_param_info));
    assert_int_not_equal(info.head.id, 0);
    assert_non_null(info.head.key);

    memset(&info, MARK, sizeof(info));
    info.head.size = sizeof(sv_param_info) - 1;
    assert_int_equal(f->plugin->param_info(f->plugin, 0, &info.head), SV_ERR_SIZE);
    for (size_t i = sizeof(uint32_t); i < sizeof(info); i++) assert_int_equal(info.bytes[i], MARK);
}

static void test_format(void **state) {
    fixture *f = *state;
    GROWN(sv_format) format;
    memset(&format, MARK, sizeof(format));
    format.head = small_format();
    format.head.size = sizeof(sv_format) - 1;
    assert_int_equal(f->plugin->activate(f->plugin, &format.head), SV_ERR_SIZE);
    const sv_frame frame = one_frame();
    assert_int_equal(f->plugin->begin(f->plugin, &frame), SV_ERR_STATE); /* the instance stayed inactive */

    format.head.size = sizeof(format);
    assert_int_equal(f->plugin->activate(f->plugin, &format.head), SV_OK);
    f->plugin->deactivate(f->plugin);
}

/* A whole frame with every struct of a newer host: the answer is the one of a frame with 1.0's structs. */
static void test_grown_frame(void **state) {
    fixture *f = *state;
    sv_frame frame = one_frame();
    sv_slab slab = whole_slab(f);
    sv_result result = depth_result(f);
    for (size_t i = 0; i < sizeof(f->volume); i++) f->volume[i] = (unsigned char)(i * 7919u >> 3);
    assert_int_equal(f->plugin->begin(f->plugin, &frame), SV_OK);
    assert_int_equal(f->plugin->slab(f->plugin, &slab), SV_OK);
    const sv_status expected = f->plugin->end(f->plugin, &result);
    assert_true(expected >= 0);
    float depth[RAYS];
    memcpy(depth, f->depth, sizeof(depth));
    memset(f->depth, MARK, sizeof(f->depth));

    GROWN(sv_frame) long_frame;
    GROWN(sv_slab) long_slab;
    GROWN(sv_result) long_result;
    GROWN(sv_stats) long_stats;
    memset(&long_frame, MARK, sizeof(long_frame));
    memset(&long_slab, MARK, sizeof(long_slab));
    memset(&long_result, MARK, sizeof(long_result));
    memset(&long_stats, MARK, sizeof(long_stats));
    long_frame.head = frame;
    long_frame.head.size = sizeof(long_frame);
    long_slab.head = slab;
    long_slab.head.size = sizeof(long_slab);
    long_stats.head.size = sizeof(long_stats);
    long_result.head = result;
    long_result.head.size = sizeof(long_result);
    long_result.head.stats = &long_stats.head;
    assert_int_equal(f->plugin->begin(f->plugin, &long_frame.head), SV_OK);
    assert_int_equal(f->plugin->slab(f->plugin, &long_slab.head), SV_OK);
    assert_int_equal(f->plugin->end(f->plugin, &long_result.head), expected);
    assert_memory_equal(f->depth, depth, sizeof(depth));
    assert_int_equal(long_stats.head.rays, RAYS);
    assert_int_equal(long_stats.head.outcome, expected);
    assert_tail_untouched(long_stats.bytes, sizeof(sv_stats));
}

static void test_short_frame(void **state) {
    fixture *f = *state;
    sv_frame frame = one_frame();
    frame.size = SV_FRAME_SIZE_1_0 - 1;
    assert_int_equal(f->plugin->begin(f->plugin, &frame), SV_ERR_SIZE);
    /* A host of 1.0, and one with half a rotation, which says nothing: what lies behind is not the plugin's.
     */
    for (uint32_t more = 0; more <= EXTRA; more += EXTRA) {
        unsigned char *old = malloc(SV_FRAME_SIZE_1_0 + more);
        assert_non_null(old);
        memset(old, MARK, SV_FRAME_SIZE_1_0 + more);
        frame.size = SV_FRAME_SIZE_1_0 + more;
        memcpy(old, &frame, SV_FRAME_SIZE_1_0);
        assert_int_equal(f->plugin->begin(f->plugin, (const sv_frame *)(const void *)old), SV_OK);
        free(old);
    }

    frame.size = sizeof(frame);
    sv_slab slab = whole_slab(f);
    slab.size = sizeof(slab) - 1;
    assert_int_equal(f->plugin->begin(f->plugin, &frame), SV_OK);
    assert_int_equal(f->plugin->slab(f->plugin, &slab), SV_ERR_SIZE);

    slab.size = sizeof(slab);
    sv_result result = depth_result(f);
    result.size = sizeof(result) - 1;
    for (size_t i = 0; i < RAYS; i++) f->depth[i] = -77.0f;
    assert_int_equal(f->plugin->begin(f->plugin, &frame), SV_OK);
    assert_int_equal(f->plugin->slab(f->plugin, &slab), SV_OK);
    assert_int_equal(f->plugin->end(f->plugin, &result), SV_ERR_SIZE);
    for (size_t i = 0; i < RAYS; i++) assert_true(f->depth[i] == -77.0f);

    GROWN(sv_stats) stats;
    memset(&stats, MARK, sizeof(stats));
    stats.head.size = sizeof(sv_stats) - 1;
    result.size = sizeof(result);
    result.stats = &stats.head;
    assert_int_equal(f->plugin->begin(f->plugin, &frame), SV_OK);
    assert_int_equal(f->plugin->slab(f->plugin, &slab), SV_OK);
    assert_int_equal(f->plugin->end(f->plugin, &result), SV_ERR_SIZE);
    for (size_t i = sizeof(uint32_t); i < sizeof(stats); i++) assert_int_equal(stats.bytes[i], MARK);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(test_entry, open_library, close_library),
        cmocka_unit_test_setup_teardown(test_host, open_library, close_library),
        cmocka_unit_test_setup_teardown(test_param_info, open_library, close_library),
        cmocka_unit_test_setup_teardown(test_format, open_library, close_library),
        cmocka_unit_test_setup_teardown(test_grown_frame, open_active, close_active),
        cmocka_unit_test_setup_teardown(test_short_frame, open_active, close_active),
    };
    return cmocka_run_group_tests_name("struct sizes", tests, NULL, NULL);
}
