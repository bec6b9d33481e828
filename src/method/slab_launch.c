/* SPDX-License-Identifier: MIT */
#include "method/method.h"

sv_status sv_slabs_one_by_one(const sv_map *m, sv_method_state *s, const sv_placed_slabs *slabs,
                              sv_take_slab *take) {
    const sv_batch *b = &slabs->batch;
    sv_placed_slab next = {.buffer = slabs->buffer, .first_slice = b->first_slice};
    sv_status status = SV_OK;
    for (uint32_t i = 0; status == SV_OK && i < b->count; i++) {
        next.offset = b->offset[i];
        next.slice_count = b->slices[i];
        status = take(m, s, &next);
        next.first_slice += next.slice_count;
    }
    return status;
}

static void texture_args(sv_launch *l, const sv_map *m) {
    const sv_config *c = m->config;
    const uint32_t numbers[] = {c->row_pitch, c->tiles_x, c->tile_w, c->tile_h};
    for (size_t i = 0; i < sizeof numbers / sizeof *numbers; i++) sv_launch_uint(l, numbers[i]);
}

static void scanned_args(sv_launch *l, const sv_map *m, cl_mem unread) {
    const sv_config *c = m->config;
    sv_launch_uint(l, c->padding);
    sv_launch_uint(l, c->ranged);
    sv_launch_uint(l, m->padded_width);
    sv_launch_buffer(l, c->ranged ? m->scanned : unread);
}

sv_launch sv_slab_launch(const sv_map *m, cl_kernel kernel, const char *name, const sv_placed_slab *slab,
                         cl_mem unread) {
    const cl_ulong first_byte = slab->offset;
    sv_launch l = sv_launch_begin(m->queue, kernel, name);
    sv_launch_buffer(&l, slab->buffer);
    sv_launch_arg(&l, sizeof first_byte, &first_byte);
    texture_args(&l, m);
    sv_launch_uint(&l, slab->first_slice);
    sv_launch_uint(&l, slab->slice_count);
    scanned_args(&l, m, unread);
    return l;
}

sv_launch sv_slabs_launch(const sv_map *m, cl_kernel kernel, const char *name, const sv_placed_slabs *slabs,
                          cl_mem unread) {
    sv_launch l = sv_launch_begin(m->queue, kernel, name);
    sv_launch_buffer(&l, slabs->buffer);
    sv_launch_arg(&l, sizeof slabs->batch, &slabs->batch);
    texture_args(&l, m);
    scanned_args(&l, m, unread);
    return l;
}
