/* SPDX-License-Identifier: MIT */
/* Times a plugin's frame beside reading the volume and the plain C frame, in turns. */
#ifndef BENCH_PLUGIN_H
#define BENCH_PLUGIN_H

#include "base/progress.h"
#include "bench/bench_slabs.h"
#include "bench/bench_team.h"
#include "bench/bench_times.h"
#include "plugin/capabilities.h"
#include "plugin/loader.h"
#include "plugin/plugin_ext.h"

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
    BENCH_READ,  /* (a) the volume's bytes once, two threads */
    BENCH_PLAIN, /* (b) plain C, two threads */
    BENCH_FRAME, /* the plugin: begin to end; with the host's queue until that has run */
    BENCH_BEGIN, /* its parts */
    BENCH_SLABS,
    BENCH_END,
    BENCH_ADJUST, /* another q on the same volume */
    BENCH_PARTS
} bench_part;

typedef struct {
    bench_variant variant;
    const char *method; /* "mean" is what plain C computes; others are timed without it (BENCH_PLAIN is 0) */
    uint32_t frames;
    bench_times times[BENCH_PARTS];
    sv_stats stats;
    sv_points_report points; /* size 0: the plugin does not tell */
    double difference;       /* largest of the plugin's depths from plain C's, slices */
    bool has_stages;
    sv_stage_times stages; /* medians of frames with events on, measured apart */
} bench_plugin_result;

typedef struct {
    const hs_plugin *plugin;
    const hs_cl *cl;
    bench_team *team;
    uint32_t frames;
    const sv_param_value *values; /* for activate and for each frame, beside the benchmark's own */
    uint32_t value_count;
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
 * slices off; then nothing is timed. HS_ERR_PLUGIN, HS_ERR_DEVICE, HS_ERR_MEMORY. */
bool bench_plugin_run(const bench_plugin_setup *setup, const bench_slabs *slabs, const bench_variant *variant,
                      hs_progress *progress, bench_plugin_result *result, hs_error *err);

#endif
