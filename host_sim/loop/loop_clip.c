/* SPDX-License-Identifier: MIT */
/* The plugin's share of a frame. Whatever it returns but SV_OK, the frame is rendered unclipped. */
#include "loop/loop_parts.h"

#include <stdlib.h>
#include <string.h>

/* The values of parameters that only activate reads. Others in the format would be refused or ignored. */
static bool pick_reactivate_values(const hs_clipper *clipper, sv_param_value *out, uint32_t *count) {
    const sv_plugin *instance = clipper->plugin->instance;
    *count = 0;
    for (uint32_t i = 0; i < instance->param_count(instance); i++) {
        sv_param_info info = {.size = sizeof info};
        if (instance->param_info(instance, i, &info) != SV_OK) return false;
        if (!(info.flags & SV_PARAM_REACTIVATE)) continue;
        for (uint32_t v = 0; v < clipper->value_count; v++)
            if (clipper->values[v].id == info.id) out[(*count)++] = clipper->values[v];
    }
    return true;
}

static sv_format make_format(const hs_clipper *clipper) {
    const hs_slab_layout *layout = &clipper->slabs->layout;
    sv_format format = {.size = sizeof format,
                        .width = layout->width,
                        .height = layout->height,
                        .slices = layout->slices,
                        .max_slab_slices = layout->slab_slices,
                        .voxel_type = SV_VOXEL_U8,
                        .carrier = clipper->slabs->carrier,
                        .padding_value = 0,
                        .tiles_x = layout->tiles_x,
                        .tile_w = layout->tile_w,
                        .tile_h = layout->tile_h,
                        .row_pitch = layout->row_pitch};
    if (!clipper->own_queue) {
        format.context = clipper->cl->context;
        format.device = clipper->cl->device;
        format.queue = clipper->cl->queue;
    }
    if (clipper->slabs->carrier == SV_CARRIER_HOST) {
        format.host_memory = clipper->slabs->memory;
        format.host_memory_bytes = clipper->slabs->memory_bytes;
    }
    return format;
}

/* A failure here is the plugin's: it stays inactive, and the host goes on without it. */
static bool activate(hs_clipper *clipper, hs_error *err) {
    sv_param_value *fixed = calloc(clipper->value_count + 1u, sizeof *fixed);
    if (!fixed)
        return hs_fail(err, HS_ERR_MEMORY, "plugin parameters: no memory for %u", clipper->value_count);
    sv_format format = make_format(clipper);
    const sv_plugin *instance = clipper->plugin->instance;
    if (!pick_reactivate_values(clipper, fixed, &format.value_count)) {
        (void)hs_fail(&clipper->error, HS_ERR_PLUGIN, "%s: param_info fails for an index below param_count",
                      clipper->plugin->path);
    } else {
        format.values = format.value_count ? fixed : NULL;
        sv_status status = instance->activate(instance, &format);
        clipper->active = hs_plugin_check(clipper->plugin, status, "activate", &clipper->error);
    }
    free(fixed);
    return hs_clipper_sure_create(clipper, err);
}

bool hs_clipper_create(hs_clipper *clipper, const hs_cl *cl, const hs_slabs *slabs, const hs_plugin *plugin,
                       const hs_loop_options *options, hs_error *err) {
    *clipper = (hs_clipper){.plugin = plugin,
                            .cl = cl,
                            .slabs = slabs,
                            .own_queue = options->own_queue,
                            .want_confidence = options->dvr.ghost_width > 0 && options->dvr.ghost_doubt > 0,
                            .values = options->values,
                            .value_count = options->value_count,
                            .pixels = (size_t)slabs->layout.width * slabs->layout.height};
    cl_int code;
    clipper->depth =
        clCreateBuffer(cl->context, CL_MEM_READ_WRITE, clipper->pixels * sizeof(float), NULL, &code);
    if (!hs_cl_check(code, "clCreateBuffer (depthmap)", err)) return false;
    clipper->host_depth = calloc(clipper->pixels, sizeof(float));
    clipper->status = calloc(clipper->pixels, 1);
    if (!clipper->host_depth || !clipper->status)
        return hs_fail(err, HS_ERR_MEMORY, "depthmap: no memory for %zu pixels", clipper->pixels);
    return !plugin || activate(clipper, err);
}

void hs_clipper_destroy(hs_clipper *clipper) {
    if (clipper->active) clipper->plugin->instance->deactivate(clipper->plugin->instance);
    hs_clipper_sure_destroy(clipper);
    if (clipper->depth) clReleaseMemObject(clipper->depth);
    free(clipper->host_depth);
    free(clipper->status);
    *clipper = (hs_clipper){0};
}

/* Where the plugin shall write; the statistics are emptied. */
static sv_result make_result(hs_clipper *clipper) {
    clipper->stats = (sv_stats){.size = sizeof clipper->stats};
    return (sv_result){.size = sizeof(sv_result),
                       .depth = clipper->own_queue ? clipper->host_depth : NULL,
                       .depth_object = clipper->own_queue ? NULL : clipper->depth,
                       .status = clipper->want_status ? clipper->status : NULL,
                       .stats = &clipper->stats};
}

/* begin, every slab, end. Returns the first status that is not SV_OK; *call names the call it came from. */
static sv_status ask_plugin(hs_clipper *clipper, uint32_t index, const char **call) {
    const sv_plugin *instance = clipper->plugin->instance;
    const sv_frame frame = {.size = sizeof frame,
                            .index = index,
                            .values = clipper->value_count ? clipper->values : NULL,
                            .value_count = clipper->value_count};
    *call = "begin";
    sv_status status = instance->begin(instance, &frame);
    for (uint32_t i = 0; status == SV_OK && i < clipper->slabs->count; i++) {
        sv_slab slab;
        *call = "slab";
        hs_slabs_describe(clipper->slabs, i, &slab);
        status = instance->slab(instance, &slab);
    }
    if (status != SV_OK) return status;
    *call = "end";
    const sv_result result = make_result(clipper);
    return instance->end(instance, &result);
}

/* After the plugin's last call: the depthmap is on the device, the queue has run, and the outcome is known.
 */
static bool settle(hs_clipper *clipper, sv_status status, const char *call, hs_frame *frame, hs_error *err) {
    bool asked = false;
    if (status >= SV_OK) hs_plugin_points(clipper->plugin->instance, &clipper->points);
    if (status == SV_OK && !hs_clipper_sure_ask(clipper, &asked, err)) return false;
    if (status == SV_OK && clipper->own_queue) {
        cl_int code =
            clEnqueueWriteBuffer(clipper->cl->queue, clipper->depth, CL_FALSE, 0,
                                 clipper->pixels * sizeof(float), clipper->host_depth, 0, NULL, NULL);
        if (!hs_cl_check(code, "clEnqueueWriteBuffer (depthmap)", err)) return false;
    }
    /* Waiting here costs some 30 us and settles two things: the statistics are valid, and the host knows the
     * outcome before it renders. After a failure the plugin's commands may still be under way, too. */
    if (!hs_cl_check(clFinish(clipper->cl->queue), "clFinish (plugin)", err)) return false;
    if (status < SV_OK) {
        (void)hs_plugin_check(clipper->plugin, status, call, &clipper->error);
        frame->outcome = status;
        return true;
    }
    frame->stats = clipper->stats;
    frame->points = clipper->points;
    /* With the host's queue end returns SV_OK before the outcome is known: the statistics tell it. */
    frame->outcome = status != SV_OK ? status : clipper->stats.outcome;
    frame->clipped = frame->outcome == SV_OK;
    frame->sure = frame->clipped && hs_clipper_sure_settle(clipper, asked);
    return true;
}

bool hs_clipper_frame(hs_clipper *clipper, uint32_t index, hs_frame *frame, hs_error *err) {
    if (!clipper->active) {
        frame->outcome = SV_ERR_STATE;
        return true;
    }
    const char *call;
    const sv_status status = ask_plugin(clipper, index, &call);
    return settle(clipper, status, call, frame, err);
}

bool hs_clipper_adjust(hs_clipper *clipper, sv_param_value value, hs_frame *frame, hs_error *err) {
    if (!clipper->active) {
        frame->outcome = SV_ERR_STATE;
        return true;
    }
    const sv_plugin *instance = clipper->plugin->instance;
    const sv_result result = make_result(clipper);
    return settle(clipper, instance->adjust(instance, &value, 1, &result), "adjust", frame, err);
}

static const sv_ext_timing *timing_of(const hs_clipper *clipper) {
    return clipper->active ? hs_plugin_timing(clipper->plugin->instance) : NULL;
}

bool hs_clipper_time_stages(hs_clipper *clipper, bool on) {
    const sv_ext_timing *ext = timing_of(clipper);
    return ext && ext->enable(clipper->plugin->instance, on) == SV_OK;
}

bool hs_clipper_stage_times(hs_clipper *clipper, sv_stage_times *times) {
    const sv_ext_timing *ext = timing_of(clipper);
    *times = (sv_stage_times){.size = sizeof *times};
    return ext && ext->stage_times(clipper->plugin->instance, times) == SV_OK;
}
