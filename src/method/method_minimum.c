/* SPDX-License-Identifier: MIT */
/* Method minimum: passes of a minimum filter until no pixel is empty; and the same filter, a given number of
 * passes, before another method. */
#include "device/launch.h"
#include "kernels_minimum.h"

enum { K_CLEAR, K_ENTER, K_COLUMNS, K_ROWS, K_LEAVE };
static const char *const kernels[] = {"minimum_clear", "minimum_enter", "minimum_columns",
                                      "minimum_rows",  "minimum_leave", NULL};
enum { MAP_A, MAP_B };
enum { MARGIN = 32 };                          /* SV_MIN_MARGIN of the kernels */
static const uint32_t EVERY_PASS = UINT32_MAX; /* no counting, no early end */

static sv_source source(void) {
    return (sv_source){sv_kernels_minimum, sv_kernels_minimum_size};
}

static uint32_t commands(const sv_config *c) {
    return 2 * (c->width > c->height ? c->width : c->height) + 32;
}

static sv_status create(sv_pipeline *p, sv_method_state *s) {
    sv_status status = SV_OK;
    const size_t bytes = (p->padded_width + (size_t)2 * MARGIN) * p->config.height * sizeof(cl_float);
    s->buffer[MAP_A] = sv_clx_buffer(p->diag, p->device, bytes, NULL, &status);
    s->buffer[MAP_B] = sv_clx_buffer(p->diag, p->device, bytes, NULL, &status);
    if (status != SV_OK) return status;
    sv_launch l = sv_launch_begin(p, s->kernels.kernel[K_CLEAR], "minimum_clear");
    sv_launch_uint(&l, p->padded_width);
    sv_launch_buffer(&l, s->buffer[MAP_A]);
    sv_launch_buffer(&l, s->buffer[MAP_B]);
    return sv_launch_items(&l, p->config.height, SV_STAGE_RECONSTRUCT);
}

static sv_status enter(sv_pipeline *p, sv_method_state *s) {
    sv_launch l = sv_launch_begin(p, s->kernels.kernel[K_ENTER], "minimum_enter");
    sv_launch_uint(&l, p->padded_width);
    sv_launch_buffer(&l, p->chain.maps);
    sv_launch_buffer(&l, s->buffer[MAP_A]);
    return sv_launch_vectors(&l, p->padded_width, p->config.height, SV_STAGE_RECONSTRUCT);
}

static sv_status pass(sv_pipeline *p, sv_method_state *s, uint32_t k, uint32_t number) {
    sv_launch l = sv_launch_begin(p, s->kernels.kernel[K_COLUMNS], "minimum_columns");
    const uint32_t columns[] = {p->padded_width, p->config.height, k, number};
    for (size_t i = 0; i < 4; i++) sv_launch_uint(&l, columns[i]);
    sv_launch_buffer(&l, s->buffer[MAP_A]);
    sv_launch_buffer(&l, s->buffer[MAP_B]);
    sv_launch_buffer(&l, p->buffers.record);
    const sv_status status = sv_launch_vectors(&l, p->padded_width, p->config.height, SV_STAGE_RECONSTRUCT);
    if (status != SV_OK) return status;
    l = sv_launch_begin(p, s->kernels.kernel[K_ROWS], "minimum_rows");
    const uint32_t rows[] = {p->config.width, p->padded_width, k, number};
    for (size_t i = 0; i < 4; i++) sv_launch_uint(&l, rows[i]);
    sv_launch_buffer(&l, s->buffer[MAP_B]);
    sv_launch_buffer(&l, s->buffer[MAP_A]);
    sv_launch_buffer(&l, p->buffers.record);
    return sv_launch_vectors(&l, p->padded_width, p->config.height, SV_STAGE_RECONSTRUCT);
}

static sv_status leave(sv_pipeline *p, sv_method_state *s, bool to_maps) {
    sv_launch l = sv_launch_begin(p, s->kernels.kernel[K_LEAVE], "minimum_leave");
    sv_launch_uint(&l, p->padded_width);
    sv_launch_uint(&l, to_maps);
    sv_launch_buffer(&l, s->buffer[MAP_A]);
    sv_launch_buffer(&l, p->buffers.status);
    sv_launch_buffer(&l, to_maps ? p->chain.maps : p->buffers.surfaces);
    sv_launch_buffer(&l, p->buffers.record);
    return sv_launch_vectors(&l, p->padded_width, p->config.height, SV_STAGE_RECONSTRUCT);
}

sv_status sv_minimum_prefilter(sv_pipeline *p, sv_method_state *s, uint32_t k, uint32_t passes) {
    sv_status status = enter(p, s);
    for (uint32_t n = 0; status == SV_OK && n < passes; n++) status = pass(p, s, k, EVERY_PASS);
    return status == SV_OK ? leave(p, s, true) : status;
}

static sv_status run(sv_pipeline *p, sv_method_state *s, uint32_t planes) {
    (void)planes; /* never linear: one plane */
    sv_status status = enter(p, s);
    for (uint32_t n = 0; status == SV_OK && n < p->job.pass_limit; n++) status = pass(p, s, p->job.k, n);
    if (status == SV_OK) status = leave(p, s, false);
    return status == SV_OK ? sv_chain_done_passes(p) : status;
}

const sv_method sv_method_minimum = {.linear = false,
                                     .kernels = kernels,
                                     .source = source,
                                     .commands = commands,
                                     .create = create,
                                     .run = run};
