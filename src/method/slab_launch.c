/* SPDX-License-Identifier: MIT */
#include "method/method.h"

sv_launch sv_slab_launch(const sv_map *m, cl_kernel kernel, const char *name, const sv_placed_slab *slab,
                         cl_mem unread) {
    const sv_config *c = m->config;
    const cl_ulong first_byte = slab->offset;
    const uint32_t padding = c->padding == SV_NO_PADDING ? 256 : (uint32_t)c->padding;
    const uint32_t numbers[] = {c->row_pitch,      c->tiles_x, c->tile_w, c->tile_h,      slab->first_slice,
                                slab->slice_count, padding,    c->ranged, m->padded_width};
    sv_launch l = sv_launch_begin(m->queue, kernel, name);
    sv_launch_buffer(&l, slab->buffer);
    sv_launch_arg(&l, sizeof first_byte, &first_byte);
    for (size_t i = 0; i < sizeof numbers / sizeof *numbers; i++) sv_launch_uint(&l, numbers[i]);
    sv_launch_buffer(&l, c->ranged ? m->scanned : unread);
    return l;
}
