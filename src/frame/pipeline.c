/* SPDX-License-Identifier: MIT */
/* Buffers and their life, and the front of a frame: begin and slab. pipeline_end.c has the rest. */
#include "device/launch.h"

#include <assert.h>
#include <stdlib.h>
#include <string.h>

/* Maps up to this many pixels are reconstructed in one launch by one work item: there a launch costs as much
 * as a pass (docs/performance.md, "bands or one launch"). */
enum { SINGLE_MAX_PIXELS = 200 * 200 };
enum { BAND_MIN_ROWS = 32, BANDS_PER_UNIT = 2 };
/* Slabs wait until they hold this many voxels: about what a launch costs, so waiting longer gains nothing. */
enum { BATCH_VOXELS = 1 << 20 };

uint64_t sv_pipeline_slab_bytes(const sv_config *c, uint32_t slices) {
    if (slices == 0) return 0;
    const uint64_t last = slices - 1;
    const uint64_t row = last / c->tiles_x * c->tile_h + c->height - 1;
    const uint64_t full_row = slices > c->tiles_x ? c->tiles_x - 1 : last; /* the widest row of tiles */
    const uint64_t end_last = row * c->row_pitch + last % c->tiles_x * c->tile_w + c->width;
    const uint64_t row_above =
        slices > c->tiles_x ? (last / c->tiles_x - 1) * c->tile_h + c->height - 1 : row;
    const uint64_t end_above = row_above * c->row_pitch + full_row * c->tile_w + c->width;
    return end_last > end_above ? end_last : end_above;
}

/* Texture rows up to the last voxel of a slab. */
static uint64_t slab_rows(const sv_config *c, uint32_t slices) {
    return (uint64_t)((slices + c->tiles_x - 1) / c->tiles_x - 1) * c->tile_h + c->height;
}

/* A frame's fixed-point format. */
static sv_fixed format_of(const sv_config *c, uint32_t k, uint32_t weight_initial) {
    return c->half_sums ? sv_half_format(c->slices, weight_initial)
                        : sv_fixed_format(c->width, c->height, c->slices, k, weight_initial);
}

bool sv_pipeline_needs_wide(const sv_config *c) {
    for (uint32_t k = 3; k <= SV_MAX_K; k += 2)
        if (format_of(c, k, 4).wide) return true;
    return false;
}

static uint32_t resolve_strategy(const sv_device *device, const sv_config *c) {
    if (c->strategy != SV_STRATEGY_AUTO) return c->strategy;
    if (!device->is_cpu) return SV_STRATEGY_RAYS;
    return (uint64_t)c->width * c->height <= SINGLE_MAX_PIXELS ? SV_STRATEGY_SINGLE : SV_STRATEGY_BANDS;
}

static uint32_t band_count(const sv_device *device, const sv_config *c) {
    if (c->strategy != SV_STRATEGY_BANDS) return 1;
    const uint32_t wanted = device->compute_units * BANDS_PER_UNIT;
    const uint32_t most = (c->height + BAND_MIN_ROWS - 1) / BAND_MIN_ROWS;
    return wanted < most ? wanted : most;
}

/* What a method works with. Sums are also where the points stage leaves its own, whatever the method. */
static sv_status create_map_buffers(sv_pipeline *p) {
    const sv_config *c = &p->config;
    const size_t plane = (size_t)p->padded_width * c->height;
    const size_t sum = p->wide ? sizeof(cl_ulong) : sizeof(cl_uint);
    const size_t scratch_rows = p->bands * (size_t)SV_SCRATCH_ROWS;
    sv_buffers *b = &p->buffers;
    sv_status status = SV_OK;
    b->status = sv_clx_buffer(p->diag, p->device, plane, NULL, &status);
    b->sums_a = sv_clx_buffer(p->diag, p->device, SV_SUM_PLANES * plane * sum, NULL, &status);
    if (c->method == SV_METHOD_MEAN) {
        b->sums_b = sv_clx_buffer(p->diag, p->device, SV_SUM_PLANES * plane * sum, NULL, &status);
        b->scratch = sv_clx_buffer(p->diag, p->device, scratch_rows * (p->padded_width + SV_ROW_SLACK) * sum,
                                   NULL, &status);
    }
    b->surfaces = sv_clx_buffer(p->diag, p->device, 2 * plane * sizeof(cl_float), NULL, &status);
    return status;
}

static sv_status create_buffers(sv_pipeline *p) {
    const sv_config *c = &p->config;
    const size_t plane = (size_t)p->padded_width * c->height;
    sv_buffers *b = &p->buffers;
    sv_status status = SV_OK;
    const bool in_place = c->carrier == SV_CARRIER_HOST && c->host_memory && p->device->shares_memory;
    if (in_place)
        b->host_slabs = sv_clx_buffer(p->diag, p->device, c->host_memory_bytes,
                                      (void *)(uintptr_t)c->host_memory, &status);
    else if (c->carrier != SV_CARRIER_BUFFER)
        b->slab = sv_clx_buffer(p->diag, p->device, p->slab_bytes * p->batch_slots, NULL, &status);
    b->state8 = sv_clx_buffer(p->diag, p->device, SV_STATE8_PLANES * plane, NULL, &status);
    b->state16 =
        sv_clx_buffer(p->diag, p->device, plane * SV_STATE16_PLANES * sizeof(cl_ushort), NULL, &status);
    b->survey = sv_clx_buffer(p->diag, p->device, (size_t)p->bands * 257 * sizeof(cl_uint), NULL, &status);
    b->histogram = sv_clx_buffer(p->diag, p->device, 256 * sizeof(cl_uint), NULL, &status);
    b->record = sv_clx_buffer(p->diag, p->device, (SV_REC_PASS0 + (size_t)p->pass_capacity) * sizeof(cl_uint),
                              NULL, &status);
    b->depth =
        sv_clx_buffer(p->diag, p->device, (size_t)c->width * c->height * sizeof(cl_float), NULL, &status);
    return status == SV_OK ? create_map_buffers(p) : status;
}

/* Slabs of full length that make a batch worth its launch. */
static uint32_t batch_slots(const sv_config *c) {
    const uint64_t slab = (uint64_t)c->width * c->height * c->max_slab_slices;
    assert(slab > 0);
    const uint64_t wanted = (BATCH_VOXELS + slab - 1) / slab;
    return wanted < SV_BATCH ? (uint32_t)wanted : SV_BATCH;
}

sv_status sv_pipeline_create(sv_pipeline *p, sv_diag *diag, const sv_device *device, sv_program *narrow,
                             sv_program *wide, sv_timing *timing, const sv_config *config) {
    *p = (sv_pipeline){
        .diag = diag, .device = device, .narrow = narrow, .wide = wide, .timing = timing, .config = *config};
    p->config.strategy = resolve_strategy(device, config);
    p->spacing = 1;
    p->padded_width = (config->width + SV_LANES - 1) / SV_LANES * SV_LANES;
    p->bands = band_count(device, &p->config);
    p->pass_capacity = sv_pass_limit(config->width, config->height, 3);
    p->slab_bytes = sv_pipeline_slab_bytes(config, config->max_slab_slices);
    if (config->carrier == SV_CARRIER_IMAGE) /* images are copied in whole rows */
        p->slab_bytes = slab_rows(config, config->max_slab_slices) * config->row_pitch;
    p->batch_slots = batch_slots(config);
    sv_status status = create_buffers(p);
    if (status == SV_OK) status = sv_chain_create(p);
    if (status != SV_OK) sv_pipeline_destroy(p);
    return status;
}

sv_status sv_pipeline_warm_up(sv_pipeline *p, const sv_values *values) {
    if (p->chain.plain_mean) return SV_OK;
    sv_pipeline_begin(p, values);
    /* A slab of no slices reads nothing, so any buffer will do. */
    const sv_status status = sv_chain_slab(p, p->buffers.state8, 0, 0);
    if (status != SV_OK) return status;
    return sv_chain_run(p, 0.0f); /* the record is zeros: no points */
}

sv_status sv_pipeline_create_reduced(sv_pipeline *p) {
    sv_pipeline *r = malloc(sizeof *r);
    if (!r) return sv_fail(p->diag, SV_ERR_NO_MEMORY, "no memory for the reduced map (%zu bytes)", sizeof *r);
    *r = (sv_pipeline){
        .diag = p->diag, .device = p->device, .narrow = p->narrow, .wide = p->wide, .config = p->config};
    p->reduced = r;
    r->spacing = p->config.reduction;
    r->config.width = sv_reduced_side(p->config.width, r->spacing);
    r->config.height = sv_reduced_side(p->config.height, r->spacing);
    r->config.reduction = 1;
    r->padded_width = (r->config.width + SV_LANES - 1) / SV_LANES * SV_LANES;
    r->bands = band_count(p->device, &r->config);
    const sv_status status = create_map_buffers(r);
    r->buffers.record = p->buffers.record; /* freed with p's */
    return status;
}

void sv_pipeline_destroy(sv_pipeline *p) {
    if (p->reduced) {
        p->reduced->buffers.record = NULL;
        sv_pipeline_destroy(p->reduced);
        free(p->reduced);
        p->reduced = NULL;
    }
    sv_chain_destroy(&p->chain);
    sv_buffers *b = &p->buffers;
    cl_mem *const all[] = {&b->slab,      &b->host_slabs, &b->state8, &b->state16, &b->survey,
                           &b->histogram, &b->status,     &b->sums_a, &b->sums_b,  &b->scratch,
                           &b->surfaces,  &b->record,     &b->depth};
    for (size_t i = 0; i < sizeof all / sizeof *all; i++) sv_clx_release(all[i]);
}

/* What depends on the map's size: the filter's passes and the format of its sums. */
static void choose_format(sv_pipeline *p) {
    const sv_config *c = &p->config;
    sv_job *j = &p->job;
    j->pass_limit = sv_pass_limit(c->width, c->height, j->k);
    const sv_fixed format = format_of(c, j->k, j->weight_initial);
    j->fraction = format.fraction;
    p->program = format.wide ? p->wide : p->narrow;
}

/* The job of the smaller map: lengths in its own pixels. Lambda is an area (docs/algorithm.md). */
static void begin_reduced(sv_pipeline *r, const sv_pipeline *p) {
    const double area = (double)r->spacing * r->spacing;
    double *v = r->values.of;
    r->job = p->job;
    r->job.width = r->config.width;
    r->job.padded_width = r->padded_width;
    r->job.height = r->config.height;
    r->job.k = sv_reduced_kernel(p->job.k, r->spacing);
    choose_format(r);
    r->values = p->values;
    v[SV_PARAM_PREFILTER_KERNEL] = sv_reduced_kernel((uint32_t)v[SV_PARAM_PREFILTER_KERNEL], r->spacing);
    v[SV_PARAM_LAMBDA] /= area;
}

void sv_pipeline_begin(sv_pipeline *p, const sv_values *values) {
    const sv_config *c = &p->config;
    const double *v = values->of;
    sv_job *j = &p->job;
    *j = (sv_job){.width = c->width, .padded_width = p->padded_width, .height = c->height};
    j->bone_mode = (uint32_t)v[SV_PARAM_BONE_MODE];
    j->fluid_level = sv_grey_level(v[SV_PARAM_FLUID_THRESHOLD], 1);
    j->bone_level = sv_grey_level(v[SV_PARAM_BONE_THRESHOLD], 1);
    j->bone_drop = 255 - sv_grey_level(1.0 - v[SV_PARAM_BONE_OFFSET], 1);
    j->bone_wanted = sv_rays_wanted(v[SV_PARAM_BONE_FRACTION], c->width * c->height);
    j->drop_empty = v[SV_PARAM_DROP_EMPTY] != 0.0;
    j->min_gap = sv_gap_samples(v[SV_PARAM_MIN_GAP], c->substeps);
    j->evidence = (uint32_t)(v[SV_PARAM_EVIDENCE] * 1000.0 + 0.5);
    j->k = (uint32_t)v[SV_PARAM_KERNEL];
    sv_fill_weights(v[SV_PARAM_FILL_WEIGHT], &j->weight_initial, &j->weight_filled);
    choose_format(p);
    p->level_n = sv_grey_level(v[SV_PARAM_FLUID_THRESHOLD], c->substeps);
    p->next_slice = 0;
    p->values = *values;
    p->batch = (sv_batch){0};
    if (p->reduced) begin_reduced(p->reduced, p);
    if (p->timing) sv_timing_reset(p->timing);
}

/* Brings a slab where the kernels can read it: the buffer and the offset of its first byte. Copied slabs get
 * a slot each, for the batch that they will be launched with. */
static sv_status place_slab(sv_pipeline *p, const sv_slab *slab, cl_mem *buffer, uint64_t *offset) {
    const sv_config *c = &p->config;
    *buffer = p->buffers.slab;
    *offset = p->batch.count * p->slab_bytes;
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
    cl_event *slot = sv_timing_slot(p->timing, SV_STAGE_TRANSFER);
    const cl_command_queue queue = p->device->queue;
    if (c->carrier == SV_CARRIER_HOST) {
        const size_t bytes = sv_pipeline_slab_bytes(c, slab->slice_count);
        return sv_clx_check(
            p->diag,
            clEnqueueWriteBuffer(queue, *buffer, CL_FALSE, *offset, bytes, slab->memory, 0, NULL, slot),
            "slab: clEnqueueWriteBuffer");
    }
    const size_t origin[3] = {0, 0, 0};
    const size_t region[3] = {(size_t)c->tiles_x * c->tile_w, slab_rows(c, slab->slice_count), 1};
    return sv_clx_check(
        p->diag,
        clEnqueueCopyImageToBuffer(queue, slab->object, *buffer, origin, region, *offset, 0, NULL, slot),
        "slab: clEnqueueCopyImageToBuffer");
}

/* Launches the profile of the slabs that wait. */
static sv_status launch_profile(sv_pipeline *p) {
    const sv_config *c = &p->config;
    const bool rays = c->strategy == SV_STRATEGY_RAYS;
    sv_launch l = rays ? SV_LAUNCH(p, profile_rays) : SV_LAUNCH(p, profile_strip);
    sv_launch_buffer(&l, p->batch_buffer);
    sv_launch_arg(&l, sizeof p->batch, &p->batch);
    const uint32_t numbers[] = {
        c->row_pitch,    c->tiles_x, c->tile_w,          c->tile_h,  c->width,
        p->padded_width, c->height,  p->job.fluid_level, p->level_n, (uint32_t)c->padding & 255u};
    for (size_t i = 0; i < sizeof numbers / sizeof *numbers; i++) sv_launch_uint(&l, numbers[i]);
    sv_launch_buffer(&l, p->buffers.state8);
    sv_launch_buffer(&l, p->buffers.state16);
    p->batch = (sv_batch){.first_slice = p->next_slice};
    return rays ? sv_launch_pixels(&l, c->width, c->height, SV_STAGE_PROFILE)
                : sv_launch_items(&l, c->height, SV_STAGE_PROFILE);
}

/* True if the slabs that wait are worth a launch, or no more can wait. */
static bool batch_is_due(const sv_pipeline *p) {
    const sv_config *c = &p->config;
    const uint64_t slices = p->next_slice - p->batch.first_slice;
    return p->batch.count == p->batch_slots || p->next_slice == c->slices ||
           slices * c->width * c->height >= BATCH_VOXELS;
}

sv_status sv_pipeline_slab(sv_pipeline *p, const sv_slab *slab) {
    cl_mem buffer = NULL;
    uint64_t offset = 0;
    sv_status status = place_slab(p, slab, &buffer, &offset);
    if (status == SV_OK && p->batch.count > 0 && buffer != p->batch_buffer) status = launch_profile(p);
    if (status != SV_OK) return status;
    status = sv_chain_slab(p, buffer, offset, slab->slice_count);
    if (status != SV_OK) return status;
    p->batch_buffer = buffer;
    p->batch.offset[p->batch.count] = offset;
    p->batch.slices[p->batch.count++] = slab->slice_count;
    p->next_slice += slab->slice_count;
    return batch_is_due(p) ? launch_profile(p) : SV_OK;
}
