/* SPDX-License-Identifier: MIT */
/*
 * Calls of the plugin's ABI in any order with any numbers. Pointers are what the header asks for: where a
 * field says how much memory there is, so much is there. The input is a list of calls; a call's struct is a
 * right one of which some words are overwritten. A call of OpenCL may fail (fake_cl.h). Whatever comes, a
 * status is one of the header's, a failure has a reason, and a frame that came out well has a finite map.
 */
#include "fuzz/fake_cl.h"
#include "fuzz/fuzz_bytes.h"
#include "fuzz/fuzz_target.h"
#include "plugin/loader.h"
#include "smartvis/confidence.h"
#include "smartvis/points.h"
#include "smartvis/timing.h"
#include "smartvis_plugin.h"

#include <math.h>
#include <stdlib.h>

enum { WIDTH = 9, HEIGHT = 7, SLICES = 12, SLAB = 5, RAYS = WIDTH * HEIGHT, VOXELS = SLICES * RAYS };
enum { VALUES = 6, MAX_CALLS = 40, MAX_PITCH = 512 };

typedef struct {
    const sv_plugin *plugin;
    uint8_t *voxels; /* VOXELS bytes */
    sv_scanned scanned[RAYS];
    sv_param_value values[VALUES];
    uint32_t next_slice;
} machine;

static const sv_host host = {sizeof host, SV_ABI_MINOR, NULL, "fuzz", "1", NULL, NULL};

static const sv_format small_format = {.size = sizeof small_format,
                                       .width = WIDTH,
                                       .height = HEIGHT,
                                       .slices = SLICES,
                                       .max_slab_slices = SLAB,
                                       .voxel_type = SV_VOXEL_U8,
                                       .carrier = SV_CARRIER_HOST,
                                       .padding_value = SV_NO_PADDING,
                                       .tiles_x = 1,
                                       .tile_w = WIDTH,
                                       .tile_h = HEIGHT,
                                       .row_pitch = WIDTH,
                                       .spacing_mm = {1, 1, 1},
                                       .flags = SV_FORMAT_SCANNED};

/* What every call of [control] and [frame] keeps to. */
static sv_status checked(const sv_plugin *p, sv_status status) {
    FUZZ_HOLDS(hs_status_is_known(status));
    const char *reason = p->last_error(p);
    FUZZ_HOLDS(reason && (status == SV_OK) == (reason[0] == '\0'));
    return status;
}

/* Some of the plugin's parameters, mostly with values that they take. */
static uint32_t take_values(machine *m, fuzz_bytes *b) {
    const uint32_t count = fuzz_u8(b) % (VALUES + 1);
    for (uint32_t i = 0; i < count; i++) {
        sv_param_info info = {.size = sizeof info};
        const uint8_t choice = fuzz_u8(b);
        if (m->plugin->param_info(m->plugin, choice % m->plugin->param_count(m->plugin), &info) != SV_OK)
            abort();
        const double value = choice & 0x80
                                 ? fuzz_double(b)
                                 : info.min_value + (info.max_value - info.min_value) * fuzz_u8(b) / 255.0;
        m->values[i] = (sv_param_value){choice == 0x7f ? fuzz_u32(b) : info.id, choice == 0x7e, value};
    }
    return count;
}

static void call_activate(machine *m, fuzz_bytes *b) {
    sv_format format = small_format;
    format.values = m->values;
    format.value_count = take_values(m, b);
    /* Words before the OpenCL objects: those are addresses, which nobody can check. */
    fuzz_words(b, &format, offsetof(sv_format, context), fuzz_u8(b) % 4);
    if ((uint64_t)format.width * format.height * format.slices > 1u << 20)
        format.width = 0; /* right, but slow */
    const sv_status status = checked(m->plugin, m->plugin->activate(m->plugin, &format));
    /* Frames of another shape would need other memory than the machine has. */
    if (status >= SV_OK && memcmp(&format.width, &small_format.width, 4 * sizeof(uint32_t)) != 0)
        m->plugin->deactivate(m->plugin);
}

static void call_begin(machine *m, fuzz_bytes *b) {
    sv_frame frame = {.size = sizeof frame, .index = fuzz_u64(b), .values = m->values, .scanned = m->scanned};
    frame.value_count = take_values(m, b);
    fuzz_take(b, m->scanned, fuzz_u8(b) % (sizeof m->scanned + 1));
    fuzz_words(b, &frame, offsetof(sv_frame, values), fuzz_u8(b) % 3);
    fuzz_words(b, frame.probe_rotation, sizeof frame - offsetof(sv_frame, probe_rotation), fuzz_u8(b) % 3);
    if (fuzz_u8(b) & 1) frame.scanned = NULL;
    if (fuzz_u8(b) & 1) frame.values = NULL;
    if (checked(m->plugin, m->plugin->begin(m->plugin, &frame)) == SV_OK) m->next_slice = 0;
}

static void call_slab(machine *m, fuzz_bytes *b) {
    const uint32_t left = SLICES - m->next_slice;
    sv_slab slab = {
        .size = sizeof slab, .first_slice = m->next_slice, .slice_count = left < SLAB ? left : SLAB};
    fuzz_take(b, m->voxels, fuzz_u8(b) * 4u % (VOXELS + 1));
    fuzz_words(b, &slab, offsetof(sv_slab, memory), fuzz_u8(b) % 3);
    /* Exactly as long as said, so that a read behind it shows; it is free until the next end. */
    const uint64_t fair = (uint64_t)slab.slice_count * RAYS;
    slab.bytes = fuzz_u8(b) & 0x80 ? fuzz_u32(b) % VOXELS : fair;
    if (slab.bytes > VOXELS) slab.bytes = VOXELS;
    slab.memory = m->voxels + VOXELS - slab.bytes;
    if (checked(m->plugin, m->plugin->slab(m->plugin, &slab)) == SV_OK) m->next_slice += slab.slice_count;
}

/* A frame that came out well: the map is whole, and its notes are told in the same way everywhere. */
static void check_map(const sv_result *result, sv_status status) {
    const uint32_t pitch = (result->depth_pitch ? result->depth_pitch : WIDTH * 4) / 4;
    for (uint32_t i = 0; i < RAYS; i++) {
        const float d = result->depth[i / WIDTH * pitch + i % WIDTH];
        FUZZ_HOLDS(isfinite(d) && (status != SV_NO_SURFACE || d == 0.0f));
    }
    const sv_stats *stats = result->stats;
    FUZZ_HOLDS(!stats || stats->size < sizeof *stats || stats->outcome == status);
}

/* end or adjust, whose rules for results are the same. */
static void call_result(machine *m, fuzz_bytes *b, int adjust) {
    sv_stats stats = {.size = sizeof stats, .outcome = 77};
    sv_result result = {.size = sizeof result, .stats = &stats};
    result.depth_pitch = fuzz_u8(b) & 0x80 ? fuzz_u32(b) % (MAX_PITCH + 1) : 0;
    const uint32_t pitch = result.depth_pitch < WIDTH * 4 ? WIDTH * 4 : result.depth_pitch;
    const size_t bytes =
        (HEIGHT - 1) * pitch + WIDTH * 4; /* to the last pixel, and not to the end of its row */
    float *depth = malloc(bytes);
    uint8_t *points = malloc(RAYS);
    if (!depth || !points) abort();
    memset(depth, 0xff, bytes); /* NaN */
    result.depth = fuzz_u8(b) % 8 == 1 ? NULL : depth;
    result.status = fuzz_u8(b) % 8 == 1 ? NULL : points;
    if (fuzz_u8(b) % 8 == 1) result.stats = NULL;
    if (fuzz_u8(b) % 8 == 1) stats.size = fuzz_u8(b) % (sizeof stats + 1);
    if (fuzz_u8(b) % 8 == 1) result.size = fuzz_u32(b) % (sizeof result + 1);
    const uint32_t count = adjust ? take_values(m, b) : 0;
    const sv_plugin *p = m->plugin;
    const sv_status status =
        checked(p, adjust ? p->adjust(p, m->values, count, &result) : p->end(p, &result));
    if (status >= SV_OK) check_map(&result, status);
    free(points);
    free(depth);
}

/* [any]: parameters and texts. */
static void call_params(const machine *m, fuzz_bytes *b) {
    char text[40];
    sv_param_info info = {.size = fuzz_u8(b) & 1 ? fuzz_u32(b) % (sizeof info + 1) : sizeof info};
    FUZZ_HOLDS(hs_status_is_known(
        m->plugin->param_info(m->plugin, fuzz_u8(b) & 1 ? fuzz_u32(b) : fuzz_u8(b), &info)));
    const uint32_t bytes = fuzz_u8(b) % (sizeof text + 1), id = fuzz_u8(b);
    memset(text, 'x', sizeof text);
    const sv_status status = m->plugin->param_text(m->plugin, id, fuzz_double(b), text, bytes);
    FUZZ_HOLDS(hs_status_is_known(status) && (status < 0 || memchr(text, '\0', bytes)));
    for (uint32_t i = bytes; i < sizeof text; i++) FUZZ_HOLDS(text[i] == 'x');
}

static void call_extension(const machine *m, fuzz_bytes *b) {
    static const char *const ids[] = {SV_EXT_POINTS, SV_EXT_TIMING, SV_EXT_CONFIDENCE};
    char id[40];
    float map[RAYS];
    const sv_plugin *p = m->plugin;
    fuzz_take(b, id, sizeof id - 1);
    id[sizeof id - 1] = '\0';
    (void)p->get_extension(p, id);
    const uint8_t which = fuzz_u8(b) % 3;
    const void *table = p->get_extension(p, ids[which]);
    FUZZ_HOLDS(table);
    sv_points_report points = {.size = fuzz_u8(b) % (sizeof points + 1)};
    sv_stage_times times = {.size = fuzz_u8(b) % (sizeof times + 1)};
    sv_confidence_report report = {.size = fuzz_u8(b) % (sizeof report + 1)};
    if (which == 0) (void)checked(p, ((const sv_ext_points *)table)->write(p, &points));
    if (which == 1) {
        (void)checked(p, ((const sv_ext_timing *)table)->enable(p, fuzz_u8(b)));
        (void)checked(p, ((const sv_ext_timing *)table)->stage_times(p, &times));
    }
    if (which == 2) {
        const sv_ext_confidence *confidence = table;
        (void)checked(p, confidence->read(p, fuzz_u8(b) & 1 ? map : NULL, fuzz_u8(b) & 1 ? &report : NULL));
        (void)checked(p, confidence->write(p, fuzz_u8(b) & 1 ? map : NULL, NULL, fuzz_u64(b)));
    }
}

/* Creation with any id: an instance or nothing. */
static void call_create(fuzz_bytes *b) {
    char id[40];
    const sv_plugin *p = (const sv_plugin *)&host;
    fuzz_take(b, id, sizeof id - 1);
    id[sizeof id - 1] = '\0';
    const sv_status status = smartvis_plugin_entry.create(&host, id, &p);
    FUZZ_HOLDS(hs_status_is_known(status) && (status == SV_OK) == (p != NULL));
    if (p) p->destroy(p);
}

static void one_call(machine *m, fuzz_bytes *b) {
    switch (fuzz_u8(b) % 16) {
    case 0:
        call_activate(m, b);
        break;
    case 1:
        m->plugin->deactivate(m->plugin);
        break;
    case 2:
        call_params(m, b);
        break;
    case 3:
        call_extension(m, b);
        break;
    case 4:
        call_create(b);
        break;
    case 5:
    case 6:
        call_begin(m, b);
        break;
    case 7:
        call_result(m, b, 1);
        break;
    case 8:
    case 9:
        call_result(m, b, 0);
        break;
    default:
        call_slab(m, b);
    }
}

/* Activation takes longer than all else, so one instance stays active from input to input. */
static const sv_plugin *standing(void) {
    static const sv_plugin *plugin;
    if (plugin) return plugin;
    if (smartvis_plugin_entry.create(&host, smartvis_plugin_entry.descriptor(0)->id, &plugin) != SV_OK)
        abort();
    if (plugin->activate(plugin, &small_format) != SV_OK) {
        fuzz_broken(__FILE__, __LINE__, plugin->last_error(plugin));
    }
    return plugin;
}

/* Ends a frame that is under way: its slabs must stay until then. */
static void end_frame(const sv_plugin *p) {
    static float depth[RAYS];
    const sv_result result = {.size = sizeof result, .depth = depth};
    (void)checked(p, p->end(p, &result));
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    fuzz_bytes b = {data, size};
    static machine m;
    const uint8_t head = fuzz_u8(&b);
    const int fresh = head % 16 == 15;
    memset(&m, 0, sizeof m);
    m.voxels = calloc(VOXELS, 1);
    if (!m.voxels) abort();
    m.plugin = standing();
    if (fresh && smartvis_plugin_entry.create(&host, m.plugin->descriptor->id, &m.plugin) != SV_OK) abort();
    fake_cl_fail(head / 16); /* of the first calls one, or none */
    for (int i = 0; i < MAX_CALLS && b.left > 0; i++) {
        /* Only a fresh instance leaves its state: the standing one is for frames. */
        if (!fresh && b.at[0] % 16 < 2) {
            (void)fuzz_u8(&b);
            continue;
        }
        one_call(&m, &b);
    }
    fake_cl_fail(0);
    end_frame(m.plugin);
    if (fresh) m.plugin->destroy(m.plugin);
    free(m.voxels);
    return 0;
}
