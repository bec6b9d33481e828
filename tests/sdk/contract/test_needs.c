/* SPDX-License-Identifier: MIT */
/*
 * smartvis.needs/1 tells what activate really takes and what a frame really enqueues: buffers, heap and
 * commands as the spies count them, over methods, layouts, sizes, carriers and settings; and it asks OpenCL
 * nothing. A format that the device has no room for is refused before anything is made.
 * Requirement: R8.
 */
#include "smartvis/lookup.h"
#include "smartvis/needs.h"
#include "smartvis/timing.h"
#include "support/plain_format.h"
#include "support/rig.h"
#include "validate/spy/cl_spy.h"
#include "validate/spy/heap_spy.h"

static const sv_ext_needs *needs_of(const rig *r) {
    const sv_ext_needs *needs = r->plugin->get_extension(r->plugin, SV_EXT_NEEDS);
    assert_non_null(needs);
    return needs;
}

/* The answer; no call of OpenCL and no allocation is made for it. The format's objects are left out. */
static sv_needs ask(const rig *r, const sv_format *format, const sv_param_value *values, uint32_t count) {
    const sv_needs_device device = stage_facts(r->device);
    sv_format planned = *format;
    sv_needs needs = {.size = sizeof needs};
    planned.context = NULL;
    planned.device = NULL;
    planned.queue = NULL;
    spy_reset();
    heap_spy_reset();
    const sv_status status = needs_of(r)->of(r->plugin, &planned, values, count, &device, &needs);
    if (status != SV_OK) fail_msg("needs: %d: %s", (int)status, r->plugin->last_error(r->plugin));
    for (int kind = 0; kind < SPY_KINDS; kind++) assert_int_equal(spy_count((spy_kind)kind), 0);
    assert_int_equal(heap_spy_count(), 0);
    return needs;
}

static void same(const char *what, const char *of, uint64_t told, uint64_t seen) {
    if (told != seen)
        fail_msg("%s: %s: %llu told, %llu seen", of, what, (unsigned long long)told,
                 (unsigned long long)seen);
}

/* One setting: keys and names or numbers, "" for none. */
typedef struct {
    const char *method, *strategy;
    uint32_t width, height, slices, slab_slices, carrier;
    bool in_place, own_queue, ranged, timed;
    struct {
        const char *key;
        double value;
        bool fixed;
    } with[3];
} setting;

/* With a byte less than it needs, of memory or in its largest buffer, activate refuses before it makes
 * anything, and says what it lacks; with so much, both hold. */
static void refused_below(rig *r, const sv_format *format, uint64_t memory, uint64_t largest,
                          const char *text) {
    spy_device_memory(memory, largest);
    assert_int_equal(r->plugin->activate(r->plugin, format), SV_ERR_FORMAT);
    if (!strstr(r->plugin->last_error(r->plugin), text)) fail_msg("%s", r->plugin->last_error(r->plugin));
    assert_int_equal(spy_live_bytes(), 0);
}

static void holds(rig *r, const setting *s) {
    static const sv_scanned ranges[256 * 256];
    char name[160];
    sv_param_value frame_values[4];
    uint32_t count = 0, fixed = 2;
    rig_format how = {.width = s->width,
                      .height = s->height,
                      .slices = s->slices,
                      .slab_slices = s->slab_slices,
                      .carrier = s->carrier,
                      .in_place = s->in_place,
                      .own_queue = s->own_queue,
                      .padding = SV_NO_PADDING,
                      .scanned = s->ranged ? ranges : NULL};
    how.fixed[0] = (sv_param_value){rig_param(r, "method"), 0, rig_enum(r, "method", s->method)};
    how.fixed[1] = (sv_param_value){rig_param(r, "strategy"), 0, rig_enum(r, "strategy", s->strategy)};
    for (size_t i = 0; i < 3 && s->with[i].key; i++) {
        const sv_param_value v = {rig_param(r, s->with[i].key), 0, s->with[i].value};
        if (s->with[i].fixed)
            how.fixed[fixed++] = v;
        else
            frame_values[count++] = v;
    }
    (void)snprintf(name, sizeof name, "%s, %s, %u x %u x %u in slabs of %u", s->method, s->strategy, s->width,
                   s->height, s->slices, s->slab_slices);
    uint8_t *volume = unit_memory((size_t)s->width * s->height * s->slices);
    stage *t = rig_stage(r, &how, volume);
    rig_result out = rig_result_make(s->width, s->height);
    const sv_plugin *p = r->plugin;
    const sv_needs told = ask(r, &t->format, frame_values, count);
    char text[80];
    refused_below(r, &t->format, told.device_bytes - 1, 0, " bytes on the device, which has ");
    refused_below(r, &t->format, 0, told.largest_buffer - 1, " bytes, the device allows ");
    spy_device_memory(told.device_bytes, told.largest_buffer);
    r->all_logs[0] = '\0';
    assert_int_equal(p->activate(p, &t->format), SV_OK);
    spy_device_memory(0, 0);
    (void)snprintf(text, sizeof text, " needs %llu bytes on the device, the largest",
                   (unsigned long long)told.device_bytes);
    if (!strstr(r->all_logs, text)) fail_msg("'%s' in %s", text, r->all_logs);
    same("bytes of buffers", name, told.device_bytes, spy_live_bytes());
    assert_true(told.largest_buffer > 0 && told.largest_buffer <= told.device_bytes);
    if (heap_spy_works()) {
        const uint64_t seen = heap_spy_bytes(), slack = 32u * heap_spy_live();
        if (seen < told.host_bytes || seen > told.host_bytes + slack)
            same("bytes of heap memory", name, told.host_bytes, seen);
    }
    const sv_needs active = ask(r, &t->format, frame_values, count);
    assert_memory_equal(&active, &told, sizeof told);
    const sv_ext_timing *timing = p->get_extension(p, SV_EXT_TIMING);
    if (s->timed) assert_int_equal(timing->enable(p, 1), SV_OK);
    const int32_t before = spy_live();
    spy_reset();
    sv_frame frame = stage_frame(t, frame_values, count);
    assert_int_equal(p->begin(p, &frame), SV_OK);
    for (uint32_t n = 0; n < t->slab_count; n++) {
        const sv_slab slab = stage_slab(t, n);
        assert_int_equal(p->slab(p, &slab), SV_OK);
    }
    const sv_result result = {
        .size = sizeof result, .depth = out.depth, .status = out.status, .stats = &out.stats};
    assert_true(p->end(p, &result) >= SV_OK);
    same("commands of a frame", name, told.commands, spy_count(SPY_ENQUEUE));
    if (s->timed) same("events of a timed frame", name, told.commands, (uint64_t)(spy_live() - before));
    spy_reset();
    assert_true(p->adjust(p, NULL, 0, &result) >= SV_OK);
    same("commands of an adjust", name, told.adjust_commands, spy_count(SPY_ENQUEUE));
    assert_int_equal(clFinish(r->queue), CL_SUCCESS);
    p->deactivate(p);
    assert_int_equal(spy_live(), 0);
}

static void told_is_taken(void **state) {
    rig *r = *state;
    static const setting settings[] = {
        {"wall", "single", 21, 18, 14, 6, .ranged = true},
        {"wall", "rays", 37, 50, 41, 9, .carrier = SV_CARRIER_BUFFER},
        {"wall", "auto", 128, 128, 128, 16, SV_CARRIER_BUFFER, .ranged = true, .timed = true},
        {"wall", "bands", 64, 33, 20, 1, SV_CARRIER_IMAGE, .with = {{"unsure", 1, false}}},
        {"wall", "auto", 1, 1, 1, 1, .own_queue = true},
        {"mean", "single", 21, 18, 14, 6, .in_place = true},
        {"mean", "auto", 220, 210, 24, 8, .carrier = SV_CARRIER_BUFFER},
        {"mean", "rays", 90, 70, 40, 1, .timed = true, .with = {{"kernel", 3, false}}},
        {"mean", "bands", 90, 250, 24, 5, SV_CARRIER_IMAGE, .ranged = true, .with = {{"kernel", 63, false}}},
        {"mean", "rays", 64, 64, 32, 8, .with = {{"substeps", 4, true}}},
        {"mean", "auto", 100, 60, 16, 16, .with = {{"kernel", 3, false}}, .own_queue = true},
        {"mean", "bands", 64, 64, 32, 1, SV_CARRIER_BUFFER, .timed = true,
         .with = {{"prefilter", 1, true}, {"prefilter_passes", 16, false}, {"kernel", 3, false}}},
        {"minimum", "auto", 50, 40, 20, 7, .carrier = SV_CARRIER_HOST},
        {"minimum", "rays", 130, 20, 20, 20, .timed = true, .with = {{"kernel", 3, false}}},
        {"spline", "auto", 40, 60, 24, 6, .carrier = SV_CARRIER_IMAGE},
        {"spline", "rays", 40, 60, 24, 24, .with = {{"precision", 1, true}, {"merge_grid", 7, true}}},
        {"spline", "single", 33, 65, 24, 1, .timed = true,
         .with = {{"spline_grid", 16, true}, {"prefilter", 1, true}, {"prefilter_passes", 16, false}}},
        {"wall", "auto", 77, 66, 55, 11, .in_place = true},
        {"wall", "rays", 77, 66, 55, 1, SV_CARRIER_IMAGE, .ranged = true, .timed = true},
    };
    spy_watch(r->entry);
    heap_spy_watch(r->entry);
    for (size_t i = 0; i < sizeof settings / sizeof *settings; i++) holds(r, &settings[i]);
}

static void also(setting *s, const sv_param_info *p, double value) {
    uint32_t n = 0;
    while (s->with[n].key) n++;
    s->with[n].key = p->key;
    s->with[n].value = value;
    s->with[n].fixed = (p->flags & SV_PARAM_REACTIVATE) != 0;
}

/* Every parameter of the plugin's list, at its ends, with the first method that it matters to. */
static void every_parameter_is_counted(void **state) {
    rig *r = *state;
    sv_param_info p, on, method;
    char name[32];
    spy_watch(r->entry);
    heap_spy_watch(r->entry);
    assert_true(sv_lookup_key(r->plugin, "method", &method));
    for (uint32_t i = 0; sv_lookup_index(r->plugin, i, &p); i++) {
        setting s = {
            .method = name, .strategy = "auto", .width = 21, .height = 18, .slices = 14, .slab_slices = 6};
        sv_param_value with[RIG_MAX_ENABLE];
        int count = -1;
        if (strcmp(p.key, "method") == 0 || strcmp(p.key, "strategy") == 0) continue; /* in every setting */
        for (double m = method.min_value; count < 0; m++) {
            assert_true(m <= method.max_value);
            if (r->plugin->param_text(r->plugin, method.id, m, name, sizeof name) == SV_OK)
                count = rig_enable(r, &p, m, with);
        }
        for (int n = 0; n < count; n++) {
            assert_true(sv_lookup_id(r->plugin, with[n].id, &on));
            also(&s, &on, with[n].value);
        }
        for (int high = 0; high < 2; high++) {
            setting end = s;
            also(&end, &p, high ? p.max_value : p.min_value);
            holds(r, &end);
        }
    }
}

/* Another device takes something else, and the number of its units counts where work is by bands. */
static void the_device_counts(void **state) {
    rig *r = *state;
    const sv_param_value mean = {rig_param(r, "method"), 0, rig_enum(r, "method", "mean")};
    sv_format format = plain_format(300, 300, 64, 4);
    format.max_slab_slices = 16;
    format.carrier = SV_CARRIER_BUFFER;
    format.values = &mean;
    format.value_count = 1;
    const uint32_t cpu = SV_NEEDS_CPU | SV_NEEDS_UNIFIED | SV_NEEDS_DOUBLES;
    const sv_needs_device devices[] = {{sizeof *devices, cpu, 2, 0},
                                       {sizeof *devices, cpu, 64, 0},
                                       {sizeof *devices, SV_NEEDS_DOUBLES, 64, 0}};
    sv_needs needs[3];
    for (int i = 0; i < 3; i++) {
        needs[i].size = sizeof *needs;
        assert_int_equal(needs_of(r)->of(r->plugin, &format, NULL, 0, &devices[i], &needs[i]), SV_OK);
    }
    assert_true(needs[0].device_bytes < needs[1].device_bytes); /* more bands */
    assert_int_equal(needs[0].commands, needs[1].commands);
    assert_true(needs[2].commands > needs[1].commands); /* two launches a pass */
    /* A parameter of the frame counts, too. */
    const sv_param_value k = {rig_param(r, "kernel"), 0, 3};
    assert_int_equal(needs_of(r)->of(r->plugin, &format, &k, 1, &devices[0], &needs[1]), SV_OK);
    assert_true(needs[1].commands > needs[0].commands);
}

/* The largest that the header allows, in one slab: more than any device has, for real. */
static void the_largest_format(void **state) {
    enum { SIDE = 8192 };
    rig *r = *state;
    sv_format format = plain_format(SIDE, SIDE, SIDE, 1);
    format.context = r->context;
    format.device = r->device;
    format.queue = r->queue;
    spy_watch(r->entry);
    heap_spy_watch(r->entry);
    assert_true(ask(r, &format, NULL, 0).device_bytes > (uint64_t)SIDE * SIDE * SIDE);
    spy_reset();
    assert_int_equal(r->plugin->activate(r->plugin, &format), SV_ERR_FORMAT);
    assert_non_null(strstr(r->last_log, "activate: a format of 8192 x 8192 x 8192 needs "));
    assert_int_equal(spy_count(SPY_CREATE) + spy_count(SPY_ENQUEUE) + spy_count(SPY_BUILD), 0);
}

/* In words; every other way to get it wrong is test_layer_careless's. */
static void what_cannot_be_is_refused(void **state) {
    rig *r = *state;
    const sv_plugin *p = r->plugin;
    const sv_ext_needs *ext = needs_of(r);
    sv_format format = plain_format(8, 8, 8, 4);
    format.carrier = SV_CARRIER_IMAGE;
    format.row_pitch = 0;
    sv_needs_device device = {sizeof device, SV_NEEDS_CPU, 1, 0};
    sv_needs needs = {.size = sizeof needs};
    const sv_param_value unknown = {.id = 999}, fixed = {rig_param(r, "method"), 0, 0};
    assert_int_equal(ext->of(p, &format, NULL, 0, &device, &needs), SV_OK);
    assert_string_equal(p->last_error(p), "");
    assert_int_equal(ext->of(p, &format, NULL, 0, NULL, &needs), SV_ERR_ARGUMENT);
    assert_string_equal(p->last_error(p), "needs: device is NULL");
    assert_int_equal(ext->of(p, &format, &unknown, 1, &device, &needs), SV_ERR_PARAM_ID);
    assert_int_equal(ext->of(p, &format, &fixed, 1, &device, &needs), SV_ERR_PARAM_FIXED);
    device.flags = device.compute_units = 0;
    assert_int_equal(ext->of(p, &format, NULL, 0, &device, &needs), SV_ERR_ARGUMENT);
    assert_string_equal(p->last_error(p),
                        "needs: flags is 0x0, known are 0x7; compute_units is 0, expected 1 or more");
    device.compute_units = 1;
    format.tile_w = 7;
    assert_int_equal(ext->of(p, &format, NULL, 0, &device, &needs), SV_ERR_FORMAT);
}

UNIT_MAIN_OF(NULL, NULL, RIG_TEST(told_is_taken), RIG_TEST(every_parameter_is_counted),
             RIG_TEST(the_device_counts), RIG_TEST(the_largest_format), RIG_TEST(what_cannot_be_is_refused))
