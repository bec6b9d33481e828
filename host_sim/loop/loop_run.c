/* SPDX-License-Identifier: MIT */
#include "loop/loop_run.h"

#include "loop/loop_state.h"

#include <math.h>
#include <stdlib.h>

#define PLUGIN_STAGE_FRAMES 7u /* extra frames with the plugin's own timing on */

static int ascending(const void *a, const void *b) {
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

/* Sorts in place. The median of an even count is the mean of the middle two. */
static hs_timing summarise(double *ms, uint32_t count) {
    qsort(ms, count, sizeof *ms, ascending);
    const double median = count % 2 ? ms[count / 2] : 0.5 * (ms[count / 2 - 1] + ms[count / 2]);
    const uint32_t rank = (uint32_t)ceil(0.95 * count);
    return (hs_timing){.median = median, .p95 = ms[rank - 1]};
}

static void count_outcome(hs_loop_result *result, const hs_frame *frame) {
    if (frame->clipped)
        result->clipped_frames++;
    else if (frame->outcome > SV_OK)
        result->note_frames++;
    else
        result->failed_frames++;
    result->partial_frames += frame->clipped && frame->outcome == SV_PARTIAL;
    result->outcome = frame->outcome;
    result->stats = frame->stats;
    result->points = frame->points;
}

/* The split of the plugin's time. Apart from the timed run, since every command then keeps an event. */
static bool measure_plugin_stages(hs_loop *loop, hs_loop_result *result, hs_error *err) {
    if (!hs_clipper_time_stages(loop->clipper, true)) return true;
    double ms[5][PLUGIN_STAGE_FRAMES];
    uint32_t got = 0;
    bool ok = true;
    for (uint32_t i = 0; ok && i < PLUGIN_STAGE_FRAMES; i++) {
        hs_frame frame;
        sv_stage_times times;
        ok = hs_loop_frame(loop, HS_SETTING_SMARTVIS, i % loop->options.frames, &frame, err);
        if (!ok || !hs_clipper_stage_times(loop->clipper, &times)) continue;
        const double stage[5] = {times.transfer_ms, times.profile_ms, times.threshold_ms,
                                 times.reconstruct_ms, times.output_ms};
        for (int s = 0; s < 5; s++) ms[s][got] = stage[s];
        got++;
    }
    (void)hs_clipper_time_stages(loop->clipper, false);
    if (!ok || got == 0) return ok;
    result->has_plugin_stages = true;
    result->plugin_stages = (sv_stage_times){.size = sizeof result->plugin_stages,
                                             .transfer_ms = summarise(ms[0], got).median,
                                             .profile_ms = summarise(ms[1], got).median,
                                             .threshold_ms = summarise(ms[2], got).median,
                                             .reconstruct_ms = summarise(ms[3], got).median,
                                             .output_ms = summarise(ms[4], got).median};
    return true;
}

/* The frames of a run; `times` has HS_STAGE_COUNT rows of a time a frame. */
static bool run_frames(hs_loop *loop, double *times, hs_progress *progress, hs_loop_result *result,
                       hs_error *err) {
    const uint32_t frames = result->frames;
    hs_frame frame;
    if (!hs_loop_frame(loop, result->setting, 0, &frame, err)) return false; /* first launches: not counted */
    for (uint32_t i = 0; i < frames; i++) {
        if (!hs_loop_frame(loop, result->setting, i, &frame, err)) return false;
        for (int s = 0; s < HS_STAGE_COUNT; s++) times[(size_t)s * frames + i] = frame.ms[s];
        if (result->setting == HS_SETTING_SMARTVIS) count_outcome(result, &frame);
        if (progress) hs_progress_step(progress, i + 1u);
    }
    for (int s = 0; s < HS_STAGE_COUNT; s++) result->stage[s] = summarise(times + (size_t)s * frames, frames);
    return true;
}

bool hs_loop_run(hs_loop *loop, hs_setting setting, hs_progress *progress, hs_loop_result *result,
                 hs_error *err) {
    const uint32_t frames = loop->options.frames;
    *result = (hs_loop_result){.setting = setting, .frames = frames};
    double *times = calloc((size_t)HS_STAGE_COUNT * frames, sizeof *times);
    if (!times) return hs_fail(err, HS_ERR_MEMORY, "times: no memory for %u frames", frames);
    const bool ok = run_frames(loop, times, progress, result, err);
    free(times);
    if (!ok) return false;
    const double loop_ms = result->stage[HS_STAGE_LOOP].median;
    result->volumes_per_second = loop_ms > 0 ? 1e3 / loop_ms : 0;
    result->plugin_share = loop_ms > 0 ? result->stage[HS_STAGE_PLUGIN].median / loop_ms : 0;
    return setting != HS_SETTING_SMARTVIS || measure_plugin_stages(loop, result, err);
}
