/* SPDX-License-Identifier: MIT */
#include "frame/pipeline.h"

#include "device/queue.h"

/* Finds the bone level from the survey of so many bands, and starts an empty record. */
static sv_status launch_level(sv_pipeline *p, uint32_t bands) {
    sv_launch l = SV_LAUNCH_JOB(&p->map, band_level);
    sv_launch_buffer(&l, p->buffers.survey);
    sv_launch_uint(&l, bands);
    sv_launch_buffer(&l, p->buffers.histogram);
    sv_launch_buffer(&l, p->buffers.record);
    return sv_launch_items(&l, 1, SV_STAGE_THRESHOLD);
}

static void points_args(sv_launch *l, const sv_pipeline *p) {
    const sv_map *m = &p->map;
    const cl_mem buffers[] = {p->buffers.state8, p->buffers.state16, m->status,
                              m->sums,           m->surfaces,        m->record};
    for (size_t i = 0; i < sizeof buffers / sizeof *buffers; i++) sv_launch_buffer(l, buffers[i]);
}

/* Computes status map and sums, and an empty surface, by bands of rows. */
static sv_status points_by_bands(sv_pipeline *p) {
    const sv_buffers *b = &p->buffers;
    sv_launch l = SV_LAUNCH_JOB(&p->map, band_survey);
    sv_launch_buffer(&l, b->state8);
    sv_launch_buffer(&l, b->survey);
    sv_status status = sv_launch_items(&l, p->map.bands, SV_STAGE_THRESHOLD);
    if (status == SV_OK) status = launch_level(p, p->map.bands);
    if (status != SV_OK) return status;
    l = SV_LAUNCH_JOB(&p->map, band_points);
    points_args(&l, p);
    return sv_launch_items(&l, p->map.bands, SV_STAGE_THRESHOLD);
}

/* Computes status map and sums, and an empty surface, by pixels. */
static sv_status points_by_rays(sv_pipeline *p) {
    const sv_buffers *b = &p->buffers;
    sv_launch l = SV_LAUNCH(&p->map, rays_clear);
    sv_launch_buffer(&l, b->survey);
    sv_status status = sv_launch_items(&l, 257, SV_STAGE_THRESHOLD);
    if (status == SV_OK) {
        l = SV_LAUNCH_JOB(&p->map, rays_survey);
        sv_launch_buffer(&l, b->state8);
        sv_launch_buffer(&l, b->survey);
        status = sv_launch_pixels(&l, p->config.width, p->config.height, SV_STAGE_THRESHOLD);
    }
    if (status == SV_OK) status = launch_level(p, p->map.bands);
    if (status != SV_OK) return status;
    l = SV_LAUNCH_JOB(&p->map, rays_points);
    points_args(&l, p);
    return sv_launch_pixels(&l, p->map.padded_width, p->config.height, SV_STAGE_THRESHOLD);
}

sv_status sv_pipeline_end(sv_pipeline *p) {
    sv_chain *chain = &p->chain;
    const sv_buffers *b = &p->buffers;
    p->ended = true;
    if (chain->method->slabs) return chain->method->find(&p->map, &chain->state, &p->context);
    if (chain->direct && chain->method->single && p->config.strategy == SV_STRATEGY_SINGLE) {
        const sv_ray_states rays = {b->state8, b->state16, b->histogram};
        return chain->method->single(&p->map, &chain->state, &rays);
    }
    const bool by_rays = p->config.strategy == SV_STRATEGY_RAYS;
    const sv_status status = by_rays ? points_by_rays(p) : points_by_bands(p);
    return status == SV_OK ? sv_chain_run(chain, b->state16, p->q) : status;
}

sv_status sv_pipeline_adjust(sv_pipeline *p, float q) {
    p->q = q;
    return p->chain.linear || p->chain.method->slabs ? SV_OK : sv_chain_run(&p->chain, p->buffers.state16, q);
}

/* S(q) from the two surfaces; where q is in the first plane already, the second holds zeros. */
static sv_status blend_surfaces(sv_pipeline *p, const sv_depth_target *to) {
    const sv_config *c = &p->config;
    const float q = p->chain.linear ? p->q : 1.0f;
    sv_launch l = SV_LAUNCH(&p->map, blend);
    sv_launch_buffer(&l, p->map.surfaces);
    sv_launch_uint(&l, c->width);
    sv_launch_uint(&l, p->map.padded_width);
    sv_launch_uint(&l, c->height);
    sv_launch_arg(&l, sizeof q, &q);
    sv_launch_buffer(&l, to->buffer);
    sv_launch_arg(&l, sizeof to->first, &to->first);
    return sv_launch_items(&l, c->height, SV_STAGE_OUTPUT);
}

/* Enqueues a read of a map whose rows are `from_pitch` bytes apart into host rows `to_pitch` apart. */
static sv_status read_rows(sv_pipeline *p, cl_mem from, size_t from_pitch, void *to, size_t to_pitch,
                           size_t row_bytes, const char *what) {
    if (sv_counted(&p->queue)) return SV_OK;
    const size_t origin[3] = {0, 0, 0};
    const size_t region[3] = {row_bytes, p->config.height, 1};
    cl_event *slot = sv_timing_slot(p->queue.timing, SV_STAGE_OUTPUT);
    const cl_command_queue queue = p->queue.device->queue;
    const bool whole = from_pitch == row_bytes && to_pitch == row_bytes;
    const cl_int code =
        whole ? clEnqueueReadBuffer(queue, from, CL_FALSE, 0, row_bytes * p->config.height, to, 0, NULL, slot)
              : clEnqueueReadBufferRect(queue, from, CL_FALSE, origin, origin, region, from_pitch, 0,
                                        to_pitch, 0, to, 0, NULL, slot);
    return sva_cl_check(p->queue.diag, code, what);
}

/* Enqueues a read of words of the record into what follows the `size` of a struct of the ABI. */
static sv_status read_record(sv_pipeline *p, uint32_t word, void *out, size_t bytes, const char *what) {
    if (sv_counted(&p->queue)) return SV_OK;
    return sva_cl_check(p->queue.diag,
                        clEnqueueReadBuffer(p->queue.device->queue, p->buffers.record, CL_FALSE,
                                            word * sizeof(cl_uint), bytes - sizeof(uint32_t),
                                            (char *)out + sizeof(uint32_t), 0, NULL,
                                            sv_timing_slot(p->queue.timing, SV_STAGE_OUTPUT)),
                        what);
}

static sv_status read_stats(sv_pipeline *p, sv_stats *stats) {
    _Static_assert(sizeof *stats == SV_REC_STATS_WORDS * sizeof(cl_uint), "the record is no longer sv_stats");
    return read_record(p, SV_REC_OUTCOME, stats, sizeof *stats, "end: read of the statistics");
}

sv_status sv_pipeline_read_points(sv_pipeline *p, sv_points_report *out) {
    _Static_assert(sizeof *out == (1 + SV_REC_EVIDENT + 1 - SV_REC_EMPTY) * sizeof(cl_uint),
                   "the record is no longer sv_points_report");
    /* This is no part of the frame that is timed. */
    sv_timing *timing = p->queue.timing;
    p->queue.timing = NULL;
    const sv_status status = read_record(p, SV_REC_EMPTY, out, sizeof *out, "points: read of the record");
    p->queue.timing = timing;
    return status;
}

sv_status sv_pipeline_output(sv_pipeline *p, const sv_result *result) {
    const sv_config *c = &p->config;
    const sv_method *m = p->chain.method;
    const size_t row = (size_t)c->width * sizeof(float);
    const cl_mem depth = result->depth_object ? result->depth_object : p->buffers.depth;
    const sv_depth_target to = {depth, result->depth_object ? result->depth_offset / sizeof(float) : 0};
    sv_status status = m->place ? m->place(&p->map, &p->chain.state, p->q, &to) : blend_surfaces(p, &to);
    if (status == SV_OK && result->depth)
        status = read_rows(p, depth, row, result->depth, result->depth_pitch ? result->depth_pitch : row, row,
                           "end: read of the depthmap");
    if (status == SV_OK && result->status)
        status = read_rows(p, p->map.status, p->map.padded_width, result->status, c->width, c->width,
                           "end: read of the status map");
    if (status == SV_OK && result->stats) status = read_stats(p, result->stats);
    return status;
}

sv_status sv_pipeline_confidence(sv_pipeline *p, float *map, cl_mem object, uint64_t offset, bool wait) {
    const cl_command_queue queue = p->queue.device->queue;
    const cl_mem from = p->chain.method->confidence(&p->chain.state);
    const size_t bytes = (size_t)p->config.width * p->config.height * sizeof *map;
    const cl_int code = map ? clEnqueueReadBuffer(queue, from, CL_FALSE, 0, bytes, map, 0, NULL, NULL)
                            : clEnqueueCopyBuffer(queue, from, object, 0, offset, bytes, 0, NULL, NULL);
    if (code != CL_SUCCESS) return sva_cl_check(p->queue.diag, code, "confidence: enqueue");
    return wait ? sva_cl_check(p->queue.diag, clFinish(queue), "confidence: clFinish") : SV_OK;
}
