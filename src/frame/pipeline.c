/* SPDX-License-Identifier: MIT */
/* Buffers and their life, and the front of a frame: begin and slab. pipeline_end.c has the rest. */
#include "frame/pipeline.h"

#include "device/queue.h"
#include "quantise.h"
#include "smartvis/author_checks.h"

#include <assert.h>

/* Maps up to this many pixels are reconstructed in one launch by one work item: there a launch costs as much
 * as a pass (docs/performance.md). */
enum { SINGLE_MAX_PIXELS = 200 * 200 };
/* Slabs wait until they hold this many voxels: about what a launch costs, so waiting longer gains nothing. */
enum { BATCH_VOXELS = 1 << 20 };

/* Bytes of a slab texture up to its last voxel. */
static uint64_t slab_bytes(const sv_config *c, uint32_t slices) {
    const sv_format f = {.width = c->width,
                         .height = c->height,
                         .tiles_x = c->tiles_x,
                         .tile_w = c->tile_w,
                         .tile_h = c->tile_h,
                         .row_pitch = c->row_pitch};
    return sva_slab_bytes(&f, slices);
}

/* Texture rows up to the last voxel of a slab. */
static uint64_t slab_rows(const sv_config *c, uint32_t slices) {
    return (uint64_t)((slices + c->tiles_x - 1) / c->tiles_x - 1) * c->tile_h + c->height;
}

uint32_t sv_pipeline_strategy(const sv_device *device, const sv_config *c) {
    if (c->strategy != SV_STRATEGY_AUTO) return c->strategy;
    if (!device->is_cpu) return SV_STRATEGY_RAYS;
    return (uint64_t)c->width * c->height <= SINGLE_MAX_PIXELS ? SV_STRATEGY_SINGLE : SV_STRATEGY_BANDS;
}

/* All buffers of the pipeline, made or counted (device/queue.h): there is no other list of them. */
static sv_status make_buffers(sv_pipeline *p) {
    const sv_config *c = &p->config;
    const sv_queue *q = &p->queue;
    const size_t plane = (size_t)p->map.padded_width * c->height;
    const bool in_place = c->carrier == SV_CARRIER_HOST && c->host_memory && q->device->shares_memory;
    sv_buffers *b = &p->buffers;
    sv_status status = SV_OK;
    if (in_place)
        b->host_slabs = sv_buffer_wrap(q, c->host_memory, c->host_memory_bytes, &status);
    else if (c->carrier != SV_CARRIER_BUFFER)
        b->slab = sv_buffer_make(q, p->slab_bytes * p->batch_slots, &status);
    if (p->chain.needs_profile) {
        b->state8 = sv_buffer_make(q, SV_STATE8_PLANES * plane, &status);
        b->state16 = sv_buffer_make(q, plane * SV_STATE16_PLANES * sizeof(cl_ushort), &status);
        b->survey = sv_buffer_make(q, (size_t)p->map.bands * 257 * sizeof(cl_uint), &status);
        b->histogram = sv_buffer_make(q, 256 * sizeof(cl_uint), &status);
    }
    b->record = sv_buffer_make(q, (SV_REC_PASS0 + (size_t)p->pass_capacity) * sizeof(cl_uint), &status);
    b->depth = sv_buffer_make(q, (size_t)c->width * c->height * sizeof(cl_float), &status);
    if (c->ranged) {
        b->ranges = sv_buffer_make(q, (size_t)c->width * c->height * sizeof(sv_scanned), &status);
        b->scanned = sv_buffer_make(q, plane * SV_SCANNED_PLANES * sizeof(cl_ushort), &status);
        p->map.scanned = b->scanned;
    }
    if (status == SV_OK)
        status = p->chain.method->slabs ? sv_map_status_buffer(&p->map, b->record)
                                        : sv_map_buffers(&p->map, b->record);
    return status == SV_OK ? sv_chain_buffers(&p->chain) : status;
}

/* Slabs of full length that make a batch worth its launch. */
static uint32_t batch_slots(const sv_config *c) {
    const uint64_t slab = (uint64_t)c->width * c->height * c->max_slab_slices;
    assert(slab > 0);
    const uint64_t wanted = (BATCH_VOXELS + slab - 1) / slab;
    return wanted < SV_BATCH ? (uint32_t)wanted : SV_BATCH;
}

/* Sets everything but the buffers and the kernels. */
static void plan(sv_pipeline *p, const sv_queue *queue, const sv_config *config, bool wide_sums) {
    *p = (sv_pipeline){.queue = *queue, .config = *config};
    p->config.strategy = sv_pipeline_strategy(queue->device, config);
    sv_map_init(&p->map, &p->queue, &p->config, wide_sums);
    p->pass_capacity = sv_pass_limit(config->width, config->height, 3);
    p->slab_bytes = slab_bytes(config, config->max_slab_slices);
    if (config->carrier == SV_CARRIER_IMAGE) /* images are copied in whole rows */
        p->slab_bytes = slab_rows(config, config->max_slab_slices) * config->row_pitch;
    p->batch_slots = batch_slots(config);
}

/* A pipeline that makes nothing: its queue counts. */
static sv_status pretend(sv_pipeline *p, sv_diag *diag, const sv_device *device, const sv_config *config,
                         sv_tally *tally) {
    static const sv_program no_kernels;
    const sv_queue counting = {.diag = diag, .device = device, .tally = tally};
    plan(p, &counting, config, sv_map_needs_wide(config));
    p->map.narrow = p->map.wide = &no_kernels;
    sv_chain_init(&p->chain, &p->map);
    return make_buffers(p);
}

static sv_status pretend_output(sv_pipeline *p) {
    sv_stats stats;
    float depth;
    uint8_t points;
    const sv_result result = {.depth = &depth, .status = &points, .stats = &stats};
    return sv_pipeline_output(p, &result);
}

static sv_status pretend_frame(sv_pipeline *p, const sv_values *values, uint32_t slab_slices) {
    const sv_config *c = &p->config;
    const sv_frame_context context = {0};
    sv_pipeline_begin(p, values, &context);
    sv_status status = c->ranged ? sv_pipeline_scanned(p, NULL, NULL, 0) : SV_OK;
    while (status == SV_OK && p->next_slice < c->slices) {
        const uint32_t left = c->slices - p->next_slice;
        const sv_slab slab = {.first_slice = p->next_slice,
                              .slice_count = left < slab_slices ? left : slab_slices,
                              .memory = c->host_memory,
                              .object = (cl_mem)((uintptr_t)p->next_slice + 1)};
        status = sv_pipeline_slab(p, &slab);
    }
    if (status == SV_OK) status = sv_pipeline_end(p);
    return status == SV_OK ? pretend_output(p) : status;
}

sv_status sv_pipeline_demand(sv_diag *diag, const sv_device *device, const sv_config *config,
                             const sv_values *values, uint32_t slab_slices, sv_demand *out) {
    sv_pipeline p;
    sv_tally tally = {0};
    sv_status status = pretend(&p, diag, device, config, &tally);
    if (status == SV_OK) status = pretend_frame(&p, values, slab_slices);
    *out = (sv_demand){.bytes = tally.bytes, .largest_buffer = tally.largest, .commands = tally.commands};
    if (status == SV_OK) status = sv_pipeline_adjust(&p, p.q);
    if (status == SV_OK) status = pretend_output(&p);
    out->adjust_commands = tally.commands - out->commands;
    return status;
}

sv_status sv_pipeline_check_memory(sv_diag *diag, const sv_device *device, const sv_config *config) {
    sv_tally tally = {0};
    sv_pipeline p;
    const sv_status status = pretend(&p, diag, device, config, &tally);
    if (status != SV_OK) return status;
    if (tally.bytes > device->memory)
        return sva_error(diag, SV_ERR_FORMAT,
                         "activate: a format of %u x %u x %u needs %llu bytes on the device, which has %llu",
                         config->width, config->height, config->slices, (unsigned long long)tally.bytes,
                         (unsigned long long)device->memory);
    if (tally.largest > device->largest_buffer)
        return sva_error(
            diag, SV_ERR_FORMAT,
            "activate: a format of %u x %u x %u needs a buffer of %llu bytes, the device allows %llu",
            config->width, config->height, config->slices, (unsigned long long)tally.largest,
            (unsigned long long)device->largest_buffer);
    sva_say(diag, SV_LOG_INFO,
            "activate: %u x %u x %u needs %llu bytes on the device, the largest buffer %llu", config->width,
            config->height, config->slices, (unsigned long long)tally.bytes,
            (unsigned long long)tally.largest);
    return SV_OK;
}

sv_status sv_pipeline_create(sv_pipeline *p, sv_diag *diag, const sv_device *device, const sv_program *narrow,
                             const sv_program *wide, sv_timing *timing, const sv_config *config) {
    const sv_queue queue = {.diag = diag, .device = device, .timing = timing};
    plan(p, &queue, config, wide != NULL);
    p->map.narrow = narrow;
    p->map.wide = wide;
    sv_chain_init(&p->chain, &p->map);
    sv_status status = make_buffers(p);
    if (status == SV_OK) status = sv_chain_build(&p->chain);
    if (status != SV_OK) sv_pipeline_destroy(p);
    return status;
}

sv_status sv_pipeline_warm_up(sv_pipeline *p, const sv_values *values) {
    if (p->chain.direct) return SV_OK;
    sv_values all = *values;
    all.of[SV_PARAM_UNSURE] = SV_UNSURE_CLIP; /* a later frame may launch what others leave out */
    all.of[SV_PARAM_Q] = 0.0;
    const sv_frame_context context = {.beams = {.rotation = {[0] = 1.0f, [4] = 1.0f, [8] = 1.0f}}};
    sv_pipeline_begin(p, &all, &context);
    const sv_method *m = p->chain.method;
    if (!m->slabs)
        return sv_chain_run(&p->chain, p->buffers.state16, p->q); /* the record is zeros: no points */
    /* A slab of no slices reads nothing, so any buffer will do. */
    const sv_placed_slabs none = {.buffer = p->buffers.depth, .batch = {.count = 1}};
    const sv_depth_target to = {p->buffers.depth, 0};
    sv_status status = m->slabs(&p->map, &p->chain.state, &none);
    if (status == SV_OK) status = m->find(&p->map, &p->chain.state, &context);
    return status == SV_OK ? m->place(&p->map, &p->chain.state, p->q, &to) : status;
}

void sv_pipeline_destroy(sv_pipeline *p) {
    sv_chain_destroy(&p->chain);
    sv_map_release(&p->map);
    sv_buffers *b = &p->buffers;
    cl_mem *const all[] = {&b->slab,      &b->host_slabs, &b->state8, &b->state16, &b->survey,
                           &b->histogram, &b->record,     &b->ranges, &b->scanned, &b->depth};
    for (size_t i = 0; i < sizeof all / sizeof *all; i++) sv_buffer_release(all[i]);
}

static sv_job job_of(const sv_config *c, const sv_values *values) {
    const double *v = values->of;
    sv_job j = {.bone_mode = (uint32_t)v[SV_PARAM_BONE_MODE]};
    j.fluid_level = sv_grey_level(v[SV_PARAM_FLUID_THRESHOLD], 1);
    j.bone_level = sv_grey_level(v[SV_PARAM_BONE_THRESHOLD], 1);
    j.bone_drop = 255 - sv_grey_level(1.0 - v[SV_PARAM_BONE_OFFSET], 1);
    j.bone_wanted = sv_rays_wanted(v[SV_PARAM_BONE_FRACTION], c->width * c->height);
    j.drop_empty = v[SV_PARAM_DROP_EMPTY] != 0.0;
    j.min_gap = sv_gap_samples(v[SV_PARAM_MIN_GAP], c->substeps);
    j.evidence = (uint32_t)(v[SV_PARAM_EVIDENCE] * 1000.0 + 0.5);
    j.k = (uint32_t)v[SV_PARAM_KERNEL];
    sv_fill_weights(v[SV_PARAM_FILL_WEIGHT], &j.weight_initial, &j.weight_filled);
    return j;
}

void sv_pipeline_begin(sv_pipeline *p, const sv_values *values, const sv_frame_context *context) {
    const sv_job job = job_of(&p->config, values);
    sv_map_begin(&p->map, &job, values);
    p->level_n = sv_grey_level(values->of[SV_PARAM_FLUID_THRESHOLD], p->config.substeps);
    p->context = *context;
    p->context.beams.same_volume = context->beams.same_volume && p->ended;
    p->ended = false;
    p->q = (float)values->of[SV_PARAM_Q];
    p->next_slice = 0;
    p->waiting = (sv_placed_slabs){0};
    if (p->queue.timing) sv_timing_reset(p->queue.timing);
}

sv_status sv_pipeline_scanned(sv_pipeline *p, const sv_scanned *ranges, cl_mem object, uint64_t offset) {
    const sv_config *c = &p->config;
    const size_t bytes = (size_t)c->width * c->height * sizeof *ranges;
    if (!object) {
        const cl_int code =
            sv_counted(&p->queue)
                ? CL_SUCCESS
                : clEnqueueWriteBuffer(p->queue.device->queue, p->buffers.ranges, CL_FALSE, 0, bytes, ranges,
                                       0, NULL, sv_timing_slot(p->queue.timing, SV_STAGE_TRANSFER));
        const sv_status status = sva_cl_check(p->queue.diag, code, "begin: clEnqueueWriteBuffer of scanned");
        if (status != SV_OK) return status;
    }
    const cl_ulong first = offset / sizeof(cl_ushort);
    const cl_kernel kernel = p->chain.needs_profile ? p->map.program->scanned_planes
                                                    : p->chain.state.kernels.kernel[SV_METHOD_SCANNED];
    sv_launch l = sv_launch_begin(&p->queue, kernel, "scanned_planes");
    sv_launch_buffer(&l, object ? object : p->buffers.ranges);
    sv_launch_arg(&l, sizeof first, &first);
    sv_launch_uint(&l, c->width);
    sv_launch_uint(&l, p->map.padded_width);
    sv_launch_uint(&l, c->height);
    sv_launch_uint(&l, c->slices);
    sv_launch_buffer(&l, p->buffers.scanned);
    return sv_launch_items(&l, c->height, SV_STAGE_TRANSFER);
}

/* Brings a slab where the kernels can read it: the buffer and the offset of its first byte. Copied slabs get
 * a slot each, for the batch that they will be launched with. */
static sv_status place_slab(sv_pipeline *p, const sv_slab *slab, cl_mem *buffer, uint64_t *offset) {
    const sv_config *c = &p->config;
    *buffer = p->buffers.slab;
    *offset = p->waiting.batch.count * p->slab_bytes;
    if (c->carrier == SV_CARRIER_BUFFER) {
        *buffer = slab->object;
        *offset = slab->offset;
        return SV_OK;
    }
    if (p->buffers.host_slabs) {
        *buffer = p->buffers.host_slabs;
        *offset = (uint64_t)((const char *)slab->memory - (const char *)c->host_memory);
        return SV_OK;
    }
    if (sv_counted(&p->queue)) return SV_OK;
    cl_event *slot = sv_timing_slot(p->queue.timing, SV_STAGE_TRANSFER);
    const cl_command_queue queue = p->queue.device->queue;
    if (c->carrier == SV_CARRIER_HOST) {
        const size_t bytes = slab_bytes(c, slab->slice_count);
        return sva_cl_check(
            p->queue.diag,
            clEnqueueWriteBuffer(queue, *buffer, CL_FALSE, *offset, bytes, slab->memory, 0, NULL, slot),
            "slab: clEnqueueWriteBuffer");
    }
    const size_t origin[3] = {0, 0, 0};
    const size_t region[3] = {(size_t)c->tiles_x * c->tile_w, slab_rows(c, slab->slice_count), 1};
    return sva_cl_check(
        p->queue.diag,
        clEnqueueCopyImageToBuffer(queue, slab->object, *buffer, origin, region, *offset, 0, NULL, slot),
        "slab: clEnqueueCopyImageToBuffer");
}

/* Launches the profile of the slabs that wait. */
static sv_status launch_profile(const sv_pipeline *p) {
    const sv_config *c = &p->config;
    const bool rays = c->strategy == SV_STRATEGY_RAYS;
    sv_launch l = rays ? SV_LAUNCH(&p->map, profile_rays) : SV_LAUNCH(&p->map, profile_strip);
    sv_launch_buffer(&l, p->waiting.buffer);
    sv_launch_arg(&l, sizeof p->waiting.batch, &p->waiting.batch);
    const uint32_t numbers[] = {c->row_pitch, c->tiles_x,          c->tile_w, c->tile_h,
                                c->width,     p->map.padded_width, c->height, p->map.job.fluid_level,
                                p->level_n,   c->padding};
    for (size_t i = 0; i < sizeof numbers / sizeof *numbers; i++) sv_launch_uint(&l, numbers[i]);
    /* Without ranges the kernel reads none: any buffer will do. */
    sv_launch_buffer(&l, c->ranged ? p->buffers.scanned : p->buffers.state16);
    sv_launch_buffer(&l, p->buffers.state8);
    sv_launch_buffer(&l, p->buffers.state16);
    return rays ? sv_launch_pixels(&l, c->width, c->height, SV_STAGE_PROFILE)
                : sv_launch_items(&l, c->height, SV_STAGE_PROFILE);
}

/* Launches what the frame wants of the slabs that wait, and lets no more wait. */
static sv_status launch_waiting(sv_pipeline *p) {
    const sv_method *m = p->chain.method;
    const sv_status status = m->slabs ? m->slabs(&p->map, &p->chain.state, &p->waiting) : launch_profile(p);
    p->waiting.batch = (sv_batch){.first_slice = p->next_slice};
    return status;
}

/* True if the slabs that wait are worth a launch, or no more can wait. */
static bool batch_is_due(const sv_pipeline *p) {
    const sv_config *c = &p->config;
    const sv_batch *b = &p->waiting.batch;
    const uint64_t slices = p->next_slice - b->first_slice;
    return b->count == p->batch_slots || p->next_slice == c->slices ||
           slices * c->width * c->height >= BATCH_VOXELS;
}

sv_status sv_pipeline_slab(sv_pipeline *p, const sv_slab *slab) {
    sv_placed_slabs *w = &p->waiting;
    cl_mem buffer;
    uint64_t offset;
    sv_status status = place_slab(p, slab, &buffer, &offset);
    if (status == SV_OK && w->batch.count > 0 && buffer != w->buffer) status = launch_waiting(p);
    if (status != SV_OK) return status;
    p->next_slice += slab->slice_count;
    w->buffer = buffer;
    w->batch.offset[w->batch.count] = offset;
    w->batch.slices[w->batch.count++] = slab->slice_count;
    return batch_is_due(p) ? launch_waiting(p) : SV_OK;
}
