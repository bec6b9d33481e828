/* The chain from the initial points to the surfaces, and the table of methods. */
#include "method.h"

#include "enqueue.h"
#include "kernels_chain.h"

#include <stdio.h>

static const sv_method *const methods[SV_METHOD_COUNT] = {
    [SV_METHOD_MEAN] = &sv_method_mean,         [SV_METHOD_MINIMUM] = &sv_method_minimum,
    [SV_METHOD_SPLINE] = &sv_method_spline,     [SV_METHOD_PUSHPULL] = &sv_method_pushpull,
    [SV_METHOD_MEMBRANE] = &sv_method_membrane, [SV_METHOD_PLATE] = &sv_method_plate,
    [SV_METHOD_COST] = &sv_method_cost,
};

enum { K_BEGIN, K_GATHER, K_DONE };
static const char *const kernels[] = {"chain_begin", "chain_gather", "chain_done", NULL};

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

uint32_t sv_chain_commands(const sv_config *c) {
    const bool filtered = is_filtered(c);
    return methods[c->method]->commands(c) + (filtered ? sv_method_minimum.commands(c) : 0) + 4;
}

sv_status sv_chain_create(sv_pipeline *p) {
    const sv_config *c = &p->config;
    sv_chain *chain = &p->chain;
    const bool filtered = is_filtered(c);
    chain->method = methods[c->method];
    chain->doubles = p->device->has_doubles && !c->float32;
    chain->plain_mean = c->method == SV_METHOD_MEAN && !filtered;
    chain->linear = chain->method->linear && !filtered;
    if (chain->plain_mean) return SV_OK;
    char options[64];
    (void)snprintf(options, sizeof options, "-DSV_SUBSTEPS=%u", c->substeps);
    sv_status status = sv_kernel_set_build(p->diag, p->device, sv_kernels_chain, sv_kernels_chain_size,
                                           kernels, options, &chain->gather);
    const size_t plane = (size_t)p->padded_width * c->height * sizeof(cl_float);
    chain->maps = sv_clx_buffer(p->diag, p->device, 2 * plane, NULL, &status);
    if (status == SV_OK && filtered) status = create_method(p, &sv_method_minimum, &chain->filter);
    if (status == SV_OK) status = create_method(p, chain->method, &chain->state);
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
    sv_launch l = sv_launch_begin(p, p->chain.gather.kernel[K_BEGIN], "chain_begin");
    sv_launch_uint(&l, p->job.pass_limit);
    sv_launch_buffer(&l, p->buffers.record);
    const sv_status status = sv_launch_items(&l, 1, SV_STAGE_RECONSTRUCT);
    if (status != SV_OK) return status;
    l = sv_launch_begin(p, p->chain.gather.kernel[K_GATHER], "chain_gather");
    sv_launch_uint(&l, p->padded_width);
    sv_launch_uint(&l, c->height);
    sv_launch_buffer(&l, p->buffers.state16);
    sv_launch_buffer(&l, p->buffers.status);
    sv_launch_uint(&l, !p->chain.linear);
    sv_launch_arg(&l, sizeof q, &q);
    sv_launch_buffer(&l, p->chain.maps);
    return sv_launch_vectors(&l, p->padded_width, c->height, SV_STAGE_RECONSTRUCT);
}

sv_status sv_chain_run(sv_pipeline *p, float q) {
    sv_chain *chain = &p->chain;
    if (chain->plain_mean) return chain->method->run(p, &chain->state, 2);
    const double *v = p->values.of;
    sv_status status = fetch_points(p, q);
    if (status == SV_OK && is_filtered(&p->config))
        status = sv_minimum_prefilter(p, &chain->filter, (uint32_t)v[SV_PARAM_PREFILTER_KERNEL],
                                      (uint32_t)v[SV_PARAM_PREFILTER_PASSES]);
    return status == SV_OK ? chain->method->run(p, &chain->state, chain->linear ? 2 : 1) : status;
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
