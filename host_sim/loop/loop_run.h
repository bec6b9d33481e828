/* SPDX-License-Identifier: MIT */
/* Parts of a run: single stages of a frame, with what they leave read back to the host, and many frames of
 * one setting as medians, percentiles and counts. */
#pragma once

#include "core/progress.h"
#include "loop/loop.h"

/* Scan conversion for frame `index`. The slabs stay as they are until the next one. */
bool hs_loop_convert(hs_loop *loop, uint32_t index, hs_error *err);

/* The plugin's share of frame `index`: begin, slabs, end, with the loop's values. `map` (may be NULL)
 * receives the depthmap, width * height slices of the loop's layout, or zeros, which clip nothing, if it may
 * not be used. Times are not measured: frame->ms is zero. A failing plugin is no error
 * (hs_loop_plugin_error). */
bool hs_loop_clip(hs_loop *loop, uint32_t index, hs_frame *frame, float *map, hs_error *err);

/* hs_loop_clip of the last frame with another value of a parameter that is flagged SV_PARAM_ADJUST. */
bool hs_loop_adjust(hs_loop *loop, sv_param_value value, hs_frame *frame, float *map, hs_error *err);

/*
 * Where the rays end: a pixel's value is the depth in steps at which its opacity reached the renderer's
 * limit, or hs_loop_ray_steps if it never did (hs_dvr_render). As many values as the picture has pixels. Rays
 * start where the map of `frame`, the last one, tells (NULL: none, the full volume); or all at one step (>
 * 0); or at the front of another volume, of the source's size, that is uploaded for it.
 */
bool hs_loop_ray_ends(hs_loop *loop, uint32_t index, const hs_frame *frame, float *ends, hs_error *err);
bool hs_loop_ray_ends_from(hs_loop *loop, uint32_t index, uint32_t step, float *ends, hs_error *err);
bool hs_loop_ray_ends_in(hs_loop *loop, uint32_t index, const hs_volume *other, float *ends, hs_error *err);

/* Steps of a ray of frame `index` that crosses the whole box. */
uint32_t hs_loop_ray_steps(const hs_loop *loop, uint32_t index);

/* Of a duration's samples, milliseconds; p95, p99: nearest rank. */
typedef struct {
    double min, median, p95, p99, max;
} hs_timing;

/* Sorts the samples. The median of an even count is the mean of the middle two; zeros without samples. */
hs_timing hs_timing_of(double *ms, uint32_t count);

/* One setting over all frames. */
typedef struct {
    hs_setting setting;
    uint32_t frames;
    uint32_t clipped_frames; /* rendered with the plugin's map */
    uint32_t partial_frames; /* those of them whose map has pixels without a surface (SV_PARTIAL) */
    uint32_t note_frames;    /* the plugin found no surface: rendered unclipped */
    uint32_t failed_frames;  /* the plugin failed or was not there: rendered unclipped */
    hs_timing stage[HS_STAGE_COUNT];
    double volumes_per_second; /* 1000 / median of the whole loop */
    double plugin_share;       /* median of the plugin / median of the loop, 0 .. 1 */
    uint32_t doubtful_frames;  /* clipped although the plugin doubts it */
    hs_doubt doubt;            /* of the last frame */
    sv_status outcome;         /* of the last frame, with its statistics */
    sv_stats stats;
    sv_points_report points;
    bool has_plugin_stages;       /* the plugin has smartvis.timing/1 and it gave times: */
    sv_stage_times plugin_stages; /* medians of a few extra frames, measured apart because events cost time */
} hs_loop_result;

/* Runs options->frames frames of one setting after one that is not counted. `progress` may be NULL; it is
 * told about every frame. HS_ERR_DEVICE or HS_ERR_MEMORY. */
bool hs_loop_run(hs_loop *loop, hs_setting setting, hs_progress *progress, hs_loop_result *result,
                 hs_error *err);
