/* SPDX-License-Identifier: MIT */
#include "abi/extensions.h"

#include "abi/validate.h"
#include "frame/instance.h"
#include "frame/pipeline_end.h"

#include <string.h>

static sv_status stats_enable(const sv_plugin *plugin, uint32_t on) {
    sv_instance *in = sv_instance_of(plugin);
    if (in->state == SV_STATE_INACTIVE) return sv_blame_host(&in->diag, SV_ERR_STATE, "stats: not active");
    sv_timing_reset(&in->timing);
    in->timing.enabled = on != 0;
    return SV_OK;
}

static sv_status stats_stage_times(const sv_plugin *plugin, sv_stage_times *out) {
    sv_instance *in = sv_instance_of(plugin);
    if (!out) return sv_blame_host(&in->diag, SV_ERR_ARGUMENT, "stage_times: out is NULL");
    if (out->size < sizeof *out)
        return sv_blame_host(&in->diag, SV_ERR_SIZE, "stage_times: size is %u, expected at least %zu",
                             out->size, sizeof *out);
    return sv_timing_read(&in->timing, &in->diag, out);
}

static const sv_ext_stats ext_stats = {
    .size = sizeof ext_stats, .enable = stats_enable, .stage_times = stats_stage_times};

static sv_status spline_report(const sv_plugin *plugin, sv_spline_report *out) {
    sv_instance *in = sv_instance_of(plugin);
    if (!out) return sv_blame_host(&in->diag, SV_ERR_ARGUMENT, "spline: out is NULL");
    if (out->size < sizeof *out)
        return sv_blame_host(&in->diag, SV_ERR_SIZE, "spline: size is %u, expected at least %zu", out->size,
                             sizeof *out);
    sv_chain *chain = &in->pipeline.chain;
    if (in->state != SV_STATE_FINISHED || !chain->method->spline_report)
        return sv_blame_host(&in->diag, SV_ERR_STATE, "spline: no finished frame with method spline");
    return chain->method->spline_report(sv_chain_map(chain), &chain->state, out);
}

static const sv_ext_spline ext_spline = {.size = sizeof ext_spline, .report = spline_report};

static sv_status confidence_ready(sv_instance *in) {
    if (in->state == SV_STATE_FINISHED && in->pipeline.chain.method->confidence) return SV_OK;
    return sv_blame_host(&in->diag, SV_ERR_STATE,
                         "confidence: no finished frame with a method that gives it");
}

static sv_status confidence_read(const sv_plugin *plugin, float *map, sv_confidence_report *out) {
    sv_instance *in = sv_instance_of(plugin);
    if (out && out->size < sizeof *out)
        return sv_blame_host(&in->diag, SV_ERR_SIZE, "confidence: size is %u, expected at least %zu",
                             out->size, sizeof *out);
    const sv_chain *chain = &in->pipeline.chain;
    sv_status status = confidence_ready(in);
    if (status == SV_OK && map) status = sv_pipeline_confidence(&in->pipeline, map, NULL, 0, true);
    if (status != SV_OK || !out) return status;
    return chain->method->confidence_report(&in->pipeline.map, &chain->state, out);
}

static uint32_t confidence_offered(const sv_plugin *plugin) {
    const sv_instance *in = plugin->plugin_data;
    return in->state != SV_STATE_INACTIVE && in->pipeline.chain.method->confidence;
}

/* On the frame path: like end, it waits for nothing but a queue of the plugin's own. */
static sv_status confidence_write(const sv_plugin *plugin, float *map, struct _cl_mem *object,
                                  uint64_t offset) {
    sv_instance *in = sv_instance_of(plugin);
    const sv_result to = {.size = sizeof to, .depth = map, .depth_object = object, .depth_offset = offset};
    sv_status status = confidence_ready(in);
    if (status == SV_OK) status = sv_validate_result(&in->diag, "confidence", &in->pipeline, &to);
    if (status != SV_OK) return status;
    return sv_pipeline_confidence(&in->pipeline, map, object, offset, in->device.owned);
}

static const sv_ext_confidence ext_confidence = {.size = sizeof ext_confidence,
                                                 .read = confidence_read,
                                                 .offered = confidence_offered,
                                                 .write = confidence_write};

const void *sv_extension_find(const char *id) {
    if (strcmp(id, SV_EXT_STATS) == 0) return &ext_stats;
    if (strcmp(id, SV_EXT_CONFIDENCE) == 0) return &ext_confidence;
    return strcmp(id, SV_EXT_SPLINE) == 0 ? &ext_spline : NULL;
}
