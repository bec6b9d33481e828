/* SPDX-License-Identifier: MIT */
/* The ABI's glue: one screen per function. What is behind it: instance.c, then pipeline.c. */
#include "abi/abi.h"
#include "frame/instance.h"
#include "frame/pipeline.h"
#include "smartvis/probe.h"

#include <stdlib.h>
#include <string.h>

static const sv_descriptor descriptor = {
    .size = sizeof descriptor,
    .id = "org.smartvis.clip",
    .name = "SmartVis",
    .vendor = "SmartVis",
    .version = SV_VERSION,
    .carriers = SV_BIT(SV_CARRIER_HOST) | SV_BIT(SV_CARRIER_BUFFER) | SV_BIT(SV_CARRIER_IMAGE),
    .voxel_types = SV_BIT(SV_VOXEL_U8),
    .queues = SV_QUEUE_OWN | SV_QUEUE_HOST,
    .features = SV_FEATURE_SCANNED | SV_FEATURE_PADDING | SV_FEATURE_ADJUST | SV_FEATURE_PROBE,
    .extensions = sv_extension_ids,
    .summary =
        "Clipping depthmap by method wall (docs/surface.md): removes the tissue in front of the fetus.",
};

static void plugin_deactivate(const sv_plugin *plugin) {
    sv_instance *in = sv_instance_enter(plugin);
    if (in->state == SV_STATE_INACTIVE)
        (void)sv_blame_host(&in->diag, SV_ERR_STATE, "deactivate: not active");
    else
        sv_instance_deactivate(in);
}

static void plugin_destroy(const sv_plugin *plugin) {
    if (!plugin) return;
    sv_instance *in = sv_instance_enter(plugin);
    if (in->state != SV_STATE_INACTIVE) {
        (void)sv_blame_host(&in->diag, SV_ERR_STATE, "destroy: still active, deactivating");
        sv_instance_deactivate(in);
    }
    free(in);
}

static sv_status plugin_activate(const sv_plugin *plugin, const sv_format *format) {
    sv_instance *in = sv_instance_enter(plugin);
    if (in->state != SV_STATE_INACTIVE)
        return sv_blame_host(&in->diag, SV_ERR_STATE, "activate: already active");
    sv_values values;
    sv_params_defaults(&values);
    sv_status status = sv_validate_format(&in->diag, format, false);
    if (status == SV_OK)
        status = sv_params_apply(&in->diag, "activate", format->values, format->value_count,
                                 SV_PARAM_REACTIVATE, true, &values);
    return status == SV_OK ? sv_instance_activate(in, format, &values) : status;
}

/* With its own queue nobody but the plugin can wait: after a failure, or when a frame is dropped, the host
 * may reuse its slabs and maps at once. */
static sv_status let_go(sv_instance *in, sv_status status) {
    if (in->device.owned) (void)clFinish(in->device.queue);
    return status;
}

static sv_status plugin_begin(const sv_plugin *plugin, const sv_frame *frame) {
    sv_instance *in = sv_instance_enter(plugin);
    if (in->state == SV_STATE_INACTIVE) return sv_blame_host(&in->diag, SV_ERR_STATE, "begin: not active");
    if (in->state == SV_STATE_SLABS) (void)let_go(in, SV_OK);
    in->state = SV_STATE_IDLE;
    sv_status status = sv_validate_frame(&in->diag, &in->pipeline, frame);
    if (status != SV_OK) return status;
    sv_values values = in->activated;
    status = sv_params_apply(&in->diag, "begin", frame->values, frame->value_count, 0, false, &values);
    if (status == SV_OK) status = sv_validate_values(&in->diag, &in->pipeline, &values);
    if (status != SV_OK) return status;
    in->frame = values;
    sv_pipeline_begin(&in->pipeline, &in->frame);
    in->pipeline.map.continues = !(frame->flags & SV_FRAME_DISCONTINUITY);
    sv_probe_of(frame, in->pipeline.map.probe_rotation, in->pipeline.map.probe_side);
    if (in->pipeline.config.ranged) {
        status =
            sv_pipeline_scanned(&in->pipeline, frame->scanned, frame->scanned_object, frame->scanned_offset);
        if (status != SV_OK) return let_go(in, status);
    }
    in->state = SV_STATE_SLABS;
    return SV_OK;
}

static sv_status plugin_slab(const sv_plugin *plugin, const sv_slab *slab) {
    sv_instance *in = sv_instance_enter(plugin);
    if (in->state != SV_STATE_SLABS)
        return sv_blame_host(&in->diag, SV_ERR_STATE, "slab: no frame was begun");
    sv_status status = sv_validate_slab(&in->diag, &in->pipeline, slab);
    if (status == SV_OK) status = sv_pipeline_slab(&in->pipeline, slab);
    if (status == SV_OK) return SV_OK;
    in->state = SV_STATE_IDLE;
    return let_go(in, status);
}

/* Waits in own-queue mode, and returns the outcome of the frame. */
static sv_status wait_outcome(sv_instance *in, const char *call, const sv_result *result) {
    if (!in->device.owned) return SV_OK;
    const sv_status status = sv_clx_check(&in->diag, clFinish(in->device.queue), call);
    const sv_stats *stats = result->stats;
    if (status != SV_OK || !stats || stats->outcome == SV_OK) return status;
    return sv_report(&in->diag, SV_LOG_DEBUG, stats->outcome,
                     "%s: %s: %u rays gave a point, %u of %u pixels are without a surface", call,
                     stats->outcome == SV_NO_SURFACE ? "no surface" : "partial surface", stats->points,
                     stats->unfilled, stats->rays);
}

static sv_status output(sv_instance *in, const char *call, const sv_values *values, const sv_result *result) {
    sv_result own = *result;
    sv_stats stats = {.size = sizeof stats};
    if (in->device.owned && !own.stats) own.stats = &stats; /* end must return the outcome */
    const sv_status status = sv_pipeline_output(&in->pipeline, (float)values->of[SV_PARAM_Q], &own);
    return status == SV_OK ? wait_outcome(in, call, &own) : status;
}

static sv_status plugin_end(const sv_plugin *plugin, const sv_result *result) {
    sv_instance *in = sv_instance_enter(plugin);
    if (in->state != SV_STATE_SLABS) return sv_blame_host(&in->diag, SV_ERR_STATE, "end: no frame was begun");
    in->state = SV_STATE_IDLE;
    sv_status status = SV_OK;
    if (in->pipeline.next_slice < in->pipeline.config.slices)
        status = sv_blame_host(&in->diag, SV_ERR_SLAB_MISSING, "end: %u of %u slices came",
                               in->pipeline.next_slice, in->pipeline.config.slices);
    if (status == SV_OK) status = sv_validate_result(&in->diag, "end", &in->pipeline, result);
    if (status == SV_OK) status = sv_pipeline_end(&in->pipeline, (float)in->frame.of[SV_PARAM_Q]);
    if (status == SV_OK) status = output(in, "end", &in->frame, result);
    if (status < 0) return let_go(in, status);
    in->state = SV_STATE_FINISHED;
    in->timing.complete = in->timing.enabled;
    return status;
}

static sv_status plugin_adjust(const sv_plugin *plugin, const sv_param_value *values, uint32_t value_count,
                               const sv_result *result) {
    sv_instance *in = sv_instance_enter(plugin);
    if (in->state != SV_STATE_FINISHED)
        return sv_blame_host(&in->diag, SV_ERR_STATE, "adjust: no finished frame");
    sv_values adjusted = in->frame;
    sv_status status =
        sv_params_apply(&in->diag, "adjust", values, value_count, SV_PARAM_ADJUST, false, &adjusted);
    if (status == SV_OK) status = sv_validate_result(&in->diag, "adjust", &in->pipeline, result);
    in->pipeline.queue.timing = NULL; /* the times stay those of the frame */
    if (status == SV_OK) status = sv_pipeline_adjust(&in->pipeline, (float)adjusted.of[SV_PARAM_Q]);
    if (status == SV_OK) status = output(in, "adjust", &adjusted, result);
    in->pipeline.queue.timing = &in->timing;
    return status < 0 ? let_go(in, status) : status;
}

static uint32_t plugin_param_count(const sv_plugin *plugin) {
    (void)plugin;
    return sv_params_count();
}

/* Calls from any thread tell the host's log what is wrong, but leave last_error to the instance's own
 * threads. */
static sv_diag diag_of_any_thread(const sv_plugin *plugin) {
    const sv_instance *in = plugin->plugin_data;
    return (sv_diag){.host = in->diag.host};
}

static sv_status plugin_param_info(const sv_plugin *plugin, uint32_t index, sv_param_info *out) {
    sv_diag diag = diag_of_any_thread(plugin);
    return sv_params_info(&diag, index, out);
}

static sv_status plugin_param_text(const sv_plugin *plugin, uint32_t id, double value, char *out,
                                   uint32_t bytes) {
    sv_diag diag = diag_of_any_thread(plugin);
    return sv_params_text(&diag, id, value, out, bytes);
}

static const char *plugin_last_error(const sv_plugin *plugin) {
    const sv_instance *in = plugin->plugin_data;
    return in->diag.last_error;
}

static const void *plugin_get_extension(const sv_plugin *plugin, const char *id) {
    (void)plugin;
    return id ? sv_extension(id) : NULL;
}

static const sv_plugin vtable = {
    .size = sizeof vtable,
    .descriptor = &descriptor,
    .destroy = plugin_destroy,
    .activate = plugin_activate,
    .deactivate = plugin_deactivate,
    .begin = plugin_begin,
    .slab = plugin_slab,
    .end = plugin_end,
    .adjust = plugin_adjust,
    .param_count = plugin_param_count,
    .param_info = plugin_param_info,
    .param_text = plugin_param_text,
    .last_error = plugin_last_error,
    .get_extension = plugin_get_extension,
};

static const sv_descriptor *entry_descriptor(uint32_t index) {
    return index == 0 ? &descriptor : NULL;
}

static sv_status entry_create(const sv_host *host, const char *id, const sv_plugin **out) {
    if (!out) return SV_ERR_ARGUMENT;
    *out = NULL;
    if (!host || !id) return SV_ERR_ARGUMENT;
    if (host->size < sizeof *host) return SV_ERR_SIZE;
    sv_diag diag = {.host = host};
    if (strcmp(id, descriptor.id) != 0)
        return sv_blame_host(&diag, SV_ERR_UNKNOWN_ID, "create: no plugin '%.100s' here, only '%s'", id,
                             descriptor.id);
    sv_instance *in = calloc(1, sizeof *in);
    if (!in)
        return sv_fail(&diag, SV_ERR_NO_MEMORY, "create: no memory for an instance (%zu bytes)", sizeof *in);
    in->abi = vtable;
    in->abi.plugin_data = in;
    in->diag = diag;
    sv_params_defaults(&in->activated);
    *out = &in->abi;
    return SV_OK;
}

const sv_entry smartvis_plugin_entry = {
    .abi_major = SV_ABI_MAJOR,
    .abi_minor = SV_ABI_MINOR,
    .size = sizeof smartvis_plugin_entry,
    .count = 1,
    .descriptor = entry_descriptor,
    .create = entry_create,
};
