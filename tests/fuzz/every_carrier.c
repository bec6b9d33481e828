/* SPDX-License-Identifier: MIT */
/*
 * A plugin for fuzz_recording and fuzz_door: it takes every carrier on both queues, and in `end` reads every
 * byte of all slabs and ranges that it was promised, and writes every byte of the map. On OpenCL without a
 * device the address sanitizer sees what is not there, or no longer.
 */
#include "smartvis/author.h"

#include <CL/cl.h>

typedef struct {
    sv_slab slabs[SVA_MAX_SIDE];
    uint32_t count;
    uint8_t *row; /* of a slab */
    uint32_t sum;
} keeper;

static sv_status prepare(sva *a) {
    keeper *k = (keeper *)a->own;
    k->row = (uint8_t *)malloc(a->format.width);
    return k->row ? SV_OK : SV_ERR_NO_MEMORY;
}

static void release(sva *a) {
    free(((keeper *)a->own)->row);
    ((keeper *)a->own)->row = NULL;
}

static sv_status begin(sva *a) {
    ((keeper *)a->own)->count = 0;
    return SV_OK;
}

static sv_status keep(sva *a, const sv_slab *slab) {
    keeper *k = (keeper *)a->own;
    k->slabs[k->count++] = *slab;
    return SV_OK;
}

static sv_status read_row(sva *a, const sv_slab *s, uint32_t slice, uint32_t y) {
    keeper *k = (keeper *)a->own;
    const sv_format *f = &a->format;
    const size_t at = sva_byte(f, 0, y, slice),
                 from[3] = {slice % f->tiles_x * f->tile_w, slice / f->tiles_x * f->tile_h + y, 0};
    const size_t pixels[3] = {f->width, 1, 1};
    cl_int code = CL_SUCCESS;
    if (f->carrier == SV_CARRIER_HOST)
        memcpy(k->row, (const uint8_t *)s->memory + at, f->width);
    else if (f->carrier == SV_CARRIER_BUFFER)
        code = clEnqueueReadBuffer(f->queue, s->object, CL_TRUE, (size_t)s->offset + at, f->width, k->row, 0,
                                   NULL, NULL);
    else
        code = clEnqueueReadImage(f->queue, s->object, CL_TRUE, from, pixels, 0, 0, k->row, 0, NULL, NULL);
    for (uint32_t x = 0; x < f->width; x++) k->sum += k->row[x];
    return code == CL_SUCCESS ? SV_OK : SV_ERR_OPENCL;
}

static sv_status finish(sva *a, float *depth) { /* NOLINT(readability-non-const-parameter) */
    const keeper *k = (const keeper *)a->own;
    sv_status status = SV_OK;
    (void)depth;
    for (uint32_t n = 0; n < k->count; n++)
        for (uint32_t s = 0; s < k->slabs[n].slice_count; s++)
            for (uint32_t y = 0; y < a->format.height && status == SV_OK; y++)
                status = read_row(a, &k->slabs[n], s, y);
    for (uint32_t i = 0; a->scanned && i < sva_rays(a); i++) ((keeper *)a->own)->sum += a->scanned[i].end;
    return status;
}

/* Depths that the voxels choose, which nobody may read as more than depths. */
static sv_status output(sva *a, const sv_result *r) {
    const sv_format *f = &a->format;
    const float depth = (float)(((const keeper *)a->own)->sum % f->slices);
    const size_t row = f->width * sizeof depth, pitch = r->depth_pitch ? r->depth_pitch : row;
    for (uint32_t y = 0; y < f->height && r->depth; y++)
        for (uint32_t x = 0; x < f->width; x++)
            memcpy((char *)r->depth + y * pitch + x * sizeof depth, &depth, sizeof depth);
    if (r->status) memset(r->status, SV_POINT_INITIAL, sva_rays(a));
    if (r->stats) r->stats->rays = r->stats->points = (uint32_t)sva_rays(a);
    return !r->depth_object ||
                   clEnqueueFillBuffer(f->queue, r->depth_object, &depth, sizeof depth,
                                       (size_t)r->depth_offset, row * f->height, 0, NULL, NULL) == CL_SUCCESS
               ? SV_OK
               : SV_ERR_OPENCL;
}

static sv_status adjust(sva *a, float *depth) { /* NOLINT(readability-non-const-parameter) */
    (void)a, (void)depth;
    return SV_OK;
}

static const sv_descriptor descriptor = {sizeof(sv_descriptor),
                                         SV_BIT(SV_CARRIER_HOST) | SV_BIT(SV_CARRIER_BUFFER) |
                                             SV_BIT(SV_CARRIER_IMAGE),
                                         "org.smartvis.test.every_carrier",
                                         "Every carrier",
                                         "SmartVis tests",
                                         "1",
                                         "Reads all that it was promised.",
                                         SV_BIT(SV_VOXEL_U8),
                                         SV_QUEUE_OWN | SV_QUEUE_HOST,
                                         SV_FEATURE_SCANNED | SV_FEATURE_ADJUST,
                                         0,
                                         (const char *const[]){NULL}};

static const sva_method method = {.descriptor = &descriptor,
                                  .own_bytes = sizeof(keeper),
                                  .activate = prepare,
                                  .deactivate = release,
                                  .begin = begin,
                                  .slab = keep,
                                  .finish = finish,
                                  .adjust = adjust,
                                  .output = output};
SVA_ENTRY(method);
