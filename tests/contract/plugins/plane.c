/* SPDX-License-Identifier: MIT */
/*
 * A small whole plugin whose depthmap is a plane, whatever the volume holds. It fails where it is told to,
 * and CMakeLists.txt compiles variants of it that no host may accept:
 *
 *   TP_ABI_MAJOR     the entry's ABI major
 *   TP_ENTRY_SIZE    the entry's size
 *   TP_CREATE        what create returns
 *   TP_SLAB          the instance's slab
 *   TP_FAILS_BY      how it fails where it is told to: not by an error, but by fail_by(), see there
 *   TP_BEGIN         what begin returns: a note changes nothing
 *   TP_MAP_ONCE      only the first frame's map is written; later frames are said to be whole, too
 *   TP_PARTIAL       the right half of the map has no surface: SV_PARTIAL
 *   TP_CONFIDENCE    with smartvis.confidence/1, from 0 at the left to 1 at the right; TP_SURE_... says how
 */
#include "smartvis/author.h"
#include "smartvis/confidence.h"

#include <CL/cl.h>
#include <math.h>
#include <signal.h>
#include <unistd.h>

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
#define TP_SLAB sva_slab
#endif
#ifndef TP_MAP_ONCE
#define TP_MAP_ONCE 0
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

static const char *const shapes[] = {"flat", "tilted"};
static const char *const calls[] = {"none", "activate", "begin", "slab", "end"};

static const sva_param params[PARAM_COUNT] = {
    {.id = PARAM_DEPTH,
     .type = SV_PARAM_FLOAT,
     .flags = SV_PARAM_PRIMARY,
     .key = "depth",
     .label = "Depth",
     .unit = "slices",
     .help = "Where the plane lies at x = 0.",
     .min_value = -1e4,
     .max_value = 1e4,
     .display_max = 30,
     .step = 0.5},
    {.id = PARAM_SHAPE,
     .type = SV_PARAM_ENUM,
     .flags = SV_PARAM_EXPERT | SV_PARAM_REACTIVATE,
     .key = "shape",
     .label = "Shape",
     .unit = "",
     .help = "tilted goes one slice deeper per pixel in x.",
     .max_value = 1,
     .names = shapes},
    {.id = PARAM_FAIL,
     .type = SV_PARAM_ENUM,
     .flags = SV_PARAM_REACTIVATE,
     .key = "fail",
     .label = "Failing call",
     .unit = "",
     .help = "The call that fails on purpose; slab is the second of a frame.",
     .max_value = FAIL_END,
     .names = calls},
    {.id = PARAM_EVERY,
     .type = SV_PARAM_INT,
     .key = "every",
     .label = "Failing frames",
     .unit = "frames",
     .help = "Only frames whose index is a multiple of this fail.",
     .min_value = 1,
     .max_value = 63,
     .default_value = 1,
     .step = 2},
    {.id = PARAM_NOTE,
     .type = SV_PARAM_BOOL,
     .key = "note",
     .label = "Note",
     .unit = "",
     .help = "Comes out as SV_NO_SURFACE, with the plane in the map all the same: a host must not use it.",
     .max_value = 1}};

typedef struct {
    float *map;  /* width * height; the host's queue copies from here */
    float *sure; /* the same for the confidence */
} plane;

#ifdef TP_FAILS_BY
enum { TP_CRASH = 1, TP_HANG, TP_LEAVE, TP_GRAB };

/* What no host can take back. */
static void fail_by(int how) {
    if (how == TP_CRASH) (void)raise(SIGSEGV);
    if (how == TP_LEAVE) exit(0);
    for (volatile int endless = 1; endless;) {
        if (how == TP_GRAB) memset(malloc(1u << 20), 1, 1u << 20);
        (void)usleep(200);
    }
}
#endif

/* SV_ERR_INTERNAL if this is the call, and the frame, that the parameters name. */
static sv_status fail_here(sva *a, int call) {
    const uint64_t every = (uint64_t)sva_value(a, PARAM_EVERY);
    if ((int)sva_value(a, PARAM_FAIL) != call || a->frame.index % every != 0) return SV_OK;
#ifdef TP_FAILS_BY
    fail_by(TP_FAILS_BY);
#endif
    return sva_error(a, SV_ERR_INTERNAL, "fails in %s on purpose", calls[call]);
}

static sv_status plane_activate(sva *a) {
    plane *p = a->own;
    const sv_status status = fail_here(a, FAIL_ACTIVATE);
    if (status != SV_OK) return status;
    p->map = calloc(sva_rays(a), sizeof(float));
    p->sure = calloc(sva_rays(a), sizeof(float));
    return p->map && p->sure ? SV_OK : sva_error(a, SV_ERR_NO_MEMORY, "no memory for two maps");
}

static void plane_deactivate(sva *a) {
    plane *p = a->own;
    free(p->map);
    free(p->sure);
    p->map = p->sure = NULL;
}

static sv_status plane_begin(sva *a) {
    const sv_status status = fail_here(a, FAIL_BEGIN);
    return status != SV_OK ? status : TP_BEGIN;
}

static sv_status plane_slab(sva *a, const sv_slab *slab) {
    return slab->first_slice > 0 ? fail_here(a, FAIL_SLAB) : SV_OK;
}

/* Columns of the map that have a surface: all, or the left half. */
static uint32_t columns(const sva *a) {
    return a->format.width / HALF;
}

static sv_status plane_finish(sva *a, float *depth) { /* NOLINT(readability-non-const-parameter) */
    const plane *p = a->own;
    const float slope = sva_value(a, PARAM_SHAPE) != 0 ? 1.0f : 0.0f;
    (void)depth;
    for (uint32_t y = 0; y < a->format.height; y++)
        for (uint32_t x = 0; x < columns(a); x++)
            p->map[(size_t)y * a->format.width + x] = (float)sva_value(a, PARAM_DEPTH) + slope * (float)x;
    return fail_here(a, FAIL_END);
}

/* What a host must not believe: see CMakeLists.txt. */
#ifndef TP_OUTCOME
#define TP_OUTCOME FOUND
#endif
#ifdef TP_LIE
static float lie(size_t ray) {
    return ray == 7 ? TP_LIE : 1.0f;
}
#endif

static sv_status plane_output(sva *a, const sv_result *result) {
    const plane *p = a->own;
#ifdef TP_LIE
    for (size_t i = 0; i < sva_rays(a); i++) p->map[i] = lie(i);
#endif
#ifdef TP_WRITES_NOTHING
    (void)p;
    return SV_OK;
#endif
    const size_t rays = sva_rays(a);
    const sv_status outcome = sva_value(a, PARAM_NOTE) != 0 ? SV_NO_SURFACE : TP_OUTCOME;
    const int written = !TP_MAP_ONCE || a->frame.index == 0;
    if (written && result->depth) memcpy(result->depth, p->map, rays * sizeof(float));
    if (written && result->depth_object &&
        clEnqueueWriteBuffer(a->format.queue, result->depth_object, CL_FALSE, result->depth_offset,
                             rays * sizeof(float), p->map, 0, NULL, NULL) != CL_SUCCESS)
        return sva_error(a, SV_ERR_OPENCL, "clEnqueueWriteBuffer fails");
    if (result->status) memset(result->status, SV_POINT_INITIAL, rays);
    if (result->stats) {
        const uint32_t size = result->stats->size;
        const sv_stats stats = {.size = size,
                                .outcome = outcome,
                                .rays = (uint32_t)rays,
                                .points = (uint32_t)rays,
                                .unfilled = (uint32_t)rays - columns(a) * a->format.height};
        *result->stats = stats;
    }
    return a->format.queue ? SV_OK : outcome;
}

#ifdef TP_CONFIDENCE
enum { TP_SURE_RAMP = 1, TP_SURE_FULL, TP_SURE_FAILS, TP_SURE_NAN, TP_SURE_ABOVE, TP_SURE_OLD, TP_SURE_NONE };

static uint32_t confidence_offered(const sv_plugin *plugin) {
    (void)plugin;
    return TP_CONFIDENCE != TP_SURE_NONE;
}

static sv_status confidence_write(const sv_plugin *plugin, float *map, struct _cl_mem *object,
                                  uint64_t offset) {
    sva *a = plugin->plugin_data;
    plane *p = a->own;
    const uint32_t width = a->format.width, rays = width * a->format.height;
    for (uint32_t i = 0; i < rays; i++)
        p->sure[i] = TP_CONFIDENCE == TP_SURE_FULL ? 1.0f : (float)(i % width) / (float)(width - 1);
    if (TP_CONFIDENCE == TP_SURE_NAN) p->sure[rays / 2] = NAN;
    if (TP_CONFIDENCE == TP_SURE_ABOVE) p->sure[0] = p->sure[rays - 1] = 1.001f;
    if (TP_CONFIDENCE == TP_SURE_FAILS) return sva_error(a, SV_ERR_INTERNAL, "is never sure, on purpose");
    if (map) memcpy(map, p->sure, rays * sizeof *map);
    if (object && clEnqueueWriteBuffer(a->format.queue, object, CL_FALSE, offset, rays * sizeof(float),
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

static const void *plane_extension(const sva *a, const char *id) {
    (void)a;
#ifdef TP_CONFIDENCE
    if (strcmp(id, SV_EXT_CONFIDENCE) == 0) return &ext_confidence;
#endif
    (void)id;
    return NULL;
}

#ifdef TP_CONFIDENCE
static const char *const extensions[] = {SV_EXT_CONFIDENCE, NULL};
#else
static const char *const extensions[] = {NULL};
#endif

static const sv_descriptor descriptor = {.size = sizeof(sv_descriptor),
                                         .carriers = SV_BIT(SV_CARRIER_HOST) | SV_BIT(SV_CARRIER_BUFFER) |
                                                     SV_BIT(SV_CARRIER_IMAGE),
                                         .id = "org.smartvis.test.plane",
                                         .name = "Plane",
                                         .vendor = "SmartVis tests",
                                         .version = "1.0.0",
                                         .summary = "A plane at a given depth, whatever the volume holds.",
                                         .voxel_types = SV_BIT(SV_VOXEL_U8),
                                         .queues = SV_QUEUE_OWN | SV_QUEUE_HOST,
                                         .extensions = extensions};

static const sva_method method = {.descriptor = &descriptor,
                                  .params = params,
                                  .param_count = PARAM_COUNT,
                                  .own_bytes = sizeof(plane),
                                  .activate = plane_activate,
                                  .deactivate = plane_deactivate,
                                  .begin = plane_begin,
                                  .slab = plane_slab,
                                  .finish = plane_finish,
                                  .output = plane_output,
                                  .extension = plane_extension};

static const sv_descriptor *descriptor_at(uint32_t index) {
    return index == 0 ? &descriptor : NULL;
}

static sv_status create(const sv_host *host, const char *id, const sv_plugin **out) {
    *out = NULL;
    if (TP_CREATE != SV_OK) return TP_CREATE;
    const sv_status status = sva_create(&method, host, id, out);
    if (status == SV_OK) ((sva *)(*out)->plugin_data)->api.slab = TP_SLAB;
    return status;
}

SV_EXPORT const sv_entry smartvis_plugin_entry = {.abi_major = TP_ABI_MAJOR,
                                                  .abi_minor = SV_ABI_MINOR,
                                                  .size = TP_ENTRY_SIZE,
                                                  .count = 1,
                                                  .descriptor = descriptor_at,
                                                  .create = create};
