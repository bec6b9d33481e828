/* SPDX-License-Identifier: MIT */
/*
 * What libsmartvis_host tells a plugin, as a plugin sees it (base/plugins/recorder.c), and what of a volume
 * in memory was scanned.
 */
#include "base/plugins/record.h"
#include "door/smartvis_host.h"
#include "support/door_calls.h"
#include "support/unit.h"

#include <dlfcn.h>
#include <math.h>

static const char *build;
static uint8_t bytes[8 * 8 * 8];

static svh_host *open_host(void) {
    const svh_options options = {.size = sizeof options, .guard = SVH_GUARD_OFF};
    svh_host *out;
    door_must(svh_open(&options, &out, &told));
    return out;
}

static int set_up(void **state) {
    (void)state;
    build = getenv("SV_BUILD_DIR");
    host = open_host();
    return build ? 0 : -1;
}

static int tear_down(void **state) {
    (void)state;
    svh_close(host);
    return 0;
}

/* A cube, scanned from below. */
static svh_volume *take_cube(svh_host *of, double mm) {
    svh_volume *volume;
    const svh_voxels given = {.size = sizeof given,
                              .n = {8, 8, 8},
                              .spacing = {mm, mm, mm},
                              .scanned = SVH_ALL_SCANNED,
                              .probe_said = 1,
                              .bytes = bytes};
    door_must(svh_volume_take(of, &given, &volume, &told));
    unit_keep(free_volume, volume);
    return volume;
}

static svh_result clip(svh_clipper *clipper, svh_volume *volume, const svh_view *view,
                       const svh_frame *frame) {
    svh_result result = {.size = sizeof result};
    door_must(svh_clip(clipper, volume, view, frame, &result, &told));
    return result;
}

/* What the recording plugin of this name was told of its last frame, in this process. */
static const record *record_of(const char *path) {
    static const sv_host own = {
        .size = sizeof own, .abi_minor = SV_ABI_MINOR, .name = "test", .version = "1"};
    const sv_plugin *p = NULL;
    void *library = dlopen(path, RTLD_NOW | RTLD_NOLOAD);
    assert_non_null(library);
    const sv_entry *entry = dlsym(library, SV_ENTRY_SYMBOL);
    assert_int_equal(entry->create(&own, entry->descriptor(0)->id, &p), SV_OK);
    const record *seen = p->get_extension(p, RECORD_ID);
    p->destroy(p);
    (void)dlclose(library);
    return seen;
}

/* Of a turned camera a plugin without SV_FEATURE_PROBE hears as of another scan. */
static void a_plugin_is_told_what_continues(void **state) {
    (void)state;
    static const struct {
        uint32_t flags;
        int turned; /* beside the frame before */
        uint32_t told, told_plain;
    } frames[] = {{SVH_CONTINUES, 0, SV_FRAME_DISCONTINUITY, SV_FRAME_DISCONTINUITY}, /* the first */
                  {SVH_CONTINUES, 0, 0, 0},
                  {SVH_CONTINUES, 1, 0, SV_FRAME_DISCONTINUITY},
                  {SVH_SAME_VOLUME, 0, SV_FRAME_SAME_VOLUME, 0},
                  {SVH_SAME_VOLUME, 1, SV_FRAME_SAME_VOLUME, SV_FRAME_DISCONTINUITY},
                  {0, 0, SV_FRAME_DISCONTINUITY, SV_FRAME_DISCONTINUITY}};
    static const char *const names[] = {"recorder", "recorder_plain"};
    svh_volume *volume = take_cube(host, 1.0);
    for (int n = 0; n < 2; n++) {
        const char *path = unit_text("%s/tests/plugins/%s.so", build, names[n]);
        svh_clipper *clipper = clipper_of(path);
        svh_view view = {.size = sizeof view, .around = 1};
        for (size_t i = 0; i < sizeof frames / sizeof *frames; i++) {
            const svh_frame frame = {.size = sizeof frame, .flags = frames[i].flags, .time_ns = 100 + i};
            view.yaw += frames[i].turned * 20.0;
            view.n[0] = 0;
            door_must(svh_plan(volume, &view, &told));
            (void)clip(clipper, volume, &view, &frame);
            const record *seen = record_of(path);
            if (seen->frame.flags != (n ? frames[i].told_plain : frames[i].told))
                fail_msg("%s, frame %zu: flags are 0x%x", names[n], i, seen->frame.flags);
            assert_int_equal(seen->frame.time_ns, 100 + i);
            assert_int_equal(seen->frame.index, i);
        }
    }
}

/* The same voxels of another size are another format. */
static void another_spacing_activates_anew(void **state) {
    (void)state;
    const char *path = unit_text("%s/tests/plugins/recorder.so", build);
    svh_clipper *clipper = clipper_of(path);
    for (double mm = 0.5; mm < 1.0; mm += 0.125) {
        svh_volume *volume = take_cube(host, mm);
        svh_view view = {.size = sizeof view, .lowres = 8};
        door_must(svh_plan(volume, &view, &told));
        const svh_result result = clip(clipper, volume, &view, NULL);
        assert_int_equal(result.n[0], 8);
        assert_true(fabs((double)record_of(path)->format.spacing_mm[0] - view.box[0] / 8.0) < 1e-6);
    }
}

/* The device is closed now and then (door.h), but never under what lies there. */
static void many_activations_leave_others_alone(void **state) {
    (void)state;
    const char *path = unit_text("%s/tests/plugins/recorder.so", build);
    svh_clipper *stays = clipper_of(path), *changes = clipper_of(path);
    svh_volume *kept = take_cube(host, 1.0);
    svh_view view = {.size = sizeof view, .lowres = 8};
    door_must(svh_plan(kept, &view, &told));
    (void)clip(stays, kept, &view, NULL);
    for (uint32_t i = 0; i < 40; i++) {
        svh_view other = {.size = sizeof other, .lowres = 8 + i % 2};
        svh_volume *volume = take_cube(host, 1.0);
        door_must(svh_plan(volume, &other, &told));
        (void)clip(changes, volume, &other, NULL);
    }
    (void)clip(stays, kept, &view, NULL);
    assert_int_equal(record_of(path)->frame.index, 1); /* it was never activated anew */
}

static void hosts_share_nothing(void **state) {
    (void)state;
    svh_result result = {.size = sizeof result};
    svh_clipper *clipper = clipper_of(unit_text("%s/tests/plugins/recorder.so", build));
    svh_host *other = open_host();
    svh_volume *volume = take_cube(other, 1.0);
    svh_close(other);
    door_must_not(svh_clip(clipper, volume, NULL, NULL, &result, &told), SVH_USAGE, "taken by another host");
}

/* What a mask says was scanned is grey, and black echoes under it are not lost. */
static void a_mask_says_what_was_scanned(void **state) {
    (void)state;
    static const uint8_t values[] = {0, 0, 7, 9, 0, 5, 6, 8}, mask[] = {1, 0, 1, 1, 1, 1, 0, 1};
    static const uint8_t levels[] = {1, 0, 7, 9, 1, 5, 0, 8};
    svh_about about = {.size = sizeof about};
    svh_volume *volume;
    const svh_voxels given = {.size = sizeof given,
                              .n = {2, 2, 2},
                              .unsaid = 1,
                              .scanned = SVH_ALL_SCANNED,
                              .bytes = values,
                              .mask = mask};
    door_must(svh_volume_take(host, &given, &volume, &told));
    unit_keep(free_volume, volume);
    door_must(svh_volume_about(volume, &about, &told));
    assert_memory_equal(about.levels, levels, sizeof levels);
}

UNIT_MAIN(set_up, tear_down, a_plugin_is_told_what_continues, another_spacing_activates_anew,
          many_activations_leave_others_alone, hosts_share_nothing, a_mask_says_what_was_scanned)
