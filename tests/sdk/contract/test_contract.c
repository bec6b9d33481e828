/* SPDX-License-Identifier: MIT */
/*
 * The header's rules on calls: calls in the wrong state, NULL where something is needed, structs that are
 * too short, ids and flags that nobody knows. A refused call says why, and changes nothing.
 */
#include "support/fixture.h"

/* ---- states ---- */

static sv_status adjust(fixture *f) {
    const sv_result result = fixture_result(f);
    return f->r.plugin->adjust(f->r.plugin, NULL, 0, &result);
}

/* A call in the wrong state tells the host that it misbehaves. */
static void wrong_state(fixture *f, sv_status status, const char *text) {
    fixture_refused(f, status, SV_ERR_STATE, text);
    assert_string_equal(f->r.last_log, f->r.plugin->last_error(f->r.plugin));
    assert_int_equal(f->r.last_severity, SV_LOG_HOST_MISBEHAVING);
}

/* sv_validate has the table of every call in every state. Here are the words, and the calls of
 * smartvis.timing/1, which may come while the instance is active and have times behind a frame that was
 * timed. */
static void calls_in_the_wrong_state(void **state) {
    fixture *f = *state;
    const sv_plugin *p = f->r.plugin;
    const sv_ext_timing *timing = p->get_extension(p, SV_EXT_TIMING);
    sv_stage_times times = {.size = sizeof times};
    wrong_state(f, fixture_begin(f), "begin: ");
    wrong_state(f, fixture_slab(f, 0), "slab: ");
    wrong_state(f, fixture_end(f), "end: ");
    wrong_state(f, adjust(f), "adjust: ");
    wrong_state(f, timing->enable(p, 0), "timing: not active");
    wrong_state(f, timing->stage_times(p, &times), "stage_times: ");
    assert_int_equal(fixture_activate(f), SV_OK);
    wrong_state(f, fixture_activate(f), "activate: ");
    wrong_state(f, adjust(f), "adjust: ");
    for (uint32_t n = 0; n <= FIXTURE_SLABS; n++) { /* idle, begun, midway, complete */
        assert_int_equal(timing->enable(p, 0), SV_OK);
        wrong_state(f, timing->stage_times(p, &times), "stage_times: ");
        if (n == 0) assert_int_equal(fixture_begin(f), SV_OK);
        if (n < FIXTURE_SLABS) assert_int_equal(fixture_slab(f, n), SV_OK);
    }
    assert_int_equal(fixture_end(f), SV_OK);
    wrong_state(f, timing->stage_times(p, &times), "stage_times: "); /* it was not timed */
    assert_int_equal(timing->enable(p, 0), SV_OK);
    assert_int_equal(adjust(f), SV_OK);
    assert_int_equal(clFinish(f->r.queue), CL_SUCCESS);
    fixture_frame_is_good(f);
}

/* A call in the wrong state leaves the frame under way as it is. */
static void a_refused_call_changes_nothing(void **state) {
    fixture *f = *state;
    assert_int_equal(fixture_begin(f), SV_OK);
    for (uint32_t n = 0; n < FIXTURE_SLABS; n++) {
        fixture_refused(f, fixture_activate(f), SV_ERR_STATE, "activate: the instance is active");
        assert_int_equal(adjust(f), SV_ERR_STATE);
        assert_int_equal(fixture_slab(f, n), SV_OK);
    }
    assert_int_equal(fixture_end(f), SV_OK);
    assert_memory_equal(f->out.depth, f->good.depth, FIXTURE_RAYS * sizeof(float));
    /* A refused adjust leaves the finished frame finished. */
    fixture_refused(f, f->r.plugin->adjust(f->r.plugin, NULL, 0, NULL), SV_ERR_ARGUMENT, "result is NULL");
    const sv_param_value wrong = {rig_param(&f->r, "q"), 0, 9.0};
    const sv_result result = fixture_result(f);
    fixture_refused(f, f->r.plugin->adjust(f->r.plugin, &wrong, 1, &result), SV_ERR_PARAM_RANGE, "q is 9");
    assert_int_equal(adjust(f), SV_OK);
    assert_int_equal(clFinish(f->r.queue), CL_SUCCESS);
    assert_memory_equal(f->out.depth, f->good.depth, FIXTURE_RAYS * sizeof(float));
}

static void deactivate_when_inactive(void **state) {
    fixture *f = *state;
    const unsigned lines = f->r.log_lines;
    f->r.plugin->deactivate(f->r.plugin);
    assert_int_equal(f->r.log_lines, lines + 1);
    fixture_refused(f, SV_ERR_STATE, SV_ERR_STATE, "deactivate: the instance is inactive");
    fixture_works(f);
    f->r.plugin->deactivate(f->r.plugin);
    assert_string_equal(f->r.plugin->last_error(f->r.plugin), "");
}

/* ---- NULL ---- */

static void null_arguments(void **state) {
    fixture *f = *state;
    const sv_plugin *p = f->r.plugin;
    const sv_entry *entry = f->r.entry;
    const sv_plugin *out = p;
    assert_int_equal(entry->create(NULL, entry->descriptor(0)->id, &out), SV_ERR_ARGUMENT);
    assert_null(out);
    assert_int_equal(entry->create(&f->r.host, NULL, &out), SV_ERR_ARGUMENT);
    assert_int_equal(entry->create(&f->r.host, entry->descriptor(0)->id, NULL), SV_ERR_ARGUMENT);
    fixture_refused(f, p->activate(p, NULL), SV_ERR_ARGUMENT, "format is NULL");
    assert_int_equal(fixture_activate(f), SV_OK);
    fixture_refused(f, p->begin(p, NULL), SV_ERR_ARGUMENT, "frame is NULL");
    const sv_frame no_values = {.size = sizeof no_values, .value_count = 3};
    fixture_refused(f, p->begin(p, &no_values), SV_ERR_ARGUMENT, "values is NULL, value_count is 3");
    assert_int_equal(fixture_begin(f), SV_OK);
    fixture_refused(f, p->slab(p, NULL), SV_ERR_ARGUMENT, "slab is NULL");
    fixture_feed(f, FIXTURE_SLABS);
    fixture_refused(f, p->end(p, NULL), SV_ERR_ARGUMENT, "result is NULL");
    fixture_keep_reason(f);
    fixture_refused_anywhere(f, p->param_info(p, 0, NULL), SV_ERR_ARGUMENT, "out is NULL");
    fixture_keep_reason(f);
    fixture_refused_anywhere(f, p->param_text(p, 1, 0.0, NULL, 10), SV_ERR_ARGUMENT, "no room");
    const sv_ext_timing *stats = p->get_extension(p, SV_EXT_TIMING);
    fixture_refused(f, stats->stage_times(p, NULL), SV_ERR_ARGUMENT, "out is NULL");
    assert_null(p->get_extension(p, NULL));
    fixture_frame_is_good(f);
    p->destroy(NULL);
}

/* ---- sizes, ids, flags ---- */

/* That every struct which is too short is refused is sv_validate's; here are the words, and the times. */
static void structs_too_short(void **state) {
    fixture *f = *state;
    const sv_plugin *p = f->r.plugin;
    const sv_ext_timing *stats = p->get_extension(p, SV_EXT_TIMING);
    const sv_frame frame = {.size = 8};
    sv_slab slab = stage_slab(f->textures, 0);
    sv_result result = fixture_result(f);
    sv_param_info info = {.size = 8};
    sv_stage_times times = {.size = 8};
    slab.size = result.size = 8;
    fixture_refused(f, p->begin(p, &frame), SV_ERR_SIZE, "size is 8");
    assert_int_equal(fixture_begin(f), SV_OK);
    fixture_refused(f, p->slab(p, &slab), SV_ERR_SIZE, "size is 8");
    fixture_feed(f, FIXTURE_SLABS);
    fixture_refused(f, p->end(p, &result), SV_ERR_SIZE, "size is 8");
    fixture_keep_reason(f);
    fixture_refused_anywhere(f, p->param_info(p, 0, &info), SV_ERR_SIZE, "size is 8");
    fixture_refused(f, stats->stage_times(p, &times), SV_ERR_SIZE, "size is 8");
    fixture_frame_is_good(f);
}

/* Of a newer host's struct the tail stays as it is, of a shorter one, which is refused, all but its size. A
 * frame that ends with those of 1.0, or within the rotation, says nothing of the probe. */
static void only_known_bytes_are_touched(void **state) {
    enum { EXTRA = 24, MARK = 0xA5 };
    fixture *f = *state;
    const sv_plugin *p = f->r.plugin;
    union {
        sv_param_info info;
        sv_stats stats;
        sv_frame frame;
        unsigned char bytes[sizeof(sv_frame) + EXTRA];
    } u;
    for (int longer = 0; longer < 2; longer++) {
        const sv_status status = longer ? SV_OK : SV_ERR_SIZE;
        memset(&u, MARK, sizeof u);
        u.info.size = (uint32_t)sizeof u.info + (longer ? EXTRA : -1u);
        assert_int_equal(p->param_info(p, 0, &u.info), status);
        for (size_t i = longer ? sizeof u.info : 4; i < sizeof u; i++) assert_int_equal(u.bytes[i], MARK);

        memset(&u, MARK, sizeof u);
        u.stats.size = (uint32_t)sizeof u.stats + (longer ? EXTRA : -1u);
        sv_result result = fixture_result(f);
        result.stats = &u.stats;
        memset(f->out.depth, MARK, FIXTURE_RAYS * sizeof(float));
        fixture_feed(f, FIXTURE_SLABS);
        assert_int_equal(p->end(p, &result), status);
        assert_int_equal(clFinish(f->r.queue), CL_SUCCESS);
        for (size_t i = longer ? sizeof u.stats : 4; i < sizeof u; i++) assert_int_equal(u.bytes[i], MARK);
        const unsigned char *depth = (const unsigned char *)f->out.depth;
        for (size_t i = 0; !longer && i < FIXTURE_RAYS * sizeof(float); i++) assert_int_equal(depth[i], MARK);

        memset(&u, MARK, sizeof u);
        memset(&u.frame, 0, SV_FRAME_SIZE_1_0);
        u.frame.size = SV_FRAME_SIZE_1_0 + (longer ? EXTRA : 0);
        assert_int_equal(p->begin(p, &u.frame), SV_OK);
    }
}

static void unknown_ids_and_flags(void **state) {
    fixture *f = *state;
    const sv_plugin *p = f->r.plugin, *out = p;
    const sv_entry *entry = f->r.entry;
    char id[128];
    (void)snprintf(id, sizeof id, "%s.more", entry->descriptor(0)->id);
    fixture_refused(f, entry->create(&f->r.host, id, &out), SV_ERR_UNKNOWN_ID, "");
    assert_non_null(strstr(f->r.last_log, id));
    assert_null(out);
    assert_int_equal(entry->create(&f->r.host, "", &out), SV_ERR_UNKNOWN_ID);
    assert_null(entry->descriptor(entry->count));
    assert_null(p->get_extension(p, "smartvis.timing/2"));
    assert_null(p->get_extension(p, "smartvis.timing/1 "));
    assert_null(p->get_extension(p, ""));
    const sv_frame frame = {.size = sizeof frame, .flags = 0x80000000u};
    fixture_refused(f, p->begin(p, &frame), SV_ERR_ARGUMENT, "flags is 0x80000000");
    fixture_frame_is_good(f);
}

UNIT_MAIN(NULL, NULL, FIXTURE_TEST(calls_in_the_wrong_state),
          FIXTURE_TEST_ACTIVE(a_refused_call_changes_nothing), FIXTURE_TEST(deactivate_when_inactive),
          FIXTURE_TEST(null_arguments), FIXTURE_TEST_ACTIVE(structs_too_short),
          FIXTURE_TEST_ACTIVE(unknown_ids_and_flags), FIXTURE_TEST_ACTIVE(only_known_bytes_are_touched))
