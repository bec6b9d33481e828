/* SPDX-License-Identifier: MIT */
#include "frame/instance.h"

#include "device/host_state.h"
#include "frame/selftest.h"

#include <stdio.h>
#include <unistd.h>

/* Volumes beyond this do not stay in a CPU's caches from one frame to the next. */
enum { FETCH_AHEAD_BYTES = 16 << 20 };

static sv_config config_of(const sv_format *f, const sv_values *values) {
    return (sv_config){.width = f->width,
                       .height = f->height,
                       .slices = f->slices,
                       .max_slab_slices = f->max_slab_slices,
                       .tiles_x = f->tiles_x,
                       .tile_w = f->tile_w,
                       .tile_h = f->tile_h,
                       .row_pitch = f->carrier == SV_CARRIER_IMAGE ? f->tiles_x * f->tile_w : f->row_pitch,
                       .carrier = f->carrier,
                       .padding =
                           f->padding_value == SV_NO_PADDING ? SV_UNPADDED : (uint32_t)f->padding_value,
                       .spacing = {f->spacing_mm[0], f->spacing_mm[1], f->spacing_mm[2]},
                       .ranged = (f->flags & SV_FORMAT_SCANNED) != 0,
                       .substeps = (uint32_t)values->of[SV_PARAM_SUBSTEPS],
                       .strategy = (uint32_t)values->of[SV_PARAM_STRATEGY],
                       .method = (uint32_t)values->of[SV_PARAM_METHOD],
                       .prefilter = (uint32_t)values->of[SV_PARAM_PREFILTER],
                       .float32 = values->of[SV_PARAM_PRECISION] == SV_PRECISION_FLOAT32,
                       .merge_grid = (uint32_t)values->of[SV_PARAM_MERGE_GRID],
                       .spline_grid = (uint32_t)values->of[SV_PARAM_SPLINE_GRID],
                       .host_memory = f->host_memory,
                       .host_memory_bytes = f->host_memory_bytes};
}

/* Builds the kernel sets for vectors of `strip` rays and lets the device prove itself. What the method does
 * not launch is not compiled: a method that takes no points needs no ray profiles, no sums and no test of
 * them. */
static sv_status build_and_test(sv_instance *in, const sv_config *config, const sv_values *activated,
                                uint32_t strip) {
    sv_structure structure = {.substeps = config->substeps,
                              .strip = strip,
                              .padded = sv_is_padded(config),
                              .ranged = config->ranged,
                              .fetch_ahead =
                                  (strip > 16) && (uint64_t)config->width * config->height * config->slices >
                                                      FETCH_AHEAD_BYTES};
    const bool needs_wide = sv_chain_needs_wide(config);
    if (!sv_chain_needs_profile(config)) return SV_OK; /* the method's own kernels do it all */
    sv_status status = sv_program_build(in->diag, &in->device, &structure, &in->narrow);
    if (status == SV_OK && needs_wide) {
        structure.wide_sums = true;
        status = sv_program_build(in->diag, &in->device, &structure, &in->wide);
    }
    if (status == SV_OK)
        status =
            sv_selftest(in->diag, &in->device, &in->narrow, needs_wide ? &in->wide : NULL, config, activated);
    if (status != SV_OK) {
        sv_program_release(&in->narrow);
        sv_program_release(&in->wide);
    }
    return status;
}

/* The widest vectors first: they need more than OpenCL C promises, so a failure only costs speed. A work item
 * a ray has none: its programs are the same for all widths. */
static sv_status build_kernels(sv_instance *in, const sv_config *config, const sv_values *activated) {
    const bool strips =
        sv_chain_needs_profile(config) && in->device.is_cpu && config->strategy != SV_STRATEGY_RAYS;
    const uint32_t widest = !strips || config->width < 32 ? 16 : config->width < 64 ? 32 : 64;
    if (widest > 16) {
        if (build_and_test(in, config, activated, widest) == SV_OK) return SV_OK;
        sva_say(in->diag, SV_LOG_INFO, "no vectors of %u rays on this device; going on with 16", widest);
        in->diag->reason[0] = '\0'; /* nothing has failed yet */
    }
    return build_and_test(in, config, activated, 16);
}

/* For who waits: where programs are kept, the next time needs a hundredth of the time. The number of quick
 * ones is always told: to who compares logs, numbers are no difference. */
static void tell_times(const sv_instance *in, double seconds) {
    const sv_builds *b = &in->builds;
    char kept[40] = "";
    if (b->kept > 0) (void)snprintf(kept, sizeof kept, ", %u of them kept in files", b->kept);
    sva_say(
        in->diag, SV_LOG_INFO,
        "activate: %.2f s; of it %.2f s for building %u program%s%s, %u without optimisation, the rest for "
        "the first run of their kernels",
        seconds, b->seconds, b->built, b->built == 1 ? "" : "s", kept, b->quick);
}

/* Kernels, self-tests and buffers, on an open device. */
static sv_status prepare(sv_instance *in, const sv_config *config, const sv_values *values) {
    const sv_program *const wide = sv_chain_needs_wide(config) ? &in->wide : NULL;
    sv_status status = sv_pipeline_check_memory(in->diag, &in->device, config);
    if (status == SV_OK) status = build_kernels(in, config, values);
    if (status == SV_OK)
        status = sv_selftest_method(in->diag, &in->device, &in->narrow, wide, config, values);
    if (status == SV_OK)
        status =
            sv_pipeline_create(&in->pipeline, in->diag, &in->device, &in->narrow, wide, &in->timing, config);
    if (status == SV_OK) status = sv_pipeline_warm_up(&in->pipeline, values);
    return status == SV_OK ? sva_cl_check(in->diag, clFinish(in->device.queue), "activate: clFinish")
                           : status;
}

/* The most that any frame enqueues: slabs of one slice, and values that ask for most passes. */
static sv_status max_commands(sv_diag *diag, const sv_device *device, const sv_config *config,
                              const sv_values *activated, uint32_t *out) {
    sv_values values = *activated;
    sv_demand most;
    values.of[SV_PARAM_KERNEL] = SV_MIN_KERNEL;
    values.of[SV_PARAM_PASSES] = 0.0; /* as many as it takes */
    values.of[SV_PARAM_PREFILTER_PASSES] = SV_MAX_PREFILTER_PASSES;
    const sv_status status = sv_pipeline_demand(diag, device, config, &values, 1, &most);
    *out = most.commands;
    return status;
}

sv_status sv_instance_needs(sv_diag *diag, const sv_device *device, const sv_format *format,
                            const sv_values *activated, const sv_values *frame, sv_needs *out) {
    const sv_config config = config_of(format, activated);
    uint32_t capacity = 0;
    sv_demand most;
    sv_status status = max_commands(diag, device, &config, activated, &capacity);
    if (status == SV_OK)
        status = sv_pipeline_demand(diag, device, &config, frame, config.max_slab_slices, &most);
    if (status != SV_OK) return status;
    *out = (sv_needs){.commands = most.commands,
                      .adjust_commands = most.adjust_commands,
                      .device_bytes = most.bytes,
                      .largest_buffer = most.largest_buffer,
                      .host_bytes = sv_timing_bytes(capacity)};
    return SV_OK;
}

static sv_status check_layout(sv_diag *diag, const sv_device *device, const sv_config *config) {
    if (!device->rays_only || sv_pipeline_strategy(device, config) == SV_STRATEGY_RAYS) return SV_OK;
    return sva_error(
        diag, SV_ERR_NO_DEVICE,
        "activate: the OpenCL platform 'rusticl' compiles no rows of rays: take strategy=rays or auto");
}

static sv_status activate(sv_instance *in, const sv_format *format, const sv_values *values) {
    const double begun = sv_seconds();
    in->process = getpid();
    sv_config config = config_of(format, values);
    uint32_t commands = 0;
    sv_status status = sv_device_open(in->diag, format->context, format->device, format->queue, &in->device);
    if (status == SV_OK) status = check_layout(in->diag, &in->device, &config);
    if (status == SV_OK) status = max_commands(in->diag, &in->device, &config, values, &commands);
    if (status == SV_OK) status = sv_timing_create(&in->timing, in->diag, commands);
    in->device.builds = &in->builds;
    if (status == SV_OK) {
        config.strategy = sv_pipeline_strategy(&in->device, &config); /* the self-tests run what frames run */
        status = prepare(in, &config, values);
    }
    if (status == SV_OK) tell_times(in, sv_seconds() - begun);
    sv_builds_release(&in->builds);
    in->device.builds = NULL;
    return status;
}

sv_status sv_instance_activate(sv_instance *in, const sv_format *format, const sv_values *values) {
    sv_host_state host;
    sv_host_state_keep(&host);
    const sv_status status = activate(in, format, values);
    sv_host_state_put_back(&host);
    return status;
}

void sv_instance_deactivate(sv_instance *in) {
    /* Waits for the host's queue, too: commands in flight use the buffers that are about to go. */
    if (in->device.queue) (void)clFinish(in->device.queue);
    sv_pipeline_destroy(&in->pipeline);
    sv_program_release(&in->narrow);
    sv_program_release(&in->wide);
    sv_timing_destroy(&in->timing);
    sv_device_close(&in->device);
}

bool sv_instance_is_forked(const sv_instance *in) {
    return in->process != getpid();
}

sv_status sv_instance_check_process(const sv_instance *in) {
    if (!sv_instance_is_forked(in)) return SV_OK;
    return sva_error(in->diag, SV_ERR_STATE,
                     "this process was forked after activate, and OpenCL does not work in it: activate in a "
                     "process that is started anew (Python's multiprocessing: spawn)");
}
