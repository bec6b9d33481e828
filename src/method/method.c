/* SPDX-License-Identifier: MIT */
/* The chain from the initial points to the surfaces, and the table of methods. */
#include "method/method.h"

#include "device/launch.h"
#include "kernels_chain.h"

#include <stdio.h>

#define SV_METHOD_ENTRY(NAME, value, key) [SV_METHOD_##NAME] = &sv_method_##key,
static const sv_method *const methods[SV_METHOD_COUNT] = {SV_METHODS(SV_METHOD_ENTRY)};
#undef SV_METHOD_ENTRY

enum { K_BEGIN, K_GATHER, K_CELLS, K_SPREAD, K_DONE };
static const char *const kernels[] = {"chain_begin",  "chain_gather", "chain_cells",
                                      "chain_spread", "chain_done",   NULL};

/* Builds the kernels of a method and lets it make its buffers. */
static sv_status create_method(sv_pipeline *p, const sv_method *method, sv_method_state *state) {
    char options[64];
    (void)snprintf(options, sizeof options, "-DSV_DOUBLES=%d", p->chain.doubles);
    const sv_source source = method->source();
    sv_status status = method->kernels ? sv_kernel_set_build(p->diag, p->device, source.text, source.size,
                                                             method->kernels, options, &state->kernels)
                                       : SV_OK;
    return status == SV_OK ? method->create(p, state) : status;
}

/* A method that takes the slabs asks for no points, so there is nothing to filter. */
static bool is_filtered(const sv_config *c) {
    return c->prefilter != SV_PREFILTER_NONE && !methods[c->method]->slab;
}

static bool is_reduced(const sv_config *c) {
    return c->reduction > 1 && !methods[c->method]->slab;
}

sv_pipeline *sv_chain_map(sv_pipeline *p) {
    return p->reduced ? p->reduced : p;
}

uint32_t sv_chain_commands(const sv_config *c) {
    const bool filtered = is_filtered(c);
    return methods[c->method]->commands(c) + (filtered ? sv_method_minimum.commands(c) : 0) + 5;
}

/* The maps of the points; each point stands for one until chain_cells counts them. */
static sv_status create_maps(sv_pipeline *p) {
    const size_t plane = (size_t)p->padded_width * p->config.height * sizeof(cl_float);
    const cl_float one = 1.0f;
    sv_status status = SV_OK;
    p->chain.maps = sv_clx_buffer(p->diag, p->device, 3 * plane, NULL, &status);
    if (status != SV_OK) return status;
    return sv_clx_check(p->diag,
                        clEnqueueFillBuffer(p->device->queue, p->chain.maps, &one, sizeof one, 2 * plane,
                                            plane, 0, NULL, NULL),
                        "clEnqueueFillBuffer");
}

sv_status sv_chain_create(sv_pipeline *p) {
    const sv_config *c = &p->config;
    sv_chain *chain = &p->chain;
    const bool filtered = is_filtered(c), reduced = is_reduced(c);
    chain->method = methods[c->method];
    chain->doubles = p->device->has_doubles && !c->float32;
    chain->plain_mean = c->method == SV_METHOD_MEAN && !filtered && !reduced;
    chain->linear = chain->method->linear && !filtered;
    if (chain->plain_mean) return SV_OK;
    sv_status status = reduced ? sv_pipeline_create_reduced(p) : SV_OK;
    if (status != SV_OK) return status;
    sv_pipeline *on = sv_chain_map(p);
    on->chain = *chain;
    char options[64];
    (void)snprintf(options, sizeof options, "-DSV_SUBSTEPS=%u", c->substeps);
    status = sv_kernel_set_build(p->diag, p->device, sv_kernels_chain, sv_kernels_chain_size, kernels,
                                 options, &on->chain.gather);
    if (status == SV_OK) status = create_maps(on);
    if (status == SV_OK && filtered) status = create_method(on, &sv_method_minimum, &on->chain.filter);
    if (status == SV_OK) status = create_method(on, chain->method, &on->chain.state);
    return status;
}

sv_status sv_chain_slab(sv_pipeline *p, cl_mem buffer, uint64_t offset, uint32_t slice_count) {
    sv_chain *chain = &p->chain;
    return chain->method->slab ? chain->method->slab(p, &chain->state, buffer, offset, slice_count) : SV_OK;
}

static void release_state(sv_method_state *state) {
    sv_kernel_set_release(&state->kernels);
    for (uint32_t i = 0; i < SV_MAX_METHOD_BUFFERS; i++) sv_clx_release(&state->buffer[i]);
}

void sv_chain_destroy(sv_chain *chain) {
    release_state(&chain->state);
    release_state(&chain->filter);
    sv_kernel_set_release(&chain->gather);
    sv_clx_release(&chain->maps);
}

/* Forgets the passes of the run before, and fetches the depths of the initial points: both ends, or S(q). */
static sv_status fetch_points(sv_pipeline *p, float q) {
    const sv_config *c = &p->config;
    sv_pipeline *on = sv_chain_map(p);
    const bool cells = on != p;
    sv_launch l = sv_launch_begin(p, on->chain.gather.kernel[K_BEGIN], "chain_begin");
    sv_launch_uint(&l, on->job.pass_limit);
    sv_launch_buffer(&l, p->buffers.record);
    const sv_status status = sv_launch_items(&l, 1, SV_STAGE_RECONSTRUCT);
    if (status != SV_OK) return status;
    l = sv_launch_begin(p, on->chain.gather.kernel[cells ? K_CELLS : K_GATHER],
                        cells ? "chain_cells" : "chain_gather");
    if (cells) sv_launch_uint(&l, c->width);
    sv_launch_uint(&l, p->padded_width);
    sv_launch_uint(&l, c->height);
    sv_launch_buffer(&l, p->buffers.state16);
    sv_launch_buffer(&l, p->buffers.status);
    sv_launch_uint(&l, !p->chain.linear);
    sv_launch_arg(&l, sizeof q, &q);
    if (!cells) {
        sv_launch_buffer(&l, p->chain.maps);
        return sv_launch_vectors(&l, p->padded_width, c->height, SV_STAGE_RECONSTRUCT);
    }
    const bool filters = is_filtered(c) && p->values.of[SV_PARAM_PREFILTER_PASSES] > 0.0;
    sv_launch_uint(&l, filters || c->method == SV_METHOD_MINIMUM); /* a minimum is of minima */
    sv_launch_uint(&l, c->reduction);
    sv_launch_uint(&l, on->padded_width);
    sv_launch_uint(&l, on->config.height);
    sv_launch_buffer(&l, on->chain.maps);
    sv_launch_buffer(&l, on->buffers.status);
    return sv_launch_pixels(&l, on->padded_width, on->config.height, SV_STAGE_RECONSTRUCT);
}

/* The cells' surfaces to the pixels'. */
static sv_status spread(sv_pipeline *p, sv_pipeline *on) {
    sv_launch l = sv_launch_begin(p, on->chain.gather.kernel[K_SPREAD], "chain_spread");
    const uint32_t sizes[] = {p->config.width,  p->padded_width,  p->config.height,  p->config.reduction,
                              on->config.width, on->padded_width, on->config.height, p->chain.linear ? 2 : 1};
    for (size_t i = 0; i < sizeof sizes / sizeof *sizes; i++) sv_launch_uint(&l, sizes[i]);
    sv_launch_buffer(&l, on->buffers.surfaces);
    sv_launch_buffer(&l, p->buffers.surfaces);
    sv_launch_buffer(&l, p->buffers.record);
    return sv_launch_pixels(&l, on->config.width, on->config.height, SV_STAGE_RECONSTRUCT);
}

sv_status sv_chain_run(sv_pipeline *p, float q) {
    sv_chain *chain = &p->chain;
    if (chain->plain_mean) return chain->method->run(p, &chain->state, 2);
    sv_pipeline *on = sv_chain_map(p);
    const double *v = on->values.of;
    on->timing = p->timing;
    sv_status status = fetch_points(p, q);
    if (status == SV_OK && is_filtered(&p->config))
        status = sv_minimum_prefilter(on, &on->chain.filter, (uint32_t)v[SV_PARAM_PREFILTER_KERNEL],
                                      (uint32_t)v[SV_PARAM_PREFILTER_PASSES]);
    if (status == SV_OK) status = chain->method->run(on, &on->chain.state, chain->linear ? 2 : 1);
    return status == SV_OK && on != p ? spread(p, on) : status;
}

sv_levels sv_levels_make(uint32_t width, uint32_t height) {
    sv_levels l = {.count = 0};
    for (;;) {
        l.width[l.count] = width;
        l.height[l.count] = height;
        l.offset[l.count] = l.pixels;
        l.pixels += width * height;
        l.count++;
        if ((width == 1 && height == 1) || l.count == SV_MAX_LEVELS) return l;
        width = (width + 1) / 2;
        height = (height + 1) / 2;
    }
}

sv_status sv_chain_done(sv_pipeline *p, uint32_t passes) {
    sv_launch l = sv_launch_begin(p, p->chain.gather.kernel[K_DONE], "chain_done");
    sv_launch_uint(&l, passes);
    sv_launch_buffer(&l, p->buffers.record);
    return sv_launch_items(&l, 1, SV_STAGE_RECONSTRUCT);
}

sv_status sv_chain_done_passes(sv_pipeline *p) {
    sv_launch l = SV_LAUNCH(p, band_record);
    sv_launch_uint(&l, p->job.pass_limit);
    sv_launch_buffer(&l, p->buffers.record);
    return sv_launch_items(&l, 1, SV_STAGE_RECONSTRUCT);
}
