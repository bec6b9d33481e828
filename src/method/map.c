/* SPDX-License-Identifier: MIT */
#include "method/method.h"

#include "device/queue.h"
#include "mean/mean_shared.h"
#include "quantise.h"

enum { BAND_MIN_ROWS = 32, BANDS_PER_UNIT = 2 };

bool sv_map_needs_wide(const sv_config *c) {
    for (uint32_t k = 3; k <= SV_MAX_K; k += 2)
        if (sv_fixed_format(c->width, c->height, c->slices, k, 4).wide) return true;
    return false;
}

static uint32_t band_count(const sv_device *device, uint32_t strategy, uint32_t height) {
    if (strategy != SV_STRATEGY_BANDS) return 1;
    const uint32_t wanted = device->compute_units * BANDS_PER_UNIT;
    const uint32_t maximum = (height + BAND_MIN_ROWS - 1) / BAND_MIN_ROWS;
    return wanted < maximum ? wanted : maximum;
}

void sv_map_init(sv_map *m, const sv_queue *queue, const sv_config *c, bool wide_sums) {
    *m = (sv_map){.queue = queue, .config = c, .width = c->width, .height = c->height};
    m->padded_width = (m->width + SV_LANES - 1) / SV_LANES * SV_LANES;
    m->bands = band_count(queue->device, c->strategy, m->height);
    m->sum_bytes = wide_sums ? sizeof(cl_ulong) : sizeof(cl_uint);
    m->doubles = queue->device->has_doubles && !c->float32;
}

static size_t plane_of(const sv_map *m) {
    return (size_t)m->padded_width * m->height;
}

sv_status sv_map_status_buffer(sv_map *m, cl_mem record) {
    sv_status status = SV_OK;
    m->record = record;
    m->status = sv_buffer_make(m->queue, plane_of(m), &status);
    return status;
}

sv_status sv_map_buffers(sv_map *m, cl_mem record) {
    sv_status status = sv_map_status_buffer(m, record);
    m->sums = sv_buffer_make(m->queue, SV_SUM_PLANES * plane_of(m) * m->sum_bytes, &status);
    m->surfaces = sv_buffer_make(m->queue, 2 * plane_of(m) * sizeof(cl_float), &status);
    return status;
}

sv_status sv_map_point_buffers(sv_map *m) {
    sv_status status = SV_OK;
    m->points = sv_buffer_make(m->queue, 2 * plane_of(m) * sizeof(cl_float), &status);
    return status;
}

void sv_map_release(sv_map *m) {
    cl_mem *const own[] = {&m->status, &m->points, &m->sums, &m->surfaces};
    for (size_t i = 0; i < sizeof own / sizeof *own; i++) sv_buffer_release(own[i]);
    m->record = NULL;
}

void sv_map_begin(sv_map *m, const sv_job *job, const sv_values *values) {
    sv_job *j = &m->job;
    *j = *job;
    m->values = *values;
    j->width = m->width;
    j->padded_width = m->padded_width;
    j->height = m->height;
    j->pass_limit = sv_pass_limit(m->width, m->height, j->k);
    const sv_fixed format = sv_fixed_format(m->width, m->height, m->config->slices, j->k, j->weight_initial);
    j->fraction = format.fraction;
    m->program = format.wide && m->wide ? m->wide : m->narrow;
}

sv_status sv_map_done_passes(const sv_map *m, uint32_t passes) {
    sv_launch l = SV_LAUNCH(m, band_record);
    sv_launch_uint(&l, passes);
    sv_launch_buffer(&l, m->record);
    return sv_launch_items(&l, 1, SV_STAGE_RECONSTRUCT);
}
