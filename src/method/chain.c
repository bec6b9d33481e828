/* SPDX-License-Identifier: MIT */
#include "method/chain.h"

#include "device/queue.h"
#include "kernels_chain.h"
#include "method/method.h"

#include <stdio.h>

enum { K_BEGIN, K_GATHER, K_CELLS, K_SPREAD, K_DONE };
static const char *const kernels[] = {"chain_begin",  "chain_gather", "chain_cells",
                                      "chain_spread", "chain_done",   NULL};

/* A method that takes the slabs asks for no points, so there is nothing to filter, and works on cells
 * of its own. */
static bool is_filtered(const sv_config *c) {
    return c->prefilter != SV_PREFILTER_NONE && !sv_method_of(c->method)->slabs;
}

static bool is_reduced(const sv_config *c) {
    return c->reduction > 1 && !sv_method_of(c->method)->slabs;
}

bool sv_chain_is_surveyed(const sv_config *c) {
    return sv_method_uses(sv_method_of(c->method), SV_PARAM_EVIDENCE);
}

bool sv_chain_needs_wide(const sv_config *c) {
    return sv_chain_is_surveyed(c) && sv_map_needs_wide(c);
}

void sv_chain_init(sv_chain *chain, sv_map *frame) {
    const sv_config *c = frame->config;
    *chain = (sv_chain){.method = sv_method_of(c->method),
                        .surveyed = sv_chain_is_surveyed(c),
                        .filtered = is_filtered(c),
                        .reduced = is_reduced(c),
                        .frame = frame};
    chain->linear = chain->method->linear && !chain->filtered;
    chain->direct = chain->method->takes_sums && !chain->filtered && !chain->reduced;
    if (!chain->reduced) return;
    sv_map_init(&chain->cells, frame->queue, c, c->reduction, frame->sum_bytes == sizeof(cl_ulong));
    chain->cells.narrow = frame->narrow;
    chain->cells.wide = frame->wide;
}

sv_map *sv_chain_map(sv_chain *chain) {
    return chain->reduced ? &chain->cells : chain->frame;
}

sv_status sv_chain_buffers(sv_chain *chain) {
    sv_map *on = sv_chain_map(chain);
    sv_status status =
        chain->reduced ? sv_map_buffers(on, chain->method->takes_sums, chain->frame->record) : SV_OK;
    if (status == SV_OK && !chain->direct && !chain->method->slabs) status = sv_map_point_buffers(on);
    if (status == SV_OK && chain->filtered) status = sv_method_minimum.buffers(on, &chain->filter);
    return status == SV_OK ? chain->method->buffers(on, &chain->state) : status;
}

/* Builds the kernels of a method and lets it enqueue what it needs once. */
static sv_status build_method(const sv_map *map, const sv_method *method, sv_method_state *state) {
    char options[64];
    (void)snprintf(options, sizeof options, "-DSV_DOUBLES=%d", map->doubles);
    const bool rays = method->ray_source && map->config->strategy == SV_STRATEGY_RAYS;
    const sv_source source = rays ? method->ray_source() : method->source();
    const char *const *const names = rays ? method->ray_kernels : method->kernels;
    const sv_status status = sv_kernel_set_build(map->queue->diag, map->queue->device, source.text,
                                                 source.size, names, options, &state->kernels);
    return status == SV_OK && method->prepare ? method->prepare(map, state) : status;
}

sv_status sv_chain_build(sv_chain *chain) {
    if (chain->direct) return SV_OK;
    const sv_map *on = sv_chain_map(chain);
    char options[64];
    if (chain->method->slabs) return build_method(on, chain->method, &chain->state);
    (void)snprintf(options, sizeof options, "-DSV_SUBSTEPS=%u", on->config->substeps);
    sv_status status = sv_kernel_set_build(on->queue->diag, on->queue->device, sv_kernels_chain,
                                           sv_kernels_chain_size, kernels, options, &chain->gather);
    if (status == SV_OK && chain->filtered) status = build_method(on, &sv_method_minimum, &chain->filter);
    return status == SV_OK ? build_method(on, chain->method, &chain->state) : status;
}

static void release_state(sv_method_state *state) {
    sv_kernel_set_release(&state->kernels);
    for (uint32_t i = 0; i < SV_MAX_METHOD_BUFFERS; i++) sv_buffer_release(&state->buffer[i]);
}

void sv_chain_destroy(sv_chain *chain) {
    release_state(&chain->state);
    release_state(&chain->filter);
    sv_kernel_set_release(&chain->gather);
    sv_map_release(&chain->cells);
}

void sv_chain_begin(sv_chain *chain) {
    if (chain->reduced) sv_map_begin_reduced(&chain->cells, chain->frame);
}

static sv_launch begin(const sv_chain *chain, int kernel) {
    return sv_launch_begin(chain->frame->queue, chain->gather.kernel[kernel], kernels[kernel]);
}

/* Forgets the passes of the run before. */
static sv_status forget_passes(sv_chain *chain) {
    sv_launch l = begin(chain, K_BEGIN);
    sv_launch_uint(&l, sv_chain_map(chain)->job.pass_limit);
    sv_launch_buffer(&l, chain->frame->record);
    return sv_launch_items(&l, 1, SV_STAGE_RECONSTRUCT);
}

/* True if a cell stands for the minimum depth of its points: the minimum filter takes minima of minima. */
static bool takes_minimum(const sv_chain *chain) {
    const bool filters = chain->filtered && chain->frame->values.of[SV_PARAM_PREFILTER_PASSES] > 0.0;
    return filters || chain->method->definition->minimum;
}

/* Fetches the depths of the initial points: both ends, or S(q). */
static sv_status fetch_points(sv_chain *chain, cl_mem state16, float q) {
    const sv_map *frame = chain->frame, *on = sv_chain_map(chain);
    sv_launch l = begin(chain, chain->reduced ? K_CELLS : K_GATHER);
    if (chain->reduced) sv_launch_uint(&l, frame->width);
    sv_launch_uint(&l, frame->padded_width);
    sv_launch_uint(&l, frame->height);
    sv_launch_buffer(&l, state16);
    sv_launch_buffer(&l, frame->status);
    sv_launch_uint(&l, !chain->linear);
    sv_launch_arg(&l, sizeof q, &q);
    if (!chain->reduced) {
        sv_launch_buffer(&l, on->points);
        return sv_launch_vectors(&l, on->padded_width, on->height, SV_STAGE_RECONSTRUCT);
    }
    sv_launch_uint(&l, takes_minimum(chain));
    sv_launch_uint(&l, on->spacing);
    sv_launch_uint(&l, on->padded_width);
    sv_launch_uint(&l, on->height);
    sv_launch_buffer(&l, on->points);
    sv_launch_buffer(&l, on->status);
    return sv_launch_pixels(&l, on->padded_width, on->height, SV_STAGE_RECONSTRUCT);
}

/* Notes the passes in the record after the method, if it does not write them itself. */
static sv_status note_passes(sv_chain *chain) {
    if (!chain->method->passes) return SV_OK;
    const sv_map *on = sv_chain_map(chain);
    sv_launch l = begin(chain, K_DONE);
    sv_launch_uint(&l, chain->method->passes(on));
    sv_launch_buffer(&l, on->record);
    return sv_launch_items(&l, 1, SV_STAGE_RECONSTRUCT);
}

/* Interpolates the surfaces of cells at the pixels. */
static sv_status spread(sv_chain *chain) {
    const sv_map *frame = chain->frame, *on = &chain->cells;
    sv_launch l = begin(chain, K_SPREAD);
    const uint32_t sizes[] = {frame->width, frame->padded_width, frame->height, on->spacing,
                              on->width,    on->padded_width,    on->height,    chain->linear ? 2 : 1};
    for (size_t i = 0; i < sizeof sizes / sizeof *sizes; i++) sv_launch_uint(&l, sizes[i]);
    sv_launch_buffer(&l, on->surfaces);
    sv_launch_buffer(&l, frame->surfaces);
    sv_launch_buffer(&l, on->record);
    return sv_launch_pixels(&l, on->width, on->height, SV_STAGE_RECONSTRUCT);
}

sv_status sv_chain_run(sv_chain *chain, cl_mem state16, float q) {
    const sv_map *on = sv_chain_map(chain);
    if (chain->direct) return chain->method->run(on, &chain->state, 2);
    const double *v = on->values.of;
    sv_status status = forget_passes(chain);
    if (status == SV_OK) status = fetch_points(chain, state16, q);
    if (status == SV_OK && chain->filtered)
        status = sv_minimum_prefilter(on, &chain->filter, (uint32_t)v[SV_PARAM_PREFILTER_KERNEL],
                                      (uint32_t)v[SV_PARAM_PREFILTER_PASSES]);
    if (status == SV_OK) status = chain->method->run(on, &chain->state, chain->linear ? 2 : 1);
    if (status == SV_OK) status = note_passes(chain);
    return status == SV_OK && chain->reduced ? spread(chain) : status;
}
