/* SPDX-License-Identifier: MIT */
/*
 * A small whole plugin whose depthmap is a plane, whatever the volume holds. It fails where it is told to.
 * Each line of `variants` is a library of its name; all but the first are plugins that no host may accept, or
 * believe.
 */
/* The header says that the entry is constant; here loading changes it. */
#define smartvis_plugin_entry constant_entry
#include "smartvis/author.h"
#undef smartvis_plugin_entry
#include "smartvis/confidence.h"

#include <CL/cl.h>
#include <math.h>
#include <unistd.h>

enum { FAIL_BY_ERROR, FAIL_BY_CRASH, FAIL_BY_HANG, FAIL_BY_LEAVING };
enum {
    NO_EXTENSION,
    CONFIDENCE_RAMP,
    CONFIDENCE_FULL,
    CONFIDENCE_FAILS,
    CONFIDENCE_NAN,
    CONFIDENCE_ABOVE,
    CONFIDENCE_OLD,
    CONFIDENCE_NONE,
    CONFIDENCE_DOUBTFUL
};

typedef struct {
    const char *name;
    int newer; /* the entry's ABI major is as many above this one's */
    uint32_t entry_size;
    sv_status create, begin; /* what they return: of begin, a note changes nothing */
    int no_slab;
    int far_default; /* a default beyond its range */
    int partial;     /* the right half of the map has no surface: SV_PARTIAL */
    int outcome;     /* if not the one that is true */
    float lie;       /* a depth that no host may believe */
    int writes_nothing;
    int map_once;    /* only the first frame's map is written; later frames are said to be whole, too */
    int tells_fresh; /* the plane lies a slice deeper where a frame is marked SV_FRAME_DISCONTINUITY */
    int fails_by; /* how it fails where it is told to; all but an error only a process of its own survives */
    int confidence; /* smartvis.confidence/1, from 0 at the left to 1 at the right, and its faults */
} variant;

/* CMakeLists.txt reads the names. */
static const variant variants[] = {
    {"plane", .newer = 0},
    {"other_major", .newer = 1},
    {"older_major", .newer = -1},
    {"short_entry", .entry_size = 16},
    {"create_fails", .create = SV_ERR_NO_MEMORY},
    {"no_slab", .no_slab = 1},
    {"far_default", .far_default = 1},
    {"partial", .partial = 1},
    {"depth_nan", .lie = NAN},
    {"depth_far", .lie = 1e30f},
    {"depth_endless", .lie = -INFINITY},
    {"writes_nothing", .writes_nothing = 1},
    {"map_once", .map_once = 1},
    {"outcome_77", .outcome = 77},
    {"outcome_minus_77", .outcome = -77},
    {"begin_77", .begin = 77},
    {"note_early", .begin = SV_PARTIAL},
    {"by_crash", .fails_by = FAIL_BY_CRASH},
    {"fresh_told", .fails_by = FAIL_BY_CRASH, .tells_fresh = 1},
    {"by_hang", .fails_by = FAIL_BY_HANG},
    {"by_leave", .fails_by = FAIL_BY_LEAVING},
    {"confidence_ramp", .confidence = CONFIDENCE_RAMP},
    {"confidence_doubtful", .confidence = CONFIDENCE_DOUBTFUL},
    {"confidence_full", .confidence = CONFIDENCE_FULL},
    {"confidence_fails", .confidence = CONFIDENCE_FAILS},
    {"confidence_nan", .confidence = CONFIDENCE_NAN},
    {"confidence_above", .confidence = CONFIDENCE_ABOVE},
    {"confidence_old", .confidence = CONFIDENCE_OLD},
    {"confidence_none", .confidence = CONFIDENCE_NONE},
};

/* This source is compiled once. The linker says which line a library is. */
__attribute__((visibility("hidden"))) extern const unsigned char plane_line, plane_lines[32];
const unsigned char plane_lines[32] = {0,  1,  2,  3,  4,  5,  6,  7,  8,  9,  10, 11, 12, 13, 14, 15,
                                       16, 17, 18, 19, 20, 21, 22, 23, 24, 25, 26, 27, 28, 29, 30, 31};

static const variant *self(void) {
    return &variants[plane_line];
}

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
     .display_max = 48,
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
    SVA_PARAM(PARAM_EVERY, SV_PARAM_INT, 0, "every", "Failing frames", "frames",
              "Only frames whose index is a multiple of this fail.", 1, 63, 1, 2),
    SVA_PARAM(PARAM_NOTE, SV_PARAM_BOOL, 0, "note", "Note", "",
              "Comes out as SV_NO_SURFACE, with the plane in the map all the same: a host must not use it.",
              0, 1, 0, 0)};

typedef struct {
    float *map;        /* width * height; the host's queue copies from here */
    float *confidence; /* the same for the confidence */
} plane;

/* What no host can take back. */
static void fail_by(int how) {
    volatile uintptr_t nowhere = 8;
    if (how == FAIL_BY_CRASH) *(volatile char *)nowhere = 1;
    if (how == FAIL_BY_LEAVING) exit(0);
    for (volatile int endless = 1; endless;) (void)usleep(200);
}

/* SV_ERR_INTERNAL if this is the call, and the frame, that the parameters name. */
static sv_status fail_here(sva *a, int call) {
    const uint64_t every = (uint64_t)sva_value(a, PARAM_EVERY);
    if ((int)sva_value(a, PARAM_FAIL) != call || a->frame.index % every != 0) return SV_OK;
    if (self()->fails_by != FAIL_BY_ERROR) fail_by(self()->fails_by);
    return sva_error(a, SV_ERR_INTERNAL, "fails in %s on purpose", calls[call]);
}

static sv_status plane_activate(sva *a) {
    plane *p = a->own;
    const sv_status status = fail_here(a, FAIL_ACTIVATE);
    if (status != SV_OK) return status;
    p->map = calloc(sva_rays(a), sizeof(float));
    p->confidence = calloc(sva_rays(a), sizeof(float));
    return p->map && p->confidence ? SV_OK : sva_error(a, SV_ERR_NO_MEMORY, "no memory for two maps");
}

static void plane_deactivate(sva *a) {
    plane *p = a->own;
    free(p->map);
    free(p->confidence);
    p->map = p->confidence = NULL;
}

static sv_status plane_begin(sva *a) {
    const sv_status status = fail_here(a, FAIL_BEGIN);
    return status != SV_OK ? status : self()->begin;
}

static sv_status plane_slab(sva *a, const sv_slab *slab) {
    return slab->first_slice > 0 ? fail_here(a, FAIL_SLAB) : SV_OK;
}

/* Columns of the map that have a surface: all, or the left half. */
static uint32_t columns(const sva *a) {
    return self()->partial ? a->format.width / 2 : a->format.width;
}

static sv_status plane_finish(sva *a, float *depth) { /* NOLINT(readability-non-const-parameter) */
    const plane *p = a->own;
    const float slope = sva_value(a, PARAM_SHAPE) != 0 ? 1.0f : 0.0f;
    const int fresh = self()->tells_fresh && (a->frame.flags & SV_FRAME_DISCONTINUITY);
    const float depth_here = (float)sva_value(a, PARAM_DEPTH) + (fresh ? 1.0f : 0.0f);
    for (uint32_t y = 0; y < a->format.height; y++)
        for (uint32_t x = 0; x < columns(a); x++)
            p->map[(size_t)y * a->format.width + x] = depth_here + slope * (float)x;
    return fail_here(a, FAIL_END);
}

static sv_status plane_output(sva *a, const sv_result *result) {
    const plane *p = a->own;
    const size_t rays = sva_rays(a);
    if (self()->writes_nothing) return SV_OK;
    for (size_t i = 0; self()->lie != 0.0f && i < rays; i++) p->map[i] = i == 7 ? self()->lie : 1.0f;
    const int found = self()->partial ? SV_PARTIAL : self()->outcome;
    const sv_status outcome = sva_value(a, PARAM_NOTE) != 0 ? SV_NO_SURFACE : found;
    const int written = !self()->map_once || a->frame.index == 0;
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

static uint32_t confidence_offered(const sv_plugin *plugin) {
    return self()->confidence != CONFIDENCE_NONE;
}

static sv_status confidence_write(const sv_plugin *plugin, float *map, struct _cl_mem *object,
                                  uint64_t offset) {
    sva *a = plugin->plugin_data;
    plane *p = a->own;
    const uint32_t width = a->format.width, rays = width * a->format.height;
    const int kind = self()->confidence;
    for (uint32_t i = 0; i < rays; i++)
        p->confidence[i] = kind == CONFIDENCE_FULL ? 1.0f : (float)(i % width) / (float)(width - 1);
    if (kind == CONFIDENCE_NAN) p->confidence[rays / 2] = NAN;
    if (kind == CONFIDENCE_ABOVE) p->confidence[0] = p->confidence[rays - 1] = 1.001f;
    if (kind == CONFIDENCE_FAILS) return sva_error(a, SV_ERR_INTERNAL, "is never sure, on purpose");
    if (map) memcpy(map, p->confidence, rays * sizeof *map);
    if (object && clEnqueueWriteBuffer(a->format.queue, object, CL_FALSE, offset, rays * sizeof(float),
                                       p->confidence, 0, NULL, NULL) != CL_SUCCESS)
        return SV_ERR_OPENCL;
    return SV_OK;
}

static sv_status confidence_read(const sv_plugin *plugin, float *map, sv_confidence_report *out) {
    if (self()->confidence == CONFIDENCE_DOUBTFUL && out) {
        out->reason = SV_REASON_DOUBTFUL;
        out->found = 0.14f;
        out->wanted = 0.3f;
        if (!map) return SV_OK;
    }
    return map ? confidence_write(plugin, map, NULL, 0) : SV_ERR_STATE;
}

static const sv_ext_confidence ext_confidence = {.size = sizeof ext_confidence,
                                                 .read = confidence_read,
                                                 .offered = confidence_offered,
                                                 .write = confidence_write};
/* An older plugin's table ends after `read`. */
static const sv_ext_confidence ext_old = {.size = offsetof(sv_ext_confidence, offered),
                                          .read = confidence_read};

static const void *plane_extension(const sva *a, const char *id) {
    if (self()->confidence == NO_EXTENSION || strcmp(id, SV_EXT_CONFIDENCE) != 0) return NULL;
    return self()->confidence == CONFIDENCE_OLD ? &ext_old : &ext_confidence;
}

static const char *extensions[] = {SV_EXT_CONFIDENCE, NULL};

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
    if (self()->create != SV_OK) return self()->create;
    static sva_param spoilt[PARAM_COUNT];
    memcpy(spoilt, params, sizeof spoilt);
    if (self()->far_default) spoilt[0].default_value = 1e5;
    static sva_method own;
    own = method;
    own.params = spoilt;
    const sv_status status = sva_create(&own, host, id, out);
    if (status == SV_OK && self()->no_slab) ((sva *)(*out)->plugin_data)->api.slab = NULL;
    return status;
}

extern SV_EXPORT sv_entry smartvis_plugin_entry;
SV_EXPORT sv_entry smartvis_plugin_entry = {.abi_major = SV_ABI_MAJOR,
                                            .abi_minor = SV_ABI_MINOR,
                                            .size = sizeof(sv_entry),
                                            .count = 1,
                                            .descriptor = descriptor_at,
                                            .create = create};

__attribute__((constructor)) static void load(void) {
    smartvis_plugin_entry.abi_major += (uint32_t)self()->newer;
    if (self()->entry_size != 0) smartvis_plugin_entry.size = self()->entry_size;
    if (self()->confidence == NO_EXTENSION) extensions[0] = NULL;
}
