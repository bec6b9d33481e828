/* SPDX-License-Identifier: MIT */
/*
 * The checking layer names what breaks a rule: every rule that it sees is broken once, by a plugin of
 * tests/sdk/wrong/ or by the host that this test plays.
 */
#include "rules/rules.h"
#include "smartvis/confidence.h"
#include "support/layer_fixture.h"
#include "support/unit.h"

#include <math.h>
#include <pthread.h>

/* ---- what a host does that is wrong */
static void unknown_id(layer_subject *s) {
    const sv_plugin *other = NULL;
    (void)s->entry->create(&s->host, "org.smartvis.test.nobody", &other);
    if (other) other->destroy(other);
}
static void early_slab(layer_subject *s) {
    (void)layer_activate(s);
    (void)layer_slab(s, 0);
}
static void active_destroy(layer_subject *s) {
    (void)layer_activate(s);
    s->p->destroy(s->p);
    s->p = NULL;
}
static void second_call(void *context) {
    layer_subject *s = context;
    assert_int_equal(s->p->adjust(s->p, NULL, 0, NULL), SV_ERR_STATE);
}
static void call_in_call(layer_subject *s) {
    assert_int_equal(layer_activate(s), SV_OK);
    s->on_log = second_call; /* the plugin tells of the flags, and the host answers with another call */
    s->frame.flags = 0x80;
    (void)layer_begin(s);
}
/* A frame of this thread, which another one ends. */
static void *end_elsewhere(void *context) {
    assert_int_equal(layer_end(context), SV_ERR_STATE);
    return NULL;
}
static void anothers_frame(layer_subject *s) {
    pthread_t other;
    call_in_call(s);
    s->frame.flags = 0;
    assert_int_equal(layer_begin(s), SV_OK);
    for (uint32_t n = 0; n < SLABS; n++) assert_int_equal(layer_slab(s, n), SV_OK);
    assert_int_equal(pthread_create(&other, NULL, end_elsewhere, s), 0);
    assert_int_equal(pthread_join(other, NULL), 0);
    assert_true(layer_end(s) >= SV_OK);
}
static void short_slab(layer_subject *s) {
    layer_start(s, 0);
    sv_slab slab = layer_slab_of(s, 0);
    slab.size = 8;
    (void)s->p->slab(s->p, &slab);
}
static void short_frame(layer_subject *s) {
    (void)layer_activate(s);
    s->frame.size = 8;
    (void)layer_begin(s);
}
static void reserved_field(layer_subject *s) {
    layer_start(s, 0);
    sv_slab slab = layer_slab_of(s, 0);
    slab.reserved = 3;
    (void)s->p->slab(s->p, &slab);
}
static void narrow_tiles(layer_subject *s) {
    s->format.tile_w = W - 1;
    (void)layer_activate(s);
}
static void begin_with(layer_subject *s, uint32_t id, double value) {
    const sv_param_value list = {.id = id, .value = value};
    (void)layer_activate(s);
    s->frame.values = &list;
    s->frame.value_count = 1;
    (void)layer_begin(s);
}
static void value_of_nan(layer_subject *s) {
    begin_with(s, 2, (double)NAN);
}
static void fixed_value(layer_subject *s) {
    begin_with(s, 4, 1.0);
}
static void unknown_flags(layer_subject *s) {
    (void)layer_activate(s);
    s->frame.flags = 0x80;
    (void)layer_begin(s);
}
static void good_after_bad(layer_subject *s) {
    unknown_flags(s);
    s->frame.flags = 0;
    (void)layer_begin(s);
}
static void probe_of_no_rotation(layer_subject *s) {
    s->frame.probe_rotation[0] = 2.0f;
    (void)layer_activate(s);
    (void)layer_begin(s);
}
static void missing_values(layer_subject *s) {
    (void)layer_activate(s);
    s->frame.value_count = 3;
    (void)layer_begin(s);
}
static void clock_runs_back(layer_subject *s) {
    layer_start(s, SLABS);
    (void)layer_end(s);
    s->frame.time_ns = 50;
    (void)layer_begin(s);
}
static void slab_left_out(layer_subject *s) {
    layer_start(s, 1);
    (void)layer_slab(s, 2);
}
static void two_maps(layer_subject *s) {
    layer_start(s, SLABS);
    sv_result result = layer_result_of(s);
    result.depth = s->depth;
    result.depth_object = (void *)s;
    (void)s->p->end(s->p, &result);
}
static void small_map(layer_subject *s) {
    layer_start(s, SLABS);
    sv_result result = layer_result_of(s);
    result.depth_offset = 4;
    (void)s->p->end(s->p, &result);
}
static void foreign_ranges(layer_subject *s) {
    hs_cl other;
    must(hs_cl_open_bare(&other, &err));
    cl_mem ranges = clCreateBuffer(other.context, CL_MEM_READ_WRITE, sizeof s->ranges, NULL, NULL);
    s->frame.scanned = NULL;
    s->frame.scanned_object = ranges;
    (void)layer_activate(s);
    (void)layer_begin(s);
    s->p->deactivate(s->p);
    (void)clReleaseMemObject(ranges);
    hs_cl_close(&other);
}
static void object_released(layer_subject *s) {
    layer_start(s, SLABS);
    (void)clReleaseMemObject(s->objects[1]);
    s->objects[1] = NULL;
    (void)clFinish(s->cl.queue); /* commands hold their objects */
    (void)layer_end(s);
    s->p->deactivate(s->p);
}
static void voxels_change(layer_subject *s) {
    layer_start(s, SLABS);
    memset(s->volume[3], 99, sizeof s->volume[3]);
    (void)layer_end(s);
}
static void ranges_change(layer_subject *s) {
    layer_start(s, SLABS);
    for (int i = 0; i < RAYS; i++) s->ranges[i].first = 2;
    (void)layer_end(s);
}
static void object_changes(layer_subject *s) {
    const cl_uchar white = 255;
    layer_start(s, SLABS);
    (void)clEnqueueFillBuffer(s->cl.queue, s->objects[2], &white, 1, 0, SLAB * RAYS, 0, NULL, NULL);
    (void)layer_end(s);
    s->p->deactivate(s->p);
}
/* Behind end, while the queue has not run. */
static void memory_changes_late(layer_subject *s) {
    cl_event gate = clCreateUserEvent(s->cl.context, NULL);
    s->format.carrier = SV_CARRIER_HOST;
    (void)layer_activate(s);
    (void)clEnqueueBarrierWithWaitList(s->cl.queue, 1, &gate, NULL);
    (void)layer_begin(s);
    for (uint32_t n = 0; n < SLABS; n++) (void)layer_slab(s, n);
    const sv_result result = layer_result_of(s);
    (void)s->p->end(s->p, &result);
    memset(s->volume, 99, sizeof s->volume);
    (void)clSetUserEventStatus(gate, CL_COMPLETE);
    (void)clFinish(s->cl.queue);
    s->p->deactivate(s->p);
    (void)clReleaseEvent(gate);
}
static void nameless_host(layer_subject *s) {
    const sv_plugin *other = NULL;
    s->host.name = NULL;
    (void)s->entry->create(&s->host, s->entry->descriptor(0)->id, &other);
    if (other) other->destroy(other);
}

/* ---- the rules */
#define CPU "wrong/right/results"
#define CL  "wrong/right/opencl"
static const struct {
    rule_name rule;
    const char *plugin;
    void (*act)(layer_subject *s);
    const char *text; /* call, field and value */
} cases[] = {
    {RULE_entry_whole, "wrong/short_entry", layer_use, "entry.size is 16"},
    {RULE_descriptors, "wrong/unknown_feature", layer_use, "features is 0x"},
    {RULE_descriptor_constant, "wrong/descriptor_changes", layer_use, "activate: the descriptor"},
    {RULE_instance_whole, "wrong/null_function", layer_use, "NULL"},
    {RULE_instance_whole, "wrong/no_instance", layer_use, "create: returns SV_OK"},
    {RULE_create_refusals, "wrong/takes_any_id", unknown_id, "org.smartvis.test.nobody"},
    {RULE_create_refusals, "wrong/out_left_behind", unknown_id, "*out is not NULL"},
    {RULE_extensions, "wrong/any_extension", layer_use, SV_EXT_CONFIDENCE},
    {RULE_host_callbacks, "wrong/unknown_severity", layer_use, "log: severity is 9"},
    {RULE_host_callbacks, "wrong/logs_null", layer_use, "log: text is NULL"},
    {RULE_process_untouched, "wrong/changes_rounding", layer_use, "end: leaves the rounding mode"},
    {RULE_process_untouched, "wrong/changes_locale", layer_use, "activate: changes the locale"},
    {RULE_param_ids, "wrong/param_id_zero", layer_use, "the id of parameter"},
    {RULE_param_strings, "wrong/param_label_null", layer_use, "label is NULL"},
    {RULE_param_ranges, "wrong/default_out_of_range", layer_use, "the default is"},
    {RULE_param_dependencies, "wrong/depends_on_itself", layer_use, "depends on itself"},
    {RULE_param_flags, "wrong/two_primaries", layer_use, "2 parameters"},
    {RULE_param_info_calls, "wrong/info_overruns", layer_use, "param_info: writes behind"},
    {RULE_param_text, "wrong/text_overruns", layer_use, "param_text: id is"},
    {RULE_param_text, "wrong/text_without_nul", layer_use, "no NUL"},
    {RULE_param_out_of_range, "wrong/accepts_nan", value_of_nan,
     "begin: returns SV_OK, and SV_ERR_PARAM_RANGE was due"},
    {RULE_param_fixed, "wrong/accepts_fixed", fixed_value,
     "begin: returns SV_OK, and SV_ERR_PARAM_FIXED was due"},
    {RULE_frame_outcome, "wrong/end_77", layer_use, "(77)"},
    {RULE_frame_outcome, "wrong/begin_partial", layer_use, "begin: returns SV_PARTIAL"},
    {RULE_frame_outcome, "wrong/outcomes_differ", layer_use, "the statistics say SV_PARTIAL"},
    {RULE_depth_values, "wrong/depth_1e30", layer_use, "1e+30"},
    {RULE_depth_values, "wrong/last_row_missing", layer_use, "(0, 19) is NaN, or was not written"},
    {RULE_guard_bands, "wrong/writes_past_map", layer_use, "end: surface wrote beyond its 480 rays"},
    {RULE_frame_statistics, "wrong/rays_wrong", layer_use, "stats.rays is 1"},
    {RULE_frame_statistics, "wrong/status_map_garbage", layer_use, "is 9"},
    {RULE_confidence, "wrong/confidence_above", layer_use, "1.001"},
    {RULE_inputs_unchanged, "wrong/writes_into_slab", layer_use, "voxel"},
    {RULE_inputs_unchanged, "wrong/writes_into_ranges", layer_use, "the scanned range"},
    {RULE_probe, "wrong/takes_any_probe", probe_of_no_rotation, "begin: probe_rotation is 2 0 0"},
    {RULE_foreign_objects, "wrong/takes_foreign_objects", foreign_ranges,
     "scanned_object is of another context"},
    {RULE_call_states, "wrong/slab_before_begin", early_slab,
     "slab: returns SV_OK, and SV_ERR_STATE was due"},
    {RULE_slab_refusals, "wrong/takes_any_order", slab_left_out, "first_slice is 16, expected 8"},
    {RULE_format_refusals, "wrong/takes_any_format", narrow_tiles, "tile_w is 23"},
    {RULE_null_arguments, "wrong/takes_missing_values", missing_values, "value_count is 3"},
    {RULE_struct_sizes, "wrong/ignores_sizes", short_frame, "size is 8"},
    {RULE_reasons, "wrong/no_reason", unknown_flags,
     "begin: returns SV_ERR_ARGUMENT, and last_error is empty"},
    {RULE_reasons, "wrong/reason_stays", good_after_bad, "begin: returns SV_OK, and last_error is"},
    {RULE_frame_path_time, "wrong/shared_scratch", layer_use, "end: took"},
    {RULE_host_create, CPU, nameless_host, "create: host.name is NULL"},
    {RULE_host_create, CPU, unknown_id, "create: id is \"org.smartvis.test.nobody\""},
    {RULE_host_states, CPU, early_slab, "slab: the instance is active, and no frame is under way"},
    {RULE_host_states, CPU, active_destroy, "destroy: the instance is active"},
    {RULE_host_threads, CPU, call_in_call, "adjust: comes while another call"},
    {RULE_host_threads, CPU, anothers_frame, "end: calls overlap, and another thread began the frame"},
    {RULE_host_sizes, CPU, short_slab, "size is 8"},
    {RULE_host_reserved, CPU, reserved_field, "slab: reserved is 3"},
    {RULE_host_format, CPU, narrow_tiles, "tile_w is 23"},
    {RULE_host_values, CPU, value_of_nan, "begin: level is nan"},
    {RULE_host_frame, CPU, unknown_flags, "begin: flags is 0x80"},
    {RULE_host_frame, CPU, probe_of_no_rotation, "begin: probe_rotation is 2 0 0"},
    {RULE_host_clock, CPU, clock_runs_back, "begin: time_ns is 50"},
    {RULE_host_slabs, CPU, slab_left_out, "slab: first_slice is 16, expected 8"},
    {RULE_host_result, CPU, two_maps, "end: both"},
    {RULE_host_objects, CL, foreign_ranges, "begin: scanned_object is of another context"},
    {RULE_host_objects, CL, small_map, "end: depth_object has 1920 bytes, and 1920 are needed from 4 on"},
    {RULE_host_objects_kept, CL, object_released, "end: the object of the slab of slice 8"},
    {RULE_host_contents, CPU, voxels_change, "of slice 3 was 120 and is 99"},
    {RULE_host_contents, CPU, ranges_change, "the scanned range of ray (0"},
    {RULE_host_contents, CL, object_changes, "of slice 16 was 200 and is 255"},
    {RULE_host_contents, CL, memory_changes_late, "and is 99"},
};
enum { CASES = sizeof cases / sizeof *cases };

/* The first line of the log that names the rule and has the text (NULL: any). */
static const char *find(const layer_subject *s, rule_name name, const char *text) {
    char words[80];
    (void)snprintf(words, sizeof words, "check: %s: ", rules[name].id);
    for (const char *line = strstr(s->log, words); line; line = strstr(line + 1, words)) {
        const char *found = text ? strstr(line, text) : line;
        if (found && found < strchr(line, '\n')) return line;
    }
    return NULL;
}

static void every_rule_is_broken_and_named(void **state) {
    bool broken[RULE_COUNT] = {false};
    int bad = 0;
    (void)setenv("SMARTVIS_CHECK_MS", "2", 1);
    for (int n = 0; n < CASES; n++) {
        const rule_name name = cases[n].rule;
        layer_subject *s = layer_open(cases[n].plugin);
        if (strcmp(cases[n].plugin, CL) == 0 || name == RULE_foreign_objects) layer_take_queue(s);
        layer_create(s);
        if (s->p) cases[n].act(s);
        const char *line = find(s, name, NULL);
        /* The severity tells whose rule it is, and the first line how to mend it. */
        const int severity = rule_is_hosts(name) ? SV_LOG_HOST_MISBEHAVING : SV_LOG_PLUGIN_MISBEHAVING;
        if (!find(s, name, cases[n].text) || line[-2] - '0' != severity || !strstr(line, rules[name].mend)) {
            print_error("%s, %s: expected '%s' in\n%s\n", rules[name].id, cases[n].plugin, cases[n].text,
                        s->log);
            bad++;
        }
        broken[name] = true;
        layer_close(s);
    }
    (void)unsetenv("SMARTVIS_CHECK_MS");
    assert_int_equal(bad, 0);
    for (int n = 0; n < RULE_COUNT; n++)
        if (rules[n].seen != broken[n])
            fail_msg("%s is %s here", rules[n].id, broken[n] ? "seen" : "not broken");
}

/* A volume that is as large as no scan breaks no rule: the host is asked, also where breaches are stopped. */
static void lengths_are_asked_about(void **state) {
    static const char asked[] = "activate: the volume is 0.06 mm wide: is its spacing in metres?\n";
    (void)setenv("SMARTVIS_CHECK", "stop", 1);
    layer_subject *s = layer_open(CPU);
    for (int k = 0; k < 3; k++) s->format.spacing_mm[k] = 0.0025f;
    layer_create(s);
    layer_use(s);
    const char *line = find(s, RULE_host_format, asked);
    if (!line) fail_msg("%s", s->log);
    assert_int_equal(line[-2] - '0', SV_LOG_WARNING);
    assert_null(find(s, RULE_host_format, "Read the descriptor")); /* of a breach */
    assert_true(s->stats.rays == RAYS);
    layer_close(s);
    (void)unsetenv("SMARTVIS_CHECK");
}

UNIT_MAIN(NULL, NULL, lengths_are_asked_about, every_rule_is_broken_and_named)
