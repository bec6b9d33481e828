/* SPDX-License-Identifier: MIT */
/* Times the host's own parts and the whole scan loop around the plugin. */
#ifndef BENCH_HOST_H
#define BENCH_HOST_H

#include "bench/bench_lit.h"
#include "bench/bench_times.h"
#include "loop/loop_run.h"

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

#endif
