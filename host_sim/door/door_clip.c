/* SPDX-License-Identifier: MIT */
/* A frame: activated where that is needed, converted, asked, read back. */
#include "door/door_clipper.h"

#include <stdlib.h>
#include <string.h>

/* --------------------------------------------------------------------------------------------- frame -- */

/* What a call of the plugin came to, if it failed. A clipper that never was active is tried anew. */
static bool check_outcome(svh_clipper *clipper, const hs_clip_outcome *clip, hs_error *err) {
    if (clip->outcome >= SV_OK) return true;
    const hs_error *said = hs_clipper_error(clipper->clipper);
    (void)hs_fail(err, HS_ERR_PLUGIN, "%s", said->code != HS_OK ? said->text : "the plugin gives no reason");
    hs_clipper_forget_error(clipper->clipper);
    if (clip->outcome == SV_ERR_STATE) door_deactivate(clipper);
    return false;
}

static bool keep_marks(svh_clipper *clipper, const svh_frame *frame, hs_error *err) {
    free(clipper->marks);
    clipper->mark_count = 0;
    clipper->marks = door_marks(frame->marks, frame->mark_count, err);
    if (clipper->marks) clipper->mark_count = frame->mark_count;
    return clipper->marks != NULL;
}

static bool check_frame(const svh_frame *frame, hs_error *err) {
    return (frame->flags & ~(uint32_t)(SVH_CONTINUES | SVH_SAME_VOLUME | SVH_TIMED)) == 0 ||
           hs_fail(err, HS_ERR_USAGE, "svh_frame: flags are 0x%x, expected SVH_CONTINUES, ...", frame->flags);
}

/* The camera has moved if it looks elsewhere than before. */
static hs_frame_facts facts_of(const svh_clipper *clipper, const svh_view *view, const svh_frame *frame,
                               const hs_camera *camera) {
    const bool same = (frame->flags & SVH_SAME_VOLUME) != 0;
    return (hs_frame_facts){.index = clipper->index,
                            .time_ns = frame->time_ns,
                            .continues = clipper->has_before && (same || frame->flags & SVH_CONTINUES),
                            .same_volume = clipper->has_before && same,
                            .moved = !door_same(camera->rotation, clipper->camera.rotation, 9),
                            .told = door_told(view)};
}

static bool ask(svh_clipper *clipper, svh_volume *volume, const svh_view *view, const svh_frame *frame,
                hs_clip_outcome *clip, hs_error *err) {
    hs_camera camera;
    hs_device_volume *source = NULL;
    if (!door_camera(volume, view, &camera, err) || !keep_marks(clipper, frame, err) ||
        !door_activate(clipper, volume, view, &camera, err) || !(source = door_bring(volume, err)) ||
        !hs_slabs_convert(clipper->slabs, source, &camera, err) ||
        !hs_cl_check(clFinish(volume->host->cl.queue), "clFinish (scan conversion)", err))
        return false;
    const hs_frame_facts facts = facts_of(clipper, view, frame, &camera);
    hs_clipper_set_values(clipper->clipper, clipper->values, clipper->value_count);
    hs_clipper_want(clipper->clipper, true, true);
    clipper->volume = NULL;
    const bool timed = frame->flags & SVH_TIMED && hs_clipper_time_stages(clipper->clipper, true);
    const bool ok = hs_clipper_frame(clipper->clipper, facts, clip, err) && check_outcome(clipper, clip, err);
    clipper->times = (sv_stage_times){0};
    if (ok && timed) (void)hs_clipper_stage_times(clipper->clipper, &clipper->times);
    if (timed && clipper->clipper) (void)hs_clipper_time_stages(clipper->clipper, false);
    if (!ok) return false;
    clipper->index++;
    clipper->has_before = true;
    clipper->volume = volume;
    clipper->camera = camera;
    return true;
}

/* -------------------------------------------------------------------------------------------- result -- */

static bool offers_confidence(const svh_clipper *clipper) {
    const sv_plugin *instance = clipper->plugin.instance;
    const sv_ext_confidence *ext = hs_plugin_confidence(instance);
    return ext && ext->offered(instance);
}

/* Where nothing is clipped there is nothing to be sure of. */
static bool read_maps(svh_clipper *clipper, const hs_clip_outcome *clip, svh_result *out, hs_error *err) {
    const size_t rays = (size_t)clipper->n[0] * clipper->n[1];
    memset(clipper->depth, 0, rays * sizeof *clipper->depth);
    memset(clipper->confidence, 0, rays * sizeof *clipper->confidence);
    if (clip->clipped && !hs_clipper_read_depth(clipper->clipper, clipper->depth, err)) return false;
    if (clip->clipped && clipper->mark_count > 0 &&
        !hs_marks_apply(clipper->marks, clipper->mark_count, &clipper->volume->volume, &clipper->camera,
                        clipper->n, clipper->depth, err))
        return false;
    if (clip->has_confidence && !hs_clipper_read_confidence(clipper->clipper, clipper->confidence, err))
        return false;
    out->depth = clipper->depth;
    out->status = hs_clipper_status(clipper->clipper);
    if (clip->has_confidence || (!clip->clipped && offers_confidence(clipper)))
        out->confidence = clipper->confidence;
    return true;
}

static void tell_reason(svh_clipper *clipper, svh_result *out) {
    sv_confidence_report report;
    out->why = clipper->why;
    if (!hs_plugin_reason(clipper->plugin.instance, &report, clipper->why)) clipper->why[0] = '\0';
    out->knows_fluid = offers_confidence(clipper);
    if (!out->knows_fluid) return;
    out->fluid_threshold = report.fluid_threshold;
    out->open_rays = report.open_rays;
    out->try_id = report.try_id;
    out->try_value = (double)report.try_value;
}

static bool tell(svh_clipper *clipper, const hs_clip_outcome *clip, svh_result *out, hs_error *err) {
    svh_result own = {.outcome = clip->outcome,
                      .clips = clip->clipped,
                      .points = clip->stats.points,
                      .unfilled = clip->stats.unfilled,
                      .knows_points = clip->points.size != 0 && clip->stats.points > 0,
                      .bone_threshold = clip->points.bone_threshold,
                      .volume_max = clip->points.volume_max,
                      .passes = clip->points.passes,
                      .reconstruct_ms = (float)clipper->times.reconstruct_ms};
    memcpy(own.n, clipper->n, sizeof own.n);
    own.spacing[0] = own.spacing[1] = clipper->camera.extent / clipper->n[0];
    own.spacing[2] = clipper->camera.depth_extent / clipper->n[2];
    tell_reason(clipper, &own);
    if (!read_maps(clipper, clip, &own, err)) return false;
    door_give(out, &own, sizeof own);
    return true;
}

int32_t svh_clip(svh_clipper *clipper, svh_volume *volume, const svh_view *view, const svh_frame *frame,
                 svh_result *out, svh_error *error) {
    svh_frame told = {0};
    svh_view seen = {.size = sizeof seen};
    hs_clip_outcome clip;
    hs_error err = {0};
    if (!DOOR_GIVEN(&err, clipper, volume, out)) return door_leave(NULL, &err, error);
    if (!view) {
        const int32_t code = svh_plan(volume, &seen, error);
        if (code != SVH_OK) return code;
    }
    (void)pthread_mutex_lock(&clipper->host->lock);
    if (volume->host != clipper->host)
        (void)hs_fail(&err, HS_ERR_USAGE,
                      "svh_clip: the volume was taken by another host than the clipper's");
    else if (DOOR_FITS(svh_result, out, &err) && (!frame || DOOR_TAKE(svh_frame, &told, frame, &err)) &&
             (!view || DOOR_TAKE(svh_view, &seen, view, &err)) && check_frame(&told, &err) &&
             door_check_planned(&seen, &err) && ask(clipper, volume, &seen, &told, &clip, &err))
        (void)tell(clipper, &clip, out, &err);
    return door_leave(clipper->host, &err, error);
}

static bool adjust(svh_clipper *clipper, const uint32_t *ids, const double *values, uint32_t count,
                   hs_clip_outcome *clip, hs_error *err) {
    if (!clipper->volume) return hs_fail(err, HS_ERR_USAGE, "svh_adjust: there is no volume to adjust yet");
    if (count > 0 && (!ids || !values))
        return hs_fail(err, HS_ERR_USAGE, "svh_adjust: %s is NULL, expected %u", ids ? "values" : "ids",
                       count);
    sv_param_value *own = hs_memory(count + 1u, sizeof *own, "settings", err);
    for (uint32_t i = 0; own && i < count; i++) own[i] = (sv_param_value){.id = ids[i], .value = values[i]};
    const bool ok = own && hs_clipper_adjust(clipper->clipper, own, count, clip, err);
    free(own);
    return ok && check_outcome(clipper, clip, err);
}

int32_t svh_adjust(svh_clipper *clipper, const uint32_t *ids, const double *values, uint32_t count,
                   svh_result *out, svh_error *error) {
    hs_clip_outcome clip;
    hs_error err = {0};
    if (!DOOR_GIVEN(&err, clipper, out)) return door_leave(NULL, &err, error);
    (void)pthread_mutex_lock(&clipper->host->lock);
    clipper->times = (sv_stage_times){0};
    if (DOOR_FITS(svh_result, out, &err) && adjust(clipper, ids, values, count, &clip, &err))
        (void)tell(clipper, &clip, out, &err);
    return door_leave(clipper->host, &err, error);
}
