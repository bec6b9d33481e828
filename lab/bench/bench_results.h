/* SPDX-License-Identifier: MIT */
/* What sv_bench measures, part by part, and how it is told. */
#pragma once

#include "bench/bench.h"
#include "core/progress.h"
#include "plugin/capabilities.h"
#include "plugin/loader.h"
#include "render/host_kernels.h"
#include "smartvis_plugin.h"

/* ---------------------------------------------------------------------------------------------- plugin -- */
/* Times a plugin's frame beside the plain C frame, in turns. */

/* How slabs get to the plugin, and whose queue it uses. */
typedef enum {
    BENCH_PLACE_OWN,  /* host memory, registered: read where it is; the plugin's queue */
    BENCH_PLACE_HOST, /* the same, the host's queue */
    BENCH_COPY_OWN,   /* host memory, not registered: copied */
    BENCH_COPY_HOST,
    BENCH_BUFFER_HOST, /* OpenCL buffer; the host's queue */
    BENCH_ROUTES
} bench_route;

/* "host memory in place, own queue", ...; and for files "place-own", ... */
const char *bench_route_label(bench_route route);
const char *bench_route_key(bench_route route);

typedef struct {
    uint32_t n; /* voxels an axis */
    uint32_t k; /* mean filter */
    uint32_t slab_slices;
    bench_route route;
} bench_variant;

typedef enum {
    BENCH_PLAIN, /* plain C, two threads */
    BENCH_FRAME, /* the plugin: begin to end; with the host's queue until that has run */
    BENCH_BEGIN, /* its parts */
    BENCH_SLABS,
    BENCH_END,
    BENCH_ADJUST,  /* another q on the same volume */
    BENCH_DROPPED, /* a frame that is given up behind its last slab: until its commands have run */
    BENCH_PARTS
} bench_part;

typedef struct {
    bench_variant variant;
    const char *method; /* "mean" is what plain C computes; others are timed without it (BENCH_PLAIN is 0) */
    uint32_t frames;
    hs_timing times[BENCH_PARTS];
    sv_stats stats;
    sv_points_report points; /* size 0: the plugin does not tell */
    double difference;       /* largest of the plugin's depths from plain C's, slices */
    bool has_stages;
    sv_stage_times stages; /* medians of frames with events on, measured apart */
} bench_plugin_result;

typedef struct {
    const hs_plugin *plugin;
    const hs_cl *cl;
    uint32_t frames;
    /* The value of the parameter "method"; NULL: as the plugin stands, and compared with plain C. */
    const char *method;
} bench_plugin_setup;

/* True if the plugin has no parameters 'q' and 'kernel': plain C's mean filter says nothing about its map. */
bool bench_plugin_is_foreign(const hs_plugin *plugin);

/* `method` of the setup for such a plugin: what it does of itself. */
#define BENCH_OWN "own"

/* How slabs go to the plugin on a route. */
hs_handover bench_route_handover(bench_route route);

/* Whether the plugin has the method at all. */
bool bench_plugin_has_method(const hs_plugin *plugin, const char *method);

/* HS_ERR_FAILED if the plugin's map is not plain C's: another status somewhere, or a depth more than 1e-3
 * slices off; then nothing is timed. HS_ERR_PLUGIN, HS_ERR_DEVICE, HS_ERR_MEMORY.
 * `voxels`: bench_volume_make. */
bool bench_plugin_run(const bench_plugin_setup *setup, const uint8_t *voxels, const bench_variant *variant,
                      hs_progress *progress, bench_plugin_result *result, hs_error *err);

/* --------------------------------------------------------------------------------------------- results -- */

/* All of a run. Arrays are not owned. */
typedef struct {
    bench_machine machine;
    const bench_plugin_result *plugin;
    uint32_t plugin_count;
} bench_report;

/* --------------------------------------------------------------------------------------------- methods -- */
/* The frames of another method than the one plain C computes. */

/* The method that is timed beside the mean filter. */
#define BENCH_METHOD "wall"

/* What frames with the plugin's own defaults cost: half of them, all but one in a hundred, all. */
void bench_print_worst(const bench_report *report);

/* Prints all results of a method other than the mean filter. */
void bench_print_method(const bench_report *report, const char *method);

/* ---------------------------------------------------------------------------------------------- tables -- */
/* The benchmark's results as tables on standard output. */

/* Line by line as results come in: the head before the first variant of a size, then a line each. */
void bench_print_plugin_head(uint32_t n, uint32_t k);
void bench_print_plugin(const bench_plugin_result *result);
void bench_print_stages(const bench_plugin_result *results, uint32_t count);
