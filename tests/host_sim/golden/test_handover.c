/* SPDX-License-Identifier: MIT */
/*
 * What the host tells a plugin, as a plugin sees it (contract/plugins/recorder.c): slabs as the plugin takes
 * them by its descriptor, what was scanned, millimetres, time, and what does not continue.
 */
#include "base/plugins/record.h"
#include "support/loop_fixture.h"

#include <math.h>

static const record *record_of(const hs_plugin *plugin) {
    const record *seen = plugin->instance->get_extension(plugin->instance, RECORD_ID);
    assert_non_null(seen);
    return seen;
}

/* One frame of a loop that is then gone; the record stays. */
static const record *one_frame(const fixture *f, const hs_plugin *plugin, const hs_loop_options *options,
                               uint32_t index) {
    hs_frame frame;
    hs_loop *loop = make_loop_of(f, plugin, options);
    must(hs_loop_frame(loop, HS_SETTING_SMARTVIS, index, &frame, &err));
    assert_int_equal(frame.outcome, SV_OK);
    return record_of(plugin);
}

/* Cuts a fan out of the layers: ray (x, y) of the source is scanned from slice (x + y) % 20 on, nothing of x
 * < 6, and only up to slice 30 of y >= 42. */
static hs_volume make_fan(void) {
    hs_volume v = make_layers(false);
    for (uint32_t z = 0; z < N; z++)
        for (uint32_t y = 0; y < N; y++)
            for (uint32_t x = 0; x < N; x++)
                if (x < 6 || z < (x / 3 + y / 3) % 7 * 3 || (y >= 42 && z >= 30))
                    v.voxels[(z * N + y) * N + x] = 0;
    return v;
}

/* A low-resolution ray covers 3 x 3 rays of the source, and a slice 3 slices: the fan is cut along them. */
static void ranges_are_the_fan(void **state) {
    static fixture f; /* what is given back at the end refers to it */
    f = *(const fixture *)*state;
    hs_volume fan = make_fan();
    const hs_volume *volumes[] = {&fan};
    f.source = (hs_source){.volumes = volumes, .count = 1};
    hs_plugin *plugin = open_plugin("recorder");
    const hs_loop_options o = options_with(NULL, 0);
    const record *seen = one_frame(&f, plugin, &o, 0);
    assert_int_equal(seen->format.flags, SV_FORMAT_SCANNED);
    assert_int_equal(seen->format.padding_value, SV_NO_PADDING);
    for (uint32_t y = 0; y < LOW; y++)
        for (uint32_t x = 0; x < LOW; x++) {
            const sv_scanned range = seen->scanned[y * LOW + x];
            const bool none = x < 2;
            const uint32_t first = (x + y) % 7, end = y >= 14 ? 10 : LOW;
            if (none)
                assert_true(range.first >= range.end);
            else if (range.first != first || range.end != end)
                fail_msg("ray (%u, %u): %u .. %u, expected %u .. %u", x, y, range.first, range.end, first,
                         end);
        }
}

static void slabs_go_as_the_plugin_takes_them(void **state) {
    const fixture *f = *state;
    static const struct {
        const char *plugin;
        uint32_t flags;
        int32_t padding;
    } table[] = {{"recorder", SV_FORMAT_SCANNED, SV_NO_PADDING},
                 {"recorder_padding", 0, 0},
                 {"recorder_plain", 0, SV_NO_PADDING}};
    for (size_t n = 0; n < sizeof table / sizeof *table; n++) {
        hs_plugin *plugin = open_plugin(table[n].plugin);
        hs_loop_options o = options_with(NULL, 0);
        assert_int_equal(o.carrier, SV_CARRIER_BUFFER); /* which these plugins do not take */
        const record *seen = one_frame(f, plugin, &o, 0);
        assert_int_equal(seen->format.carrier, SV_CARRIER_HOST);
        assert_null(seen->format.queue);
        assert_int_equal(seen->format.flags, table[n].flags);
        assert_int_equal(seen->format.padding_value, table[n].padding);
    }
}

/* The loop goes on unclipped, and says what the descriptor lacks; activate was not called. */
static void what_it_does_not_take_is_said(void **state) {
    const fixture *f = *state;
    static const struct {
        const char *plugin, *part;
        uint32_t carrier;
        bool fixed;
    } table[] = {
        {"recorder", "takes no OpenCL image slabs of 8 bits on the host's queue", SV_CARRIER_IMAGE, true},
        {"recorder_u16",
         "takes no slabs of 8 bits: its descriptor has carriers 0x2, voxel_types 0x4, queues 0x1",
         SV_CARRIER_BUFFER, false}};
    for (size_t n = 0; n < sizeof table / sizeof *table; n++) {
        hs_plugin *plugin = open_plugin(table[n].plugin);
        hs_loop_options o = options_with(NULL, 0);
        o.carrier = table[n].carrier;
        o.carrier_fixed = table[n].fixed;
        hs_loop *loop = make_loop_of(f, plugin, &o);
        hs_frame frame;
        must(hs_loop_frame(loop, HS_SETTING_SMARTVIS, 0, &frame, &err));
        assert_false(frame.clipped);
        const hs_error *told = hs_loop_plugin_error(loop);
        assert_int_equal(told->code, HS_ERR_PLUGIN);
        if (!strstr(told->text, table[n].part)) fail_msg("'%s' in '%s'", table[n].part, told->text);
    }
}

static void millimetres_and_time(void **state) {
    const fixture *f = *state;
    hs_plugin *plugin = open_plugin("recorder");
    const hs_loop_options o = options_with(NULL, 0);
    const record *seen = one_frame(f, plugin, &o, 3);
    for (int axis = 0; axis < 3; axis++)
        assert_true(fabsf(seen->format.spacing_mm[axis] - 3.0f) < 1e-5f); /* 48 voxels of 1 mm by 16 */
    assert_int_equal(seen->frame.index, 3);
    assert_int_equal(seen->frame.time_ns, 200000000); /* the fourth of 20 a second */
}

/* What the camera knows reaches the plugin; a volume that does not say where its probe was gives zeros. */
static void where_the_probe_is(void **state) {
    static fixture f; /* what is given back at the end refers to it */
    f = *(const fixture *)*state;
    hs_volume scanned = f.layers;
    const hs_volume *volumes[] = {&scanned};
    f.source = (hs_source){.volumes = volumes, .count = 1};
    hs_volume_scanned_from(&scanned, HS_PROBE_LOW_Z);
    for (int known = 1; known >= 0; known--) {
        hs_plugin *plugin = open_plugin("recorder");
        hs_loop_options o = options_with(NULL, 0);
        o.yaw = 90; /* it looks along the volume's x: the beams run to the picture's left */
        scanned.course = (hs_course){.kind = known ? HS_BEAMS_FAN : HS_BEAMS_UNKNOWN, .sweep = 7};
        if (!known) memset(scanned.probe_turn, 0, sizeof scanned.probe_turn);
        static const float turned[9] = {0, 0, -1, 0, 1, 0, 1, 0, 0};
        const record *seen = one_frame(&f, plugin, &o, 0);
        for (int k = 0; k < 9; k++) assert_true(seen->frame.probe_rotation[k] == (known ? turned[k] : 0.0f));
        for (int k = 0; k < 3; k++) assert_true(seen->frame.probe_side[k] == (float)(known && k == 0));
        /* The volume's corner is at the picture's right end, 16 pixels of 3 mm. */
        static const float corner[3] = {46.5f, -1.5f, -1.5f};
        assert_int_equal(seen->frame.beams, known ? SV_BEAMS_FAN : SV_BEAMS_UNKNOWN);
        assert_true(seen->frame.beam_sweep_mm == (known ? 7.0f : 0.0f));
        for (int k = 0; k < 3; k++)
            assert_true(fabsf(seen->frame.beam_apex_mm[k] - (known ? corner[k] : 0.0f)) < 1e-4f);
    }
}

/* A still volume continues, and is the same one unless it is scanned live; a sequence continues until it
 * starts again; a camera that turns does where the plugin is told the pose. */
static void what_continues(void **state) {
    static fixture f; /* what is given back at the end refers to these */
    static hs_volume scanned;
    static const hs_volume *volumes[] = {&scanned, &scanned};
    f = *(const fixture *)*state;
    enum { STILL, SEQUENCE, ORBIT, ORBIT_TOLD, LIVE, KINDS };
    scanned = f.layers;
    f.source.volumes = volumes;
    for (uint32_t kind = 0; kind < KINDS; kind++) {
        hs_plugin *plugin = open_plugin("recorder");
        f.source.count = kind == SEQUENCE ? 2 : 1;
        if (kind >= ORBIT_TOLD) hs_volume_scanned_from(&scanned, HS_PROBE_LOW_Z);
        hs_loop_options o = options_with(NULL, 0);
        o.orbit = kind == ORBIT || kind == ORBIT_TOLD ? 30 : 0;
        o.live = kind == LIVE;
        hs_loop *loop = make_loop_of(&f, plugin, &o);
        for (uint32_t index = 0; index < 4; index++) {
            hs_error err = {0};
            hs_frame frame;
            assert_true(hs_loop_frame(loop, HS_SETTING_SMARTVIS, index, &frame, &err));
            const bool continues = kind == SEQUENCE ? index % 2 == 1 : kind != ORBIT && index > 0;
            const bool same = continues && kind != SEQUENCE && kind != LIVE;
            const uint32_t flags = record_of(plugin)->frame.flags;
            if (flags != (same ? SV_FRAME_SAME_VOLUME : continues ? 0u : (uint32_t)SV_FRAME_DISCONTINUITY))
                fail_msg("kind %u, frame %u: flags are %u", kind, index, flags);
        }
        /* A plugin that is activated anew knows nothing of the frame before. */
        hs_error err = {0};
        hs_frame frame;
        assert_true(hs_loop_reactivate(loop, plugin, &o, &err));
        assert_true(hs_loop_frame(loop, HS_SETTING_SMARTVIS, 5, &frame, &err));
        assert_true(record_of(plugin)->frame.flags & SV_FRAME_DISCONTINUITY);
    }
}

UNIT_MAIN(set_up, tear_down, ranges_are_the_fan, slabs_go_as_the_plugin_takes_them,
          what_it_does_not_take_is_said, millimetres_and_time, where_the_probe_is, what_continues)
