/* SPDX-License-Identifier: MIT */
/* Wrong plugins: maps, outcomes, statistics, and what they do with the host's memory. */
#include "wrong_base.h"

#include <math.h>

static sv_status begin(const sv_plugin *plugin, const sv_frame *frame) {
    sv_frame f;
    const int whole = frame && frame->size >= SV_FRAME_SIZE_1_0;
    if (whole) memcpy(&f, frame, frame->size < sizeof f ? frame->size : sizeof f);
    if (whole && WRONG_IS(takes_any_probe)) f.size = SV_FRAME_SIZE_1_0;
    if (whole && WRONG_IS(reads_past_frame) && frame->size == SV_FRAME_SIZE_1_0) {
        f = *frame;
        f.size = sizeof f;
    }
    const sv_status status = sva_begin(plugin, whole ? &f : frame);
    if (status != SV_OK) return status;
    if (WRONG_IS(begin_77)) return 77;
    if (WRONG_IS(begin_partial)) return SV_PARTIAL;
    if (WRONG_IS(writes_into_ranges) && frame->scanned) ((sv_scanned *)(uintptr_t)frame->scanned)->end = 0;
    return status;
}

/* ---- slabs */
static uint32_t slabs_of_frame, hatched; /* of one frame; the tests of these run one instance at a time */

static void look_at_padding(const sva *a, const uint8_t *texture) {
    const sv_format *f = &a->format;
    if (f->tile_w > f->width) hatched += texture[f->width];
}

static sv_status slab(const sv_plugin *plugin, const sv_slab *s) {
    sva *a = wrong_self(plugin);
    const sv_status status = sva_slab(plugin, s);
    if (status != SV_OK) return status;
    if (s->first_slice == 0) slabs_of_frame = hatched = 0;
    slabs_of_frame++;
    const volatile uint8_t *bytes = (const uint8_t *)s->memory;
    if (WRONG_IS(slab_1)) return SV_NO_SURFACE;
    if (WRONG_IS(writes_into_slab)) *(uint8_t *)(uintptr_t)s->memory ^= 1;
    if (WRONG_IS(reads_past_slab)) (void)bytes[s->bytes + 64];
    if (WRONG_IS(reads_padding)) look_at_padding(a, (const uint8_t *)s->memory);
    return status;
}

/* ---- maps */
static void spoil_depths(const sva *a, const sv_result *r) {
    static uint32_t calls;
    static float before[4096];
    const size_t rays = sva_rays(a);
    const uint32_t width = a->format.width;
    const int plain = r->depth_pitch == 0 || r->depth_pitch == width * sizeof(float);
    if (WRONG_IS(depth_nan)) r->depth[0] = NAN;
    if (WRONG_IS(depth_infinite)) r->depth[0] = -INFINITY;
    if (WRONG_IS(depth_far)) r->depth[0] = 2.5f * (float)a->format.slices + 1.0f;
    if (WRONG_IS(depth_1e30) && plain)
        for (size_t i = 0; i < rays; i++) r->depth[i] = 1e30f;
    if (WRONG_IS(another_map_every_time)) r->depth[0] = (float)(calls++ % 2);
    if (WRONG_IS(depends_on_slabs)) r->depth[0] = 1.0f / (float)slabs_of_frame;
    if (WRONG_IS(reads_padding)) r->depth[0] = (float)(hatched % 7) * 0.125f;
    if (WRONG_IS(writes_past_map)) {
        const size_t pitch = r->depth_pitch ? r->depth_pitch / sizeof(float) : width;
        r->depth[(a->format.height - 1) * pitch + width] = 0.5f;
    }
    if (WRONG_IS(writes_between_rows) && !plain)
        r->depth[(a->format.height - 2) * (r->depth_pitch / sizeof(float)) + width] = 0.5f;
    if (WRONG_IS(remembers_frames) && plain && rays <= 4096)
        for (size_t i = 0; i < rays; i++) {
            const float now = r->depth[i];
            r->depth[i] = 0.5f * (now + before[i]);
            before[i] = now;
        }
}

static void spoil_rest(const sva *a, const sv_result *r) {
    sv_stats *s = r->stats;
    if (WRONG_IS(status_map_garbage) && r->status) r->status[0] = 9;
    if (!s) return;
    if (WRONG_IS(rays_wrong)) s->rays = 1;
    if (WRONG_IS(points_unmarked)) s->points++;
    if (WRONG_IS(unfilled_too_many)) s->unfilled = s->rays + 1;
    if (WRONG_IS(stats_size_changed)) s->size = 4;
    if (WRONG_IS(writes_past_stats)) memset(s + 1, 0, 4);
    if (WRONG_IS(outcome_negative)) s->outcome = -77;
    if (WRONG_IS(outcomes_differ)) s->outcome = SV_PARTIAL;
    if (WRONG_IS(end_77)) s->outcome = 77;
    if (WRONG_IS(depths_without_surface)) {
        s->outcome = SV_NO_SURFACE;
        s->unfilled = (uint32_t)sva_rays(a);
    }
}

/* The results as the host gave them, but for those that this plugin does not write. */
static sv_status give_less(const sv_plugin *plugin, const sv_result *r) {
    sva *a = wrong_self(plugin);
    const size_t row = a->format.width * sizeof(float);
    const size_t pitch = r->depth_pitch ? r->depth_pitch : row;
    float *rows = (float *)malloc(sva_rays(a) * sizeof(float));
    sv_result less = *r;
    if (!rows) return SV_ERR_NO_MEMORY;
    less.depth = rows;
    less.depth_pitch = 0;
    const sv_status status = sva_end(plugin, &less);
    for (size_t y = 0; WRONG_IS(last_row_missing) && y + 1 < a->format.height; y++)
        memcpy((char *)r->depth + y * pitch, rows + y * a->format.width, row);
    free(rows);
    return status;
}

static void divide_by_width(const sva *a) {
    volatile uint32_t columns = a->format.width - 1;
    if (columns == 0) wrong_crash();
}

static sv_status end(const sv_plugin *plugin, const sv_result *r) {
    sva *a = wrong_self(plugin);
    const int usable = r && r->size >= sizeof *r && r->depth && a->state == SVA_SLABS;
    if (usable && WRONG_IS(crash_on_one_pixel)) divide_by_width(a);
    if (usable && WRONG_IS(end_minus_77)) return sva_error(a, -77, "end: an error of a number of its own");
    if (usable && (WRONG_IS(map_not_written) || WRONG_IS(last_row_missing))) return give_less(plugin, r);
    if (usable && WRONG_IS(ignores_pitch)) {
        sv_result narrow = *r;
        narrow.depth_pitch = 0;
        return sva_end(plugin, &narrow);
    }
    const sv_status status = sva_end(plugin, r);
    if (WRONG_IS(crash_on_black) && status == SV_NO_SURFACE) wrong_crash();
    if (status < 0 || !usable) return status;
    spoil_depths(a, r);
    spoil_rest(a, r);
    if (WRONG_IS(end_77)) return 77;
    return WRONG_IS(depths_without_surface) ? SV_NO_SURFACE : status;
}

/* ---- confidence */
static uint32_t confidence_offered(const sv_plugin *plugin) {
    return wrong_self(plugin)->state != SVA_INACTIVE;
}

static sv_status confidence_read(const sv_plugin *plugin, float *map, sv_confidence_report *out) {
    sva *a = wrong_self(plugin);
    const size_t rays = sva_rays(a);
    if (a->state != SVA_FINISHED) return sva_wrong_state(a, "confidence");
    for (size_t i = 0; map && i < rays; i++) map[i] = a->points[i] == SV_POINT_INITIAL ? 0.75f : 0.0f;
    if (map && WRONG_IS(confidence_above)) map[0] = 1.001f;
    if (map && WRONG_IS(confidence_nan)) map[rays / 2] = NAN;
    if (out) {
        const sv_confidence_report report = {
            .size = out->size, .fluid_threshold = 0.2f, .rays = (uint32_t)rays, .open_rays = (uint32_t)rays};
        *out = report;
    }
    a->reason[0] = '\0';
    return SV_OK;
}

static sv_status confidence_write(const sv_plugin *plugin, float *map, struct _cl_mem *object,
                                  uint64_t offset) {
    if (!map || object) return sva_error(wrong_self(plugin), SV_ERR_ARGUMENT, "write: no map");
    return confidence_read(plugin, map, NULL);
}

static const sv_ext_confidence confidence = {.size = sizeof confidence,
                                             .read = confidence_read,
                                             .offered = confidence_offered,
                                             .write = confidence_write};

static const void *extension(const sv_plugin *plugin, const char *id) {
    return id && strcmp(id, SV_EXT_CONFIDENCE) == 0 ? &confidence : NULL;
}

static const char *const extensions[] = {SV_EXT_CONFIDENCE, NULL};
static const sv_descriptor descriptor = {.size = sizeof descriptor,
                                         .carriers = SV_BIT(SV_CARRIER_HOST),
                                         .id = "org.smartvis.test.wrong",
                                         .name = "Wrong",
                                         .vendor = "SmartVis tests",
                                         .version = "1.0.0",
                                         .summary = "A plugin for tests that is wrong in one way at most.",
                                         .voxel_types = SV_BIT(SV_VOXEL_U8),
                                         .queues = SV_QUEUE_OWN,
                                         .features = WRONG_FEATURES,
                                         .extensions = extensions};
static const sva_method method = {.descriptor = &descriptor,
                                  .params = wrong_params,
                                  .param_count = PARAMS,
                                  .ray_bytes = sizeof(wrong_edge),
                                  .finish = wrong_find,
                                  .adjust = wrong_place};

static void misbehave(sv_plugin *api) {
    api->begin = begin;
    api->slab = slab;
    api->end = end;
    api->get_extension = extension;
}
WRONG_ENTRY(method, misbehave);
