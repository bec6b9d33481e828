/* SPDX-License-Identifier: MIT */
/* Slabs in the three carriers. Scan conversion writes a device buffer; host memory and images are filled from
 * it. */
#include "loop/loop_parts.h"

#include <stdlib.h>
#include <string.h>

/* Texture rows of a slab of `slices` slices. */
static size_t texture_rows(const hs_slab_layout *layout, uint32_t slices) {
    return (size_t)((slices + layout->tiles_x - 1) / layout->tiles_x) * layout->tile_h;
}

/* The largest 2D image of the device; 0 x 0 if it has none. */
static bool image_limits(const hs_cl *cl, size_t limits[2], hs_error *err) {
    cl_bool supported = CL_FALSE;
    cl_int code = clGetDeviceInfo(cl->device, CL_DEVICE_IMAGE_SUPPORT, sizeof supported, &supported, NULL);
    limits[0] = limits[1] = 0;
    if (code == CL_SUCCESS && supported) {
        code = clGetDeviceInfo(cl->device, CL_DEVICE_IMAGE2D_MAX_WIDTH, sizeof limits[0], &limits[0], NULL);
        if (code == CL_SUCCESS)
            code =
                clGetDeviceInfo(cl->device, CL_DEVICE_IMAGE2D_MAX_HEIGHT, sizeof limits[1], &limits[1], NULL);
    }
    return hs_cl_check(code, "clGetDeviceInfo (images)", err);
}

static bool check_image_size(const hs_slabs *slabs, const hs_cl *cl, hs_error *err) {
    const size_t width = (size_t)slabs->layout.tiles_x * slabs->layout.tile_w;
    const size_t height = texture_rows(&slabs->layout, slabs->layout.slab_slices);
    size_t limits[2];
    if (!image_limits(cl, limits, err)) return false;
    if (limits[0] == 0)
        return hs_fail(err, HS_ERR_DEVICE, "carrier image: %s has no images", cl->device_name);
    return (width <= limits[0] && height <= limits[1]) ||
           hs_fail(err, HS_ERR_USAGE,
                   "carrier image: a slab's texture is %zu x %zu pixels, the device allows %zu x %zu", width,
                   height, limits[0], limits[1]);
}

static bool create_images(hs_slabs *slabs, const hs_cl *cl, hs_error *err) {
    const cl_image_format format = {.image_channel_order = CL_R, .image_channel_data_type = CL_UNORM_INT8};
    slabs->images = calloc(slabs->count, sizeof(cl_mem));
    if (!slabs->images)
        return hs_fail(err, HS_ERR_MEMORY, "slab images: no memory for %u handles", slabs->count);
    for (uint32_t i = 0; i < slabs->count; i++) {
        const cl_image_desc desc = {.image_type = CL_MEM_OBJECT_IMAGE2D,
                                    .image_width = (size_t)slabs->layout.tiles_x * slabs->layout.tile_w,
                                    .image_height = texture_rows(&slabs->layout, slabs->layout.slab_slices)};
        cl_int code;
        slabs->images[i] = clCreateImage(cl->context, CL_MEM_READ_WRITE, &format, &desc, NULL, &code);
        if (!hs_cl_check(code, "clCreateImage (slab)", err)) return false;
    }
    return true;
}

bool hs_slabs_create(hs_slabs *slabs, const hs_cl *cl, const hs_slab_layout *layout, uint32_t carrier,
                     hs_error *err) {
    *slabs = (hs_slabs){.layout = *layout, .carrier = carrier, .count = hs_slab_count(layout)};
    size_t bytes = hs_slab_bytes(layout, layout->slab_slices);
    slabs->stride = (bytes + HS_SLAB_ALIGN - 1) / HS_SLAB_ALIGN * HS_SLAB_ALIGN;
    slabs->memory_bytes = slabs->stride * slabs->count;
    cl_ulong limit = 0;
    cl_int code = clGetDeviceInfo(cl->device, CL_DEVICE_MAX_MEM_ALLOC_SIZE, sizeof limit, &limit, NULL);
    if (!hs_cl_check(code, "clGetDeviceInfo (CL_DEVICE_MAX_MEM_ALLOC_SIZE)", err)) return false;
    if (slabs->memory_bytes > limit)
        return hs_fail(err, HS_ERR_USAGE,
                       "low-resolution volume %u x %u x %u: %zu bytes of slabs, the device allows %llu",
                       layout->width, layout->height, layout->slices, slabs->memory_bytes,
                       (unsigned long long)limit);
    if (carrier == SV_CARRIER_IMAGE && !check_image_size(slabs, cl, err)) return false;
    slabs->buffer = clCreateBuffer(cl->context, CL_MEM_READ_WRITE, slabs->memory_bytes, NULL, &code);
    if (!hs_cl_check(code, "clCreateBuffer (slabs)", err)) return false;
    if (carrier == SV_CARRIER_HOST) {
        slabs->memory = aligned_alloc(HS_SLAB_ALIGN, slabs->memory_bytes);
        if (!slabs->memory)
            return hs_fail(err, HS_ERR_MEMORY, "slabs: no memory for %zu bytes", slabs->memory_bytes);
        memset(slabs->memory, 0, slabs->memory_bytes); /* touches the pages now, not in the first frame */
    }
    return carrier != SV_CARRIER_IMAGE || create_images(slabs, cl, err);
}

void hs_slabs_destroy(hs_slabs *slabs) {
    for (uint32_t i = 0; slabs->images && i < slabs->count; i++)
        if (slabs->images[i]) clReleaseMemObject(slabs->images[i]);
    free(slabs->images);
    if (slabs->buffer) clReleaseMemObject(slabs->buffer);
    free(slabs->memory);
    *slabs = (hs_slabs){0};
}

/* A finished slab from the device buffer into the carrier, in the order of the queue. */
static bool fill_carrier(const hs_slabs *slabs, const hs_cl *cl, uint32_t index, hs_error *err) {
    const uint32_t slices = hs_slab_length(&slabs->layout, index);
    const size_t offset = index * slabs->stride;
    if (slabs->carrier == SV_CARRIER_HOST) {
        cl_int code =
            clEnqueueReadBuffer(cl->queue, slabs->buffer, CL_FALSE, offset,
                                hs_slab_bytes(&slabs->layout, slices), slabs->memory + offset, 0, NULL, NULL);
        return hs_cl_check(code, "clEnqueueReadBuffer (slab)", err);
    }
    if (slabs->carrier == SV_CARRIER_IMAGE) {
        const size_t origin[3] = {0, 0, 0};
        const size_t region[3] = {(size_t)slabs->layout.tiles_x * slabs->layout.tile_w,
                                  texture_rows(&slabs->layout, slices), 1};
        cl_int code = clEnqueueCopyBufferToImage(cl->queue, slabs->buffer, slabs->images[index], offset,
                                                 origin, region, 0, NULL, NULL);
        return hs_cl_check(code, "clEnqueueCopyBufferToImage (slab)", err);
    }
    return true;
}

bool hs_slabs_convert(const hs_slabs *slabs, const hs_cl *cl, hs_scan_converter *converter,
                      const hs_device_volume *source, const hs_camera *camera, hs_error *err) {
    for (uint32_t i = 0; i < slabs->count; i++) {
        if (!hs_scan_convert_slab(converter, source, camera, i, slabs->buffer, i * slabs->stride, NULL,
                                  err) ||
            !fill_carrier(slabs, cl, i, err))
            return false;
    }
    return true;
}

void hs_slabs_describe(const hs_slabs *slabs, uint32_t index, sv_slab *out) {
    const uint32_t slices = hs_slab_length(&slabs->layout, index);
    const size_t offset = index * slabs->stride;
    *out = (sv_slab){
        .size = sizeof *out, .first_slice = index * slabs->layout.slab_slices, .slice_count = slices};
    switch (slabs->carrier) {
    case SV_CARRIER_HOST:
        out->memory = slabs->memory + offset;
        out->bytes = hs_slab_bytes(&slabs->layout, slices);
        break;
    case SV_CARRIER_BUFFER:
        out->object = slabs->buffer;
        out->offset = offset;
        out->bytes = hs_slab_bytes(&slabs->layout, slices);
        break;
    default:
        out->object = slabs->images[index];
        break;
    }
}
