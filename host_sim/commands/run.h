/* SPDX-License-Identifier: MIT */
/* One run of the simulator from request to pictures: what `run` does once, and `demo` for every scene. */
#pragma once

#include "guarded/guarded.h"
#include "loop/loop_run.h"
#include "loop/source.h"
#include "result/result_write.h"

#include <stdio.h>

/* What to run. Strings and arrays are borrowed and must outlive the run. */
typedef struct {
    const char *plugin_path; /* NULL: smartvis.so beside the executable */
    const char *plugin_id;   /* NULL: the library's first */
    const char *map; /* NULL, or instead of a plugin a file of loop.lowres * loop.lowres depths in mm */
    hs_guard_options guard;     /* whether the plugin has a process of its own */
    int32_t log_level;          /* SV_LOG_*: less severe lines of the plugin are not printed */
    const char *const *volumes; /* files, or ... */
    uint32_t volume_count;
    hs_source_scene scene;   /* ... a scene, if it has a name */
    hs_source_files files;   /* how the volumes are read */
    hs_crop crop;            /* of the volumes */
    const char *const *sets; /* key=value for the plugin's parameters */
    uint32_t set_count;
    hs_loop_options loop; /* values are filled in from sets */
    bool alone; /* hs_run_open may start this program again with the same arguments, to compile kernels */
    bool few_pictures;               /* result.png and full.png alone */
    uint32_t panel_cell;             /* width of a picture in panel.png, pixels; 0: 512 */
    bool settings[HS_SETTING_COUNT]; /* which to measure */
    uint32_t write, write_if; /* HS_RESULT_* to be written: these, and these if the plugin gives them */
    const char *reference;    /* a depthmap that the one found is compared with; NULL: none */
    double tolerance;         /* mm that the two may be apart */
} hs_run_request;

/* A run under way. Must not move in memory while open (the plugin holds a pointer into it). */
typedef struct {
    hs_run_request request;
    char plugin_path[1024];
    hs_source source;
    double unscanned; /* share of its first volume that was not scanned, 0 .. 1 */
    hs_cl cl;
    hs_plugin plugin;
    bool has_plugin;
    sv_param_value *values;
    float *depths; /* of request.map */
    hs_given_map given;
    hs_loop *loop;
    hs_error earlier_confidence_error; /* the first failure of its confidence */
    hs_error earlier_error; /* the plugin's failure while loading, or in a loop that was replaced */
    hs_loop_result results[HS_SETTING_COUNT];
    uint32_t result_count;
    bool has_written;
    hs_result_report written;
    hs_result_difference difference; /* rays is 0 if nothing was compared */
} hs_run;

/* Zeros, defaults of the loop, all settings, scene size 256, warnings of the plugin. */
void hs_run_defaults(hs_run_request *request);

/*
 * Loads plugin, source and device and builds the loop. A plugin that cannot be loaded or activated is no
 * failure: see hs_run_plugin_error. Parameters are checked first, so that a slip costs no time: HS_ERR_USAGE.
 * On failure everything is freed.
 */
bool hs_run_open(hs_run *run, const hs_run_request *request, hs_error *err);

/* Measures the wanted settings into run->results, with a progress line. */
bool hs_run_measure(hs_run *run, hs_error *err);

/* Writes the pictures of the middle frame into the folder. */
bool hs_run_pictures(hs_run *run, const char *folder, hs_error *err);

/* Writes the files that the request names into the folder, and compares the depthmap with the reference;
 * HS_ERR_USAGE if the camera orbits, or a reference is given and the source has several volumes. */
bool hs_run_write(hs_run *run, const char *folder, hs_error *err);

/* Ends the loop and builds another from the same source, plugin and device: for other cameras. run->results
 * stay. On failure there is no loop, and only hs_run_close may follow. */
bool hs_run_replace_loop(hs_run *run, const hs_loop_options *options, hs_error *err);

/* Ends loop and plugin, and everything else. False with HS_ERR_PLUGIN if a guarded plugin failed in that, or
 * at any other time. Safe on a zeroed struct and after a failed open. */
bool hs_run_close(hs_run *run, hs_error *err);

/* The first failure of the plugin, of loading or of a frame; code HS_OK if there was none. */
const hs_error *hs_run_plugin_error(const hs_run *run);

/* The first failure of the plugin's confidence map (hs_loop_confidence_error). */
const hs_error *hs_run_confidence_error(const hs_run *run);

/* True if frames of the setting have the stage at all. */
bool hs_run_has_stage(const hs_run *run, hs_setting setting, hs_stage stage);

/* "org.smartvis.clip 1.0.0", the file of a map that was given, or "no plugin". */
void hs_run_plugin_name(const hs_run *run, char *out, size_t bytes);

/* Share of voxels of a volume that were not scanned, 0 .. 1. */
double hs_unscanned_share(const hs_volume *volume);

/* The facts and the table of times, shares and statistics, as in the thesis' Figure 5.21 and Table 5.4. */
void hs_run_print(const hs_run *run, FILE *out);
