/* SPDX-License-Identifier: MIT */
/* The extensions that the plugin offers: one table each, headers in include/smartvis/. */
#include "abi/abi.h"

#include "frame/instance.h"
#include "frame/pipeline.h"
#include "smartvis/confidence.h"
#include "smartvis/needs.h"
#include "smartvis/points.h"
#include "smartvis/timing.h"

#include <string.h>

static sv_status timing_enable_of(sva *a, uint32_t on) {
    sv_instance *in = a->own;
    if (a->state == SVA_INACTIVE) return sva_blame(a, SV_ERR_STATE, "timing: not active");
    sv_timing_reset(&in->timing);
    in->timing.enabled = on != 0;
    return SV_OK;
}

static sv_status timing_enable(const sv_plugin *plugin, uint32_t on) {
    sva *a = sva_take(plugin, "timing");
    return a ? sva_leave(a, timing_enable_of(a, on)) : SV_ERR_STATE;
}

static sv_status timing_stage_times_of(sva *a, sv_stage_times *out) {
    sv_instance *in = a->own;
    if (!out) return sva_blame(a, SV_ERR_ARGUMENT, "stage_times: out is NULL");
    if (out->size < sizeof *out)
        return sva_blame(a, SV_ERR_SIZE, "stage_times: size is %u, expected at least %zu", out->size,
                         sizeof *out);
    return sv_timing_read(&in->timing, a, out);
}

static sv_status timing_stage_times(const sv_plugin *plugin, sv_stage_times *out) {
    sva *a = sva_take(plugin, "stage_times");
    return a ? sva_leave(a, timing_stage_times_of(a, out)) : SV_ERR_STATE;
}

static const sv_ext_timing ext_timing = {
    .size = sizeof ext_timing, .enable = timing_enable, .stage_times = timing_stage_times};

/* No mistake: a host need not know the methods. */
static sv_status points_none(sva *a) {
    (void)snprintf(a->reason, sizeof a->reason, "points: the method looks for none");
    sva_log(a, SV_LOG_DEBUG, a->reason);
    return SV_ERR_STATE;
}

/* On the frame path: like end, it waits for nothing but a queue of the plugin's own. */
static sv_status points_write_of(sva *a, sv_points_report *out) {
    sv_instance *in = a->own;
    if (!out) return sva_blame(a, SV_ERR_ARGUMENT, "points: out is NULL");
    if (out->size < sizeof *out)
        return sva_blame(a, SV_ERR_SIZE, "points: size is %u, expected at least %zu", out->size, sizeof *out);
    if (a->state != SVA_FINISHED) return sva_blame(a, SV_ERR_STATE, "points: no finished frame");
    if (!in->pipeline.chain.needs_profile) return points_none(a);
    sv_status status = sv_instance_check_process(in);
    if (status == SV_OK) status = sv_pipeline_read_points(&in->pipeline, out);
    if (status != SV_OK || !in->device.owned) return status;
    return sva_cl_check(a, clFinish(in->device.queue), "points: clFinish");
}

static sv_status points_write(const sv_plugin *plugin, sv_points_report *out) {
    sva *a = sva_take(plugin, "points");
    return a ? sva_leave(a, points_write_of(a, out)) : SV_ERR_STATE;
}

static const sv_ext_points ext_points = {.size = sizeof ext_points, .write = points_write};

static sv_status confidence_ready(sva *a) {
    const sv_instance *in = a->own;
    if (a->state == SVA_FINISHED && in->pipeline.chain.method->confidence)
        return sv_instance_check_process(in);
    return sva_blame(a, SV_ERR_STATE, "confidence: no finished frame with a method that gives it");
}

static sv_status confidence_read_of(sva *a, float *map, sv_confidence_report *out) {
    sv_instance *in = a->own;
    const size_t oldest_size = offsetof(sv_confidence_report, reason); /* what an older host knows */
    sv_confidence_report all = {.size = sizeof all};
    if (out && out->size < oldest_size)
        return sva_blame(a, SV_ERR_SIZE, "confidence: size is %u, expected at least %zu", out->size,
                         oldest_size);
    const sv_chain *chain = &in->pipeline.chain;
    sv_status status = confidence_ready(a);
    if (status == SV_OK && map) status = sv_pipeline_confidence(&in->pipeline, map, NULL, 0, true);
    if (status != SV_OK || !out) return status;
    status = chain->method->confidence_report(&in->pipeline.map, &chain->state, &all);
    if (status != SV_OK) return status;
    all.size = out->size;
    memcpy(out, &all, out->size < sizeof all ? out->size : sizeof all);
    return SV_OK;
}

static sv_status confidence_read(const sv_plugin *plugin, float *map, sv_confidence_report *out) {
    sva *a = sva_take(plugin, "confidence");
    return a ? sva_leave(a, confidence_read_of(a, map, out)) : SV_ERR_STATE;
}

static uint32_t confidence_offered(const sv_plugin *plugin) {
    const sva *a = plugin->plugin_data;
    const sv_instance *in = a->own;
    return a->state != SVA_INACTIVE && in->pipeline.chain.method->confidence;
}

/* On the frame path: like end, it waits for nothing but a queue of the plugin's own. */
static sv_status confidence_write_of(sva *a, float *map, struct _cl_mem *object, uint64_t offset) {
    sv_instance *in = a->own;
    const sv_result to = {.size = sizeof to, .depth = map, .depth_object = object, .depth_offset = offset};
    sv_status status = confidence_ready(a);
    if (status == SV_OK) status = sva_check_result(a, "confidence", &to);
    if (status == SV_OK && object)
        status = sva_cl_check_object(a, "confidence: object", object, SV_CARRIER_BUFFER, offset,
                                     sva_rays(a) * sizeof(float), SV_ERR_ARGUMENT);
    if (status != SV_OK) return status;
    return sv_pipeline_confidence(&in->pipeline, map, object, offset, in->device.owned);
}

static sv_status confidence_write(const sv_plugin *plugin, float *map, struct _cl_mem *object,
                                  uint64_t offset) {
    sva *a = sva_take(plugin, "confidence");
    return a ? sva_leave(a, confidence_write_of(a, map, object, offset)) : SV_ERR_STATE;
}

static const sv_ext_confidence ext_confidence = {.size = sizeof ext_confidence,
                                                 .read = confidence_read,
                                                 .offered = confidence_offered,
                                                 .write = confidence_write};

static sv_status check_needs(sv_diag *diag, const sv_needs_device *device, const sv_needs *out) {
    const uint32_t known = SV_NEEDS_CPU | SV_NEEDS_UNIFIED | SV_NEEDS_DOUBLES;
    if (!device || !out)
        return sva_blame(diag, SV_ERR_ARGUMENT, "needs: %s is NULL", device ? "out" : "device");
    if (device->size < sizeof *device || out->size < sizeof *out)
        return sva_blame(diag, SV_ERR_SIZE, "needs: size is %u, expected at least %zu",
                         device->size < sizeof *device ? device->size : out->size,
                         device->size < sizeof *device ? sizeof *device : sizeof *out);
    if ((device->flags & ~known) || device->compute_units == 0)
        return sva_blame(diag, SV_ERR_ARGUMENT,
                         "needs: flags is 0x%x, known are 0x%x; compute_units is %u, expected 1 or more",
                         device->flags, known, device->compute_units);
    return SV_OK;
}

/* What activate and begin would say, asked of a copy of the instance: a frame may be under way. */
static sv_status plan(sva *a, const sv_format *format, const sv_param_value *list, uint32_t count) {
    sv_status status = sva_check_format(a, format, 1);
    if (status != SV_OK) return status;
    for (uint32_t i = 0; i < SV_PARAM_COUNT; i++) a->fixed[i] = a->values[i] = sv_params[i].default_value;
    status = sva_take_values(a, "activate", format->values, format->value_count, SV_PARAM_REACTIVATE);
    if (status != SV_OK) return status;
    memcpy(a->fixed, a->values, SV_PARAM_COUNT * sizeof *a->values);
    sva_keep_format(a, format);
    return sva_take_values(a, "begin", list, count, 0);
}

/* Makes no OpenCL call: pipeline and methods only count. */
static sv_status needs_by(sva *a, const sv_format *format, const sv_param_value *values, uint32_t value_count,
                          const sv_needs_device *device, sv_needs *out) {
    double room[2][SV_PARAM_COUNT];
    sva planned = *a;
    planned.fixed = room[0];
    planned.values = room[1];
    sv_status status = check_needs(a, device, out);
    if (status != SV_OK) return status;
    status = plan(&planned, format, values, value_count);
    sv_needs all;
    if (status == SV_OK) {
        const bool cpu = device->flags & SV_NEEDS_CPU;
        const sv_device there = {.is_cpu = cpu,
                                 .shares_memory = cpu && (device->flags & SV_NEEDS_UNIFIED),
                                 .has_doubles = device->flags & SV_NEEDS_DOUBLES,
                                 .compute_units = device->compute_units};
        const sv_values activated = sv_values_of(room[0]), frame = sv_values_of(room[1]);
        status = sv_instance_needs(&planned, &there, &planned.format, &activated, &frame, &all);
    }
    memcpy(a->reason, planned.reason, sizeof a->reason);
    if (status != SV_OK) return status;
    all.size = out->size;
    *out = all;
    return SV_OK;
}

static sv_status needs_of(const sv_plugin *plugin, const sv_format *format, const sv_param_value *values,
                          uint32_t value_count, const sv_needs_device *device, sv_needs *out) {
    sva *a = sva_take(plugin, "needs");
    return a ? sva_leave(a, needs_by(a, format, values, value_count, device, out)) : SV_ERR_STATE;
}

static const sv_ext_needs ext_needs = {.size = sizeof ext_needs, .of = needs_of};

const char *const sv_extension_ids[] = {SV_EXT_TIMING, SV_EXT_POINTS, SV_EXT_CONFIDENCE, SV_EXT_NEEDS, NULL};

const void *sv_extension(const sva *author, const char *id) {
    (void)author; /* they are the same for all instances */
    /* The tables, in the order of sv_extension_ids. */
    static const void *const tables[] = {&ext_timing, &ext_points, &ext_confidence, &ext_needs};
    for (size_t i = 0; i < sizeof tables / sizeof *tables; i++)
        if (strcmp(id, sv_extension_ids[i]) == 0) return tables[i];
    return NULL;
}
