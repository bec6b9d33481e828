/* SPDX-License-Identifier: MIT */
#include "loop/clipper.h"

#include "guarded/guarded.h"
#include "loop/confidence_map.h"
#include "loop/map_check.h"
#include "plugin/loader_param.h"
#include "smartvis/band.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#define DEPTH_LIMIT 2.0f /* times the slices, before and behind: no surface lies farther out */

struct hs_clipper {
    const hs_plugin *plugin; /* NULL: none */
    const hs_cl *cl;
    const hs_slabs *slabs;
    bool own_queue, active;
    float spacing_mm[3];
    bool want_status, want_confidence;
    const sv_param_value *values;
    uint32_t value_count;
    size_t pixels;      /* of the depthmap */
    cl_mem depth;       /* device, float32: what the renderer reads */
    float *host_depth;  /* own queue: where the plugin writes; a band behind it */
    uint8_t *status;    /* SV_POINT_*; a band behind it */
    hs_map_check check; /* of depths that cannot be meant */
    hs_confidence_map *confidence;
    sv_stats stats;          /* written by the queue; valid when it has run */
    sv_points_report points; /* the same; size is 0 if the plugin does not have the extension */
    hs_error error;          /* the plugin's first failure */
};

/* The values of parameters that only activate reads. Others in the format would be refused or ignored. No
 * more are selected than were given, however often the plugin lists a parameter. */
static bool select_reactivate_values(const hs_clipper *clipper, sv_param_value *out, uint32_t *count) {
    const sv_plugin *instance = clipper->plugin->instance;
    *count = 0;
    for (uint32_t v = 0; v < clipper->value_count; v++) {
        sv_param_info info = {.size = sizeof info};
        uint32_t left = hs_plugin_param_count(clipper->plugin);
        for (uint32_t i = 0; left > 0; i++, left--) {
            if (instance->param_info(instance, i, &info) != SV_OK) return false;
            if (info.id == clipper->values[v].id) break;
        }
        if (left > 0 && (info.flags & SV_PARAM_REACTIVATE)) out[(*count)++] = clipper->values[v];
    }
    return true;
}

static sv_format make_format(const hs_clipper *clipper) {
    sv_format format = {.size = sizeof format};
    hs_slabs_describe_format(clipper->slabs, &format);
    memcpy(format.spacing_mm, clipper->spacing_mm, sizeof format.spacing_mm);
    if (!clipper->own_queue) {
        format.context = clipper->cl->context;
        format.device = clipper->cl->device;
        format.queue = clipper->cl->queue;
    }
    return format;
}

/* A failure here is the plugin's: it stays inactive, and the host goes on without it. */
static bool activate(hs_clipper *clipper, hs_error *err) {
    sv_param_value *fixed = hs_memory(clipper->value_count + 1u, sizeof *fixed, "plugin parameters", err);
    if (!fixed) return false;
    sv_format format = make_format(clipper);
    const sv_plugin *instance = clipper->plugin->instance;
    if (!select_reactivate_values(clipper, fixed, &format.value_count)) {
        (void)hs_fail(&clipper->error, HS_ERR_PLUGIN, "%s: param_info fails for an index below param_count",
                      clipper->plugin->path);
    } else {
        format.values = format.value_count ? fixed : NULL;
        sv_status status = instance->activate(instance, &format);
        clipper->active = hs_plugin_check(clipper->plugin, status, "activate", &clipper->error);
        if (!clipper->active && status > SV_OK) instance->deactivate(instance); /* it believes that it is */
    }
    free(fixed);
    return true;
}

static bool create_memory(hs_clipper *clipper, hs_error *err) {
    const hs_slab_layout *layout = hs_slabs_layout(clipper->slabs);
    const size_t bytes = clipper->pixels * sizeof(float);
    if (!hs_map_check_create(&clipper->check, clipper->cl, layout->width, layout->height, err) ||
        !hs_cl_take_buffer(clipper->cl, bytes, "depthmap", &clipper->depth, err))
        return false;
    clipper->host_depth = calloc(1, bytes + SV_BAND_BYTES);
    clipper->status = calloc(1, clipper->pixels + SV_BAND_BYTES);
    if (!clipper->host_depth || !clipper->status)
        return hs_fail(err, HS_ERR_MEMORY, "depthmap: no memory for %zu pixels", clipper->pixels);
    sv_band_make(clipper->host_depth + clipper->pixels);
    sv_band_make(clipper->status + clipper->pixels);
    return true;
}

hs_clipper *hs_clipper_create(const hs_cl *cl, const hs_slabs *slabs, const hs_plugin *plugin,
                              const hs_clipper_options *options, hs_error *err) {
    const hs_slab_layout *layout = hs_slabs_layout(slabs);
    hs_clipper *clipper = hs_memory(1, sizeof *clipper, "depthmap", err);
    if (!clipper) return NULL;
    clipper->plugin = plugin;
    clipper->cl = cl;
    clipper->slabs = slabs;
    clipper->own_queue = options->own_queue;
    memcpy(clipper->spacing_mm, options->spacing_mm, sizeof clipper->spacing_mm);
    clipper->want_confidence = options->want_confidence;
    hs_clipper_set_values(clipper, options->values, options->value_count);
    clipper->pixels = (size_t)layout->width * layout->height;
    if (options->refused) clipper->error = *options->refused;
    const bool asks = plugin && clipper->error.code == HS_OK;
    if (create_memory(clipper, err) && (!asks || activate(clipper, err)) &&
        (clipper->confidence = hs_confidence_map_create(cl, clipper->active ? plugin : NULL, layout->width,
                                                        layout->height, options->own_queue, err)) != NULL)
        return clipper;
    hs_clipper_destroy(clipper);
    return NULL;
}

void hs_clipper_destroy(hs_clipper *clipper) {
    if (!clipper) return;
    if (clipper->active) clipper->plugin->instance->deactivate(clipper->plugin->instance);
    hs_confidence_map_destroy(clipper->confidence);
    hs_map_check_destroy(&clipper->check);
    if (clipper->depth) clReleaseMemObject(clipper->depth);
    free(clipper->host_depth);
    free(clipper->status);
    free(clipper);
}

void hs_clipper_set_values(hs_clipper *clipper, const sv_param_value *values, uint32_t count) {
    clipper->values = values;
    clipper->value_count = count;
}

const sv_param_value *hs_clipper_values(const hs_clipper *clipper, uint32_t *count) {
    *count = clipper->value_count;
    return clipper->values;
}

void hs_clipper_want(hs_clipper *clipper, bool status, bool confidence) {
    clipper->want_status = status;
    clipper->want_confidence = confidence;
}

bool hs_clipper_wants_confidence(const hs_clipper *clipper) {
    return clipper->want_confidence;
}

/* ---------------------------------------------------------------------------------------------- frame -- */

bool hs_outcome_clips(sv_status outcome) {
    return outcome == SV_OK || outcome == SV_PARTIAL;
}

/* What no plugin writes: what still holds it was not written. */
enum { UNWRITTEN = INT32_MIN };

/* Before the plugin is asked: an earlier frame's map is forgotten. NaN is no depth, so that a pixel that the
 * plugin leaves out is found. */
static bool clear_map(hs_clipper *clipper, hs_error *err) {
    static const float nothing = NAN;
    const size_t bytes = clipper->pixels * sizeof nothing;
    if (clipper->own_queue)
        for (size_t i = 0; i < clipper->pixels; i++) clipper->host_depth[i] = nothing;
    const cl_int code = clEnqueueFillBuffer(clipper->cl->queue, clipper->depth, &nothing, sizeof nothing, 0,
                                            bytes, 0, NULL, NULL);
    return hs_cl_check(code, "clEnqueueFillBuffer (depthmap)", err);
}

/* Where the plugin shall write; the statistics are emptied. */
static sv_result make_result(hs_clipper *clipper) {
    clipper->stats = (sv_stats){.size = sizeof clipper->stats, .outcome = UNWRITTEN};
    return (sv_result){.size = sizeof(sv_result),
                       .depth = clipper->own_queue ? clipper->host_depth : NULL,
                       .depth_object = clipper->own_queue ? NULL : clipper->depth,
                       .status = clipper->want_status ? clipper->status : NULL,
                       .stats = &clipper->stats};
}

/* A plugin that is not told the pose, or does not heed it, takes a turned camera for another scene. */
static uint32_t frame_flags(const hs_clipper *clipper, const hs_frame_facts *m) {
    const sv_descriptor *d = clipper->plugin->instance->descriptor;
    const bool heeds = (d->features & SV_FEATURE_PROBE) != 0;
    const bool posed =
        heeds && (m->told.side[0] != 0.0f || m->told.side[1] != 0.0f || m->told.side[2] != 0.0f);
    if (!m->continues || (m->moved && !posed)) return SV_FRAME_DISCONTINUITY;
    return m->same_volume && heeds ? SV_FRAME_SAME_VOLUME : 0;
}

/* begin, every slab, end. A note (a positive status) of begin or slab changes nothing: the outcome is that of
 * end. Returns it, or the first error; *call names the call it came from. */
static sv_status ask_plugin(hs_clipper *clipper, hs_frame_facts facts, const char **call) {
    const sv_plugin *instance = clipper->plugin->instance;
    sv_frame frame = {.size = sizeof frame,
                      .flags = frame_flags(clipper, &facts),
                      .index = facts.index,
                      .time_ns = facts.time_ns,
                      .values = clipper->value_count ? clipper->values : NULL,
                      .value_count = clipper->value_count,
                      .beams = facts.told.beams,
                      .beam_sweep_mm = facts.told.sweep_mm};
    memcpy(frame.probe_rotation, facts.told.rotation, sizeof frame.probe_rotation);
    memcpy(frame.probe_side, facts.told.side, sizeof frame.probe_side);
    memcpy(frame.beam_apex_mm, facts.told.apex_mm, sizeof frame.beam_apex_mm);
    hs_slabs_describe_frame(clipper->slabs, clipper->own_queue, &frame);
    *call = "begin";
    sv_status status = instance->begin(instance, &frame);
    for (uint32_t i = 0; hs_status_is_success(status) && i < hs_slabs_count(clipper->slabs); i++) {
        sv_slab slab;
        *call = "slab";
        hs_slabs_describe(clipper->slabs, i, &slab);
        status = instance->slab(instance, &slab);
    }
    if (!hs_status_is_success(status)) return status;
    *call = "end";
    const sv_result result = make_result(clipper);
    return instance->end(instance, &result);
}

/* After the plugin's last call, behind its commands: the confidence, and a depthmap of its own queue. */
static bool enqueue_maps(hs_clipper *clipper, hs_error *err) {
    if (!hs_confidence_map_ask(clipper->confidence, clipper->want_confidence, err)) return false;
    if (clipper->own_queue) {
        const cl_int code =
            clEnqueueWriteBuffer(clipper->cl->queue, clipper->depth, CL_FALSE, 0,
                                 clipper->pixels * sizeof(float), clipper->host_depth, 0, NULL, NULL);
        if (!hs_cl_check(code, "clEnqueueWriteBuffer (depthmap)", err)) return false;
    }
    const float limit = DEPTH_LIMIT * (float)hs_slabs_layout(clipper->slabs)->slices;
    return hs_map_check_enqueue(&clipper->check, clipper->depth, -limit, limit, err);
}

/* Numbers that lie far out may be all that a method makes of these values: a spline goes on beyond its
 * points, ever steeper. What is no number is a fault. Which it is, is counted where there is something to
 * say. */
static bool refuse_depths(hs_clipper *clipper) {
    const char *path = clipper->plugin->path;
    const int far = (int)clipper->check.count;
    if (!hs_map_check_enqueue(&clipper->check, clipper->depth, -FLT_MAX, FLT_MAX, &clipper->error) ||
        !hs_cl_check(clFinish(clipper->cl->queue), "clFinish (map check)", &clipper->error))
        return false;
    if (clipper->check.count > 0)
        return hs_fail(&clipper->error, HS_ERR_PLUGIN,
                       "%s: end: %d of %zu depths were not written, or are not finite", path,
                       (int)clipper->check.count, clipper->pixels);
    return hs_fail(&clipper->error, HS_ERR_PLUGIN,
                   "%s: end: %d of %zu depths lie beyond %g times the volume: with these values its surface "
                   "leaves the scan",
                   path, far, clipper->pixels, (double)DEPTH_LIMIT);
}

/* False with the error if the plugin wrote behind its maps: in words of a plugin that finds that itself. */
static bool bands_hold(hs_clipper *clipper, const char *call) {
    const bool depth = sv_band_holds(clipper->host_depth + clipper->pixels);
    const bool status = sv_band_holds(clipper->status + clipper->pixels);
    return (depth && status) ||
           hs_fail(&clipper->error, HS_ERR_PLUGIN, "%s: %s: %s (%d): " SV_BAND_TEXT, clipper->plugin->path,
                   call, hs_status_name(SV_ERR_INTERNAL), SV_ERR_INTERNAL, call, (unsigned)clipper->pixels,
                   depth ? SV_BAND_STATUS : "");
}

/* What can be said against a frame whose calls all succeeded; keeps the first of it. */
static bool holds_up(hs_clipper *clipper, const char *call, sv_status status) {
    const char *path = clipper->plugin->path;
    const sv_status outcome = status == SV_OK ? clipper->stats.outcome : status;
    if (!hs_guarded_lives(clipper->plugin)) /* it ended in what follows a frame */
        return hs_fail(&clipper->error, HS_ERR_PLUGIN, "%s", hs_guarded_ended(clipper->plugin)->text);
    if (!bands_hold(clipper, call)) return false;
    if (outcome == UNWRITTEN)
        return hs_fail(&clipper->error, HS_ERR_PLUGIN, "%s: end: returned SV_OK, but wrote no statistics",
                       path);
    if (!hs_status_is_known(outcome))
        return hs_fail(&clipper->error, HS_ERR_PLUGIN, "%s: end: the outcome %d is none of the header's",
                       path, (int)outcome);
    if (hs_outcome_clips(outcome) && clipper->check.count > 0) return refuse_depths(clipper);
    return hs_plugin_check(clipper->plugin, outcome, "end", &clipper->error);
}

/* The depthmap is on the device, the queue has run, and the outcome is known. */
static bool settle(hs_clipper *clipper, sv_status status, const char *call, hs_clip_outcome *clip,
                   hs_error *err) {
    *clip = (hs_clip_outcome){.outcome = status};
    if (status >= SV_OK) hs_plugin_points(clipper->plugin->instance, &clipper->points);
    if (hs_outcome_clips(status) && !enqueue_maps(clipper, err)) return false;
    /* Waiting here costs some 30 us and settles two things: the statistics are valid, and the host knows the
     * outcome before it renders. After a failure the plugin's commands may still be under way, too. */
    if (!hs_cl_check(clFinish(clipper->cl->queue), "clFinish (plugin)", err)) return false;
    if (!hs_status_is_success(status)) {
        call = hs_guarded_call(clipper->plugin, call);
        (void)hs_plugin_check(clipper->plugin, status, call, &clipper->error);
        if (status > SV_OK) clip->outcome = SV_ERR_INTERNAL;
        return true;
    }
    if (!holds_up(clipper, call, status)) {
        clip->outcome = SV_ERR_INTERNAL;
        return true;
    }
    clip->stats = clipper->stats;
    clip->points = clipper->points;
    /* With the host's queue end returns SV_OK before the outcome is known: the statistics tell it. */
    if (status == SV_OK) clip->outcome = clipper->stats.outcome;
    clip->clipped = hs_outcome_clips(clip->outcome);
    if (clip->clipped) clip->doubt = hs_plugin_doubt(clipper->plugin->instance);
    clip->has_confidence = clip->clipped && hs_confidence_map_settle(clipper->confidence);
    return true;
}

bool hs_clipper_frame(hs_clipper *clipper, hs_frame_facts facts, hs_clip_outcome *clip, hs_error *err) {
    *clip = (hs_clip_outcome){.outcome = SV_ERR_STATE};
    if (!clipper->active) return true;
    const char *call;
    if (!clear_map(clipper, err)) return false;
    const sv_status status = ask_plugin(clipper, facts, &call);
    return settle(clipper, status, call, clip, err);
}

bool hs_clipper_adjust(hs_clipper *clipper, const sv_param_value *values, uint32_t count,
                       hs_clip_outcome *clip, hs_error *err) {
    *clip = (hs_clip_outcome){.outcome = SV_ERR_STATE};
    if (!clipper->active) return true;
    const sv_plugin *instance = clipper->plugin->instance;
    if (!clear_map(clipper, err)) return false;
    const sv_result result = make_result(clipper);
    return settle(clipper, instance->adjust(instance, values, count, &result), "adjust", clip, err);
}

/* --------------------------------------------------------------------------------------- what it left -- */

const hs_start_depths *hs_clipper_start(const hs_clipper *clipper, bool clipped, bool with_confidence,
                                        hs_start_depths *out) {
    const hs_slab_layout *layout = hs_slabs_layout(clipper->slabs);
    if (!clipped) return NULL;
    *out = (hs_start_depths){.depth = clipper->depth,
                             .confidence =
                                 with_confidence ? hs_confidence_map_values(clipper->confidence) : NULL,
                             .width = layout->width,
                             .height = layout->height,
                             .slices = layout->slices};
    return out;
}

static bool read_map(const hs_clipper *clipper, cl_mem from, float *to, const char *what, hs_error *err) {
    const size_t bytes = clipper->pixels * sizeof(float);
    return hs_cl_check(clEnqueueReadBuffer(clipper->cl->queue, from, CL_TRUE, 0, bytes, to, 0, NULL, NULL),
                       what, err);
}

bool hs_clipper_read_depth(const hs_clipper *clipper, float *depth, hs_error *err) {
    return read_map(clipper, clipper->depth, depth, "clEnqueueReadBuffer (depthmap)", err);
}

bool hs_clipper_write_depth(hs_clipper *clipper, const float *depth, hs_error *err) {
    return hs_cl_check(clEnqueueWriteBuffer(clipper->cl->queue, clipper->depth, CL_TRUE, 0,
                                            clipper->pixels * sizeof *depth, depth, 0, NULL, NULL),
                       "clEnqueueWriteBuffer (marks)", err);
}

bool hs_clipper_read_confidence(const hs_clipper *clipper, float *confidence, hs_error *err) {
    return read_map(clipper, hs_confidence_map_values(clipper->confidence), confidence,
                    "clEnqueueReadBuffer (confidence)", err);
}

const uint8_t *hs_clipper_status(const hs_clipper *clipper) {
    return clipper->status;
}

const hs_error *hs_clipper_error(const hs_clipper *clipper) {
    /* A guarded plugin may also end where no frame fails of it. */
    return clipper->error.code == HS_OK ? hs_guarded_ended(clipper->plugin) : &clipper->error;
}

void hs_clipper_forget_error(hs_clipper *clipper) {
    clipper->error = (hs_error){0};
}

const hs_error *hs_clipper_confidence_error(const hs_clipper *clipper) {
    return hs_confidence_map_error(clipper->confidence);
}

static const sv_ext_timing *timing_of(const hs_clipper *clipper) {
    return clipper->active ? hs_plugin_timing(clipper->plugin->instance) : NULL;
}

bool hs_clipper_time_stages(const hs_clipper *clipper, bool on) {
    const sv_ext_timing *ext = timing_of(clipper);
    return ext && ext->enable(clipper->plugin->instance, on) == SV_OK;
}

bool hs_clipper_stage_times(const hs_clipper *clipper, sv_stage_times *times) {
    const sv_ext_timing *ext = timing_of(clipper);
    *times = (sv_stage_times){.size = sizeof *times};
    return ext && ext->stage_times(clipper->plugin->instance, times) == SV_OK;
}
