/* SPDX-License-Identifier: MIT */
/*
 * Method mean: passes of a k x k window mean until no pixel is empty (cl/mean/mean.clh). On its own it starts
 * from the sums that the points stage wrote; behind a pre-filter from the maps.
 */
#include "method/method.h"

#include "device/queue.h"
#include "kernels_mean_maps.h"
#include "mean/mean_shared.h"

enum { K_LOAD, K_STORE };
static const char *const kernels[] = {"mean_load", "mean_store", NULL};

static sv_source source(void) {
    return (sv_source){sv_kernels_mean_maps, sv_kernels_mean_maps_size};
}

/* The second planes that passes alternate with, and the bands' scratch rows. */
enum { SUMS_B, SCRATCH };

static sv_status buffers(const sv_map *m, sv_method_state *s) {
    const size_t plane = (size_t)m->padded_width * m->height;
    const size_t row = (size_t)m->padded_width + SV_ROW_SLACK;
    sv_status status = SV_OK;
    s->buffer[SUMS_B] = sv_buffer_make(m->queue, SV_SUM_PLANES * plane * m->sum_bytes, &status);
    s->buffer[SCRATCH] =
        sv_buffer_make(m->queue, m->bands * (size_t)SV_SCRATCH_ROWS * row * m->sum_bytes, &status);
    return status;
}

/* Points and all passes in one launch, by one work item. */
static sv_status single(const sv_map *m, sv_method_state *s, const sv_ray_states *rays) {
    sv_launch l = SV_LAUNCH_JOB(m, frame_end);
    const cl_mem buffers_of_it[] = {rays->state8,       rays->state16, rays->histogram,
                                    m->status,          m->sums,       s->buffer[SUMS_B],
                                    s->buffer[SCRATCH], m->surfaces,   m->record};
    for (size_t i = 0; i < sizeof buffers_of_it / sizeof *buffers_of_it; i++)
        sv_launch_buffer(&l, buffers_of_it[i]);
    return sv_launch_items(&l, 1, SV_STAGE_RECONSTRUCT);
}

static sv_status band_pass(const sv_map *m, const sv_method_state *s, uint32_t pass) {
    sv_launch l = SV_LAUNCH_JOB(m, band_mean);
    sv_launch_uint(&l, pass);
    sv_launch_buffer(&l, pass % 2 ? s->buffer[SUMS_B] : m->sums);
    sv_launch_buffer(&l, pass % 2 ? m->sums : s->buffer[SUMS_B]);
    sv_launch_buffer(&l, m->surfaces);
    sv_launch_buffer(&l, m->status);
    sv_launch_buffer(&l, s->buffer[SCRATCH]);
    sv_launch_buffer(&l, m->record);
    return sv_launch_items(&l, m->bands, SV_STAGE_RECONSTRUCT);
}

static sv_status rays_pass(const sv_map *m, const sv_method_state *s, uint32_t pass) {
    sv_launch l = SV_LAUNCH_JOB(m, rays_columns);
    sv_launch_uint(&l, pass);
    sv_launch_buffer(&l, m->sums);
    sv_launch_buffer(&l, s->buffer[SUMS_B]);
    sv_launch_buffer(&l, m->record);
    const sv_status status = sv_launch_pixels(&l, m->width, m->height, SV_STAGE_RECONSTRUCT);
    if (status != SV_OK) return status;
    l = SV_LAUNCH_JOB(m, rays_means);
    sv_launch_uint(&l, pass);
    sv_launch_buffer(&l, s->buffer[SUMS_B]);
    sv_launch_buffer(&l, m->sums);
    sv_launch_buffer(&l, m->surfaces);
    sv_launch_buffer(&l, m->status);
    sv_launch_buffer(&l, m->record);
    return sv_launch_pixels(&l, m->width, m->height, SV_STAGE_RECONSTRUCT);
}

/* Converts maps to sums. The sums have no sign, so that of S(q) the first plane takes depths above 0 and the
 * second those below, negated; their difference is the mean of both. */
static sv_status load_points(const sv_map *m, const sv_method_state *s, uint32_t planes) {
    sv_launch l = sv_launch_begin(m->queue, s->kernels.kernel[K_LOAD], "mean_load");
    sv_launch_arg(&l, sizeof m->job, &m->job);
    sv_launch_uint(&l, m->program == m->wide);
    sv_launch_uint(&l, planes);
    sv_launch_buffer(&l, m->points);
    for (int type = 0; type < 2; type++) sv_launch_buffer(&l, m->sums);
    return sv_launch_pixels(&l, m->padded_width, m->height, SV_STAGE_RECONSTRUCT);
}

static sv_status store_surfaces(const sv_map *m, const sv_method_state *s) {
    sv_launch l = sv_launch_begin(m->queue, s->kernels.kernel[K_STORE], "mean_store");
    sv_launch_uint(&l, m->padded_width);
    sv_launch_uint(&l, m->height);
    sv_launch_buffer(&l, m->surfaces);
    return sv_launch_vectors(&l, m->padded_width, m->height, SV_STAGE_RECONSTRUCT);
}

static sv_status run(const sv_map *m, sv_method_state *s, uint32_t planes) {
    const bool rays = m->config->strategy == SV_STRATEGY_RAYS;
    const bool from_maps = m->points != NULL;
    sv_status status = from_maps ? load_points(m, s, planes) : SV_OK;
    for (uint32_t pass = 0; status == SV_OK && pass < m->job.pass_limit; pass++)
        status = rays ? rays_pass(m, s, pass) : band_pass(m, s, pass);
    if (status == SV_OK) status = sv_map_done_passes(m, m->job.pass_limit);
    return status == SV_OK && from_maps && planes == 1 ? store_surfaces(m, s) : status;
}

const sv_method sv_method_mean = {.definition = &sv_ref_method_mean,
                                  .parameters = SV_USES_POINTS | SV_USES(KERNEL) | SV_USES(FILL_WEIGHT),
                                  .linear = true,
                                  .takes_sums = true,
                                  .kernels = kernels,
                                  .source = source,
                                  .buffers = buffers,
                                  .run = run,
                                  .single = single};
