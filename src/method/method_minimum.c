/* SPDX-License-Identifier: MIT */
/* Method minimum: passes of a minimum filter until no pixel is empty; and the same filter, a given number of
 * passes, before another method. */
#include "method/method.h"

#include "device/queue.h"
#include "kernels_minimum.h"
#include "minimum/minimum_shared.h"

enum { K_CLEAR, K_LOAD, K_COLUMNS, K_ROWS, K_STORE };
static const char *const kernels[] = {"minimum_clear", "minimum_load",  "minimum_columns",
                                      "minimum_rows",  "minimum_store", NULL};
enum { MAP_A, MAP_B };
static const uint32_t EVERY_PASS = UINT32_MAX; /* passes are not counted, and none is skipped */

static sv_source source(void) {
    return (sv_source){sv_kernels_minimum, sv_kernels_minimum_size};
}

static sv_status buffers(const sv_map *m, sv_method_state *s) {
    sv_status status = SV_OK;
    const size_t bytes = (m->padded_width + (size_t)2 * SV_MIN_MARGIN) * m->height * sizeof(cl_float);
    s->buffer[MAP_A] = sv_buffer_make(m->queue, bytes, &status);
    s->buffer[MAP_B] = sv_buffer_make(m->queue, bytes, &status);
    return status;
}

/* The margins stay empty from here on. */
static sv_status prepare(const sv_map *m, sv_method_state *s) {
    sv_launch l = sv_launch_begin(m->queue, s->kernels.kernel[K_CLEAR], "minimum_clear");
    sv_launch_uint(&l, m->padded_width);
    sv_launch_buffer(&l, s->buffer[MAP_A]);
    sv_launch_buffer(&l, s->buffer[MAP_B]);
    return sv_launch_items(&l, m->height, SV_STAGE_RECONSTRUCT);
}

static sv_status load_points(const sv_map *m, sv_method_state *s) {
    sv_launch l = sv_launch_begin(m->queue, s->kernels.kernel[K_LOAD], "minimum_load");
    sv_launch_uint(&l, m->padded_width);
    sv_launch_buffer(&l, m->points);
    sv_launch_buffer(&l, s->buffer[MAP_A]);
    return sv_launch_vectors(&l, m->padded_width, m->height, SV_STAGE_RECONSTRUCT);
}

static sv_status pass(const sv_map *m, sv_method_state *s, uint32_t k, uint32_t number) {
    sv_launch l = sv_launch_begin(m->queue, s->kernels.kernel[K_COLUMNS], "minimum_columns");
    const uint32_t columns[] = {m->padded_width, m->height, k, number};
    for (size_t i = 0; i < 4; i++) sv_launch_uint(&l, columns[i]);
    sv_launch_buffer(&l, s->buffer[MAP_A]);
    sv_launch_buffer(&l, s->buffer[MAP_B]);
    sv_launch_buffer(&l, m->record);
    const sv_status status = sv_launch_vectors(&l, m->padded_width, m->height, SV_STAGE_RECONSTRUCT);
    if (status != SV_OK) return status;
    l = sv_launch_begin(m->queue, s->kernels.kernel[K_ROWS], "minimum_rows");
    const uint32_t rows[] = {m->width, m->padded_width, k, number};
    for (size_t i = 0; i < 4; i++) sv_launch_uint(&l, rows[i]);
    sv_launch_buffer(&l, s->buffer[MAP_B]);
    sv_launch_buffer(&l, s->buffer[MAP_A]);
    sv_launch_buffer(&l, m->record);
    return sv_launch_vectors(&l, m->padded_width, m->height, SV_STAGE_RECONSTRUCT);
}

static sv_status store_surfaces(const sv_map *m, sv_method_state *s, bool to_maps) {
    sv_launch l = sv_launch_begin(m->queue, s->kernels.kernel[K_STORE], "minimum_store");
    sv_launch_uint(&l, m->padded_width);
    sv_launch_uint(&l, to_maps);
    sv_launch_buffer(&l, s->buffer[MAP_A]);
    sv_launch_buffer(&l, m->status);
    sv_launch_buffer(&l, to_maps ? m->points : m->surfaces);
    sv_launch_buffer(&l, m->record);
    return sv_launch_vectors(&l, m->padded_width, m->height, SV_STAGE_RECONSTRUCT);
}

sv_status sv_minimum_prefilter(const sv_map *m, sv_method_state *s, uint32_t k, uint32_t passes) {
    sv_status status = load_points(m, s);
    for (uint32_t n = 0; status == SV_OK && n < passes; n++) status = pass(m, s, k, EVERY_PASS);
    return status == SV_OK ? store_surfaces(m, s, true) : status;
}

static sv_status run(const sv_map *m, sv_method_state *s, uint32_t planes) {
    (void)planes; /* one plane, for the method is never linear */
    sv_status status = load_points(m, s);
    const uint32_t wanted = (uint32_t)m->values.of[SV_PARAM_PASSES];
    const uint32_t passes = wanted > 0 && wanted < m->job.pass_limit ? wanted : m->job.pass_limit;
    for (uint32_t n = 0; status == SV_OK && n < passes; n++) status = pass(m, s, m->job.k, n);
    if (status == SV_OK) status = store_surfaces(m, s, false);
    return status == SV_OK ? sv_map_done_passes(m, passes) : status;
}

const sv_method sv_method_minimum = {.definition = &sv_ref_method_minimum,
                                     .parameters = SV_USES_POINTS | SV_USES(KERNEL) | SV_USES(PASSES),
                                     .linear = false,
                                     .kernels = kernels,
                                     .source = source,
                                     .buffers = buffers,
                                     .prepare = prepare,
                                     .run = run};
