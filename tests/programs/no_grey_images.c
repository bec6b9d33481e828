/* SPDX-License-Identifier: MIT */
/* For LD_PRELOAD: the device has images of four channels and none of one, as PoCL 7.1's has. */
#include <CL/cl.h>

cl_int clGetSupportedImageFormats(cl_context context, cl_mem_flags flags, cl_mem_object_type type,
                                  cl_uint room, cl_image_format *out, cl_uint *count) {
    if (out && room) *out = (cl_image_format){CL_RGBA, CL_UNORM_INT8};
    if (count) *count = 1;
    return CL_SUCCESS;
}

cl_mem clCreateImage(cl_context context, cl_mem_flags flags, const cl_image_format *format,
                     const cl_image_desc *desc, void *host, cl_int *code) {
    if (code) *code = CL_IMAGE_FORMAT_NOT_SUPPORTED;
    return NULL;
}
