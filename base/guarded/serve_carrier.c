/* SPDX-License-Identifier: MIT */
#include "guarded/serve_carrier.h"

#include "core/system.h"
#include "guard/child.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

void *hs_carrier_map(const hs_carrier *carrier, hs_guard_map map) {
    return (uint8_t *)carrier->block + hs_guard_map_offset(map, carrier->pixels);
}

static bool has_queue(const hs_carrier *carrier) {
    return carrier->cl.queue != NULL;
}

/* ----------------------------------------------------------------------------------------- objects -- */

static cl_mem make_buffer(const hs_carrier *carrier, size_t bytes, void *memory, const char *what,
                          hs_error *err) {
    cl_int code;
    const cl_mem_flags flags = memory ? CL_MEM_READ_ONLY | CL_MEM_USE_HOST_PTR : CL_MEM_READ_WRITE;
    const cl_mem buffer = clCreateBuffer(carrier->cl.context, flags, bytes, memory, &code);
    return hs_cl_check(code, what, err) ? buffer : NULL;
}

static uint32_t slab_count(const sv_format *format) {
    return (format->slices + format->max_slab_slices - 1u) / format->max_slab_slices;
}

/* Pixels of a slab's texture. */
static void texture_size(const sv_format *format, uint32_t slices, size_t size[3]) {
    size[0] = (size_t)format->tiles_x * format->tile_w;
    size[1] = (size_t)((slices + format->tiles_x - 1u) / format->tiles_x) * format->tile_h;
    size[2] = 1;
}

static bool make_images(hs_carrier *carrier, hs_error *err) {
    const cl_image_format pixel = {.image_channel_order = CL_R, .image_channel_data_type = CL_UNORM_INT8};
    const uint32_t count = slab_count(&carrier->format);
    size_t size[3];
    texture_size(&carrier->format, carrier->format.max_slab_slices, size);
    const cl_image_desc desc = {
        .image_type = CL_MEM_OBJECT_IMAGE2D, .image_width = size[0], .image_height = size[1]};
    carrier->images = hs_memory(count, sizeof *carrier->images, "slab images", err);
    if (!carrier->images) return false;
    for (uint32_t i = 0; i < count; i++) {
        cl_int code;
        carrier->images[i] =
            clCreateImage(carrier->cl.context, CL_MEM_READ_WRITE, &pixel, &desc, NULL, &code);
        if (!hs_cl_check(code, "clCreateImage (slab)", err)) return false;
    }
    return true;
}

/* The host's queue, and what lies on its device. A CPU reads the shared memory where it is. */
static bool make_objects(hs_carrier *carrier, hs_error *err) {
    const size_t map_bytes = carrier->pixels * sizeof(float);
    if (carrier->way.own_queue) return true;
    if (!hs_cl_open_bare(&carrier->cl, err)) return false;
    carrier->in_place = carrier->cl.is_cpu;
    carrier->depth = make_buffer(carrier, map_bytes, NULL, "clCreateBuffer (depthmap)", err);
    carrier->confidence = make_buffer(carrier, map_bytes, NULL, "clCreateBuffer (confidence)", err);
    if (!carrier->depth || !carrier->confidence) return false;
    carrier->scanned = make_buffer(carrier, carrier->pixels * sizeof(sv_scanned), NULL,
                                   "clCreateBuffer (scanned ranges)", err);
    if (!carrier->scanned) return false;
    if (carrier->way.carrier == SV_CARRIER_IMAGE) return make_images(carrier, err);
    if (carrier->way.carrier != SV_CARRIER_BUFFER) return true;
    void *memory = carrier->in_place ? (void *)(uintptr_t)carrier->slabs : NULL;
    carrier->buffer = make_buffer(carrier, carrier->slabs_bytes, memory, "clCreateBuffer (slabs)", err);
    return carrier->buffer != NULL;
}

static bool map_slabs(hs_carrier *carrier, hs_error *err) {
    void *at = sys_shared_map(hs_child_passed(HS_GUARD_PASSED_SLABS), carrier->slabs_bytes, false);
    carrier->slabs = at;
    if (!at || !sys_shared_use(at, carrier->slabs_bytes, false))
        return hs_fail(err, HS_ERR_MEMORY, "guard: cannot map %zu bytes of slabs: %s", carrier->slabs_bytes,
                       strerror(errno));
    return true;
}

bool hs_carrier_open(hs_carrier *carrier, hs_guard_block *block, sv_format *format, hs_error *err) {
    *carrier = (hs_carrier){.block = block, .way = block->way, .format = block->format};
    carrier->pixels = (size_t)format->width * format->height;
    carrier->slabs_bytes = block->slabs_bytes;
    if (!map_slabs(carrier, err) || !make_objects(carrier, err)) {
        hs_carrier_close(carrier);
        return false;
    }
    format->carrier = carrier->way.carrier;
    format->context = carrier->cl.context;
    format->device = carrier->cl.device;
    format->queue = carrier->cl.queue;
    /* All slabs lie in one piece of memory, if the host said so and the plugin gets memory. */
    const bool memory = carrier->way.carrier == SV_CARRIER_HOST && block->format.host_memory_bytes > 0;
    format->host_memory = memory ? carrier->slabs : NULL;
    format->host_memory_bytes = memory ? carrier->slabs_bytes : 0;
    return true;
}

void hs_carrier_close(hs_carrier *carrier) {
    if (has_queue(carrier)) (void)clFinish(carrier->cl.queue);
    const cl_mem buffers[] = {carrier->buffer, carrier->depth, carrier->confidence, carrier->scanned};
    for (size_t i = 0; i < sizeof buffers / sizeof *buffers; i++)
        if (buffers[i]) (void)clReleaseMemObject(buffers[i]);
    for (uint32_t i = 0; carrier->images && i < slab_count(&carrier->format); i++)
        if (carrier->images[i]) (void)clReleaseMemObject(carrier->images[i]);
    free(carrier->images);
    hs_cl_close(&carrier->cl);
    sys_shared_unmap((void *)(uintptr_t)carrier->slabs, carrier->slabs_bytes);
    *carrier = (hs_carrier){0};
}

/* -------------------------------------------------------------------------------------------- frame -- */

static bool write_to(const hs_carrier *carrier, cl_mem object, size_t offset, const void *from, size_t bytes,
                     const char *what, hs_error *err) {
    return hs_cl_check(
        clEnqueueWriteBuffer(carrier->cl.queue, object, CL_FALSE, offset, bytes, from, 0, NULL, NULL), what,
        err);
}

/* The slabs into objects that are not the shared memory itself. */
static bool fill_objects(const hs_carrier *carrier, hs_error *err) {
    const hs_guard_block *block = carrier->block;
    for (uint32_t i = 0; i < block->slab_count; i++) {
        const hs_guard_slab *slab = &block->slabs[i];
        const uint8_t *from = carrier->slabs + slab->offset;
        if (carrier->images) {
            const size_t origin[3] = {0, 0, 0};
            size_t region[3];
            if (i >= slab_count(&carrier->format)) return true;
            texture_size(&carrier->format, slab->slice_count, region);
            const cl_int code =
                clEnqueueWriteImage(carrier->cl.queue, carrier->images[i], CL_FALSE, origin, region,
                                    carrier->format.row_pitch, 0, from, 0, NULL, NULL);
            if (!hs_cl_check(code, "clEnqueueWriteImage (slab)", err)) return false;
        } else if (carrier->buffer && !carrier->in_place) {
            if (!write_to(carrier, carrier->buffer, slab->offset, from, slab->bytes,
                          "clEnqueueWriteBuffer (slab)", err))
                return false;
        }
    }
    return true;
}

bool hs_carrier_begin(hs_carrier *carrier, sv_frame *frame, hs_error *err) {
    const void *ranges = hs_carrier_map(carrier, HS_GUARD_SCANNED);
    const bool told = carrier->block->has_scanned;
    carrier->brings_confidence = false;
    if (!has_queue(carrier)) {
        frame->scanned = told ? ranges : NULL;
        return true;
    }
    frame->scanned_object = told ? carrier->scanned : NULL;
    return (!told || write_to(carrier, carrier->scanned, 0, ranges, carrier->pixels * sizeof(sv_scanned),
                              "clEnqueueWriteBuffer (scanned ranges)", err)) &&
           fill_objects(carrier, err);
}

void hs_carrier_slab(const hs_carrier *carrier, uint32_t index, sv_slab *out) {
    const hs_guard_slab *slab = &carrier->block->slabs[index];
    *out = (sv_slab){.size = sizeof *out, .first_slice = slab->first_slice, .slice_count = slab->slice_count};
    if (carrier->images) {
        out->object = carrier->images[index];
        return;
    }
    out->bytes = slab->bytes;
    out->object = carrier->buffer;
    out->offset = carrier->buffer ? slab->offset : 0;
    out->memory = carrier->buffer ? NULL : carrier->slabs + slab->offset;
}

bool hs_carrier_result(hs_carrier *carrier, sv_result *result, hs_error *err) {
    hs_guard_block *block = carrier->block;
    float *depth = hs_carrier_map(carrier, HS_GUARD_DEPTH);
    *result = (sv_result){.size = sizeof *result,
                          .depth = has_queue(carrier) ? NULL : depth,
                          .depth_object = carrier->depth,
                          .status = block->want_status ? hs_carrier_map(carrier, HS_GUARD_STATUS) : NULL,
                          .stats = &block->stats};
    return !has_queue(carrier) || write_to(carrier, carrier->depth, 0, depth, carrier->pixels * sizeof *depth,
                                           "clEnqueueWriteBuffer (depthmap)", err);
}

void hs_carrier_confidence(hs_carrier *carrier, float **map, cl_mem *object) {
    *object = carrier->confidence;
    *map = carrier->confidence ? NULL : hs_carrier_map(carrier, HS_GUARD_CONFIDENCE_MAP);
    carrier->brings_confidence = true;
}

static bool read_back(const hs_carrier *carrier, cl_mem object, hs_guard_map map, const char *what,
                      hs_error *err) {
    return hs_cl_check(clEnqueueReadBuffer(carrier->cl.queue, object, CL_FALSE, 0,
                                           carrier->pixels * sizeof(float), hs_carrier_map(carrier, map), 0,
                                           NULL, NULL),
                       what, err);
}

bool hs_carrier_finish(hs_carrier *carrier, hs_error *err) {
    if (!has_queue(carrier)) return true;
    return read_back(carrier, carrier->depth, HS_GUARD_DEPTH, "clEnqueueReadBuffer (depthmap)", err) &&
           (!carrier->brings_confidence || read_back(carrier, carrier->confidence, HS_GUARD_CONFIDENCE_MAP,
                                                     "clEnqueueReadBuffer (confidence)", err)) &&
           hs_cl_check(clFinish(carrier->cl.queue), "clFinish (plugin)", err);
}
