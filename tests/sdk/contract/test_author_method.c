/* SPDX-License-Identifier: MIT */
/*
 * What author.h does for a method: a small plugin made here fails where it is told to, and has tables that
 * are wrong on purpose.
 */
#include "smartvis/author.h"

#include <math.h>

#include "support/plain_format.h"
#include "support/unit.h"

enum { WIDTH = 5, HEIGHT = 3, SLICES = 4, RAYS = WIDTH * HEIGHT };

/* ---- a plugin that fails where it is told to */

enum { WHERE = 1, SHADE, COLOUR };
enum { NOWHERE, AT_ACTIVATE, AT_BEGIN, AT_SLAB, AT_FINISH, NOT_A_NUMBER, WITHOUT_REASON };
static int deactivated; /* how often */

static sv_status fail_at(sva *a, int where) {
    return (int)sva_value(a, WHERE) == where ? sva_error(a, SV_ERR_INTERNAL, "fails at %d", where) : SV_OK;
}
static sv_status on_activate(sva *a) {
    return fail_at(a, AT_ACTIVATE);
}
static sv_status on_begin(sva *a) {
    return fail_at(a, AT_BEGIN);
}
static sv_status on_slab(sva *a, const sv_slab *slab) {
    return slab->first_slice > 0 ? fail_at(a, AT_SLAB) : SV_OK;
}
static void on_deactivate(sva *a) {
    deactivated++;
}
static sv_status on_finish(sva *a, float *depth) {
    for (size_t i = 0; i < sva_rays(a); i++) depth[i] = 3.0f;
    if ((int)sva_value(a, WHERE) == NOT_A_NUMBER) depth[5] = NAN;
    if ((int)sva_value(a, WHERE) == WITHOUT_REASON) return SV_ERR_INTERNAL;
    return fail_at(a, AT_FINISH);
}

static const char *const colours[] = {"red", "green", NULL, "blue"};
static const char *const places[] = {"nowhere", "activate", "begin", "slab", "finish", "nan", "silent"};
static const sva_param own_params[] = {
    {.id = WHERE,
     .type = SV_PARAM_ENUM,
     .flags = SV_PARAM_REACTIVATE,
     .key = "where",
     .label = "Where",
     .unit = "",
     .help = "Where it fails.",
     .max_value = WITHOUT_REASON,
     .names = places},
    {.id = SHADE,
     .type = SV_PARAM_INT,
     .key = "shade",
     .label = "Shade",
     .unit = "",
     .help = "Nothing.",
     .min_value = 1,
     .max_value = 31,
     .default_value = 3,
     .step = 2,
     .display_min = 1,
     .display_max = 9,
     .group = "Looks",
     .depends_on = COLOUR,
     .depends_values = 2},
    {.id = COLOUR,
     .type = SV_PARAM_ENUM,
     .key = "colour",
     .label = "Colour",
     .unit = "",
     .help = "Nothing.",
     .max_value = 3,
     .names = colours},
};
static const sv_descriptor own_descriptor = SVA_DESCRIPTOR("test.own", "Own", "Test", "1", "Fails.", 0);
static const sva_method own_method = {.descriptor = &own_descriptor,
                                      .params = own_params,
                                      .param_count = 3,
                                      .activate = on_activate,
                                      .deactivate = on_deactivate,
                                      .begin = on_begin,
                                      .slab = on_slab,
                                      .finish = on_finish};

/* ---- a host */

static char last_log[300], last_doubt[300];

static void keep_log(const sv_host *host, int32_t severity, const char *text) {
    (void)snprintf(last_log, sizeof last_log, "%s", text);
    if (severity == SV_LOG_INFO) memcpy(last_doubt, last_log, sizeof last_log);
}

static const sv_host host = {sizeof host, SV_ABI_MINOR, NULL, "test", "1", keep_log, NULL};
static uint8_t volume[SLICES * RAYS];
static float depth[RAYS];

static sv_format small_format(void) {
    sv_format format = plain_format(WIDTH, HEIGHT, SLICES, 2);
    format.padding_value = 9;
    return format;
}

static const sv_plugin *make(const sva_method *method) {
    const sv_plugin *p = NULL;
    assert_int_equal(sva_create(method, &host, method->descriptor->id, &p), SV_OK);
    deactivated = 0;
    return p;
}

/* Activates with a place to fail at. */
static sv_status activate_at(const sv_plugin *p, int where) {
    const sv_param_value value = {WHERE, 0, where};
    sv_format format = small_format();
    format.values = &value;
    format.value_count = 1;
    return p->activate(p, &format);
}

static sv_status begin(const sv_plugin *p, const sv_param_value *values, uint32_t count) {
    const sv_frame frame = {.size = sizeof frame, .values = values, .value_count = count};
    return p->begin(p, &frame);
}

/* A frame in two slabs, into `depth`, which is -77 before. */
static sv_status frame(const sv_plugin *p) {
    const sv_result result = {.size = sizeof result, .depth = depth};
    sv_status status = begin(p, NULL, 0);
    for (uint32_t z = 0; z < SLICES && status == SV_OK; z += 2) {
        const sv_slab slab = {
            .size = sizeof slab, .first_slice = z, .slice_count = 2, .memory = volume, .bytes = 2 * RAYS};
        status = p->slab(p, &slab);
    }
    for (int i = 0; i < RAYS; i++) depth[i] = -77.0f;
    return status == SV_OK ? p->end(p, &result) : status;
}

/* ---- tests */

static void a_method_that_fails(void **state) {
    const sv_plugin *p = make(&own_method);
    assert_int_equal(activate_at(p, AT_ACTIVATE), SV_ERR_INTERNAL);
    assert_string_equal(p->last_error(p), "fails at 1");
    assert_int_equal(deactivated, 1); /* what activate made in part is freed */
    assert_int_equal(begin(p, NULL, 0), SV_ERR_STATE);
    static const char *const reasons[] = {"",
                                          "",
                                          "fails at 2",
                                          "fails at 3",
                                          "fails at 4",
                                          "end: the depth of ray (0, 1) is nan",
                                          "end: the method returned -1 without a reason"};
    for (int where = AT_BEGIN; where <= WITHOUT_REASON; where++) {
        assert_int_equal(activate_at(p, where), SV_OK);
        assert_int_equal(frame(p), SV_ERR_INTERNAL);
        assert_string_equal(p->last_error(p), reasons[where]);
        assert_string_equal(last_log, reasons[where]);
        for (int i = 0; i < RAYS; i++) assert_true(depth[i] == -77.0f);
        const sv_result result = {.size = sizeof result, .depth = depth};
        assert_int_equal(p->adjust(p, NULL, 0, &result), SV_ERR_STATE);
        p->deactivate(p);
        assert_int_equal(deactivated, where);
    }
    assert_int_equal(activate_at(p, NOWHERE), SV_OK);
    assert_int_equal(frame(p), SV_OK);
    for (int i = 0; i < RAYS; i++) assert_true(depth[i] == 3.0f);
    p->destroy(p); /* an active one is deactivated, and the host is told */
    assert_int_equal(deactivated, WITHOUT_REASON + 1);
    assert_non_null(strstr(last_log, "destroy: "));
}

/* What a table leaves out, and words: what is taken and refused, sv_validate's checks of parameters try. */
static void parameters(void **state) {
    char text[16];
    const sv_plugin *p = make(&own_method);
    sv_param_info info = {.size = sizeof info};
    assert_int_equal(p->param_info(p, 1, &info), SV_OK);
    assert_string_equal(info.group, "Looks");
    assert_true(info.depends_on == COLOUR && info.depends_values == 2 && info.display_max == 9.0);
    assert_int_equal(p->param_info(p, 2, &info), SV_OK);
    assert_string_equal(info.group, "");
    assert_true(info.display_max == 3.0 && info.step == 1.0);
    assert_int_equal(p->param_text(p, COLOUR, 2.0, text, sizeof text), SV_ERR_PARAM_RANGE); /* left out */
    assert_int_equal(activate_at(p, NOWHERE), SV_OK);
    sv_param_value values[] = {{SHADE, 0, 4.0}, {WHERE, 0, NOWHERE}};
    assert_int_equal(begin(p, values, 1), SV_ERR_PARAM_RANGE);
    assert_string_equal(p->last_error(p), "begin: shade is 4, expected 1 to 31 in steps of 2");
    values[0].value = 5.0;
    assert_int_equal(begin(p, values, 2), SV_OK); /* the value of activate may be repeated */
    values[1].value = AT_SLAB;
    assert_int_equal(begin(p, values, 2), SV_ERR_PARAM_FIXED);
    assert_string_equal(p->last_error(p), "begin: where is slab, activated with nowhere");
    assert_int_equal(begin(p, NULL, 0), SV_OK);
    assert_true(sva_value(p->plugin_data, SHADE) == 3.0); /* not listed: its default */
    p->deactivate(p);
    const sv_format format = small_format();
    assert_int_equal(activate_at(p, AT_SLAB), SV_OK);
    p->deactivate(p);
    assert_int_equal(p->activate(p, &format), SV_OK); /* an earlier activation's values do not linger */
    assert_int_equal(frame(p), SV_OK);
    p->deactivate(p);
    p->destroy(p);
}

/* Every voxel by the arithmetic drawn in the header, and what was scanned of it. */
static void voxels_and_ranges(void **state) {
    static const sv_descriptor descriptor =
        SVA_DESCRIPTOR("test.own", "Own", "Test", "1", "Reads.", SV_FEATURE_SCANNED | SV_FEATURE_PADDING);
    sva_method method = own_method;
    method.descriptor = &descriptor;
    const sv_plugin *p = make(&method);
    sv_format format = small_format();
    sv_scanned ranges[RAYS];
    format.flags = SV_FORMAT_SCANNED;
    for (uint32_t i = 0; i < RAYS; i++) ranges[i] = (sv_scanned){(uint16_t)(i % 3), (uint16_t)(i % 6)};
    for (uint32_t i = 0; i < sizeof volume; i++) volume[i] = (uint8_t)(i % 17);
    assert_int_equal(p->activate(p, &format), SV_OK);
    const sva *a = p->plugin_data;
    assert_true(a->format.spacing_mm[0] == 24.0f); /* unknown: cubes, and 120 mm for the 5 voxels of a row */
    const sv_frame scan = {.size = sizeof scan, .scanned = ranges};
    assert_int_equal(p->begin(p, &scan), SV_OK);
    const sv_slab slab = {.size = sizeof slab, .slice_count = 4, .memory = volume, .bytes = sizeof volume};
    assert_int_equal(p->slab(p, &slab), SV_OK);
    for (uint32_t z = 0; z < SLICES; z++)
        for (uint32_t i = 0; i < RAYS; i++) {
            const uint32_t x = i % WIDTH, y = i / WIDTH;
            const uint8_t voxel = volume[(z / 2 * HEIGHT + y) * 2 * WIDTH + z % 2 * WIDTH + x];
            assert_int_equal(sva_voxel(a, x, y, z), voxel);
            assert_int_equal(sva_scanned(a, x, y, z, voxel), z >= i % 3 && z < i % 6 && voxel != 9);
        }
    p->deactivate(p);
    p->destroy(p);
}

/* A frame of 1.0 says nothing of the probe, and what lies behind it is not read as if it did. With the
 * feature a wrong rotation is refused; without it the fields are ignored. */
static void where_the_probe_is(void **state) {
#define STRAIGHT .probe_rotation = {1, 0, 0, 0, 1, 0, 0, 0, 1}, .probe_side = { 0, 0, -1 }
#define TURNED   .probe_side = {1, 0, 0}, .probe_rotation
#define FAN      STRAIGHT, .beams = SV_BEAMS_FAN
    static const struct {
        const char *wrong; /* NULL: it may be */
        sv_frame frame;
    } told[] = {
        {NULL, {.probe_side = {0}}},
        {NULL, {.probe_side = {0, -1, 0}}},
        {NULL, {STRAIGHT}},
        {NULL, {TURNED = {0, 0, -1, 0, 1, 0, 1, 0, 0}}},
        {"probe_side is 1 0 0, expected the opposite of the rotation's",
         {TURNED = {0, 0, 1, 0, 1, 0, -1, 0, 0}}},
        {"probe_side is 0 0 0, expected the opposite", {.probe_rotation = {1, 0, 0, 0, 1, 0, 0, 0, 1}}},
        {"probe_rotation is 1 0 0, 0 1 0, 0 0 -1, expected a rotation",
         {TURNED = {1, 0, 0, 0, 1, 0, 0, 0, -1}}},
        {"probe_rotation is 2 0 0", {TURNED = {2, 0, 0, 0, 1, 0, 0, 0, 1}}},
        {"probe_rotation is nan 0 0", {TURNED = {NAN, 0, 0, 0, 1, 0, 0, 0, 1}}},
        {"probe_side is 0 0 inf, expected a unit vector or zeros", {.probe_side = {0, 0, INFINITY}}},
        {"probe_side is 0 0.5 0, expected a unit vector or zeros", {.probe_side = {0, 0.5f, 0}}},
        {NULL, {STRAIGHT, .beams = SV_BEAMS_PARALLEL, .flags = SV_FRAME_SAME_VOLUME}},
        {NULL, {FAN}},
        {NULL, {FAN, .beam_apex_mm = {40, 40, -57}, .beam_sweep_mm = 1e5f}},
        {"flags is 0x3, only 0x1 or 0x2", {STRAIGHT, .flags = 3}},
        {"beams is 1 without probe_rotation", {.beams = SV_BEAMS_PARALLEL, .probe_side = {0, 0, -1}}},
        {"beams is 3, expected 0 to 2", {STRAIGHT, .beams = 3}},
        {"reserved_beams is 7, expected 0", {FAN, .reserved_beams = 7}},
        {"beam_sweep_mm 2, expected 0 where", {STRAIGHT, .beams = SV_BEAMS_PARALLEL, .beam_sweep_mm = 2}},
        {"beam_apex_mm is 0 nan 0", {FAN, .beam_apex_mm = {0, NAN}}},
        {"-inf, expected -100000 to 100000", {FAN, .beam_sweep_mm = -INFINITY}},
        {"beam_apex_mm is 0 0 -100001", {FAN, .beam_apex_mm = {0, 0, -100001}}},
    };
    for (uint32_t features = 0; features <= SV_FEATURE_PROBE; features += SV_FEATURE_PROBE) {
        const sv_descriptor descriptor = SVA_DESCRIPTOR("test.own", "Own", "Test", "1", "Reads.", features);
        sva_method method = own_method;
        method.descriptor = &descriptor;
        const sv_plugin *p = make(&method);
        const sva *a = p->plugin_data;
        const sv_format format = small_format();
        assert_int_equal(p->activate(p, &format), SV_OK);
        for (size_t n = 0; n < sizeof told / sizeof *told; n++) {
            sv_frame frame = told[n].frame;
            frame.size = sizeof frame;
            const int refused = features ? told[n].wrong != NULL : frame.flags != 0;
            assert_int_equal(p->begin(p, &frame), refused ? SV_ERR_ARGUMENT : SV_OK);
            if (refused && !strstr(p->last_error(p), features ? told[n].wrong : "only 0x1 is known"))
                fail_msg("'%s'", p->last_error(p));
            frame.size = SV_FRAME_SIZE_1_0;
            frame.flags = 0;
            assert_int_equal(p->begin(p, &frame), SV_OK);
            for (int k = 0; k < 9; k++) assert_true(a->frame.probe_rotation[k] == 0.0f);
        }
        p->deactivate(p);
        p->destroy(p);
    }
}

/* A defect of the author's tables is found when the first instance is made. */
static void wrong_tables(void **state) {
    const sv_plugin *p = NULL;
    sva_param bad[3];
    sva_method method = own_method;
    method.params = bad;
    for (int n = 0; n < 5; n++) {
        memcpy(bad, own_params, sizeof bad);
        if (n == 1) bad[1].default_value = 32.0;
        if (n == 2) bad[1].id = COLOUR;
        if (n == 3) bad[1].label = NULL;
        if (n == 4) bad[1].flags = SV_PARAM_ADJUST;
        const sv_status expected = n == 0 ? SV_OK : SV_ERR_INTERNAL;
        assert_int_equal(sva_create(&method, &host, "test.own", &p), expected);
        if (n == 1)
            assert_string_equal(last_log,
                                "parameter 'shade': the default is 32, expected 1 to 31 in steps of 2");
        if (p) p->destroy(p);
    }
    method = own_method;
    method.finish = NULL;
    assert_int_equal(sva_create(&method, &host, "test.own", &p), SV_ERR_INTERNAL);
    assert_string_equal(last_log, "sva_method.finish is NULL");
    assert_null(p);
}

/* ---- calls that overlap, here one within the other */

static const char *beside; /* the call that comes while finish is under way */
static sv_status answered;

static sv_status call_beside(const sv_plugin *p) {
    const sv_format format = small_format();
    const sv_slab slab = {
        .size = sizeof slab, .slice_count = SLICES, .memory = volume, .bytes = sizeof volume};
    const sv_result result = {.size = sizeof result, .depth = depth};
    if (!strcmp(beside, "activate")) return p->activate(p, &format);
    if (!strcmp(beside, "begin")) return begin(p, NULL, 0);
    if (!strcmp(beside, "slab")) return p->slab(p, &slab);
    if (!strcmp(beside, "end")) return p->end(p, &result);
    if (!strcmp(beside, "adjust")) return p->adjust(p, NULL, 0, &result);
    if (!strcmp(beside, "deactivate")) p->deactivate(p);
    if (!strcmp(beside, "destroy")) p->destroy(p);
    return SV_ERR_STATE; /* of these two nobody hears but the log */
}

static sv_status disturbed_finish(sva *a, float *map) {
    answered = call_beside(&a->api);
    assert_int_equal(deactivated, 0);
    return on_finish(a, map);
}

/* What the log says of a volume of 128 x 128 x `slices` voxels, with its fan's lines from `face` mm (0:
 * none). */
static const char *doubt_of(const float mm[3], uint32_t slices, float face) {
    const sv_plugin *p = make(&own_method);
    sv_format f = plain_format(128, 128, slices, 1);
    sv_frame told = {.size = sizeof told, .probe_rotation = {1, 0, 0, 0, 1, 0, 0, 0, 1}};
    memcpy(f.spacing_mm, mm, sizeof f.spacing_mm);
    told.probe_side[2] = -1.0f;
    told.beams = face > 0.0f ? SV_BEAMS_FAN : SV_BEAMS_UNKNOWN;
    if (face > 0.0f) told.beam_apex_mm[2] = -0.5f * mm[2] - face;
    last_doubt[0] = '\0';
    assert_int_equal(p->activate(p, &f), SV_OK); /* a doubt is no error */
    assert_int_equal(p->begin(p, &told), SV_OK);
    static char first[sizeof last_doubt];
    memcpy(first, last_doubt, sizeof first);
    last_doubt[0] = '\0';
    assert_int_equal(p->begin(p, &told), SV_OK);
    assert_string_equal(last_doubt, ""); /* once */
    p->deactivate(p);
    p->destroy(p);
    return first;
}

static void lengths_of_no_scan_are_doubted(void **state) {
    static const struct {
        float mm[3], face;
        uint32_t slices;
        const char *told;
    } volumes[] = {
        {{0, 0, 0}, 0, 128, ""}, /* unknown */
        {{0.75f, 0.75f, 0.75f}, 0, 128, ""},
        {{0.00046875f, 0.00046875f, 0.00046875f},
         0,
         128,
         "activate: the volume is 0.06 mm wide: is its spacing in metres?"},
        {{0.075f, 0.075f, 0.075f},
         0,
         128,
         "activate: the volume is 9.6 mm wide: is its spacing in centimetres?"},
        {{4, 4, 4}, 0, 128, "activate: the volume is 512 mm wide: is its spacing right?"},
        {{0.75f, 0.75f, 0.05f},
         0,
         128,
         "activate: the volume is 96 mm wide and 6.4 mm along z: is the spacing right?"},
        {{0.75f, 0.75f, 18},
         0,
         12,
         "activate: one side of a voxel is 24 times as long as another: is the spacing right?"},
        {{0.75f, 0.75f, 0.75f}, 50, 128, ""},
        {{0.375f, 0.375f, 0.375f},
         25,
         128,
         "begin: the scan is 48 mm wide, and its lines meet 25 mm before the volume: is the spacing right?"},
        {{1.5f, 1.5f, 1.5f},
         120,
         128,
         "begin: the scan is 192 mm wide, and its lines meet 120 mm before the volume: is the spacing "
         "right?"},
        {{0.5f, 0.5f, 0.5f}, 11, 128, ""}, /* a probe within the body */
    };
    for (size_t n = 0; n < sizeof volumes / sizeof *volumes; n++)
        assert_string_equal(doubt_of(volumes[n].mm, volumes[n].slices, volumes[n].face), volumes[n].told);
}

static void calls_that_overlap(void **state) {
    static const char *const calls[] = {"activate", "begin",      "slab",   "end",
                                        "adjust",   "deactivate", "destroy"};
    sva_method method = own_method;
    method.finish = disturbed_finish;
    for (size_t n = 0; n < sizeof calls / sizeof *calls; n++) {
        const sv_plugin *p = make(&method);
        beside = calls[n];
        assert_int_equal(activate_at(p, NOWHERE), SV_OK);
        last_log[0] = '\0';
        assert_int_equal(frame(p), SV_OK);
        for (int i = 0; i < RAYS; i++) assert_true(depth[i] == 3.0f);
        assert_int_equal(answered, SV_ERR_STATE);
        const char *expected = "%s: comes while another call of this instance is under way";
        const int destroyed = !strcmp(beside, "destroy"); /* when the call has ended */
        if (!destroyed) assert_string_equal(last_log, unit_text(expected, beside));
        assert_int_equal(deactivated, destroyed);
        if (destroyed) continue;
        beside = "";
        assert_int_equal(frame(p), SV_OK);
        p->deactivate(p);
        p->destroy(p);
    }
}

UNIT_MAIN(NULL, NULL, a_method_that_fails, calls_that_overlap, parameters, voxels_and_ranges,
          where_the_probe_is, lengths_of_no_scan_are_doubted, wrong_tables)
