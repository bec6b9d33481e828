/* SPDX-License-Identifier: MIT */
#include "method/method_wall.h"

sv_wall_own *sv_wall_own_of(sv_method_state *s) {
    _Static_assert(sizeof(sv_wall_own) <= sizeof s->own, "the method's own has room in the state");
    return (sv_wall_own *)(void *)s->own.bytes;
}

bool sv_wall_is_bounded(const sv_config *c) {
    return c->ranged || sv_is_padded(c);
}

size_t sv_wall_lanes_of(uint32_t values) {
    return ((size_t)values + SV_WALL_LANES - 1) / SV_WALL_LANES * SV_WALL_LANES;
}

/* Groups of SV_WALL_LAYERS layers. */
static size_t layer_groups_of(const sv_wall_layout *l) {
    return ((size_t)l->layers + SV_WALL_LAYERS - 1) / SV_WALL_LAYERS;
}

size_t sv_wall_flags_bytes(const sv_wall_layout *l) {
    return sv_wall_lanes_of(l->cells[0]) * l->cells[1] * layer_groups_of(l) * SV_WALL_LAYERS;
}

static sv_status launch_over(sv_launch *l, sv_wall_over over, const sv_wall_layout *layout, sv_stage stage) {
    switch (over) {
    case SV_WALL_ONCE:
        return sv_launch_items(l, 1, stage);
    case SV_WALL_ROWS:
        return sv_launch_items(l, layout->rows, stage);
    case SV_WALL_ALL_LAYERS:
        return sv_launch_items(l, layout->layers, stage);
    case SV_WALL_CELL_ROWS:
        return sv_launch_items(l, layout->cells[1], stage);
    case SV_WALL_PIXEL_ROWS:
        return sv_launch_items(l, layout->height, stage);
    case SV_WALL_WORDS:
        return sv_launch_items(l, sv_wall_lanes_of(layout->cells[0]) / 8 * layer_groups_of(layout), stage);
    case SV_WALL_ONE_GROUP:
        return sv_launch_groups(l, 1, stage);
    case SV_WALL_GROUPS:
        return sv_launch_groups(l, layout->cells[1], stage);
    case SV_WALL_EACH_LAYER:
        return sv_launch_groups(l, layout->layers, stage);
    case SV_WALL_EACH_RAY:
        return sv_launch_pixels(l, layout->columns, layout->rows, stage);
    case SV_WALL_EACH_CELL:
        return sv_launch_pixels(l, layout->cells[0], layout->cells[1] * layout->layers, stage);
    case SV_WALL_EACH_PIXEL:
        break;
    }
    return sv_launch_pixels(l, layout->width, layout->height, stage);
}

/* The tables serve all grids, and what the beams say is one buffer. */
static cl_mem buffer_of(const sv_method_state *s, int buffer, bool beams) {
    const bool one = buffer == SV_WALL_TABLES || buffer >= SV_WALL_BEAMS;
    return s->buffer[beams && !one ? SV_WALL_BEAMS + buffer : buffer];
}

sv_status sv_wall_launch_all(const sv_map *m, sv_method_state *s, const sv_wall_work *work, uint32_t first,
                             uint32_t end, bool beams, const sv_depth_target *to) {
    sv_wall_own *const own = sv_wall_own_of(s);
    const sv_wall_layout *layout = beams ? &own->beams : &own->camera;
    const bool smoothed = layout->smoothed != 0;
    sv_status status = SV_OK;
    for (uint32_t i = first; status == SV_OK && i < end; i++) {
        const sv_wall_launch *w = &work->launches[i];
        if (w->when == SV_WALL_IF_SMOOTHED && !smoothed) continue;
        if (w->when == SV_WALL_UNLESS_TOLD && layout->told) continue;
        if (w->when == SV_WALL_FOR_BEAMS && !beams) continue;
        sv_launch l = sv_launch_begin(m->queue, s->kernels.kernel[w->kernel], work->kernels[w->kernel]);
        sv_launch_arg(&l, sizeof *layout, layout);
        if (w->takes & SV_WALL_BOUNDS) sv_launch_uint(&l, sv_wall_is_bounded(m->config));
        if (w->takes & SV_WALL_BOUNDS) sv_launch_uint(&l, m->padded_width);
        if (w->takes & SV_WALL_SCRATCH_WORDS) sv_launch_uint(&l, beams ? own->beam_words : own->camera_words);
        for (const int *b = w->buffers; *b >= 0; b++)
            sv_launch_buffer(&l,
                             buffer_of(s, smoothed || *b != SV_WALL_SMOOTHED ? *b : SV_WALL_LEVELS, beams));
        if (w->takes & SV_WALL_RECORD) sv_launch_buffer(&l, m->record);
        if (w->takes & SV_WALL_DEPTH) sv_launch_arg(&l, sizeof to->first, &to->first);
        if (w->takes & SV_WALL_DEPTH) sv_launch_buffer(&l, to->buffer);
        status = launch_over(&l, w->over, layout,
                             i < work->reconstructs ? SV_STAGE_THRESHOLD : SV_STAGE_RECONSTRUCT);
    }
    return status;
}
