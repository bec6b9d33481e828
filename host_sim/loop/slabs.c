/* SPDX-License-Identifier: MIT */
#include "loop/slabs.h"

#include "core/system.h"
#include "render/scan_convert.h"

#include <stdlib.h>
#include <string.h>

#define ALIGN 4096u /* bytes: a page, so that a plugin may read host memory in place */

struct hs_slabs {
    const hs_cl *cl;
    hs_scan_converter *converter;
    hs_slab_layout layout;
    uint32_t carrier;    /* SV_CARRIER_* */
    uint32_t count;      /* slabs */
    size_t stride;       /* bytes from one slab to the next, a multiple of ALIGN */
    cl_mem buffer;       /* device, all slabs: what scan conversion writes */
    cl_mem *images;      /* SV_CARRIER_IMAGE: one 2D image a slab */
    uint8_t *memory;     /* SV_CARRIER_HOST: a copy of `buffer`, aligned to ALIGN, */
    bool borrowed;       /* which is somebody else's, */
    bool in_place;       /* or `buffer` itself */
    size_t memory_bytes; /* count * stride */
    hs_fan fan;
    bool gaps;
    hs_scanned_rays rays; /* HS_FAN_RANGES: every ray's range, on the device, */
    sv_scanned *ranges;   /* and on the host */
};

/* Texture rows of a slab of `slices` slices. */
static size_t texture_rows(const hs_slab_layout *layout, uint32_t slices) {
    return (size_t)((slices + layout->tiles_x - 1) / layout->tiles_x) * layout->tile_h;
}

/* The largest 2D image of the device. */
static bool image_limits(const hs_cl *cl, size_t limits[2], hs_error *err) {
    cl_int code =
        clGetDeviceInfo(cl->device, CL_DEVICE_IMAGE2D_MAX_WIDTH, sizeof limits[0], &limits[0], NULL);
    if (code == CL_SUCCESS)
        code = clGetDeviceInfo(cl->device, CL_DEVICE_IMAGE2D_MAX_HEIGHT, sizeof limits[1], &limits[1], NULL);
    return hs_cl_check(code, "clGetDeviceInfo (images)", err);
}

static bool check_image_size(const hs_slabs *slabs, hs_error *err) {
    const size_t width = (size_t)slabs->layout.tiles_x * slabs->layout.tile_w;
    const size_t height = texture_rows(&slabs->layout, slabs->layout.slab_slices);
    size_t limits[2];
    if (!image_limits(slabs->cl, limits, err)) return false;
    return (width <= limits[0] && height <= limits[1]) ||
           hs_fail(err, HS_ERR_USAGE,
                   "carrier image: a slab's texture is %zu x %zu pixels, the device allows %zu x %zu", width,
                   height, limits[0], limits[1]);
}

static bool create_images(hs_slabs *slabs, hs_error *err) {
    const cl_image_format format = {.image_channel_order = CL_R, .image_channel_data_type = CL_UNORM_INT8};
    slabs->images = hs_memory(slabs->count, sizeof(cl_mem), "slab images", err);
    if (!slabs->images) return false;
    for (uint32_t i = 0; i < slabs->count; i++) {
        const cl_image_desc desc = {.image_type = CL_MEM_OBJECT_IMAGE2D,
                                    .image_width = (size_t)slabs->layout.tiles_x * slabs->layout.tile_w,
                                    .image_height = texture_rows(&slabs->layout, slabs->layout.slab_slices)};
        cl_int code;
        slabs->images[i] = clCreateImage(slabs->cl->context, CL_MEM_READ_WRITE, &format, &desc, NULL, &code);
        if (!hs_cl_check(code, "clCreateImage (slab)", err)) return false;
    }
    return true;
}

static bool check_buffer_size(const hs_slabs *slabs, hs_error *err) {
    const hs_slab_layout *layout = &slabs->layout;
    cl_ulong limit = 0;
    const cl_int code =
        clGetDeviceInfo(slabs->cl->device, CL_DEVICE_MAX_MEM_ALLOC_SIZE, sizeof limit, &limit, NULL);
    if (!hs_cl_check(code, "clGetDeviceInfo (CL_DEVICE_MAX_MEM_ALLOC_SIZE)", err)) return false;
    return slabs->memory_bytes <= limit ||
           hs_fail(err, HS_ERR_USAGE,
                   "low-resolution volume %u x %u x %u: %zu bytes of slabs, the device allows %llu",
                   layout->width, layout->height, layout->slices, slabs->memory_bytes,
                   (unsigned long long)limit);
}

/* The device's buffer, and what the carrier needs beside it. */
static bool create_memory(hs_slabs *slabs, hs_error *err) {
    cl_int code;
    if (!check_buffer_size(slabs, err)) return false;
    if (slabs->carrier == SV_CARRIER_IMAGE && !check_image_size(slabs, err)) return false;
    slabs->in_place = slabs->borrowed && slabs->cl->is_cpu;
    slabs->buffer =
        clCreateBuffer(slabs->cl->context, CL_MEM_READ_WRITE | (slabs->in_place ? CL_MEM_USE_HOST_PTR : 0),
                       slabs->memory_bytes, slabs->in_place ? slabs->memory : NULL, &code);
    if (!hs_cl_check(code, "clCreateBuffer (slabs)", err)) return false;
    if (slabs->carrier == SV_CARRIER_HOST && !slabs->borrowed) {
        slabs->memory = sys_aligned(ALIGN, slabs->memory_bytes);
        if (!slabs->memory)
            return hs_fail(err, HS_ERR_MEMORY, "slabs: no memory for %zu bytes", slabs->memory_bytes);
        memset(slabs->memory, 0, slabs->memory_bytes); /* touches the pages now, not in the first frame */
    }
    return slabs->carrier != SV_CARRIER_IMAGE || create_images(slabs, err);
}

static bool create_ranges(hs_slabs *slabs, hs_error *err) {
    const size_t rays = (size_t)slabs->layout.width * slabs->layout.height;
    if (slabs->fan != HS_FAN_RANGES) return true;
    slabs->ranges = hs_memory(rays, sizeof *slabs->ranges, "scanned ranges", err);
    if (!slabs->ranges) return false;
    return hs_scanned_rays_create(&slabs->rays, slabs->cl, &slabs->layout, err);
}

static size_t stride_of(const hs_slab_layout *layout) {
    return (hs_slab_bytes(layout, layout->slab_slices) + ALIGN - 1) / ALIGN * ALIGN;
}

size_t hs_slabs_bytes(const hs_slab_layout *layout) {
    return stride_of(layout) * hs_slab_count(layout);
}

hs_slabs *hs_slabs_create(const hs_cl *cl, const hs_slab_layout *layout, uint32_t carrier, hs_fan fan,
                          bool gaps, void *memory, hs_error *err) {
    hs_slabs *slabs = hs_memory(1, sizeof *slabs, "slabs", err);
    if (!slabs) return NULL;
    slabs->cl = cl;
    slabs->layout = *layout;
    slabs->carrier = carrier;
    slabs->fan = fan;
    slabs->gaps = gaps && fan == HS_FAN_RANGES;
    slabs->memory = memory;
    slabs->borrowed = memory != NULL;
    slabs->converter = hs_scan_converter_create(cl, layout, err);
    if (slabs->converter) {
        slabs->count = hs_slab_count(layout);
        slabs->stride = stride_of(layout);
        slabs->memory_bytes = hs_slabs_bytes(layout);
        if (create_memory(slabs, err) && create_ranges(slabs, err)) return slabs;
    }
    hs_slabs_destroy(slabs);
    return NULL;
}

void hs_slabs_destroy(hs_slabs *slabs) {
    if (!slabs) return;
    for (uint32_t i = 0; slabs->images && i < slabs->count; i++)
        if (slabs->images[i]) clReleaseMemObject(slabs->images[i]);
    free(slabs->images);
    if (slabs->buffer) clReleaseMemObject(slabs->buffer);
    hs_scanned_rays_destroy(&slabs->rays);
    free(slabs->ranges);
    if (!slabs->borrowed) sys_aligned_free(slabs->memory);
    hs_scan_converter_destroy(slabs->converter);
    free(slabs);
}

/* A finished slab from the device buffer into the carrier, in the order of the queue. */
static bool fill_carrier(const hs_slabs *slabs, uint32_t index, hs_error *err) {
    const hs_cl *cl = slabs->cl;
    const uint32_t slices = hs_slab_length(&slabs->layout, index);
    const size_t offset = index * slabs->stride;
    if (slabs->carrier == SV_CARRIER_HOST && slabs->in_place) return true;
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

/* Every ray's range from the converted slabs, and a copy of them on the host if the slabs go there, too. */
static bool find_ranges(hs_slabs *slabs, const hs_device_volume *source, const hs_camera *camera,
                        hs_error *err) {
    const size_t bytes = (size_t)slabs->layout.width * slabs->layout.height * sizeof *slabs->ranges;
    if (!hs_scanned_rays_find(&slabs->rays, &slabs->layout, source, camera, slabs->buffer, slabs->stride,
                              err))
        return false;
    if (slabs->carrier != SV_CARRIER_HOST) return true;
    const cl_int code = clEnqueueReadBuffer(slabs->cl->queue, slabs->rays.ranges, CL_FALSE, 0, bytes,
                                            slabs->ranges, 0, NULL, NULL);
    return hs_cl_check(code, "clEnqueueReadBuffer (scanned ranges)", err);
}

/* Memory that the device works in becomes the host's by mapping it; there is nothing to copy. */
static bool show_memory(const hs_slabs *slabs, hs_error *err) {
    cl_int code;
    if (!slabs->in_place) return true;
    void *at = clEnqueueMapBuffer(slabs->cl->queue, slabs->buffer, CL_FALSE, CL_MAP_READ, 0,
                                  slabs->memory_bytes, 0, NULL, NULL, &code);
    return hs_cl_check(code, "clEnqueueMapBuffer (slabs)", err) &&
           hs_cl_check(clEnqueueUnmapMemObject(slabs->cl->queue, slabs->buffer, at, 0, NULL, NULL),
                       "clEnqueueUnmapMemObject (slabs)", err);
}

bool hs_slabs_prepare(hs_slabs *slabs, const hs_device_volume *source, const hs_camera *camera,
                      hs_error *err) {
    return hs_scan_convert_prepare(slabs->converter, source, camera, err);
}

bool hs_slabs_convert(hs_slabs *slabs, const hs_device_volume *source, const hs_camera *camera,
                      hs_error *err) {
    for (uint32_t i = 0; i < slabs->count; i++)
        if (!hs_scan_convert_slab(slabs->converter, source, camera, i, slabs->buffer, i * slabs->stride, NULL,
                                  err) ||
            !fill_carrier(slabs, i, err))
            return false;
    return show_memory(slabs, err) &&
           (slabs->fan != HS_FAN_RANGES || find_ranges(slabs, source, camera, err));
}

const hs_slab_layout *hs_slabs_layout(const hs_slabs *slabs) {
    return &slabs->layout;
}

uint32_t hs_slabs_count(const hs_slabs *slabs) {
    return slabs->count;
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

void hs_slabs_describe_format(const hs_slabs *slabs, sv_format *format) {
    const hs_slab_layout *layout = &slabs->layout;
    format->width = layout->width;
    format->height = layout->height;
    format->slices = layout->slices;
    format->max_slab_slices = layout->slab_slices;
    format->voxel_type = SV_VOXEL_U8;
    format->carrier = slabs->carrier;
    format->padding_value = slabs->fan == HS_FAN_PADDING || slabs->gaps ? 0 : SV_NO_PADDING;
    format->flags = slabs->fan == HS_FAN_RANGES ? SV_FORMAT_SCANNED : 0;
    format->tiles_x = layout->tiles_x;
    format->tile_w = layout->tile_w;
    format->tile_h = layout->tile_h;
    format->row_pitch = layout->row_pitch;
    if (slabs->carrier != SV_CARRIER_HOST) return;
    format->host_memory = slabs->memory;
    format->host_memory_bytes = slabs->memory_bytes;
}

void hs_slabs_describe_frame(const hs_slabs *slabs, bool own_queue, sv_frame *frame) {
    if (slabs->fan != HS_FAN_RANGES) return;
    frame->scanned = own_queue ? slabs->ranges : NULL;
    frame->scanned_object = own_queue ? NULL : slabs->rays.ranges;
}
