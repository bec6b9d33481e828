/* SPDX-License-Identifier: MIT */
/*
 * Method mean: passes of a k x k window mean until no pixel is empty (cl/mean/mean.clh). On its own it starts
 * from the sums that the points stage wrote; behind a pre-filter from the maps.
 */
#include "device/launch.h"
#include "kernels_mean_maps.h"

enum { K_ENTER, K_LEAVE };
static const char *const kernels[] = {"mean_enter", "mean_leave", NULL};

static sv_source source(void) {
    return (sv_source){sv_kernels_mean_maps, sv_kernels_mean_maps_size};
}

static uint32_t commands(const sv_config *c) {
    (void)c;
    return 4; /* its passes are counted for every instance */
}

static sv_status create(sv_pipeline *p, sv_method_state *s) {
    (void)p;
    (void)s;
    return SV_OK; /* the pipeline holds its buffers */
}

/* Points and all passes in one launch, by one work item. */
sv_status sv_mean_single(sv_pipeline *p) {
    const sv_buffers *b = &p->buffers;
    sv_launch l = SV_LAUNCH_JOB(p, frame_end);
    const cl_mem buffers[] = {b->state8, b->state16, b->histogram, b->status, b->sums_a,
                              b->sums_b, b->scratch, b->surfaces,  b->record};
    for (size_t i = 0; i < sizeof buffers / sizeof *buffers; i++) sv_launch_buffer(&l, buffers[i]);
    return sv_launch_items(&l, 1, SV_STAGE_RECONSTRUCT);
}

static sv_status band_pass(sv_pipeline *p, uint32_t pass) {
    const sv_buffers *b = &p->buffers;
    sv_launch l = SV_LAUNCH_JOB(p, band_mean);
    sv_launch_uint(&l, pass);
    sv_launch_buffer(&l, pass % 2 ? b->sums_b : b->sums_a);
    sv_launch_buffer(&l, pass % 2 ? b->sums_a : b->sums_b);
    sv_launch_buffer(&l, b->surfaces);
    sv_launch_buffer(&l, b->status);
    sv_launch_buffer(&l, b->scratch);
    sv_launch_buffer(&l, b->record);
    return sv_launch_items(&l, p->bands, SV_STAGE_RECONSTRUCT);
}

static sv_status rays_pass(sv_pipeline *p, uint32_t pass) {
    const sv_buffers *b = &p->buffers;
    sv_launch l = SV_LAUNCH_JOB(p, rays_columns);
    sv_launch_uint(&l, pass);
    sv_launch_buffer(&l, b->sums_a);
    sv_launch_buffer(&l, b->sums_b);
    sv_launch_buffer(&l, b->record);
    const sv_status status = sv_launch_pixels(&l, p->config.width, p->config.height, SV_STAGE_RECONSTRUCT);
    if (status != SV_OK) return status;
    l = SV_LAUNCH_JOB(p, rays_means);
    sv_launch_uint(&l, pass);
    sv_launch_buffer(&l, b->sums_b);
    sv_launch_buffer(&l, b->sums_a);
    sv_launch_buffer(&l, b->surfaces);
    sv_launch_buffer(&l, b->status);
    sv_launch_buffer(&l, b->record);
    return sv_launch_pixels(&l, p->config.width, p->config.height, SV_STAGE_RECONSTRUCT);
}

/* Maps to sums. The sums have no sign, so that of S(q) the first plane takes depths above 0 and the second
 * those below, negated; their difference is the mean of both. */
static sv_status enter(sv_pipeline *p, const sv_method_state *s, uint32_t planes) {
    sv_launch l = sv_launch_begin(p, s->kernels.kernel[K_ENTER], "mean_enter");
    sv_launch_arg(&l, sizeof p->job, &p->job);
    sv_launch_uint(&l, p->config.half_sums ? 16 : p->program == p->wide ? 64 : 32);
    sv_launch_uint(&l, planes);
    sv_launch_buffer(&l, p->chain.maps);
    for (int type = 0; type < 3; type++) sv_launch_buffer(&l, p->buffers.sums_a);
    return sv_launch_pixels(&l, p->padded_width, p->config.height, SV_STAGE_RECONSTRUCT);
}

static sv_status leave(sv_pipeline *p, const sv_method_state *s) {
    sv_launch l = sv_launch_begin(p, s->kernels.kernel[K_LEAVE], "mean_leave");
    sv_launch_uint(&l, p->padded_width);
    sv_launch_uint(&l, p->config.height);
    sv_launch_buffer(&l, p->buffers.surfaces);
    return sv_launch_vectors(&l, p->padded_width, p->config.height, SV_STAGE_RECONSTRUCT);
}

static sv_status run(sv_pipeline *p, sv_method_state *s, uint32_t planes) {
    const bool rays = p->config.strategy == SV_STRATEGY_RAYS;
    const bool from_maps = !p->chain.plain_mean;
    sv_status status = from_maps ? enter(p, s, planes) : SV_OK;
    for (uint32_t pass = 0; status == SV_OK && pass < p->job.pass_limit; pass++)
        status = rays ? rays_pass(p, pass) : band_pass(p, pass);
    if (status == SV_OK) status = sv_chain_done_passes(p);
    return status == SV_OK && from_maps && planes == 1 ? leave(p, s) : status;
}

const sv_method sv_method_mean = {
    .linear = true, .kernels = kernels, .source = source, .commands = commands, .create = create, .run = run};
