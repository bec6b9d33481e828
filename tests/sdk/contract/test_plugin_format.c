/* SPDX-License-Identifier: MIT */
/*
 * What activate refuses, and parameters: each message names the field and its value,
 * and the instance stays usable.
 */
#include "smartvis/lookup.h"
#include "support/fixture.h"

#include <math.h>

#define FIELD(name) offsetof(sv_format, name)

/* One 32-bit field of an otherwise good format (21 x 18 x 14, slabs of 6, 4 tiles to a row). */
static void format_fields(void **state) {
    static const struct {
        size_t field;
        uint32_t value;
        sv_status status;
        const char *text;
    } table[] = {
        {FIELD(width), 0, SV_ERR_FORMAT, "width is 0, expected 1 to 8192"},
        {FIELD(width), 8193, SV_ERR_FORMAT, "width is 8193"},
        {FIELD(width), 22, SV_ERR_FORMAT, "tile_w is 21, expected 22 to 16384"},
        {FIELD(width), UINT32_MAX, SV_ERR_FORMAT, "width is 4294967295"},
        {FIELD(height), 0, SV_ERR_FORMAT, "height is 0"},
        {FIELD(height), 8193, SV_ERR_FORMAT, "height is 8193"},
        {FIELD(height), 19, SV_ERR_FORMAT, "tile_h is 18, expected 19 to 16384"},
        {FIELD(slices), 0, SV_ERR_FORMAT, "slices is 0"},
        {FIELD(slices), 8193, SV_ERR_FORMAT, "slices is 8193"},
        {FIELD(slices), 5, SV_ERR_FORMAT, "max_slab_slices is 6, expected 1 to 5"},
        {FIELD(max_slab_slices), 0, SV_ERR_FORMAT, "max_slab_slices is 0"},
        {FIELD(max_slab_slices), 15, SV_ERR_FORMAT, "max_slab_slices is 15, expected 1 to 14"},
        {FIELD(voxel_type), 0, SV_ERR_FORMAT, "voxel_type is 0"},
        {FIELD(voxel_type), 77, SV_ERR_FORMAT, "voxel_type is 77"},
        {FIELD(voxel_type), SV_VOXEL_U16, SV_ERR_FORMAT, "voxel_type is 2"},
        {FIELD(carrier), 0, SV_ERR_ARGUMENT, "carrier is 0"},
        {FIELD(carrier), 4, SV_ERR_ARGUMENT, "carrier is 4"},
        {FIELD(padding_value), (uint32_t)-2, SV_ERR_FORMAT, "padding_value is -2"},
        {FIELD(padding_value), 256, SV_ERR_FORMAT, "padding_value is 256"},
        {FIELD(tiles_x), 0, SV_ERR_FORMAT, "tiles_x is 0"},
        {FIELD(tiles_x), 5, SV_ERR_FORMAT, "row_pitch is 84, expected 105 to "},
        {FIELD(tiles_x), 0x80000000u, SV_ERR_FORMAT, "tiles_x is 2147483648"},
        {FIELD(tile_w), 20, SV_ERR_FORMAT, "tile_w is 20"},
        {FIELD(tile_w), 0x40000000u, SV_ERR_FORMAT, "tile_w is 1073741824"}, /* 4 are 0 in 32 bits */
        {FIELD(tile_h), 17, SV_ERR_FORMAT, "tile_h is 17"},
        {FIELD(tile_h), UINT32_MAX, SV_ERR_FORMAT, "tile_h is 4294967295"},
        {FIELD(row_pitch), 83, SV_ERR_FORMAT, "row_pitch is 83"},
        {FIELD(row_pitch), 0, SV_ERR_FORMAT, "row_pitch is 0"},
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

/* ---- parameters ---- */

static sv_status begin_with(fixture *f, uint32_t id, double value) {
    const sv_param_value v = {id, 0, value};
    const sv_frame frame = {.size = sizeof frame, .values = &v, .value_count = 1};
    return f->r.plugin->begin(f->r.plugin, &frame);
}

static void refused_value(fixture *f, const sv_param_info *info, double value) {
    char text[128];
    (void)snprintf(text, sizeof text, "%s is %g", info->key, value);
    fixture_refused(f, begin_with(f, info->id, value), SV_ERR_PARAM_RANGE, text);
    char shown[16] = "x";
    assert_int_equal(f->r.plugin->param_text(f->r.plugin, info->id, value, shown, sizeof shown),
                     SV_ERR_PARAM_RANGE);
    assert_string_equal(shown, "");
}

/* Nothing is rounded or clamped, and the reason names key and value. That every parameter keeps its range, in
 * begin and in param_text, is sv_validate's. */
static void values_beyond(void **state) {
    fixture *f = *state;
    const sv_plugin *p = f->r.plugin;
    static const char *const keys[] = {"q", "kernel", "unsure"};
    for (size_t i = 0; i < sizeof keys / sizeof *keys; i++) {
        sv_param_info info;
        assert_true(sv_lookup_key(p, keys[i], &info));
        const bool whole = info.type != SV_PARAM_FLOAT;
        refused_value(f, &info, info.min_value - (whole ? 1.0 : 1e-6));
        refused_value(f, &info, info.max_value + (whole ? 1.0 : 1e-6));
        refused_value(f, &info, (double)NAN);
        refused_value(f, &info, -(double)INFINITY);
        if (whole) refused_value(f, &info, info.min_value + 1e-9);
    }
    sv_param_info beyond = {.size = sizeof beyond};
    fixture_keep_reason(f);
    fixture_refused_anywhere(f, p->param_info(p, p->param_count(p), &beyond), SV_ERR_ARGUMENT, "index is ");
    fixture_refused(f, begin_with(f, rig_param(&f->r, "kernel"), 24), SV_ERR_PARAM_RANGE, "kernel is 24");
    fixture_refused(f, begin_with(f, 0, 1), SV_ERR_PARAM_ID, "id 0");
    fixture_refused(f, begin_with(f, 4711, 1), SV_ERR_PARAM_ID, "id 4711");
    fixture_frame_is_good(f); /* refused values left no trace */
}

static void fixed_parameters(void **state) {
    fixture *f = *state;
    const sv_plugin *p = f->r.plugin;
    fixture_refused(f, begin_with(f, rig_param(&f->r, "substeps"), 2), SV_ERR_PARAM_FIXED,
                    "substeps is 2, activated with 1");
    fixture_refused(f, begin_with(f, rig_param(&f->r, "strategy"), 3), SV_ERR_PARAM_FIXED, "strategy is 3");
    assert_int_equal(begin_with(f, rig_param(&f->r, "substeps"), 1), SV_OK);
    p->deactivate(p);

    sv_param_value value = {rig_param(&f->r, "q"), 0, 0.5};
    sv_format format = f->textures->format;
    format.values = &value;
    format.value_count = 1;
    fixture_refused(f, p->activate(p, &format), SV_ERR_PARAM_ID, "q is not a parameter of this call");
    value = (sv_param_value){rig_param(&f->r, "substeps"), 0, 5};
    fixture_refused(f, p->activate(p, &format), SV_ERR_PARAM_RANGE, "substeps is 5");
    value = (sv_param_value){999, 0, 5};
    fixture_refused(f, p->activate(p, &format), SV_ERR_PARAM_ID, "id 999");
    format.values = NULL;
    fixture_refused(f, p->activate(p, &format), SV_ERR_ARGUMENT, "values is NULL, value_count is 1");
    value = (sv_param_value){rig_param(&f->r, "substeps"), 0, 2};
    format.values = &value;
    assert_int_equal(p->activate(p, &format), SV_OK);
    fixture_refused(f, begin_with(f, rig_param(&f->r, "substeps"), 1), SV_ERR_PARAM_FIXED,
                    "activated with 2");
    p->deactivate(p);
    /* An earlier activation's values do not linger. */
    fixture_works(f);
}

/* A list counts as a whole: its last value of an id wins, and one bad value discards all. Frames do not
 * inherit. */
static void lists_of_values(void **state) {
    fixture *f = *state;
    const sv_plugin *p = f->r.plugin;
    const uint32_t q = rig_param(&f->r, "q");
    sv_param_value values[] = {{q, 0, 1.5},
                               {rig_param(&f->r, "kernel"), 0, 3},
                               {q, 0, rig_param_default(&f->r, "q")},
                               {rig_param(&f->r, "kernel"), 0, 23}};
    assert_int_equal(rig_frame(&f->r, f->textures, values, 4, &f->out), SV_OK);
    assert_memory_equal(f->out.depth, f->good.depth, FIXTURE_RAYS * sizeof(float));
    values[3].value = 24;
    const sv_frame frame = {.size = sizeof frame, .values = values, .value_count = 4};
    fixture_refused(f, p->begin(p, &frame), SV_ERR_PARAM_RANGE, "kernel is 24");
    fixture_frame_is_good(f);
    values[0].value = 1.5;
    assert_int_equal(rig_frame(&f->r, f->textures, values, 1, &f->out), SV_OK);
    assert_memory_not_equal(f->out.depth, f->good.depth, FIXTURE_RAYS * sizeof(float));
    fixture_frame_is_good(f); /* values that are not listed have their defaults again */

    const sv_result result = fixture_result(f);
    fixture_refused(f, p->adjust(p, &values[1], 1, &result), SV_ERR_PARAM_ID,
                    "kernel is not a parameter of this call");
    fixture_refused(f, p->adjust(p, NULL, 2, &result), SV_ERR_ARGUMENT, "values is NULL, value_count is 2");
    values[0].value = (double)NAN;
    fixture_refused(f, p->adjust(p, values, 1, &result), SV_ERR_PARAM_RANGE, "q is nan");
}

static void values_as_text(void **state) {
    fixture *f = *state;
    const sv_plugin *p = f->r.plugin;
    static const struct {
        const char *key;
        double value;
        const char *text;
    } table[] = {{"q", 0.25, "0.25"},          {"kernel", 23, "23"},         {"drop_empty", 1, "true"},
                 {"drop_empty", 0, "false"},   {"bone_mode", 0, "absolute"}, {"bone_mode", 1, "offset"},
                 {"bone_mode", 2, "fraction"}, {"strategy", 0, "auto"},      {"strategy", 3, "rays"}};
    char text[32];
    for (size_t i = 0; i < sizeof table / sizeof *table; i++) {
        const uint32_t id = rig_param(&f->r, table[i].key);
        assert_int_equal(p->param_text(p, id, table[i].value, text, sizeof text), SV_OK);
        assert_string_equal(text, table[i].text);
        memset(text, 'x', sizeof text);
        assert_int_equal(p->param_text(p, id, table[i].value, text, 3),
                         SV_OK); /* cut, ended, and no further */
        assert_int_equal(strlen(text), strlen(table[i].text) < 2 ? strlen(table[i].text) : 2);
        assert_memory_equal(text, table[i].text, strlen(text));
        assert_int_equal(text[3], 'x');
        assert_int_equal(p->param_text(p, id, table[i].value, text, 1), SV_OK);
        assert_string_equal(text, "");
    }
    fixture_keep_reason(f);
    fixture_refused_anywhere(f, p->param_text(p, 4711, 0, text, sizeof text), SV_ERR_PARAM_ID, "id 4711");
    fixture_keep_reason(f);
    fixture_refused_anywhere(f, p->param_text(p, 1, 0, text, 0), SV_ERR_ARGUMENT, "no room");
}

UNIT_MAIN(NULL, NULL, FIXTURE_TEST(format_fields), FIXTURE_TEST(opencl_objects),
          FIXTURE_TEST_ACTIVE(values_beyond), FIXTURE_TEST_ACTIVE(fixed_parameters),
          FIXTURE_TEST_ACTIVE(lists_of_values), FIXTURE_TEST(values_as_text))
