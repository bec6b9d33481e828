/* SPDX-License-Identifier: MIT */
/*
 * The header's rules on calls, beside what sv_validate tries on every plugin (states, NULL, short structs,
 * ids, values): the words of a refusal, which name field and value, and smartvis.timing/1.
 * Requirement: R5.
 */
#include "support/fixture.h"

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
    wrong_state(f, timing->enable(p, 0), "timing: not active");
    wrong_state(f, timing->stage_times(p, &times), "stage_times: ");
    assert_int_equal(fixture_activate(f), SV_OK);
    for (uint32_t n = 0; n <= FIXTURE_SLABS; n++) { /* idle, begun, midway, complete */
        assert_int_equal(timing->enable(p, 0), SV_OK);
        wrong_state(f, timing->stage_times(p, &times), "stage_times: ");
        if (n == 0) assert_int_equal(fixture_begin(f), SV_OK);
        if (n < FIXTURE_SLABS) assert_int_equal(fixture_slab(f, n), SV_OK);
    }
    assert_int_equal(fixture_end(f), SV_OK);
    wrong_state(f, timing->stage_times(p, &times), "stage_times: "); /* it was not timed */
    fixture_refused(f, timing->stage_times(p, NULL), SV_ERR_ARGUMENT, "out is NULL");
    times.size = 8;
    fixture_refused(f, timing->stage_times(p, &times), SV_ERR_SIZE, "size is 8");
    assert_int_equal(timing->enable(p, 0), SV_OK);
    assert_int_equal(adjust(f), SV_OK);
    assert_int_equal(clFinish(f->r.queue), CL_SUCCESS);
    fixture_frame_is_good(f);
    p->destroy(NULL);
}

#define FIELD(name) offsetof(sv_format, name)

/* One 32-bit field of an otherwise good format (21 x 18 x 14, slabs of 6, 4 tiles to a row): the words of
 * each kind of refusal, and numbers that depend on each other. Every field: sv_validate's format-refusals. */
static void format_fields(void **state) {
    static const struct {
        size_t field;
        uint32_t value;
        sv_status status;
        const char *text;
    } table[] = {
        {FIELD(width), 0, SV_ERR_FORMAT, "width is 0, expected 1 to 8192"},
        {FIELD(width), 22, SV_ERR_FORMAT, "tile_w is 21, expected 22 to 16384"},
        {FIELD(width), UINT32_MAX, SV_ERR_FORMAT, "width is 4294967295"},
        {FIELD(height), 19, SV_ERR_FORMAT, "tile_h is 18, expected 19 to 16384"},
        {FIELD(slices), 5, SV_ERR_FORMAT, "max_slab_slices is 6, expected 1 to 5"},
        {FIELD(max_slab_slices), 15, SV_ERR_FORMAT, "max_slab_slices is 15, expected 1 to 14"},
        {FIELD(voxel_type), 77, SV_ERR_FORMAT, "voxel_type is 77"},
        {FIELD(carrier), 4, SV_ERR_ARGUMENT, "carrier is 4"},
        {FIELD(padding_value), (uint32_t)-2, SV_ERR_FORMAT, "padding_value is -2"},
        {FIELD(tiles_x), 5, SV_ERR_FORMAT, "row_pitch is 84, expected 105 to "},
        {FIELD(tiles_x), 0x80000000u, SV_ERR_FORMAT, "tiles_x is 2147483648"},
        {FIELD(tile_w), 0x40000000u, SV_ERR_FORMAT, "tile_w is 1073741824"}, /* 4 are 0 in 32 bits */
        {FIELD(tile_h), UINT32_MAX, SV_ERR_FORMAT, "tile_h is 4294967295"},
        {FIELD(row_pitch), 83, SV_ERR_FORMAT, "row_pitch is 83"},
        {FIELD(spacing_mm[1]), 0x3f800000u, SV_ERR_FORMAT, "spacing_mm is 0, 1, 0"},
        {FIELD(spacing_mm[2]), 0x7f800000u, SV_ERR_FORMAT, "spacing_mm is 0, 0, inf"},
    };
    fixture *f = *state;
    for (size_t i = 0; i < sizeof table / sizeof *table; i++) {
        sv_format format = f->textures->format;
        memcpy((char *)&format + table[i].field, &table[i].value, sizeof table[i].value);
        fixture_refused(f, f->r.plugin->activate(f->r.plugin, &format), table[i].status, table[i].text);
        assert_int_equal(f->r.last_severity, SV_LOG_HOST_MISBEHAVING);
    }
    fixture_works(f);
}

static void opencl_objects(void **state) {
    fixture *f = *state;
    const sv_plugin *p = f->r.plugin;
    sv_format format = f->textures->format;
    format.queue = NULL;
    fixture_refused(f, p->activate(p, &format), SV_ERR_ARGUMENT, "2 of context, device and queue given");
    format.context = NULL;
    fixture_refused(f, p->activate(p, &format), SV_ERR_ARGUMENT, "1 of context, device and queue given");
    format.device = NULL;
    format.carrier = SV_CARRIER_BUFFER;
    fixture_refused(f, p->activate(p, &format), SV_ERR_FORMAT, "carrier is 2; see");
    format.carrier = SV_CARRIER_IMAGE;
    fixture_refused(f, p->activate(p, &format), SV_ERR_FORMAT, "carrier is 3; see");

    format = f->textures->format;
    format.host_memory_bytes = 100;
    fixture_refused(f, p->activate(p, &format), SV_ERR_ARGUMENT,
                    "host_memory is NULL, host_memory_bytes is 100");
    format.host_memory = f->textures->pages;
    format.host_memory_bytes = 0;
    fixture_refused(f, p->activate(p, &format), SV_ERR_ARGUMENT,
                    "host_memory is given, host_memory_bytes is 0");

    cl_int code = CL_SUCCESS;
    cl_command_queue unordered =
        clCreateCommandQueue(f->r.context, f->r.device, CL_QUEUE_OUT_OF_ORDER_EXEC_MODE_ENABLE, &code);
    assert_int_equal(code, CL_SUCCESS);
    format = f->textures->format;
    format.queue = unordered;
    fixture_refused(f, p->activate(p, &format), SV_ERR_FORMAT, "out-of-order");
    assert_int_equal(clReleaseCommandQueue(unordered), CL_SUCCESS);
    fixture_works(f);
}

UNIT_MAIN_OF(NULL, NULL, FIXTURE_TEST(calls_in_the_wrong_state), FIXTURE_TEST(format_fields),
             FIXTURE_TEST(opencl_objects))
