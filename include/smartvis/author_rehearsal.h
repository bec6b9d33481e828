/* SPDX-License-Identifier: MIT */
/*
 * A known answer for plugins with kernels: one frame of a volume that is tissue, fluid and tissue, a third
 * each, when the instance is activated. It launches every kernel of the frame once, as the ABI asks for, and
 * the depths must lie in the fluid. A part of smartvis/author_cl.h; it needs <CL/cl.h> before it.
 */
#ifndef SMARTVIS_AUTHOR_REHEARSAL_H
#define SMARTVIS_AUTHOR_REHEARSAL_H

#include "smartvis/author_device.h"

SMARTVIS_BEGIN_C

enum { SVA_TISSUE = 200, SVA_FLUID = 20, SVA_LEAST_SLICES = 6 };

typedef struct sva_rehearsal {
    uint8_t *texture; /* the longest slab */
    float *depth;
    sv_scanned *scanned; /* all of every ray, or NULL */
    cl_mem object;       /* SV_CARRIER_BUFFER: the texture on the device */
    size_t bytes;
} sva_rehearsal;

static inline sv_status sva_rehearsal_make(sva *a, sva_rehearsal *r) {
    const size_t rays = sva_rays(a);
    cl_int code = CL_SUCCESS;
    memset(r, 0, sizeof *r);
    r->bytes = (size_t)sva_slab_bytes(&a->format, a->format.max_slab_slices);
    r->texture = (uint8_t *)calloc(r->bytes, 1);
    r->depth = (float *)calloc(rays, sizeof *r->depth);
    r->scanned = (sv_scanned *)calloc(rays, sizeof *r->scanned);
    if (!r->texture || !r->depth || !r->scanned)
        return sva_error(a, SV_ERR_NO_MEMORY, "activate: no memory for a rehearsal");
    for (size_t i = 0; i < rays; i++) r->scanned[i].end = (uint16_t)a->format.slices;
    if (a->format.carrier == SV_CARRIER_BUFFER)
        r->object = clCreateBuffer(((sva_cl *)a->own)->context, CL_MEM_READ_ONLY, r->bytes, NULL, &code);
    return sva_cl_check(a, code, "clCreateBuffer");
}

static inline void sva_rehearsal_free(sva_rehearsal *r) {
    if (r->object) (void)clReleaseMemObject(r->object);
    free(r->texture);
    free(r->depth);
    free(r->scanned);
}

/* Slices first .. first + count - 1 through the method. Waits, so that the texture can be used again. */
static inline sv_status sva_rehearse_slab(sva *a, sva_rehearsal *r, uint32_t first, uint32_t count) {
    sva_cl *cl = (sva_cl *)a->own;
    const uint32_t third = a->format.slices / 3;
    sv_slab slab;
    for (uint32_t s = 0; s < count; s++) {
        int value = first + s < third || first + s >= 2 * third ? SVA_TISSUE : SVA_FLUID;
        if (value == a->padding) value++;
        for (uint32_t y = 0; y < a->format.height; y++)
            memset(r->texture + sva_byte(&a->format, 0, y, s), value, a->format.width);
    }
    memset(&slab, 0, sizeof slab);
    slab.size = (uint32_t)sizeof slab;
    slab.first_slice = first;
    slab.slice_count = count;
    slab.memory = r->object ? NULL : r->texture;
    slab.object = r->object;
    slab.bytes = r->bytes;
    if (r->object) {
        const cl_int code =
            clEnqueueWriteBuffer(cl->queue, r->object, CL_TRUE, 0, r->bytes, r->texture, 0, NULL, NULL);
        if (code != CL_SUCCESS) return sva_cl_check(a, code, "clEnqueueWriteBuffer");
    }
    const sv_status status = a->method->slab ? a->method->slab(a, &slab) : SV_OK;
    return status == SV_OK ? sva_cl_check(a, clFinish(cl->queue), "clFinish") : status;
}

static inline sv_status sva_rehearse_frame(sva *a, sva_rehearsal *r) {
    const uint32_t slices = a->format.slices, longest = a->format.max_slab_slices;
    sv_stats stats;
    sv_result result;
    memset(&a->frame, 0, sizeof a->frame);
    a->frame.scanned = a->scanned = a->format.flags & SV_FORMAT_SCANNED ? r->scanned : NULL;
    memset(&stats, 0, sizeof stats);
    memset(&result, 0, sizeof result);
    stats.size = (uint32_t)sizeof stats;
    result.size = (uint32_t)sizeof result;
    result.depth = r->depth;
    result.stats = &stats;
    sv_status s = a->method->begin ? a->method->begin(a) : SV_OK;
    for (uint32_t first = 0; s == SV_OK && first < slices; first += longest)
        s = sva_rehearse_slab(a, r, first, slices - first < longest ? slices - first : longest);
    if (s == SV_OK) s = a->method->finish(a, NULL);
    if (s >= SV_OK) s = a->method->output(a, &result);
    if (s >= SV_OK) s = sva_cl_check(a, clFinish(((sva_cl *)a->own)->queue), "clFinish");
    if (s < SV_OK || slices < SVA_LEAST_SLICES) return s < SV_OK ? s : SV_OK;
    const uint32_t third = slices / 3;
    for (size_t i = 0; i < sva_rays(a); i++)
        if (!(r->depth[i] >= (float)third - 1.0f && r->depth[i] <= (float)(2 * third)))
            return sva_error(a, SV_ERR_SELF_TEST,
                             "activate: the depth of ray %u is %g, the fluid is at %u to %u", (unsigned)i,
                             (double)r->depth[i], (unsigned)third, (unsigned)(2 * third - 1));
    return SV_OK;
}

/* [control] In activate, when all is made. SV_ERR_SELF_TEST if a depth is not in the fluid; with fewer than
 * SVA_LEAST_SLICES slices the depths are not looked at. The fluid is 40 mm long for the method, whatever the
 * spacing is. */
static inline sv_status sva_cl_rehearse(sva *a) {
    sva_rehearsal r;
    float spacing[3];
    memcpy(spacing, a->format.spacing_mm, sizeof spacing);
    for (int i = 0; i < 3; i++) a->format.spacing_mm[i] = SV_ASSUMED_EXTENT_MM / (float)a->format.slices;
    sv_status s = sva_rehearsal_make(a, &r);
    if (s == SV_OK) s = sva_rehearse_frame(a, &r);
    /* After a failure commands that use this memory may still be under way. */
    if (s != SV_OK && ((sva_cl *)a->own)->queue) (void)clFinish(((sva_cl *)a->own)->queue);
    sva_rehearsal_free(&r);
    memcpy(a->format.spacing_mm, spacing, sizeof spacing);
    a->scanned = NULL;
    return s;
}

SMARTVIS_END_C

#endif
