/* SPDX-License-Identifier: MIT */
#include "method/chain.h"

#include "device/queue.h"
#include "kernels_chain.h"
#include "method/method.h"

#include <stdio.h>

enum { K_BEGIN, K_GATHER, K_DONE };
static const char *const kernels[] = {"chain_begin", "chain_gather", "chain_done", NULL};

/* A method that takes the slabs asks for no points, so there is nothing to filter. */
static bool is_filtered(const sv_config *c) {
    return c->prefilter != SV_PREFILTER_NONE && !sv_method_of(c->method)->slabs;
}

bool sv_chain_needs_profile(const sv_config *c) {
    return sv_method_uses(sv_method_of(c->method), SV_PARAM_EVIDENCE);
}

bool sv_chain_needs_wide(const sv_config *c) {
    return sv_chain_needs_profile(c) && sv_map_needs_wide(c);
}

void sv_chain_init(sv_chain *chain, sv_map *map) {
    const sv_config *c = map->config;
    *chain = (sv_chain){.method = sv_method_of(c->method),
                        .needs_profile = sv_chain_needs_profile(c),
                        .filtered = is_filtered(c),
                        .map = map};
    chain->linear = chain->method->linear && !chain->filtered;
    chain->direct = chain->method->takes_sums && !chain->filtered;
}

sv_status sv_chain_buffers(sv_chain *chain) {
    sv_map *map = chain->map;
    sv_status status = SV_OK;
    if (!chain->direct && !chain->method->slabs) status = sv_map_point_buffers(map);
    if (status == SV_OK && chain->filtered) status = sv_method_minimum.buffers(map, &chain->filter);
    return status == SV_OK ? chain->method->buffers(map, &chain->state) : status;
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
    const sv_map *on = chain->map;
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
}

static sv_launch begin(const sv_chain *chain, int kernel) {
    return sv_launch_begin(chain->map->queue, chain->gather.kernel[kernel], kernels[kernel]);
}

/* Forgets the passes of the run before. */
static sv_status forget_passes(sv_chain *chain) {
    sv_launch l = begin(chain, K_BEGIN);
    sv_launch_uint(&l, chain->map->job.pass_limit);
    sv_launch_buffer(&l, chain->map->record);
    return sv_launch_items(&l, 1, SV_STAGE_RECONSTRUCT);
}

/* Fetches the depths of the initial points: both ends, or S(q). */
static sv_status fetch_points(sv_chain *chain, cl_mem state16, float q) {
    const sv_map *map = chain->map;
    sv_launch l = begin(chain, K_GATHER);
    sv_launch_uint(&l, map->padded_width);
    sv_launch_uint(&l, map->height);
    sv_launch_buffer(&l, state16);
    sv_launch_buffer(&l, map->status);
    sv_launch_uint(&l, !chain->linear);
    sv_launch_arg(&l, sizeof q, &q);
    sv_launch_buffer(&l, map->points);
    return sv_launch_vectors(&l, map->padded_width, map->height, SV_STAGE_RECONSTRUCT);
}

/* Notes the passes in the record after the method, if it does not write them itself. */
static sv_status note_passes(sv_chain *chain) {
    if (!chain->method->passes) return SV_OK;
    const sv_map *on = chain->map;
    sv_launch l = begin(chain, K_DONE);
    sv_launch_uint(&l, chain->method->passes(on));
    sv_launch_buffer(&l, on->record);
    return sv_launch_items(&l, 1, SV_STAGE_RECONSTRUCT);
}

sv_status sv_chain_run(sv_chain *chain, cl_mem state16, float q) {
    const sv_map *on = chain->map;
    if (chain->direct) return chain->method->run(on, &chain->state, 2);
    const double *v = on->values.of;
    sv_status status = forget_passes(chain);
    if (status == SV_OK) status = fetch_points(chain, state16, q);
    if (status == SV_OK && chain->filtered)
        status = sv_minimum_prefilter(on, &chain->filter, (uint32_t)v[SV_PARAM_PREFILTER_KERNEL],
                                      (uint32_t)v[SV_PARAM_PREFILTER_PASSES]);
    if (status == SV_OK) status = chain->method->run(on, &chain->state, chain->linear ? 2 : 1);
    return status == SV_OK ? note_passes(chain) : status;
}
