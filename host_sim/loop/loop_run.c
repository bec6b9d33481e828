/* SPDX-License-Identifier: MIT */
#include "loop/loop_run.h"

#include "loop/loop_state.h"

#include <stdlib.h>
#include <string.h>

bool hs_loop_convert(hs_loop *loop, uint32_t index, hs_error *err) {
    hs_camera camera;
    hs_loop_camera(loop, index, &camera);
    return hs_slabs_convert(loop->slabs, loop->volume, &camera, err) &&
           hs_cl_check(clFinish(loop->cl->queue), "clFinish (scan conversion)", err);
}

/* A call's outcome as a frame, and its map. */
static bool take_clip(hs_loop *loop, const hs_clip_outcome *clip, hs_frame *frame, float *map,
                      hs_error *err) {
    const hs_slab_layout *layout = hs_loop_layout(loop);
    *frame = (hs_frame){0};
    hs_loop_note_clip(clip, frame);
    if (!map) return true;
    if (clip->clipped) return hs_clipper_read_depth(loop->clipper, map, err);
    memset(map, 0, (size_t)layout->width * layout->height * sizeof *map);
    return true;
}

bool hs_loop_clip(hs_loop *loop, uint32_t index, hs_frame *frame, float *map, hs_error *err) {
    hs_clip_outcome clip;
    return hs_clipper_frame(loop->clipper, hs_loop_facts_alone(loop, index), &clip, err) &&
           hs_loop_mark(loop, index, &clip, err) && take_clip(loop, &clip, frame, map, err);
}

bool hs_loop_adjust(hs_loop *loop, sv_param_value value, hs_frame *frame, float *map, hs_error *err) {
    hs_clip_outcome clip;
    return hs_clipper_adjust(loop->clipper, &value, 1, &clip, err) &&
           hs_loop_mark(loop, loop->asked, &clip, err) && take_clip(loop, &clip, frame, map, err);
}

bool hs_loop_ray_ends(hs_loop *loop, uint32_t index, const hs_frame *frame, float *ends, hs_error *err) {
    hs_camera camera;
    hs_start_depths depths;
    const hs_start_depths *start =
        frame ? hs_clipper_start(loop->clipper, frame->clipped, frame->has_confidence, &depths) : NULL;
    hs_loop_camera(loop, index, &camera);
    return hs_screen_render(loop->screen, loop->volume, &camera, start, true, err) &&
           hs_screen_read_termination(loop->screen, ends, err);
}

bool hs_loop_ray_ends_from(hs_loop *loop, uint32_t index, uint32_t step, float *ends, hs_error *err) {
    hs_camera camera;
    hs_loop_camera(loop, index, &camera);
    return hs_screen_render_from(loop->screen, loop->volume, &camera, step, err) &&
           hs_screen_read_termination(loop->screen, ends, err);
}

bool hs_loop_ray_ends_in(hs_loop *loop, uint32_t index, const hs_volume *other, float *ends, hs_error *err) {
    hs_camera camera;
    hs_loop_camera(loop, index, &camera);
    hs_device_volume *volume = hs_device_volume_create(loop->cl, other, err);
    const bool ok = volume && hs_screen_render(loop->screen, volume, &camera, NULL, true, err) &&
                    hs_screen_read_termination(loop->screen, ends, err);
    hs_device_volume_destroy(volume);
    return ok;
}

uint32_t hs_loop_ray_steps(const hs_loop *loop, uint32_t index) {
    hs_camera camera;
    hs_loop_camera(loop, index, &camera);
    return hs_screen_steps(loop->screen, loop->volume, &camera);
}

#define PLUGIN_STAGE_FRAMES 7u /* at most so many extra frames with the plugin's own timing on */

static int ascending(const void *a, const void *b) {
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

hs_timing hs_timing_of(double *ms, uint32_t count) {
    if (count == 0) return (hs_timing){0};
    qsort(ms, count, sizeof *ms, ascending);
    return (hs_timing){.min = ms[0],
                       .median = 0.5 * (ms[(count - 1) / 2] + ms[count / 2]),
                       .p95 = ms[(count * 95 + 99) / 100 - 1],
                       .p99 = ms[(count * 99 + 99) / 100 - 1],
                       .max = ms[count - 1]};
}

static void count_outcome(hs_loop_result *result, const hs_frame *frame) {
    if (frame->clipped)
        result->clipped_frames++;
    else if (frame->outcome > SV_OK)
        result->note_frames++;
    else
        result->failed_frames++;
    result->partial_frames += frame->clipped && frame->outcome == SV_PARTIAL;
    result->doubtful_frames += frame->clipped && frame->doubt.wanted > 0.0f;
    result->doubt = frame->doubt;
    result->outcome = frame->outcome;
    result->stats = frame->stats;
    result->points = frame->points;
}

/* The split of the plugin's time. Apart from the timed run, since every command then keeps an event. */
static bool measure_plugin_stages(hs_loop *loop, hs_loop_result *result, hs_error *err) {
    if (!hs_clipper_time_stages(loop->clipper, true)) return true;
    double ms[5][PLUGIN_STAGE_FRAMES];
    const uint32_t frames = loop->options.frames;
    const uint32_t extra = frames < PLUGIN_STAGE_FRAMES ? frames : PLUGIN_STAGE_FRAMES;
    uint32_t got = 0;
    bool ok = true;
    for (uint32_t i = 0; ok && i < extra; i++) {
        hs_frame frame;
        sv_stage_times times;
        ok = hs_loop_frame_undrawn(loop, i, &frame, err);
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
                                             .transfer_ms = hs_timing_of(ms[0], got).median,
                                             .profile_ms = hs_timing_of(ms[1], got).median,
                                             .threshold_ms = hs_timing_of(ms[2], got).median,
                                             .reconstruct_ms = hs_timing_of(ms[3], got).median,
                                             .output_ms = hs_timing_of(ms[4], got).median};
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
    for (int s = 0; s < HS_STAGE_COUNT; s++)
        result->stage[s] = hs_timing_of(times + (size_t)s * frames, frames);
    return true;
}

bool hs_loop_run(hs_loop *loop, hs_setting setting, hs_progress *progress, hs_loop_result *result,
                 hs_error *err) {
    const uint32_t frames = loop->options.frames;
    *result = (hs_loop_result){.setting = setting, .frames = frames};
    double *times = hs_memory((size_t)HS_STAGE_COUNT * frames, sizeof *times, "times", err);
    if (!times) return false;
    const bool ok = run_frames(loop, times, progress, result, err);
    free(times);
    if (!ok) return false;
    const double loop_ms = result->stage[HS_STAGE_LOOP].median;
    result->volumes_per_second = loop_ms > 0 ? 1e3 / loop_ms : 0;
    result->plugin_share = loop_ms > 0 ? result->stage[HS_STAGE_PLUGIN].median / loop_ms : 0;
    return setting != HS_SETTING_SMARTVIS || measure_plugin_stages(loop, result, err);
}
