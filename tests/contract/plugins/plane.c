/* SPDX-License-Identifier: MIT */
/*
 * A small whole plugin whose depthmap is a plane, whatever the volume holds. It fails where it is told to,
 * and CMakeLists.txt compiles variants of it that no host may accept:
 *
 *   TP_ABI_MAJOR     the entry's ABI major
 *   TP_ENTRY_SIZE    the entry's size
 *   TP_CREATE        what create returns
 *   TP_SLAB          the instance's slab
 *   TP_BEGIN         what begin returns: a note changes nothing
 *   TP_PARTIAL       the right half of the map has no surface: SV_PARTIAL
 *   TP_CONFIDENCE    with smartvis.confidence/1, from 0 at the left to 1 at the right; TP_SURE_... says how
 */
#include "smartvis/confidence.h"

#include <CL/cl.h>
#include <math.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#ifndef TP_ABI_MAJOR
#define TP_ABI_MAJOR SV_ABI_MAJOR
#endif
#ifndef TP_ENTRY_SIZE
#define TP_ENTRY_SIZE sizeof(sv_entry)
#endif
#ifndef TP_CREATE
#define TP_CREATE SV_OK
#endif
#ifndef TP_SLAB
#define TP_SLAB plane_slab
#endif

#ifndef TP_BEGIN
#define TP_BEGIN SV_OK
#endif
#ifdef TP_PARTIAL
enum { HALF = 2, FOUND = SV_PARTIAL };
#else
enum { HALF = 1, FOUND = SV_OK };
#endif

enum { PARAM_DEPTH = 1, PARAM_SHAPE, PARAM_FAIL, PARAM_EVERY, PARAM_NOTE, PARAM_COUNT = 5 };
enum { FAIL_NONE, FAIL_ACTIVATE, FAIL_BEGIN, FAIL_SLAB, FAIL_END };

static const sv_param_info infos[PARAM_COUNT] = {
    {.id = PARAM_DEPTH,
     .type = SV_PARAM_FLOAT,
     .flags = SV_PARAM_PRIMARY,
     .key = "depth",
     .label = "Depth",
     .unit = "slices",
     .help = "Where the plane lies at x = 0.",
     .min_value = -1e4,
     .max_value = 1e4,
     .display_max = 100,
     .step = 0.5},
    {.id = PARAM_SHAPE,
     .type = SV_PARAM_ENUM,
     .flags = SV_PARAM_EXPERT | SV_PARAM_REACTIVATE,
     .key = "shape",
     .label = "Shape",
     .unit = "",
     .help = "tilted goes one slice deeper per pixel in x.",
     .max_value = 1,
     .display_max = 1,
     .step = 1},
    {.id = PARAM_FAIL,
     .type = SV_PARAM_ENUM,
     .flags = SV_PARAM_REACTIVATE,
     .key = "fail",
     .label = "Failing call",
     .unit = "",
     .help = "The call that fails on purpose; slab is the second of a frame.",
     .max_value = FAIL_END,
     .display_max = FAIL_END,
     .step = 1},
    {.id = PARAM_EVERY,
     .type = SV_PARAM_INT,
     .key = "every",
     .label = "Failing frames",
     .unit = "frames",
     .help = "Only frames whose index is a multiple of this fail.",
     .min_value = 1,
     .max_value = 63,
     .display_min = 1,
     .display_max = 63,
     .default_value = 1,
     .step = 2},
    {.id = PARAM_NOTE,
     .type = SV_PARAM_BOOL,
     .key = "note",
     .label = "Note",
     .unit = "",
     .help = "Comes out as SV_NO_SURFACE, with the plane in the map all the same: a host must not use it.",
     .max_value = 1,
     .display_max = 1,
     .step = 1}};

typedef struct {
    sv_plugin api;
    sv_format format;
    double fixed[PARAM_COUNT + 1];  /* parameter values by id, as at activate */
    double values[PARAM_COUNT + 1]; /* of the frame under way */
    uint64_t frame;
    uint32_t next_slice;
    float *map;  /* width * height; the host's queue copies from here */
    float *sure; /* the same for the confidence */
    char reason[160];
} plane;

static const sv_descriptor descriptor = {.size = sizeof(sv_descriptor),
                                         .id = "org.smartvis.test.plane",
                                         .name = "Plane",
                                         .vendor = "SmartVis tests",
                                         .version = "1.0.0",
                                         .summary = "A plane at a given depth, whatever the volume holds."};

static sv_status take_values(plane *p, double *out, const sv_param_value *values, uint32_t count) {
    for (uint32_t i = 0; i < count; i++) {
        const uint32_t id = values[i].id;
        if (id < 1 || id > PARAM_COUNT) {
            (void)snprintf(p->reason, sizeof p->reason, "no parameter has id %u", id);
            return SV_ERR_PARAM_ID;
        }
        const sv_param_info *info = &infos[id - 1];
        if (!(values[i].value >= info->min_value && values[i].value <= info->max_value)) {
            (void)snprintf(p->reason, sizeof p->reason, "%s is %g, allowed are %g .. %g", info->key,
                           values[i].value, info->min_value, info->max_value);
            return SV_ERR_PARAM_RANGE;
        }
        out[id] = values[i].value;
    }
    return SV_OK;
}

/* SV_ERR_INTERNAL if this is the call, and the frame, that the parameters name. */
static sv_status fail_here(plane *p, int call, const char *name) {
    if ((int)p->fixed[PARAM_FAIL] != call || p->frame % (uint64_t)p->values[PARAM_EVERY] != 0) return SV_OK;
    (void)snprintf(p->reason, sizeof p->reason, "fails in %s on purpose", name);
    return SV_ERR_INTERNAL;
}

static void plane_deactivate(const sv_plugin *plugin) {
    plane *p = plugin->plugin_data;
    free(p->map);
    free(p->sure);
    p->map = p->sure = NULL;
}

static void plane_destroy(const sv_plugin *plugin) {
    plane_deactivate(plugin);
    free(plugin->plugin_data);
}

static sv_status plane_activate(const sv_plugin *plugin, const sv_format *format) {
    plane *p = plugin->plugin_data;
    for (uint32_t id = 1; id <= PARAM_COUNT; id++) p->fixed[id] = p->values[id] = infos[id - 1].default_value;
    sv_status status = take_values(p, p->fixed, format->values, format->value_count);
    if (status == SV_OK) status = fail_here(p, FAIL_ACTIVATE, "activate");
    if (status != SV_OK) return status;
    p->format = *format;
    p->map = calloc((size_t)format->width * format->height, sizeof(float));
    p->sure = calloc((size_t)format->width * format->height, sizeof(float));
    return p->map && p->sure ? SV_OK : SV_ERR_NO_MEMORY;
}

static sv_status plane_begin(const sv_plugin *plugin, const sv_frame *frame) {
    plane *p = plugin->plugin_data;
    memcpy(p->values, p->fixed, sizeof p->values);
    sv_status status = take_values(p, p->values, frame->values, frame->value_count);
    p->frame = frame->index;
    p->next_slice = 0;
    if (status == SV_OK) status = fail_here(p, FAIL_BEGIN, "begin");
    return status != SV_OK ? status : TP_BEGIN;
}

#ifndef TP_NO_SLAB
static sv_status plane_slab(const sv_plugin *plugin, const sv_slab *slab) {
    plane *p = plugin->plugin_data;
    if (slab->first_slice != p->next_slice) {
        (void)snprintf(p->reason, sizeof p->reason, "slab starts at slice %u, expected %u", slab->first_slice,
                       p->next_slice);
        return SV_ERR_SLAB_ORDER;
    }
    p->next_slice += slab->slice_count;
    return slab->first_slice > 0 ? fail_here(p, FAIL_SLAB, "slab") : SV_OK;
}
#endif

/* Columns of the map that have a surface: all, or the left half. */
static uint32_t columns(const plane *p) {
    return p->format.width / HALF;
}

static void draw_plane(plane *p) {
    const float slope = p->fixed[PARAM_SHAPE] != 0 ? 1.0f : 0.0f;
    for (uint32_t y = 0; y < p->format.height; y++)
        for (uint32_t x = 0; x < columns(p); x++)
            p->map[(size_t)y * p->format.width + x] = (float)p->values[PARAM_DEPTH] + slope * (float)x;
}

static sv_status plane_end(const sv_plugin *plugin, const sv_result *result) {
    plane *p = plugin->plugin_data;
    const sv_status status = fail_here(p, FAIL_END, "end");
    if (status != SV_OK) return status;
    if (p->next_slice != p->format.slices) {
        (void)snprintf(p->reason, sizeof p->reason, "%u of %u slices came", p->next_slice, p->format.slices);
        return SV_ERR_SLAB_MISSING;
    }
    const uint32_t rays = p->format.width * p->format.height;
    const sv_status outcome = p->values[PARAM_NOTE] != 0 ? SV_NO_SURFACE : FOUND;
    draw_plane(p);
    if (result->depth) memcpy(result->depth, p->map, rays * sizeof(float));
    if (result->depth_object &&
        clEnqueueWriteBuffer(p->format.queue, result->depth_object, CL_FALSE, result->depth_offset,
                             rays * sizeof(float), p->map, 0, NULL, NULL) != CL_SUCCESS)
        return SV_ERR_OPENCL;
    if (result->status) memset(result->status, SV_POINT_INITIAL, rays);
    if (result->stats) {
        const uint32_t size = result->stats->size;
        const sv_stats stats = {.size = size,
                                .outcome = outcome,
                                .rays = rays,
                                .points = rays,
                                .unfilled = rays - columns(p) * p->format.height};
        memcpy(result->stats, &stats, size < sizeof stats ? size : sizeof stats);
    }
    return p->format.queue ? SV_OK : outcome;
}

static sv_status plane_adjust(const sv_plugin *plugin, const sv_param_value *values, uint32_t count,
                              const sv_result *result) {
    plane *p = plugin->plugin_data;
    (void)values;
    (void)count;
    (void)result;
    (void)snprintf(p->reason, sizeof p->reason, "no parameter can be adjusted");
    return SV_ERR_PARAM_ID;
}

static uint32_t plane_param_count(const sv_plugin *plugin) {
    (void)plugin;
    return PARAM_COUNT;
}

static sv_status plane_param_info(const sv_plugin *plugin, uint32_t index, sv_param_info *out) {
    (void)plugin;
    if (index >= PARAM_COUNT) return SV_ERR_ARGUMENT;
    const uint32_t size = out->size;
    memcpy(out, &infos[index], size < sizeof *out ? size : sizeof *out);
    out->size = size;
    return SV_OK;
}

static sv_status plane_param_text(const sv_plugin *plugin, uint32_t id, double value, char *out,
                                  uint32_t bytes) {
    static const char *const shapes[] = {"flat", "tilted"};
    static const char *const calls[] = {"none", "activate", "begin", "slab", "end"};
    (void)plugin;
    if (id < 1 || id > PARAM_COUNT) return SV_ERR_PARAM_ID;
    if (!(value >= infos[id - 1].min_value && value <= infos[id - 1].max_value)) return SV_ERR_PARAM_RANGE;
    if (id == PARAM_SHAPE)
        (void)snprintf(out, bytes, "%s", shapes[(int)value]);
    else if (id == PARAM_FAIL)
        (void)snprintf(out, bytes, "%s", calls[(int)value]);
    else
        (void)snprintf(out, bytes, "%g", value);
    return SV_OK;
}

static const char *plane_last_error(const sv_plugin *plugin) {
    return ((const plane *)plugin->plugin_data)->reason;
}

#ifdef TP_CONFIDENCE
enum { TP_SURE_RAMP = 1, TP_SURE_FULL, TP_SURE_FAILS, TP_SURE_NAN, TP_SURE_ABOVE, TP_SURE_OLD, TP_SURE_NONE };

static uint32_t confidence_offered(const sv_plugin *plugin) {
    (void)plugin;
    return TP_CONFIDENCE != TP_SURE_NONE;
}

static sv_status confidence_write(const sv_plugin *plugin, float *map, struct _cl_mem *object,
                                  uint64_t offset) {
    plane *p = plugin->plugin_data;
    const uint32_t width = p->format.width, rays = width * p->format.height;
    for (uint32_t i = 0; i < rays; i++)
        p->sure[i] = TP_CONFIDENCE == TP_SURE_FULL ? 1.0f : (float)(i % width) / (float)(width - 1);
    if (TP_CONFIDENCE == TP_SURE_NAN) p->sure[rays / 2] = NAN;
    if (TP_CONFIDENCE == TP_SURE_ABOVE) p->sure[0] = p->sure[rays - 1] = 1.001f;
    if (TP_CONFIDENCE == TP_SURE_FAILS) {
        (void)snprintf(p->reason, sizeof p->reason, "is never sure, on purpose");
        return SV_ERR_INTERNAL;
    }
    if (map) memcpy(map, p->sure, rays * sizeof *map);
    if (object && clEnqueueWriteBuffer(p->format.queue, object, CL_FALSE, offset, rays * sizeof(float),
                                       p->sure, 0, NULL, NULL) != CL_SUCCESS)
        return SV_ERR_OPENCL;
    return SV_OK;
}

static sv_status confidence_read(const sv_plugin *plugin, float *map, sv_confidence_report *out) {
    (void)out;
    return map ? confidence_write(plugin, map, NULL, 0) : SV_ERR_STATE;
}

/* An older plugin's table ends after `read`. */
static const sv_ext_confidence ext_confidence = {
    .size = TP_CONFIDENCE == TP_SURE_OLD ? offsetof(sv_ext_confidence, offered) : sizeof ext_confidence,
    .read = confidence_read,
    .offered = confidence_offered,
    .write = confidence_write};
#endif

static const void *plane_get_extension(const sv_plugin *plugin, const char *id) {
    (void)plugin;
#ifdef TP_CONFIDENCE
    if (strcmp(id, SV_EXT_CONFIDENCE) == 0) return &ext_confidence;
#endif
    (void)id;
    return NULL;
}

static const sv_descriptor *descriptor_at(uint32_t index) {
    return index == 0 ? &descriptor : NULL;
}

static sv_status create(const sv_host *host, const char *id, const sv_plugin **out) {
    (void)host;
    *out = NULL;
    if (TP_CREATE != SV_OK) return TP_CREATE;
    if (strcmp(id, descriptor.id) != 0) return SV_ERR_UNKNOWN_ID;
    plane *p = calloc(1, sizeof *p);
    if (!p) return SV_ERR_NO_MEMORY;
    p->api = (sv_plugin){.size = sizeof p->api,
                         .descriptor = &descriptor,
                         .plugin_data = p,
                         .destroy = plane_destroy,
                         .activate = plane_activate,
                         .deactivate = plane_deactivate,
                         .begin = plane_begin,
                         .slab = TP_SLAB,
                         .end = plane_end,
                         .adjust = plane_adjust,
                         .param_count = plane_param_count,
                         .param_info = plane_param_info,
                         .param_text = plane_param_text,
                         .last_error = plane_last_error,
                         .get_extension = plane_get_extension};
    *out = &p->api;
    return SV_OK;
}

SV_EXPORT const sv_entry smartvis_plugin_entry = {.abi_major = TP_ABI_MAJOR,
                                                  .abi_minor = SV_ABI_MINOR,
                                                  .size = TP_ENTRY_SIZE,
                                                  .count = 1,
                                                  .descriptor = descriptor_at,
                                                  .create = create};
