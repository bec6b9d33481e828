/* SPDX-License-Identifier: MIT */
/*
 * OpenCL's errors, and what a host may hand over as an object. A part of smartvis/author_cl.h; it
 * needs <CL/cl.h> before it, and no more of the helper than a method has.
 */
#ifndef SMARTVIS_AUTHOR_OBJECTS_H
#define SMARTVIS_AUTHOR_OBJECTS_H

#include "smartvis/author_method.h"
#include "smartvis/device.h"

SMARTVIS_BEGIN_C

/* The name of an OpenCL code, "CL_INVALID_VALUE". */
static inline const char *sva_cl_name(cl_int code) {
    return sv_devices_code(code);
}

/* SV_OK, or SV_ERR_OPENCL with "what: CL_..., (code)". */
static inline sv_status sva_cl_check(sva *a, cl_int code, const char *what) {
    if (code == CL_SUCCESS) return SV_OK;
    return sva_error(a, SV_ERR_OPENCL, "%s: %s (%d)", what, sva_cl_name(code), (int)code);
}

/* SV_OK if `object` is of the format's context and, by the carrier, a 2D image or a buffer that holds `bytes`
 * from `offset` on; else `due` with a reason that begins with `field`. */
static inline sv_status sva_cl_check_object(sva *a, const char *field, cl_mem object, uint32_t carrier,
                                            uint64_t offset, uint64_t bytes, sv_status due) {
    const int image = carrier == SV_CARRIER_IMAGE;
    const cl_mem_object_type wanted = image ? CL_MEM_OBJECT_IMAGE2D : CL_MEM_OBJECT_BUFFER;
    cl_mem_object_type type = 0;
    cl_context context = NULL;
    size_t size = 0;
    cl_int code = clGetMemObjectInfo(object, CL_MEM_TYPE, sizeof type, &type, NULL);
    if (code == CL_SUCCESS) code = clGetMemObjectInfo(object, CL_MEM_CONTEXT, sizeof context, &context, NULL);
    if (code == CL_SUCCESS) code = clGetMemObjectInfo(object, CL_MEM_SIZE, sizeof size, &size, NULL);
    if (code != CL_SUCCESS)
        return sva_blame(a, due, "%s is no %s: %s (%d)", field, image ? "2D image" : "buffer",
                         sva_cl_name(code), (int)code);
    if (context != a->format.context)
        return sva_blame(a, due, "%s is of another context than the format's", field);
    if (type != wanted)
        return sva_blame(a, due, "%s is no %s: its type is 0x%x", field, image ? "2D image" : "buffer",
                         (unsigned)type);
    if (image || (offset <= size && bytes <= size - offset)) return SV_OK;
    return sva_blame(a, due, "%s has %llu bytes, and %llu are needed from %llu on", field,
                     (unsigned long long)size, (unsigned long long)bytes, (unsigned long long)offset);
}

/* The same for a slab's object, which images must be large enough for and of 8 bits. */
static inline sv_status sva_cl_check_slab(sva *a, const sv_slab *slab) {
    const sv_format *f = &a->format;
    size_t width = 0, height = 0;
    cl_image_format format = {0, 0};
    const size_t wanted = (size_t)f->tiles_x * f->tile_w;
    const size_t rows = (size_t)((slab->slice_count - 1) / f->tiles_x) * f->tile_h + f->height;
    const sv_status s = sva_cl_check_object(a, "slab: object", slab->object, f->carrier, slab->offset,
                                            slab->bytes, SV_ERR_SLAB_SHAPE);
    if (s != SV_OK || f->carrier != SV_CARRIER_IMAGE) return s;
    cl_int code = clGetImageInfo(slab->object, CL_IMAGE_WIDTH, sizeof width, &width, NULL);
    if (code == CL_SUCCESS)
        code = clGetImageInfo(slab->object, CL_IMAGE_HEIGHT, sizeof height, &height, NULL);
    if (code == CL_SUCCESS)
        code = clGetImageInfo(slab->object, CL_IMAGE_FORMAT, sizeof format, &format, NULL);
    if (code != CL_SUCCESS)
        return sva_blame(a, SV_ERR_SLAB_SHAPE, "slab: clGetImageInfo: %s (%d)", sva_cl_name(code), (int)code);
    if (width < wanted || height < rows)
        return sva_blame(a, SV_ERR_SLAB_SHAPE,
                         "slab: the image is %llu x %llu, expected at least %llu x %llu",
                         (unsigned long long)width, (unsigned long long)height, (unsigned long long)wanted,
                         (unsigned long long)rows);
    if (format.image_channel_order == CL_R && (format.image_channel_data_type == CL_UNORM_INT8 ||
                                               format.image_channel_data_type == CL_UNSIGNED_INT8))
        return SV_OK;
    return sva_blame(a, SV_ERR_SLAB_SHAPE,
                     "slab: the image's format is 0x%x, 0x%x, expected CL_R with CL_UNORM_INT8 or "
                     "CL_UNSIGNED_INT8",
                     (unsigned)format.image_channel_order, (unsigned)format.image_channel_data_type);
}

SMARTVIS_END_C

#endif
