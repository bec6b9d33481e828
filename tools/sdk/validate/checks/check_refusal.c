/* SPDX-License-Identifier: MIT */
/* Checks of what a plugin must refuse, and that it says why. */
#include "validate/checks/check.h"

/* ---- slabs */
typedef struct {
    v_rig r;
    v_map good;
} place;

static void open_place(v_run *run, place *at) {
    memset(at, 0, sizeof *at);
    v_rig_standard(run, &at->r);
    v_frame(&at->r.s, at->r.s.plugin, &at->r.stage, NULL, 0, &at->good);
}

/* A good frame, which is the same as ever. */
static void still_good(place *at, const char *after) {
    v_map map;
    const sv_status status = v_try_frame(at->r.s.plugin, &at->r.stage, NULL, 0, &map);
    V_EXPECT(at->r.s.run, status >= 0, "a good frame after %s: %s: %s: %s", after, at->r.s.run->report->where,
             v_status(status), at->r.s.plugin->last_error(at->r.s.plugin));
    v_map_expect(at->r.s.run, &at->good, &map, "a good frame after %s is another one", after);
}

static void close_place(place *at) {
    v_map_free(&at->good);
    v_rig_close(&at->r);
}

/* `slab` as the second one of a frame is refused with `expected`; the frame is over then. */
static void refuse_slab(place *at, const char *what, sv_slab slab, sv_status expected) {
    const sv_plugin *p = at->r.s.plugin;
    v_run *run = at->r.s.run;
    (void)v_begin(p, &at->r.stage, NULL, 0);
    (void)v_slab(p, &at->r.stage, 0);
    v_where(run, "slab with %s", what);
    sv_status status = p->slab(p, &slab);
    V_EXPECT(run, status == expected, "slab with %s: %s, expected %s", what, v_status(status),
             v_status(expected));
    status = v_slab(p, &at->r.stage, 1);
    V_EXPECT(run, status == SV_ERR_STATE,
             "a slab after a refused one: %s, expected SV_ERR_STATE: the frame is over", v_status(status));
    if (at->r.stage.device.queue) (void)clFinish(at->r.stage.device.queue);
    still_good(at, what);
}

void check_slab_refusals(v_run *run) {
    place at;
    open_place(run, &at);
    const sv_slab good = stage_slab(&at.r.stage, 1);
    sv_slab slab = good;
    slab.first_slice--;
    refuse_slab(&at, "a slice that came before", slab, SV_ERR_SLAB_ORDER);
    slab.first_slice = good.first_slice + 1;
    refuse_slab(&at, "a slice left out", slab, SV_ERR_SLAB_ORDER);
    slab = good;
    slab.slice_count = 0;
    refuse_slab(&at, "no slices", slab, SV_ERR_SLAB_SHAPE);
    slab.slice_count = at.r.stage.format.max_slab_slices + 1;
    refuse_slab(&at, "one slice more than max_slab_slices", slab, SV_ERR_SLAB_SHAPE);
    slab.slice_count = UINT32_MAX;
    refuse_slab(&at, "2^32 - 1 slices", slab, SV_ERR_SLAB_SHAPE);
    slab = good;
    slab.bytes = 1;
    refuse_slab(&at, "one byte of memory", slab, SV_ERR_SLAB_SHAPE);
    slab = good;
    slab.memory = NULL;
    refuse_slab(&at, "memory NULL", slab, SV_ERR_SLAB_SHAPE);
    const sv_plugin *p = at.r.s.plugin;
    (void)v_begin(p, &at.r.stage, NULL, 0);
    (void)v_slab(p, &at.r.stage, 0);
    const sv_status status = v_end(p, &at.r.stage);
    V_EXPECT(run, status == SV_ERR_SLAB_MISSING,
             "end after one of %u slabs: %s, expected SV_ERR_SLAB_MISSING", at.r.stage.slab_count,
             v_status(status));
    if (at.r.stage.device.queue) (void)clFinish(at.r.stage.device.queue);
    still_good(&at, "an end that came too early");
    close_place(&at);
}

/* ---- formats */
static void refuse_format(place *at, const char *what, const sv_format *format) {
    const sv_plugin *p = at->r.s.plugin;
    v_run *run = at->r.s.run;
    v_where(run, "activate with %s", what);
    const sv_status status = p->activate(p, format);
    V_EXPECT(run, status < 0, "activate with %s: %s, expected an error", what, v_status(status));
    V_EXPECT(run, v_begin(p, &at->r.stage, NULL, 0) == SV_ERR_STATE,
             "after activate refused %s, the instance is not inactive", what);
}

/* Every change alone makes the format impossible or unknown. */
static void refuse_numbers(place *at) {
    const sv_format good = at->r.stage.format;
    sv_format f;
#define TRY(field, value)                                                                                    \
    do {                                                                                                     \
        f = good;                                                                                            \
        f.field = (value);                                                                                   \
        refuse_format(at, #field " = " #value, &f);                                                          \
    } while (0)
    TRY(width, 0);
    TRY(width, 8193);
    TRY(width, UINT32_MAX);
    TRY(height, 0);
    TRY(height, 8193);
    TRY(slices, 0);
    TRY(slices, 8193);
    TRY(max_slab_slices, 0);
    TRY(max_slab_slices, good.slices + 1);
    TRY(voxel_type, 0);
    TRY(voxel_type, 77);
    TRY(carrier, 0);
    TRY(carrier, 77);
    TRY(padding_value, -2);
    TRY(padding_value, 256);
    TRY(tiles_x, 0);
    TRY(tiles_x, 8193);
    TRY(tile_w, good.width - 1);
    TRY(tile_w, 16385);
    TRY(tile_h, good.height - 1);
    TRY(row_pitch, good.tiles_x * good.tile_w - 1);
    TRY(spacing_mm[0], 1.0f); /* the others are 0 */
    TRY(spacing_mm[1], NAN);
    TRY(spacing_mm[2], -1.0f);
    TRY(flags, good.flags | 0x80000000u);
    TRY(value_count, 3);
    TRY(size, 4);
#undef TRY
}

static void refuse_objects(place *at) {
    sv_format f = at->r.stage.format;
    if (f.queue) {
        f.queue = NULL;
        refuse_format(at, "a context and no queue", &f);
        f = at->r.stage.format;
        f.context = NULL;
        refuse_format(at, "a queue and no context", &f);
    }
    f = at->r.stage.format;
    f.context = NULL;
    f.device = NULL;
    f.queue = NULL;
    f.carrier = SV_CARRIER_BUFFER;
    refuse_format(at, "buffers on an own queue", &f);
    const sv_param_value unknown = {.id = 0xfffffff0u};
    f = at->r.stage.format;
    f.values = &unknown;
    f.value_count = 1;
    refuse_format(at, "a parameter that nobody knows", &f);
}

void check_format_refusals(v_run *run) {
    place at;
    open_place(run, &at);
    v_deactivate(&at.r.s, at.r.s.plugin);
    at.r.stage.format.values = NULL;
    at.r.stage.format.value_count = 0;
    refuse_numbers(&at);
    refuse_objects(&at);
    v_activate(&at.r.s, at.r.s.plugin, &at.r.stage);
    still_good(&at, "formats that were refused");
    sv_frame frame = stage_frame(&at.r.stage, NULL, 0);
    frame.flags = 0x80000000u;
    const sv_status status = at.r.s.plugin->begin(at.r.s.plugin, &frame);
    V_EXPECT(run, status < 0, "begin with flags 0x80000000: %s, expected an error", v_status(status));
    close_place(&at);
}

/* ---- NULL */
static void refused(place *at, const char *what, sv_status status, sv_status expected) {
    V_EXPECT(at->r.s.run, status == expected, "%s: %s, expected %s", what, v_status(status),
             v_status(expected));
    if (at->r.stage.device.queue) (void)clFinish(at->r.stage.device.queue);
}

/* begin and all slabs. */
static void complete(place *at) {
    (void)v_begin(at->r.s.plugin, &at->r.stage, NULL, 0);
    for (uint32_t n = 0; n < at->r.stage.slab_count; n++) (void)v_slab(at->r.s.plugin, &at->r.stage, n);
}

void check_null_arguments(v_run *run) {
    place at;
    open_place(run, &at);
    const sv_plugin *p = at.r.s.plugin;
    sv_result result = stage_result(&at.r.stage);
#define NEEDED(what, call)                                                                                   \
    v_where(run, what);                                                                                      \
    refused(&at, what, call, SV_ERR_ARGUMENT)
    v_deactivate(&at.r.s, p);
    NEEDED("activate with format NULL", p->activate(p, NULL));
    v_activate(&at.r.s, p, &at.r.stage);
    NEEDED("begin with frame NULL", p->begin(p, NULL));
    NEEDED("begin with 3 values at NULL", v_begin(p, &at.r.stage, NULL, 3));
    (void)v_begin(p, &at.r.stage, NULL, 0);
    NEEDED("slab with slab NULL", p->slab(p, NULL));
    complete(&at);
    NEEDED("end with result NULL", p->end(p, NULL));
    complete(&at);
    result.depth = NULL;
    result.depth_object = NULL;
    NEEDED("end without depth and depth_object", p->end(p, &result));
    still_good(&at, "arguments that were NULL");
    NEEDED("adjust with result NULL", p->adjust(p, NULL, 0, NULL));
    still_good(&at, "arguments that were NULL");
#undef NEEDED
    close_place(&at);
}

/* ---- sizes */
static void too_short(place *at, uint32_t size) {
    const sv_plugin *p = at->r.s.plugin;
    sv_frame frame = stage_frame(&at->r.stage, NULL, 0);
    sv_slab slab = stage_slab(&at->r.stage, 0);
    sv_result result = stage_result(&at->r.stage);
    v_where(at->r.s.run, "structs of %u bytes", size);
    frame.size = size < SV_FRAME_SIZE_1_0 ? size : SV_FRAME_SIZE_1_0 - 1;
    refused(at, "begin with a short sv_frame", p->begin(p, &frame), SV_ERR_SIZE);
    (void)v_begin(p, &at->r.stage, NULL, 0);
    slab.size = size < sizeof slab ? size : (uint32_t)sizeof slab - 1;
    refused(at, "slab with a short sv_slab", p->slab(p, &slab), SV_ERR_SIZE);
    complete(at);
    result.size = size < sizeof result ? size : (uint32_t)sizeof result - 1;
    refused(at, "end with a short sv_result", p->end(p, &result), SV_ERR_SIZE);
    complete(at);
    result.size = sizeof result;
    stage_poison(&at->r.stage, STAGE_POISON);
    result.stats->size = size < sizeof(sv_stats) ? size : (uint32_t)sizeof(sv_stats) - 1;
    refused(at, "end with short sv_stats", p->end(p, &result), SV_ERR_SIZE);
    still_good(at, "structs that were too short");
}

/* A host of a later minor: its structs are longer, and hold what this plugin does not know. */
static void longer(place *at) {
    struct {
        sv_format format;
        uint8_t more[64];
    } f;
    struct {
        sv_frame frame;
        uint8_t more[64];
    } fr;
    struct {
        sv_result result;
        uint8_t more[64];
    } re;
    const sv_plugin *p = at->r.s.plugin;
    v_run *run = at->r.s.run;
    memset(f.more, 0xff, sizeof f.more);
    memset(fr.more, 0xff, sizeof fr.more);
    memset(re.more, 0xff, sizeof re.more);
    f.format = at->r.stage.format;
    f.format.size = sizeof f;
    fr.frame = stage_frame(&at->r.stage, NULL, 0);
    fr.frame.size = sizeof fr;
    re.result = stage_result(&at->r.stage);
    re.result.size = sizeof re;
    v_deactivate(&at->r.s, p);
    v_where(run, "structs of a later minor");
    sv_status status = p->activate(p, &f.format);
    V_EXPECT(run, status >= 0, "activate refuses a longer sv_format: %s", v_status(status));
    status = p->begin(p, &fr.frame);
    V_EXPECT(run, status >= 0, "begin refuses a longer sv_frame: %s", v_status(status));
    for (uint32_t n = 0; n < at->r.stage.slab_count && status >= 0; n++) {
        struct {
            sv_slab slab;
            uint8_t more[64];
        } sl;
        memset(sl.more, 0xff, sizeof sl.more);
        sl.slab = stage_slab(&at->r.stage, n);
        sl.slab.size = sizeof sl;
        status = p->slab(p, &sl.slab);
        V_EXPECT(run, status >= 0, "slab refuses a longer sv_slab: %s", v_status(status));
    }
    stage_poison(&at->r.stage, STAGE_POISON);
    status = p->end(p, &re.result);
    V_EXPECT(run, status >= 0, "end refuses a longer sv_result: %s", v_status(status));
    v_map map;
    v_collect(&at->r.stage, status, &map);
    v_map_expect(run, &at->good, &map, "longer structs give another map");
}

void check_struct_sizes(v_run *run) {
    static const uint32_t sizes[] = {0, 1, 4, 8, UINT32_MAX};
    place at;
    open_place(run, &at);
    for (size_t i = 0; i < sizeof sizes / sizeof *sizes; i++) too_short(&at, sizes[i]);
    longer(&at);
    v_deactivate(&at.r.s, at.r.s.plugin);
    sv_format format = at.r.stage.format;
    format.size--;
    refused(&at, "activate with a short sv_format", at.r.s.plugin->activate(at.r.s.plugin, &format),
            SV_ERR_SIZE);
    v_activate(&at.r.s, at.r.s.plugin, &at.r.stage);
    close_place(&at);
}

/* ---- reasons */
static void has_reason(place *at, const char *what, sv_status status) {
    const char *reason = at->r.s.plugin->last_error(at->r.s.plugin);
    V_EXPECT(at->r.s.run, reason, "last_error is NULL after %s", what);
    V_EXPECT(at->r.s.run, rule_is_text(reason, 4096),
             "last_error after %s is not UTF-8 without control characters", what);
    V_EXPECT(at->r.s.run, (status != SV_OK) == (reason[0] != '\0'), "last_error after %s (%s) is '%s'", what,
             v_status(status), reason);
}

void check_reasons(v_run *run) {
    place at;
    open_place(run, &at);
    const sv_plugin *p = at.r.s.plugin;
    const sv_param_value unknown = {.id = 0xfffffff0u};
    has_reason(&at, "end", at.good.returned);
    has_reason(&at, "activate while active", p->activate(p, &at.r.stage.format));
    has_reason(&at, "begin with an unknown parameter", v_begin(p, &at.r.stage, &unknown, 1));
    has_reason(&at, "begin", v_begin(p, &at.r.stage, NULL, 0));
    has_reason(&at, "end without slabs", v_end(p, &at.r.stage));
    has_reason(&at, "slab without begin", v_slab(p, &at.r.stage, 0));
    has_reason(&at, "begin", v_begin(p, &at.r.stage, NULL, 0));
    has_reason(&at, "slab", v_slab(p, &at.r.stage, 0));
    has_reason(&at, "slab in the wrong order", v_slab(p, &at.r.stage, 0));
    has_reason(&at, "adjust without a frame", v_adjust(p, &at.r.stage, NULL, 0));
    if (at.r.stage.device.queue) (void)clFinish(at.r.stage.device.queue);
    v_deactivate(&at.r.s, p);
    has_reason(&at, "activate with format NULL", p->activate(p, NULL));
    v_activate(&at.r.s, p, &at.r.stage);
    has_reason(&at, "activate", SV_OK);
    close_place(&at);
}
