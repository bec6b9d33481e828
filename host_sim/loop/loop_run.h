/* SPDX-License-Identifier: MIT */
/* Many frames of one setting: medians, percentiles, counts. */
#ifndef HS_LOOP_RUN_H
#define HS_LOOP_RUN_H

#include "base/progress.h"
#include "loop/loop.h"

/* Median and 95th percentile (nearest rank) in ms. */
typedef struct {
    double median, p95;
} hs_timing;

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

#endif
