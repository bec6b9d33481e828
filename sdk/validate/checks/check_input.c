/* SPDX-License-Identifier: MIT */
/* Checks of what a plugin does with the memory that it is given. */
#include "validate/checks/check.h"

/* The call that has just returned left the host's memory as it was. */
static void expect_inputs(stage *st, uint64_t before) {
    V_EXPECT((v_run *)st->data, before == stage_inputs(st), "%s changes the host's voxels, ranges or format",
             ((v_run *)st->data)->report->where);
}

/* A frame of what the rig's stage holds, which must be the same behind every call. */
static void inputs_stay(v_rig *r) {
    v_run *run = r->s.run;
    const sv_plugin *p = r->s.plugin;
    stage *st = &r->stage;
    const uint64_t before = stage_inputs(st);
    const sv_frame frame = stage_frame(st, NULL, 0), frame_before = frame;
    sv_result result = stage_result(st);
    const sv_result result_before = result;
    stage_poison(st, STAGE_POISON);
    v_where(run, "begin");
    sv_status status = p->begin(p, &frame);
    V_EXPECT(run, memcmp(&frame, &frame_before, sizeof frame) == 0, "begin writes into sv_frame");
    expect_inputs(st, before);
    for (uint32_t n = 0; n < st->slab_count && status >= 0; n++) {
        const sv_slab slab = stage_slab(st, n), slab_before = slab;
        v_where(run, "slab %u", n);
        status = p->slab(p, &slab);
        V_EXPECT(run, memcmp(&slab, &slab_before, sizeof slab) == 0, "slab writes into sv_slab");
        expect_inputs(st, before);
    }
    v_where(run, "end");
    if (status >= 0) status = p->end(p, &result);
    V_EXPECT(run, status >= 0, "%s: %s: %s", run->report->where, v_status(status), p->last_error(p));
    V_EXPECT(run, memcmp(&result, &result_before, sizeof result) == 0, "end writes into sv_result");
    expect_inputs(st, before);
    if (!(r->s.descriptor->features & SV_FEATURE_ADJUST)) return;
    status = v_adjust(p, st, NULL, 0);
    V_EXPECT(run, status >= 0, "adjust: %s: %s", v_status(status), p->last_error(p));
    expect_inputs(st, before);
}

static bool offers(const v_rig *r, const stage_way *way) {
    const sv_descriptor *d = r->s.descriptor;
    return (d->carriers & SV_BIT(way->carrier)) &&
           (d->queues & (way->own_queue ? SV_QUEUE_OWN : SV_QUEUE_HOST));
}

/* False if the device has no images that slabs could be. */
static bool can_make(v_rig *r, const stage_way *way) {
    if (way->carrier != SV_CARRIER_IMAGE) return true;
    if (!r->device.context) v_device_open(r->s.run, &r->device);
    return stage_has_images(&r->device);
}

/* In memory, registered or not, on either queue, and in every kind of object that the plugin takes: its queue
 * can write there. */
void check_inputs_unchanged(v_run *run) {
    static const uint32_t carriers[] = {SV_CARRIER_HOST, SV_CARRIER_HOST, SV_CARRIER_HOST, SV_CARRIER_BUFFER,
                                        SV_CARRIER_IMAGE};
    v_rig *r = v_rig_standard(run);
    for (size_t n = 0; n < sizeof carriers / sizeof *carriers; n++) {
        stage_way way = v_standard_way(&r->s);
        way.carrier = carriers[n];
        way.registered = n == 1;
        way.own_queue = way.own_queue || n == 2;
        way.ranges_in_buffer = way.ranges && way.carrier != SV_CARRIER_HOST;
        if (!offers(r, &way) || (way.own_queue && way.carrier != SV_CARRIER_HOST)) continue;
        if (!can_make(r, &way)) continue;
        v_rig_again(r, &way);
        inputs_stay(r);
    }
}

/* A frame of the volume handed over in another way gives the same map. */
static void same_map(v_rig *r, const stage_way *way, const v_map *wanted, const char *what) {
    v_rig_again(r, way);
    v_rig_expect(r, wanted, "%s", what);
}

void check_reads_within_slab(v_run *run) {
    v_rig *r = v_rig_good(run);
    stage_way way = v_standard_way(&r->s);
    way.exact = true;
    same_map(r, &way, &r->good, "slabs that end where their bytes do give another map");
}

void check_padding_ignored(v_run *run) {
    static const uint8_t hatches[] = {255, 128, 7};
    v_rig *r = v_rig_good(run);
    for (size_t i = 0; i < sizeof hatches / sizeof *hatches; i++) {
        stage_way way = v_standard_way(&r->s);
        way.hatch = hatches[i];
        same_map(r, &way, &r->good, "bytes that belong to no slice show in the map");
    }
}

/* ---- what was scanned */
static void refuse_ranges(v_rig *r) {
    stage_way way = v_standard_way(&r->s);
    const sv_plugin *p = r->s.plugin;
    v_rig_set(r, &way, V_LAYERS);
    v_deactivate(&r->s, p);
    sv_format format = r->stage.format;
    format.flags = SV_FORMAT_SCANNED;
    v_where(r->s.run, "activate with SV_FORMAT_SCANNED");
    const sv_status status = p->activate(p, &format);
    V_EXPECT(r->s.run, status < 0,
             "activate takes SV_FORMAT_SCANNED, and the descriptor has no SV_FEATURE_SCANNED");
    v_activate(&r->s, p, &r->stage);
}

/* The frame of the rig's volume and ranges as they are now. */
static v_map frame_now(v_rig *r) {
    v_stage_fill(&r->stage, &r->volume);
    return v_rig_frame(r, NULL, 0);
}

static void outside_does_not_count(v_rig *r) {
    static const int values[] = {255, 128, -1};
    v_volume_narrow(&r->volume);
    v_volume_outside(r->s.run, &r->volume, 0);
    const v_map first = frame_now(r);
    for (size_t i = 0; i < sizeof values / sizeof *values; i++) {
        v_volume_outside(r->s.run, &r->volume, values[i]);
        const v_map map = frame_now(r);
        v_map_expect(r->s.run, &first, &map, "voxels outside of the scanned ranges show in the map");
    }
}

void check_scanned_ranges(v_run *run) {
    v_rig *r = v_rig_open(run);
    if (!(r->s.descriptor->features & SV_FEATURE_SCANNED)) {
        refuse_ranges(r);
        v_skip(run, "the descriptor has no SV_FEATURE_SCANNED; activate refuses ranges");
    }
    stage_way way = v_standard_way(&r->s);
    v_rig_set(r, &way, V_LAYERS);
    const uint32_t rays = way.width * way.height;
    const v_map whole = frame_now(r);
    for (uint32_t i = 0; i < rays; i++) r->volume.ranges[i].end = UINT16_MAX;
    v_map map = frame_now(r);
    v_map_expect(run, &whole, &map, "ranges that end beyond the volume are not cut off");
    outside_does_not_count(r);
    for (uint32_t i = 0; i < rays; i++) r->volume.ranges[i] = (sv_scanned){20, 10};
    map = frame_now(r);
    for (uint32_t i = 0; i < rays; i++)
        V_EXPECT(run, map.outcome == SV_NO_SURFACE || map.depth[i] == map.depth[i],
                 "nothing was scanned, and a depth is NaN");
}

void check_padding_value(v_run *run) {
    enum { VALUE = 3 }; /* darker than anything in the layered volume */
    v_rig *r = v_rig_open(run);
    stage_way way = v_standard_way(&r->s);
    const uint32_t features = r->s.descriptor->features;
    const bool heeds = (features & SV_FEATURE_PADDING) != 0, ranges = (features & SV_FEATURE_SCANNED) != 0;
    v_rig_set(r, &way, V_LAYERS);
    v_volume_narrow(&r->volume);
    v_volume_outside(run, &r->volume, VALUE);
    const v_map known = frame_now(r); /* by ranges, if the plugin takes them */
    way.padding = VALUE;
    way.ranges = false;
    if (!heeds || ranges) {
        same_map(r, &way, &known,
                 heeds ? "padding_value and the same ranges give different maps"
                       : "padding_value counts, and the descriptor has no SV_FEATURE_PADDING");
    } else {
        v_rig_again(r, &way);
        (void)frame_now(r);
        v_note(run, "the plugin takes no ranges to compare padding_value with");
    }
}

/* ---- the probe */
#define STRAIGHT .probe_rotation = {1, 0, 0, 0, 1, 0, 0, 0, 1}, .probe_side = {0, 0, -1}

/* A frame that says this of the probe and its beams; NULL: nothing. */
static v_map probe_frame(v_rig *r, const sv_frame *told) {
    r->stage.told = told ? *told : (sv_frame){0};
    r->stage.frame_flags = told ? told->flags : SV_FRAME_DISCONTINUITY;
    return v_rig_frame(r, NULL, 0);
}

/* The frames of hosts of 1.0 end before the fields. */
static void old_frame_says_nothing(v_rig *r, const v_map *plain) {
    sv_frame nothing = {.flags = SV_FRAME_DISCONTINUITY};
    memset(nothing.probe_rotation, 0xff, sizeof nothing - offsetof(sv_frame, probe_rotation));
    r->stage.frame_size = SV_FRAME_SIZE_1_0;
    const v_map map = probe_frame(r, &nothing);
    r->stage.frame_size = 0;
    v_map_expect(r->s.run, plain, &map, "what lies behind the sv_frame of a host of 1.0 counts");
}

static void probe_is_refused(v_rig *r, const sv_frame *told) {
    r->stage.told = *told;
    r->stage.frame_flags = told->flags;
    const sv_status status = v_begin(r->s.plugin, &r->stage, NULL, 0);
    V_EXPECT(
        r->s.run, status == SV_ERR_ARGUMENT,
        "begin with probe_rotation %g %g %g, ..., probe_side %g %g %g, beams %u, beam_sweep_mm %g, flags "
        "0x%x: %s, expected SV_ERR_ARGUMENT",
        (double)told->probe_rotation[0], (double)told->probe_rotation[1], (double)told->probe_rotation[2],
        (double)told->probe_side[0], (double)told->probe_side[1], (double)told->probe_side[2], told->beams,
        (double)told->beam_sweep_mm, told->flags, v_status(status));
}

void check_probe(v_run *run) {
    static const sv_frame holds[] = {
        {.probe_side = {0, -1, 0}},
        {STRAIGHT},
        {.probe_rotation = {0, 0, -1, 0, 1, 0, 1, 0, 0}, .probe_side = {1, 0, 0}},
        {STRAIGHT, .beams = SV_BEAMS_PARALLEL},
        {STRAIGHT, .beams = SV_BEAMS_FAN, .beam_apex_mm = {9, 9, -40}, .beam_sweep_mm = 23},
        {STRAIGHT, .beams = SV_BEAMS_FAN, .beam_apex_mm = {9, 9, -40}, .beam_sweep_mm = -100000}};
    static const sv_frame breaks[] = {
        {.probe_rotation = {0, 0, 1, 0, 1, 0, -1, 0, 0}, .probe_side = {1, 0, 0}}, /* transposed */
        {.probe_rotation = {1, 0, 0, 0, 1, 0, 0, 0, 1}},
        {.probe_rotation = {1, 0, 0, 0, 1, 0, 0, 0, -1}, .probe_side = {0, 0, 1}},
        {.probe_rotation = {NAN, 0, 0, 0, 1, 0, 0, 0, 1}, .probe_side = {0, 0, -1}},
        {.probe_side = {0, 2, 0}},
        {.beams = SV_BEAMS_PARALLEL},
        {STRAIGHT, .beams = SV_BEAMS_FAN + 1},
        {STRAIGHT, .beams = SV_BEAMS_PARALLEL, .reserved_beams = 1},
        {STRAIGHT, .beams = SV_BEAMS_FAN, .beam_apex_mm = {0, NAN, 0}},
        {STRAIGHT, .beams = SV_BEAMS_FAN, .beam_sweep_mm = INFINITY}};
    v_rig *r = v_rig_standard(run);
    const bool heeds = (r->s.descriptor->features & SV_FEATURE_PROBE) != 0;
    const v_map plain = probe_frame(r, NULL);
    old_frame_says_nothing(r, &plain);
    for (size_t n = 0; n < sizeof holds / sizeof *holds; n++) {
        sv_frame told = holds[n];
        told.flags = SV_FRAME_DISCONTINUITY;
        const v_map map = probe_frame(r, &told);
        if (!heeds)
            v_map_expect(run, &plain, &map, "the probe shows, and the descriptor has no SV_FEATURE_PROBE");
    }
    for (size_t n = 0; heeds && n < sizeof breaks / sizeof *breaks; n++) probe_is_refused(r, &breaks[n]);
    sv_frame same = {.flags = SV_FRAME_SAME_VOLUME};
    if (heeds) {
        (void)probe_frame(r, &same);
        same.flags |= SV_FRAME_DISCONTINUITY;
    }
    probe_is_refused(r, &same); /* both flags, or one that the plugin does not know */
    const v_map map = probe_frame(r, NULL);
    v_map_expect(run, &plain, &map,
                 "where an earlier frame's probe was shows in a frame that does not say it");
}

/* ---- carriers and queues */
/* What the descriptor does not offer, activate refuses. */
static void refuse_way(v_rig *r, const stage_way *way, const char *what) {
    stage st;
    if (!way->own_queue && !r->device.context) v_device_open(r->s.run, &r->device);
    v_stage_make(r->s.run, &st, way, &r->device);
    v_where(r->s.run, "activate with %s", what);
    const sv_status status = r->s.plugin->activate(r->s.plugin, &st.format);
    V_EXPECT(r->s.run, status < 0, "activate takes %s, which the descriptor does not offer", what);
    stage_free(&st);
}

void check_carriers(v_run *run) {
    static const char *const names[] = {"", "host memory", "buffers", "images"};
    v_map maps[2] = {{0}}; /* of the host's queue, and of the plugin's own */
    uint32_t ways = 0;
    bool images = true;
    v_rig *r = v_rig_open(run);
    for (uint32_t n = 0; n < 12; n++) {
        stage_way way = v_standard_way(&r->s);
        char what[120];
        way.carrier = 1 + n / 2 % 3;
        way.own_queue = n % 2 == 1;
        if (way.own_queue && way.carrier != SV_CARRIER_HOST) continue;
        if (!can_make(r, &way)) {
            images = false;
            continue;
        }
        const bool variant = n >= 6; /* results, ranges and registration in other ways */
        way.registered = variant && way.carrier == SV_CARRIER_HOST;
        way.depth_object = variant && !way.own_queue;
        way.ranges_in_buffer = variant && !way.own_queue && way.ranges;
        (void)snprintf(what, sizeof what, "%s on %s queue%s", names[way.carrier],
                       way.own_queue ? "the plugin's own" : "the host's",
                       !variant        ? ""
                       : way.own_queue ? ", registered"
                                       : ", map and ranges in buffers");
        if (!offers(r, &way)) {
            if (!variant && !way.own_queue) refuse_way(r, &way, what);
            continue;
        }
        v_map *first = &maps[way.own_queue];
        run->random = 1; /* the same volume every time */
        v_rig_set(r, &way, V_LAYERS);
        const v_map map = v_rig_frame(r, NULL, 0);
        if (first->depth)
            v_map_expect(run, first, &map, "%s give another map", what);
        else
            *first = map;
        ways++;
    }
    v_note(run, "%u ways to hand a volume over%s", ways,
           images ? "" : "; none in images, since the device has none of one channel");
}

/* A call that was handed an object of another context. */
static void refused_foreign(v_rig *r, const char *what, sv_status status, sv_status expected) {
    V_EXPECT(r->s.run, status == expected, "%s of another context: %s, expected %s", what, v_status(status),
             v_status(expected));
}

void check_foreign_objects(v_run *run) {
    stage_device other;
    stage foreign;
    v_rig *r = v_rig_open(run);
    stage_way way = v_standard_way(&r->s);
    if (way.own_queue) v_skip(run, "the plugin takes no objects: it works on a queue of its own");
    if (r->s.descriptor->carriers & SV_BIT(SV_CARRIER_BUFFER)) way.carrier = SV_CARRIER_BUFFER;
    way.depth_object = true;
    way.ranges_in_buffer = way.ranges;
    v_rig_set(r, &way, V_LAYERS);
    v_device_open(run, &other);
    v_stage_make(run, &foreign, &way, &other);
    const sv_plugin *p = r->s.plugin;
    sv_frame frame = stage_frame(&r->stage, NULL, 0);
    sv_slab slab = stage_slab(&r->stage, 0);
    sv_result result = stage_result(&r->stage);
    stage_poison(&r->stage, STAGE_POISON); /* the statistics get their size */
    frame.scanned_object = foreign.ranges_object;
    slab.object = foreign.objects[0];
    result.depth_object = foreign.depth_object;
    if (way.ranges) refused_foreign(r, "scanned_object", p->begin(p, &frame), SV_ERR_ARGUMENT);
    if (slab.object) {
        (void)v_begin(p, &r->stage, NULL, 0);
        refused_foreign(r, "a slab's object", p->slab(p, &slab), SV_ERR_SLAB_SHAPE);
    }
    (void)v_feed(p, &r->stage, NULL, 0);
    refused_foreign(r, "depth_object", p->end(p, &result), SV_ERR_ARGUMENT);
    (void)clFinish(r->device.queue);
    (void)v_rig_frame(r, NULL, 0);
    stage_free(&foreign);
    v_device_close(&other);
}
