/* SPDX-License-Identifier: MIT */
/* The plugin as smartvis/author.h asks for it: a method whose frames a pipeline makes (frame/pipeline.h). */
#include "abi/abi.h"
#include "frame/instance.h"
#include "frame/pipeline.h"
#include "sv_version.h"

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

static sv_status activate(sva *a) {
    sv_instance *in = a->own;
    const sv_values values = sv_values_of(a->values);
    in->diag = a;
    return sv_instance_activate(in, &a->format, &values);
}

static void deactivate(sva *a) {
    sv_instance *in = a->own;
    if (sv_instance_is_forked(in)) memset(in, 0, sizeof *in); /* all of it is the other process's */
    sv_instance_deactivate(in);
}

/* With its own queue nobody but the plugin can wait until the host's memory is free again. */
static void abandon(sva *a) {
    const sv_instance *in = a->own;
    if (in->device.owned && !sv_instance_is_forked(in)) (void)clFinish(in->device.queue);
}

static sv_status begin(sva *a) {
    sv_instance *in = a->own;
    sv_pipeline *p = &in->pipeline;
    const sv_frame *f = &a->frame;
    const sv_values values = sv_values_of(a->values);
    sv_status status = sv_instance_check_process(in);
    if (status == SV_OK && f->scanned_object)
        status = sva_cl_check_object(a, "begin: scanned_object", f->scanned_object, SV_CARRIER_BUFFER,
                                     f->scanned_offset, sva_rays(a) * sizeof(sv_scanned), SV_ERR_ARGUMENT);
    if (status != SV_OK) return status;
    p->queue.timing = &in->timing;
    const sv_frame_context context = {.beams = sv_beams_of(f),
                                      .continues = !(f->flags & SV_FRAME_DISCONTINUITY)};
    sv_pipeline_begin(p, &values, &context);
    if (!p->config.ranged) return SV_OK;
    return sv_pipeline_scanned(p, f->scanned, f->scanned_object, f->scanned_offset);
}

static sv_status slab(sva *a, const sv_slab *slab) {
    sv_instance *in = a->own;
    sv_status status = sv_instance_check_process(in);
    if (status == SV_OK && slab->object) status = sva_cl_check_slab(a, slab);
    return status == SV_OK ? sv_pipeline_slab(&in->pipeline, slab) : status;
}

static sv_status finish(sva *a, float *depth) { /* NOLINT(readability-non-const-parameter) */
    sv_instance *in = a->own;
    const sv_status status = sv_instance_check_process(in);
    (void)depth;
    return status == SV_OK ? sv_pipeline_end(&in->pipeline) : status;
}

static sv_status adjust(sva *a, float *depth) { /* NOLINT(readability-non-const-parameter) */
    sv_instance *in = a->own;
    const sv_status status = sv_instance_check_process(in);
    (void)depth;
    if (status != SV_OK) return status;
    in->pipeline.queue.timing = NULL; /* the times stay those of the frame */
    return sv_pipeline_adjust(&in->pipeline, (float)sva_value(a, SV_PARAM_Q));
}

/* Waits for the own queue, and returns the outcome of the frame. */
static sv_status wait_outcome(sva *a, const char *call, const sv_stats *stats) {
    const sv_instance *in = a->own;
    const sv_status status = sva_cl_check(a, clFinish(in->device.queue), call);
    if (status != SV_OK || stats->outcome == SV_OK) return status;
    return sva_error(a, stats->outcome, "%s: %s: %u rays gave a point, %u of %u pixels are without a surface",
                     call, stats->outcome == SV_NO_SURFACE ? "no surface" : "partial surface", stats->points,
                     stats->unfilled, stats->rays);
}

static sv_status output(sva *a, const sv_result *result) {
    sv_instance *in = a->own;
    const bool adjusts = a->state == SVA_FINISHED;
    sv_result own = *result;
    sv_stats stats = {.size = sizeof stats};
    sv_status status = SV_OK;
    if (in->device.owned && !own.stats) own.stats = &stats; /* end must return the outcome */
    if (own.depth_object)
        status = sva_cl_check_object(a, adjusts ? "adjust: depth_object" : "end: depth_object",
                                     own.depth_object, SV_CARRIER_BUFFER, own.depth_offset,
                                     sva_rays(a) * sizeof(float), SV_ERR_ARGUMENT);
    if (status == SV_OK) status = sv_pipeline_output(&in->pipeline, &own);
    if (status == SV_OK && in->device.owned) status = wait_outcome(a, adjusts ? "adjust" : "end", own.stats);
    if (status >= SV_OK && !adjusts) in->timing.complete = in->timing.enabled;
    return status;
}

static const sva_method method = {.descriptor = &descriptor,
                                  .params = sv_params,
                                  .param_count = SV_PARAM_COUNT,
                                  .own_bytes = sizeof(sv_instance),
                                  .activate = activate,
                                  .deactivate = deactivate,
                                  .begin = begin,
                                  .slab = slab,
                                  .finish = finish,
                                  .adjust = adjust,
                                  .output = output,
                                  .extension = sv_extension,
                                  .abandon = abandon,
                                  .depends_values = sv_param_depends_values};

SVA_ENTRY(method);
