/* SPDX-License-Identifier: MIT */
/* Method pushpull: a pyramid of weighted means; cost grows with the pixels, whatever the points. */
#include "device/launch.h"
#include "kernels_pushpull.h"

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

static sv_status create(sv_pipeline *p, sv_method_state *s) {
    sv_status status = SV_OK;
    s->levels = sv_levels_make(p->config.width, p->config.height);
    s->buffer[VALUES] =
        sv_clx_buffer(p->diag, p->device, 3 * (size_t)s->levels.pixels * sizeof(cl_float), NULL, &status);
    return status;
}

/* A level as the kernels see it. */
static void level_arg(sv_launch *l, const sv_levels *levels, uint32_t n) {
    const cl_uint level[4] = {levels->width[n], levels->height[n], levels->offset[n], levels->pixels};
    sv_launch_arg(l, sizeof level, level);
}

static sv_status between(sv_pipeline *p, sv_method_state *s, uint32_t planes, uint32_t fine, bool pull) {
    const uint32_t target = pull ? fine + 1 : fine;
    sv_launch l = sv_launch_begin(p, s->kernels.kernel[pull ? K_PULL : K_PUSH],
                                  pull ? "pushpull_pull" : "pushpull_push");
    level_arg(&l, &s->levels, fine);
    level_arg(&l, &s->levels, fine + 1);
    sv_launch_uint(&l, planes);
    sv_launch_buffer(&l, s->buffer[VALUES]);
    sv_launch_buffer(&l, p->buffers.record);
    return sv_launch_pixels(&l, s->levels.width[target], s->levels.height[target], SV_STAGE_RECONSTRUCT);
}

static sv_status enter(sv_pipeline *p, sv_method_state *s) {
    sv_launch l = sv_launch_begin(p, s->kernels.kernel[K_ENTER], "pushpull_enter");
    const uint32_t sizes[] = {p->config.width, p->padded_width, p->config.height, s->levels.pixels};
    for (size_t i = 0; i < 4; i++) sv_launch_uint(&l, sizes[i]);
    sv_launch_buffer(&l, p->chain.maps);
    sv_launch_buffer(&l, s->buffer[VALUES]);
    sv_launch_buffer(&l, p->buffers.record);
    return sv_launch_pixels(&l, p->config.width, p->config.height, SV_STAGE_RECONSTRUCT);
}

static sv_status leave(sv_pipeline *p, sv_method_state *s, uint32_t planes) {
    sv_launch l = sv_launch_begin(p, s->kernels.kernel[K_LEAVE], "pushpull_leave");
    const uint32_t sizes[] = {p->config.width, p->padded_width, p->config.height, s->levels.pixels, planes};
    for (size_t i = 0; i < 5; i++) sv_launch_uint(&l, sizes[i]);
    sv_launch_buffer(&l, s->buffer[VALUES]);
    sv_launch_buffer(&l, p->buffers.surfaces);
    sv_launch_buffer(&l, p->buffers.record);
    return sv_launch_pixels(&l, p->config.width, p->config.height, SV_STAGE_RECONSTRUCT);
}

static sv_status run(sv_pipeline *p, sv_method_state *s, uint32_t planes) {
    sv_status status = enter(p, s);
    for (uint32_t n = 0; status == SV_OK && n + 1 < s->levels.count; n++)
        status = between(p, s, planes, n, true);
    for (uint32_t n = s->levels.count - 1; status == SV_OK && n-- > 0;)
        status = between(p, s, planes, n, false);
    if (status == SV_OK) status = leave(p, s, planes);
    return status == SV_OK ? sv_chain_done(p, 1) : status;
}

const sv_method sv_method_pushpull = {
    .linear = true, .kernels = kernels, .source = source, .commands = commands, .create = create, .run = run};
