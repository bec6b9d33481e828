/* SPDX-License-Identifier: MIT */
/* What sv_bench measures, part by part, and how it is told. */
#ifndef BENCH_RESULTS_H
#define BENCH_RESULTS_H

#include "base/progress.h"
#include "bench/bench.h"
#include "eval/eval_box.h"
#include "loop/loop_run.h"
#include "plugin/capabilities.h"
#include "plugin/loader.h"
#include "render/host_cl.h"
#include "smartvis_plugin.h"

/* ---------------------------------------------------------------------------------------------- plugin -- */
/* Times a plugin's frame beside reading the volume and the plain C frame, in turns. */

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
    BENCH_ADJUST,  /* another q on the same volume */
    BENCH_DROPPED, /* a frame that is given up behind its last slab: until its commands have run */
    BENCH_PARTS
} bench_part;

typedef struct {
    bench_variant variant;
    const char *method; /* "mean" is what plain C computes; others are timed without it (BENCH_PLAIN is 0) */
    uint32_t frames;
    bench_times times[BENCH_PARTS];
    bench_times processor; /* of a frame, all threads */
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

/* ----------------------------------------------------------------------------------------------- looks -- */
/* Times the renderer's two looks in turns, so that other load on the machine affects both alike. */

/* One camera, clipped at a plane in the fluid or not. Milliseconds of a picture of 512 x 512. */
typedef struct {
    const char *label;
    bench_times thesis, lit;
} bench_lit_view;

typedef struct {
    bench_lit_view view[BENCH_VIEWS];
    bench_times volume; /* what the lit look makes of a new volume */
} bench_lit_result;

/* The table, with the ratios of medians and of minima. */
void bench_print_lit(const bench_lit_result *result);

/* ------------------------------------------------------------------------------------------------ loop -- */
/* Times the host's own parts and the whole scan loop around the plugin. */

typedef struct {
    const hs_plugin *plugin;
    const hs_cl *cl;
    uint32_t frames;
    const char *scene;            /* a built-in scene or a scene file; NULL: the benchmark's layered volume */
    uint32_t size;                /* voxels an axis */
    const sv_param_value *values; /* of the plugin */
    uint32_t value_count;
} bench_host_setup;

/* One camera: the loop's three settings, and pieces of it. */
typedef struct {
    const char *label;
    hs_loop_result settings[HS_SETTING_COUNT];
} bench_view_result;

typedef struct {
    uint32_t size, lowres;
    char volume[256]; /* its name */
    bench_view_result still, rotated, live;
    bench_times mip;  /* maximum intensity projection, still camera */
    bench_times grid; /* a volume to the device, with the renderer's grid of maxima */
    bench_lit_result lit;
} bench_host_result;

/* The benchmark's volume of n voxels an axis as the host keeps one; hs_volume_free `volume`. The source
 * points to `list`, one entry. HS_ERR_MEMORY. */
bool bench_layered_source(hs_source *source, hs_volume *volume, const hs_volume **list, uint32_t n,
                          hs_error *err);

/* A scene of n voxels an axis, or without one the layered volume, in `volume` and `list`; all to be closed,
 * even after a failure. */
bool bench_open_source(const char *scene, uint32_t n, hs_source *source, hs_volume *volume,
                       const hs_volume **list, hs_error *err);
void bench_close_source(const char *scene, hs_source *source, hs_volume *volume);

/* HS_ERR_* of whatever fails, the plugin included. Frames it gave no surface
 * for are counted in the results. */
bool bench_host_run(const bench_host_setup *setup, bench_host_result *result, hs_error *err);

/* ----------------------------------------------------------------------------------------------- grids -- */
/* Times the renderer of a probe's volume in turns in both grids that it could sample: the Cartesian copy, as
 * the host does, and the probe's own (lab/bench/cl/probe_grid.cl). */

/* One camera, clipped at a plane or not. Milliseconds of a picture of 512 x 512 in the thesis' look. */
typedef struct {
    const char *label;
    bench_times copy, probe;             /* both leap over the empty bricks of the copy */
    bench_times copy_walks, probe_walks; /* neither leaps */
    double difference;                   /* of the two pictures: mean of the colours' differences, of 255 */
} bench_grid_view;

typedef struct {
    char volume[256];
    uint32_t samples, lines, planes, voxels[3];
    bench_grid_view view[BENCH_VIEWS];
    bench_times making; /* the copy, from the samples */
} bench_grids_result;

/* Samples `scene` (a built-in one or a file, of `size` voxels an axis) by a probe of 400 samples, lines and
 * planes. HS_ERR_* of whatever fails; HS_ERR_FAILED if the two grids do not give one picture. */
bool bench_grids_run(const hs_cl *cl, const char *scene, uint32_t size, uint32_t frames,
                     bench_grids_result *out, hs_error *err);

/* The table, with ratios of medians and of minima, and after how many pictures the copy has paid. */
void bench_print_grids(const bench_grids_result *result);

/* ----------------------------------------------------------------------------------------------- guard -- */
/* What the guard costs a frame: the same frames with the plugin in this process and in one of its own, in
 * turns. */

typedef struct {
    const char *path, *id; /* of the plugin */
    const hs_cl *cl;
    uint32_t frames;
    const sv_param_value *values;
    uint32_t value_count;
} bench_guard_setup;

enum { BENCH_DIRECT, BENCH_GUARDED, BENCH_CHECKED, BENCH_GUARD_WAYS };

typedef struct {
    uint32_t n;                            /* voxels an axis of the low-resolution volume */
    bench_times convert[BENCH_GUARD_WAYS]; /* scan conversion into the slabs */
    bench_times plugin[BENCH_GUARD_WAYS];  /* begin to the depthmap on the host's device, checked */
} bench_guard_result;

/* HS_ERR_FAILED if the two maps differ. HS_ERR_PLUGIN, HS_ERR_DEVICE, HS_ERR_MEMORY. */
bool bench_guard_run(const bench_guard_setup *setup, uint32_t n, bench_guard_result *result, hs_error *err);

/* A heading, and a line a size. */
void bench_guard_print_head(void);
void bench_guard_print(const bench_guard_result *result);

/* ------------------------------------------------------------------------------------- scan conversion -- */
/* Times scan conversion against reading the volume's bytes once, and holds it to exact means over boxes. */

enum { BENCH_CONVERT_VIEWS = 5 };

typedef struct {
    bench_times wall, processor; /* processor: of all threads */
} bench_convert_time;

/* One camera. Milliseconds, all from the same turns. */
typedef struct {
    const char *label;
    bench_convert_time read;  /* two threads read the volume's bytes once */
    bench_convert_time fresh; /* of a volume that has just arrived: with all that is made of it */
    bench_convert_time again; /* of the same volume once more, as for a camera that moves */
    uint32_t size[3];         /* low-resolution voxels */
    hs_box_error error;
} bench_convert_view;

typedef struct {
    char volume[256]; /* its name */
    size_t bytes;
    bench_convert_view view[BENCH_CONVERT_VIEWS];
} bench_convert_result;

typedef struct {
    const hs_cl *cl;
    bench_team *team;
    uint32_t frames;
} bench_convert_setup;

/* A third of the source's resolution, cubic, slabs of 16, from several cameras. `volume` may be in probe
 * geometry; NULL: none could be had, and `err` says why. HS_ERR_*. */
bool bench_convert_run(const bench_convert_setup *setup, const hs_volume *volume, bench_convert_result *out,
                       hs_error *err);
void bench_print_convert(const bench_convert_result *result);

/* ------------------------------------------------------------------------------------------- live loop -- */
/* The whole loop as a scan runs it: a turned camera, a new volume every frame, a
 * method of the plugin's, lit. */

enum { BENCH_LOOP_METHODS = 3 };

/* One method. Milliseconds of frames that were taken in turns. */
typedef struct {
    const char *method;
    bench_times stage[HS_STAGE_COUNT]; /* lit, stage by stage */
    bench_times unlit;                 /* the whole loop in the thesis' look */
    bench_times flow;                  /* the whole loop, lit, without waits between its stages */
    bench_times processor;             /* processor time of a frame of `flow`, of all threads */
    bench_times read;                  /* two threads read the volume's bytes once */
    bench_times read_processor;
    uint32_t clipped, frames;
} bench_loop_row;

typedef struct {
    bench_loop_row row[BENCH_LOOP_METHODS];
    uint32_t count;
} bench_loop_result;

/* The methods mean, cost and wall, as far as the plugin has them; a plugin without methods as it is.
 * HS_ERR_*. */
bool bench_loop_run(const bench_host_setup *setup, bench_team *team, const hs_source *source,
                    bench_loop_result *out, hs_error *err);
void bench_print_loop(const bench_loop_result *result);

/* --------------------------------------------------------------------------------------------- frame -- */
/* Why the plugin's frame costs more in the loop than in a benchmark of its own, cause by cause. */

enum { BENCH_FRAME_WAYS = 8, BENCH_FRAME_CAMERAS = 2 };

/* By camera and way; each way has one thing more than the one before. Milliseconds of frames in turns. */
typedef struct {
    hs_slab_layout layout[BENCH_FRAME_CAMERAS]; /* of all ways but the first */
    bench_times wall[BENCH_FRAME_CAMERAS][BENCH_FRAME_WAYS];
    bench_times processor[BENCH_FRAME_CAMERAS][BENCH_FRAME_WAYS]; /* of all threads */
    bench_times command[BENCH_FRAME_CAMERAS];                     /* one that does nothing */
} bench_frame_result;

/* Times frames; false with an error of plugin or device. */
bool bench_frame_run(const bench_host_setup *setup, bench_team *team, bench_frame_result *out, hs_error *err);
void bench_print_frame(const bench_frame_result *result);

/* ------------------------------------------------------------------------------------------- growth -- */
/* How time grows with voxels and with pixels. */

/* HS_ERR_*. Prints as it goes. `setup` as for bench_plugin_run. */
bool bench_growth_run(const bench_plugin_setup *setup, hs_error *err);

/* --------------------------------------------------------------------------------------------- results -- */
/* All results of a run. */

/* All of a run. `host` and `grids` are NULL if they were not measured. Arrays are not owned. */
typedef struct {
    bench_machine machine;
    const bench_plugin_result *plugin;
    uint32_t plugin_count;
    const bench_host_result *host;
    const bench_grids_result *grids;
} bench_report;

/* --------------------------------------------------------------------------------------------- methods -- */
/* The frames of another method than the one plain C computes, as multiples of a ray profile. */

/* A method that is timed beside the mean filter. */
typedef struct {
    const char *name;
    double limit_ms[2]; /* what a frame may take at 128^3 and at 171^3, milliseconds */
    uint32_t largest;   /* voxels an axis of the largest volume that it is timed on */
} bench_method;

enum { BENCH_METHODS = 2 };
extern const bench_method bench_methods[BENCH_METHODS];

/* Milliseconds of a frame as multiples of a ray profile: of the mean filter's,
 * and of its own. NAN: not known. */
typedef struct {
    double mean, own;
} bench_profile_ratio;
bench_profile_ratio bench_per_profile(const bench_report *report, const bench_plugin_result *result);

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
void bench_print_host(const bench_host_result *host);
void bench_print_targets(const bench_report *report);

/* ----------------------------------------------------------------------------------------------- files -- */
/* The benchmark's results as CSV and JSON. */

/* HS_ERR_OUTPUT names the path. */
bool bench_write_csv(const bench_report *report, const char *path, hs_error *err);
bool bench_write_json(const bench_report *report, const char *path, hs_error *err);

#endif
