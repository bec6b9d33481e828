/* SPDX-License-Identifier: MIT */
/* Checks of what a plugin must refuse, and that it says why. */
#include "validate/checks/check.h"

/* ---- slabs */
static void still_good(v_rig *r, const char *after) {
    v_rig_expect(r, &r->good, "a good frame after %s", after);
}

/* `slab` as the second one of a frame is refused with `expected`; the frame is over then. */
static void refuse_slab(v_rig *r, const char *what, sv_slab slab, sv_status expected) {
    const sv_plugin *p = r->s.plugin;
    v_run *run = r->s.run;
    (void)v_begin(p, &r->stage, NULL, 0);
    (void)v_slab(p, &r->stage, 0);
    v_where(run, "slab with %s", what);
    sv_status status = p->slab(p, &slab);
    V_EXPECT(run, status == expected, "slab with %s: %s, expected %s", what, v_status(status),
             v_status(expected));
    status = v_slab(p, &r->stage, 1);
    V_EXPECT(run, status == SV_ERR_STATE,
             "a slab after a refused one: %s, expected SV_ERR_STATE: the frame is over", v_status(status));
    if (r->stage.device.queue) (void)clFinish(r->stage.device.queue);
    still_good(r, what);
}

void check_slab_refusals(v_run *run) {
    v_rig *r = v_rig_good(run);
    const sv_slab good = stage_slab(&r->stage, 1);
    sv_slab slab;
#define REFUSE(what, change, expected)                                                                       \
    slab = good;                                                                                             \
    change;                                                                                                  \
    refuse_slab(r, what, slab, expected)
    REFUSE("a slice that came before", slab.first_slice--, SV_ERR_SLAB_ORDER);
    REFUSE("a slice left out", slab.first_slice++, SV_ERR_SLAB_ORDER);
    REFUSE("no slices", slab.slice_count = 0, SV_ERR_SLAB_SHAPE);
    REFUSE("one slice more than max_slab_slices", slab.slice_count = r->stage.format.max_slab_slices + 1,
           SV_ERR_SLAB_SHAPE);
    REFUSE("2^32 - 1 slices", slab.slice_count = UINT32_MAX, SV_ERR_SLAB_SHAPE);
    REFUSE("one byte of memory", slab.bytes = 1, SV_ERR_SLAB_SHAPE);
    REFUSE("memory NULL", slab.memory = NULL, SV_ERR_SLAB_SHAPE);
#undef REFUSE
    const sv_plugin *p = r->s.plugin;
    (void)v_begin(p, &r->stage, NULL, 0);
    (void)v_slab(p, &r->stage, 0);
    const sv_status status = v_end(p, &r->stage);
    V_EXPECT(run, status == SV_ERR_SLAB_MISSING,
             "end after one of %u slabs: %s, expected SV_ERR_SLAB_MISSING", r->stage.slab_count,
             v_status(status));
    if (r->stage.device.queue) (void)clFinish(r->stage.device.queue);
    still_good(r, "an end that came too early");
}

/* ---- formats */
static void refuse_format(v_rig *r, const char *what, const sv_format *format) {
    const sv_plugin *p = r->s.plugin;
    v_run *run = r->s.run;
    v_where(run, "activate with %s", what);
    const sv_status status = p->activate(p, format);
    V_EXPECT(run, status < 0, "activate with %s: %s, expected an error", what, v_status(status));
    V_EXPECT(run, v_begin(p, &r->stage, NULL, 0) == SV_ERR_STATE,
             "after activate refused %s, the instance is not inactive", what);
}

/* Every change alone makes the format impossible or unknown. */
static void refuse_numbers(v_rig *r) {
    const sv_format good = r->stage.format;
    sv_format f;
#define TRY(field, value)                                                                                    \
    do {                                                                                                     \
        f = good;                                                                                            \
        f.field = (value);                                                                                   \
        refuse_format(r, #field " = " #value, &f);                                                           \
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

static void refuse_objects(v_rig *r) {
    sv_format f = r->stage.format;
    if (f.queue) {
        f.queue = NULL;
        refuse_format(r, "a context and no queue", &f);
        f = r->stage.format;
        f.context = NULL;
        refuse_format(r, "a queue and no context", &f);
    }
    f = r->stage.format;
    f.context = NULL;
    f.device = NULL;
    f.queue = NULL;
    f.carrier = SV_CARRIER_BUFFER;
    refuse_format(r, "buffers on an own queue", &f);
    const sv_param_value unknown = {.id = 0xfffffff0u};
    f = r->stage.format;
    f.values = &unknown;
    f.value_count = 1;
    refuse_format(r, "a parameter that nobody knows", &f);
}

void check_format_refusals(v_run *run) {
    v_rig *r = v_rig_good(run);
    v_deactivate(&r->s, r->s.plugin);
    r->stage.format.values = NULL;
    r->stage.format.value_count = 0;
    refuse_numbers(r);
    refuse_objects(r);
    v_activate(&r->s, r->s.plugin, &r->stage);
    still_good(r, "formats that were refused");
    sv_frame frame = stage_frame(&r->stage, NULL, 0);
    frame.flags = 0x80000000u;
    const sv_status status = r->s.plugin->begin(r->s.plugin, &frame);
    V_EXPECT(run, status < 0, "begin with flags 0x80000000: %s, expected an error", v_status(status));
}

/* ---- NULL */
static void refused(v_rig *r, const char *what, sv_status status, sv_status expected) {
    V_EXPECT(r->s.run, status == expected, "%s: %s, expected %s", what, v_status(status), v_status(expected));
    if (r->stage.device.queue) (void)clFinish(r->stage.device.queue);
}

void check_null_arguments(v_run *run) {
    v_rig *r = v_rig_good(run);
    const sv_plugin *p = r->s.plugin;
    sv_result result = stage_result(&r->stage);
#define NEEDED(what, call)                                                                                   \
    v_where(run, what);                                                                                      \
    refused(r, what, call, SV_ERR_ARGUMENT)
    v_deactivate(&r->s, p);
    NEEDED("activate with format NULL", p->activate(p, NULL));
    v_activate(&r->s, p, &r->stage);
    NEEDED("begin with frame NULL", p->begin(p, NULL));
    NEEDED("begin with 3 values at NULL", v_begin(p, &r->stage, NULL, 3));
    (void)v_begin(p, &r->stage, NULL, 0);
    NEEDED("slab with slab NULL", p->slab(p, NULL));
    (void)v_feed(p, &r->stage, NULL, 0);
    NEEDED("end with result NULL", p->end(p, NULL));
    (void)v_feed(p, &r->stage, NULL, 0);
    result.depth = NULL;
    result.depth_object = NULL;
    NEEDED("end without depth and depth_object", p->end(p, &result));
    still_good(r, "arguments that were NULL");
    NEEDED("adjust with result NULL", p->adjust(p, NULL, 0, NULL));
    still_good(r, "arguments that were NULL");
#undef NEEDED
}

/* ---- sizes */
static void too_short(v_rig *r, uint32_t size) {
    const sv_plugin *p = r->s.plugin;
    sv_frame frame = stage_frame(&r->stage, NULL, 0);
    sv_slab slab = stage_slab(&r->stage, 0);
    sv_result result = stage_result(&r->stage);
    v_where(r->s.run, "structs of %u bytes", size);
    frame.size = size < SV_FRAME_SIZE_1_0 ? size : SV_FRAME_SIZE_1_0 - 1;
    refused(r, "begin with a short sv_frame", p->begin(p, &frame), SV_ERR_SIZE);
    (void)v_begin(p, &r->stage, NULL, 0);
    slab.size = size < sizeof slab ? size : (uint32_t)sizeof slab - 1;
    refused(r, "slab with a short sv_slab", p->slab(p, &slab), SV_ERR_SIZE);
    (void)v_feed(p, &r->stage, NULL, 0);
    result.size = size < sizeof result ? size : (uint32_t)sizeof result - 1;
    refused(r, "end with a short sv_result", p->end(p, &result), SV_ERR_SIZE);
    (void)v_feed(p, &r->stage, NULL, 0);
    result.size = sizeof result;
    stage_poison(&r->stage, STAGE_POISON);
    result.stats->size = size < sizeof(sv_stats) ? size : (uint32_t)sizeof(sv_stats) - 1;
    refused(r, "end with short sv_stats", p->end(p, &result), SV_ERR_SIZE);
    still_good(r, "structs that were too short");
}

/* The struct as a host of a later minor has it: with bytes behind it that this plugin does not know. */
static void *later(v_run *run, const void *first, size_t bytes) {
    enum { MORE = 64 };
    const uint32_t size = (uint32_t)bytes + MORE;
    uint8_t *all = v_memory(run, size);
    memset(all, 0xff, size);
    memcpy(all, first, bytes);
    memcpy(all, &size, sizeof size); /* every struct begins with it */
    return all;
}

static void longer(v_rig *r) {
    const sv_plugin *p = r->s.plugin;
    v_run *run = r->s.run;
    const sv_frame frame = stage_frame(&r->stage, NULL, 0);
    const sv_result result = stage_result(&r->stage);
    v_deactivate(&r->s, p);
    v_where(run, "structs of a later minor");
    sv_status status = p->activate(p, later(run, &r->stage.format, sizeof r->stage.format));
    V_EXPECT(run, status >= 0, "activate refuses a longer sv_format: %s", v_status(status));
    status = p->begin(p, later(run, &frame, sizeof frame));
    V_EXPECT(run, status >= 0, "begin refuses a longer sv_frame: %s", v_status(status));
    for (uint32_t n = 0; n < r->stage.slab_count && status >= 0; n++) {
        const sv_slab slab = stage_slab(&r->stage, n);
        status = p->slab(p, later(run, &slab, sizeof slab));
        V_EXPECT(run, status >= 0, "slab refuses a longer sv_slab: %s", v_status(status));
    }
    stage_poison(&r->stage, STAGE_POISON);
    status = p->end(p, later(run, &result, sizeof result));
    V_EXPECT(run, status >= 0, "end refuses a longer sv_result: %s", v_status(status));
    const v_map map = v_collect(&r->stage, status);
    v_map_expect(run, &r->good, &map, "longer structs give another map");
}

void check_struct_sizes(v_run *run) {
    static const uint32_t sizes[] = {0, 1, 4, 8, UINT32_MAX};
    v_rig *r = v_rig_good(run);
    for (size_t i = 0; i < sizeof sizes / sizeof *sizes; i++) too_short(r, sizes[i]);
    longer(r);
    v_deactivate(&r->s, r->s.plugin);
    sv_format format = r->stage.format;
    format.size--;
    refused(r, "activate with a short sv_format", r->s.plugin->activate(r->s.plugin, &format), SV_ERR_SIZE);
    v_activate(&r->s, r->s.plugin, &r->stage);
}

/* ---- reasons */
static void has_reason(v_rig *r, const char *what, sv_status status) {
    const char *reason = r->s.plugin->last_error(r->s.plugin);
    V_EXPECT(r->s.run, reason, "last_error is NULL after %s", what);
    V_EXPECT(r->s.run, rule_is_text(reason, 4096),
             "last_error after %s is not UTF-8 without control characters", what);
    V_EXPECT(r->s.run, (status != SV_OK) == (reason[0] != '\0'), "last_error after %s (%s) is '%s'", what,
             v_status(status), reason);
}

void check_reasons(v_run *run) {
    v_rig *r = v_rig_good(run);
    const sv_plugin *p = r->s.plugin;
    const sv_param_value unknown = {.id = 0xfffffff0u};
    has_reason(r, "end", r->good.returned);
    has_reason(r, "activate while active", p->activate(p, &r->stage.format));
    has_reason(r, "begin with an unknown parameter", v_begin(p, &r->stage, &unknown, 1));
    has_reason(r, "begin", v_begin(p, &r->stage, NULL, 0));
    has_reason(r, "end without slabs", v_end(p, &r->stage));
    has_reason(r, "slab without begin", v_slab(p, &r->stage, 0));
    has_reason(r, "begin", v_begin(p, &r->stage, NULL, 0));
    has_reason(r, "slab", v_slab(p, &r->stage, 0));
    has_reason(r, "slab in the wrong order", v_slab(p, &r->stage, 0));
    has_reason(r, "adjust without a frame", v_adjust(p, &r->stage, NULL, 0));
    if (r->stage.device.queue) (void)clFinish(r->stage.device.queue);
    v_deactivate(&r->s, p);
    has_reason(r, "activate with format NULL", p->activate(p, NULL));
    v_activate(&r->s, p, &r->stage);
    has_reason(r, "activate", SV_OK);
}
