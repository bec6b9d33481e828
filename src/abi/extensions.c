/* SPDX-License-Identifier: MIT */
/* The extensions that the plugin offers: one table each, headers in include/smartvis/. */
#include "abi/extensions.h"

#include "frame/instance.h"
#include "smartvis/confidence.h"
#include "smartvis/points.h"
#include "smartvis/spline.h"
#include "smartvis/timing.h"

#include <string.h>

static sv_status timing_enable(const sv_plugin *plugin, uint32_t on) {
    sv_instance *in = sv_instance_enter(plugin);
    if (in->state == SV_STATE_INACTIVE) return sv_blame_host(&in->diag, SV_ERR_STATE, "timing: not active");
    sv_timing_reset(&in->timing);
    in->timing.enabled = on != 0;
    return SV_OK;
}

static sv_status timing_stage_times(const sv_plugin *plugin, sv_stage_times *out) {
    sv_instance *in = sv_instance_enter(plugin);
    if (!out) return sv_blame_host(&in->diag, SV_ERR_ARGUMENT, "stage_times: out is NULL");
    if (out->size < sizeof *out)
        return sv_blame_host(&in->diag, SV_ERR_SIZE, "stage_times: size is %u, expected at least %zu",
                             out->size, sizeof *out);
    return sv_timing_read(&in->timing, &in->diag, out);
}

static const sv_ext_timing ext_timing = {
    .size = sizeof ext_timing, .enable = timing_enable, .stage_times = timing_stage_times};

/* On the frame path: like end, it waits for nothing but a queue of the plugin's own. */
static sv_status points_write(const sv_plugin *plugin, sv_points_report *out) {
    sv_instance *in = sv_instance_enter(plugin);
    if (!out) return sv_blame_host(&in->diag, SV_ERR_ARGUMENT, "points: out is NULL");
    if (out->size < sizeof *out)
        return sv_blame_host(&in->diag, SV_ERR_SIZE, "points: size is %u, expected at least %zu", out->size,
                             sizeof *out);
    if (in->state != SV_STATE_FINISHED)
        return sv_blame_host(&in->diag, SV_ERR_STATE, "points: no finished frame");
    const sv_status status = sv_pipeline_read_points(&in->pipeline, out);
    if (status != SV_OK || !in->device.owned) return status;
    return sv_clx_check(&in->diag, clFinish(in->device.queue), "points: clFinish");
}

static const sv_ext_points ext_points = {.size = sizeof ext_points, .write = points_write};

static sv_status spline_report(const sv_plugin *plugin, sv_spline_report *out) {
    sv_instance *in = sv_instance_enter(plugin);
    if (!out) return sv_blame_host(&in->diag, SV_ERR_ARGUMENT, "spline: out is NULL");
    if (out->size < sizeof *out)
        return sv_blame_host(&in->diag, SV_ERR_SIZE, "spline: size is %u, expected at least %zu", out->size,
                             sizeof *out);
    if (in->state != SV_STATE_FINISHED || in->pipeline.config.method != SV_METHOD_SPLINE)
        return sv_blame_host(&in->diag, SV_ERR_STATE, "spline: no finished frame with method spline");
    float r[SV_SPLINE_REPORT_WORDS];
    const sv_status status = sv_spline_read(sv_chain_map(&in->pipeline), r);
    if (status == SV_OK)
        *out = (sv_spline_report){.size = out->size,
                                  .points = (uint32_t)r[0],
                                  .merge_grid = (uint32_t)r[1],
                                  .rank = (uint32_t)r[2],
                                  .dropped = (uint32_t)r[3],
                                  .condition = r[4],
                                  .residual = r[5]};
    return status;
}

static const sv_ext_spline ext_spline = {.size = sizeof ext_spline, .report = spline_report};

static sv_status confidence_ready(sv_instance *in) {
    if (in->state == SV_STATE_FINISHED && in->pipeline.config.method == SV_METHOD_COST) return SV_OK;
    return sv_blame_host(&in->diag, SV_ERR_STATE, "confidence: no finished frame with method cost");
}

static sv_status confidence_read(const sv_plugin *plugin, float *map, sv_confidence_report *out) {
    sv_instance *in = sv_instance_enter(plugin);
    if (out && out->size < sizeof *out)
        return sv_blame_host(&in->diag, SV_ERR_SIZE, "confidence: size is %u, expected at least %zu",
                             out->size, sizeof *out);
    const sv_status ready = confidence_ready(in);
    if (ready != SV_OK) return ready;
    uint32_t info[SV_COST_INFO_WORDS];
    const sv_status status = sv_cost_read(&in->pipeline, map, info);
    if (status == SV_OK && out)
        *out = (sv_confidence_report){.size = out->size,
                                      .fluid_threshold = (float)info[SV_COST_INFO_LEVEL] / 255.0f,
                                      .rays = info[SV_COST_INFO_RAYS],
                                      .open_rays = info[SV_COST_INFO_OPEN]};
    return status;
}

static uint32_t confidence_offered(const sv_plugin *plugin) {
    const sv_instance *in = plugin->plugin_data;
    return in->state != SV_STATE_INACTIVE && in->pipeline.config.method == SV_METHOD_COST;
}

/* On the frame path: like end, it waits for nothing but a queue of the plugin's own. */
static sv_status confidence_write(const sv_plugin *plugin, float *map, struct _cl_mem *object,
                                  uint64_t offset) {
    sv_instance *in = sv_instance_enter(plugin);
    const sv_result to = {.size = sizeof to, .depth = map, .depth_object = object, .depth_offset = offset};
    sv_status status = confidence_ready(in);
    if (status == SV_OK) status = sv_validate_result(&in->diag, "confidence", &in->pipeline, &to);
    if (status != SV_OK) return status;
    const cl_command_queue queue = in->device.queue;
    const cl_mem from = sv_cost_confidence(&in->pipeline);
    const size_t bytes = (size_t)in->pipeline.config.width * in->pipeline.config.height * sizeof *map;
    const cl_int code = map ? clEnqueueReadBuffer(queue, from, CL_FALSE, 0, bytes, map, 0, NULL, NULL)
                            : clEnqueueCopyBuffer(queue, from, object, 0, offset, bytes, 0, NULL, NULL);
    status = sv_clx_check(&in->diag, code, "confidence: enqueue");
    if (status != SV_OK || !in->device.owned) return status;
    return sv_clx_check(&in->diag, clFinish(queue), "confidence: clFinish");
}

static const sv_ext_confidence ext_confidence = {.size = sizeof ext_confidence,
                                                 .read = confidence_read,
                                                 .offered = confidence_offered,
                                                 .write = confidence_write};

const char *const sv_extension_ids[] = {SV_EXT_TIMING, SV_EXT_POINTS, SV_EXT_SPLINE, SV_EXT_CONFIDENCE, NULL};

const void *sv_extension(const char *id) {
    /* In the order of sv_extension_ids. */
    static const void *const tables[] = {&ext_timing, &ext_points, &ext_spline, &ext_confidence};
    for (size_t i = 0; i < sizeof tables / sizeof *tables; i++)
        if (strcmp(id, sv_extension_ids[i]) == 0) return tables[i];
    return NULL;
}
