/* SPDX-License-Identifier: MIT */
/* Method pushpull: a pyramid of weighted means; cost grows with the pixels, whatever the points. */
#include "method/method.h"

#include "device/queue.h"
#include "kernels_pushpull.h"
#include "ref/ref_pushpull.h"

enum { K_ENTER, K_PULL, K_PUSH, K_LEAVE };
static const char *const kernels[] = {"pushpull_enter", "pushpull_pull", "pushpull_push", "pushpull_leave",
                                      NULL};
enum { VALUES }; /* near, far, weight */

static sv_source source(void) {
    return (sv_source){sv_kernels_pushpull, sv_kernels_pushpull_size};
}

static uint32_t commands(const sv_config *c) {
    (void)c;
    return 2 * SV_MAX_LEVELS + 2;
}

static sv_status buffers(const sv_map *m, sv_method_state *s) {
    sv_status status = SV_OK;
    s->levels = sv_levels_make(m->width, m->height);
    s->buffer[VALUES] = sv_buffer_make(m->queue, 3 * (size_t)s->levels.pixels * sizeof(cl_float), &status);
    return status;
}

/* A level as the kernels see it. */
static void level_arg(sv_launch *l, const sv_levels *levels, uint32_t n) {
    const cl_uint level[4] = {levels->width[n], levels->height[n], levels->offset[n], levels->pixels};
    sv_launch_arg(l, sizeof level, level);
}

static sv_status between(const sv_map *m, sv_method_state *s, uint32_t planes, uint32_t fine, bool pull) {
    const uint32_t target = pull ? fine + 1 : fine;
    sv_launch l = sv_launch_begin(m->queue, s->kernels.kernel[pull ? K_PULL : K_PUSH],
                                  pull ? "pushpull_pull" : "pushpull_push");
    level_arg(&l, &s->levels, fine);
    level_arg(&l, &s->levels, fine + 1);
    sv_launch_uint(&l, planes);
    sv_launch_buffer(&l, s->buffer[VALUES]);
    sv_launch_buffer(&l, m->record);
    return sv_launch_pixels(&l, s->levels.width[target], s->levels.height[target], SV_STAGE_RECONSTRUCT);
}

static sv_status enter(const sv_map *m, sv_method_state *s) {
    sv_launch l = sv_launch_begin(m->queue, s->kernels.kernel[K_ENTER], "pushpull_enter");
    const uint32_t sizes[] = {m->width, m->padded_width, m->height, s->levels.pixels};
    for (size_t i = 0; i < 4; i++) sv_launch_uint(&l, sizes[i]);
    sv_launch_buffer(&l, m->points);
    sv_launch_buffer(&l, s->buffer[VALUES]);
    sv_launch_buffer(&l, m->record);
    return sv_launch_pixels(&l, m->width, m->height, SV_STAGE_RECONSTRUCT);
}

static sv_status leave(const sv_map *m, sv_method_state *s, uint32_t planes) {
    sv_launch l = sv_launch_begin(m->queue, s->kernels.kernel[K_LEAVE], "pushpull_leave");
    const uint32_t sizes[] = {m->width, m->padded_width, m->height, s->levels.pixels, planes};
    for (size_t i = 0; i < 5; i++) sv_launch_uint(&l, sizes[i]);
    sv_launch_buffer(&l, s->buffer[VALUES]);
    sv_launch_buffer(&l, m->surfaces);
    sv_launch_buffer(&l, m->record);
    return sv_launch_pixels(&l, m->width, m->height, SV_STAGE_RECONSTRUCT);
}

static sv_status run(const sv_map *m, sv_method_state *s, uint32_t planes) {
    sv_status status = enter(m, s);
    for (uint32_t n = 0; status == SV_OK && n + 1 < s->levels.count; n++)
        status = between(m, s, planes, n, true);
    for (uint32_t n = s->levels.count - 1; status == SV_OK && n-- > 0;)
        status = between(m, s, planes, n, false);
    return status == SV_OK ? leave(m, s, planes) : status;
}

static uint32_t passes(const sv_map *m) {
    (void)m;
    return 1;
}

/* Float32: a few roundings a level, which the next level halves (docs/numerics.md). */
static double bound(const sv_map *m) {
    return m->doubles ? 1e-3 : 1e-2;
}

const sv_method sv_method_pushpull = {.definition = &sv_ref_method_pushpull,
                                      .bound = bound,
                                      .parameters = SV_USES_POINTS,
                                      .linear = true,
                                      .kernels = kernels,
                                      .source = source,
                                      .commands = commands,
                                      .buffers = buffers,
                                      .run = run,
                                      .passes = passes};
