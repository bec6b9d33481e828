/* SPDX-License-Identifier: MIT */
#include "opencl/host_cl.h"

#include "smartvis/device.h"

#include <string.h>

bool hs_cl_check(cl_int code, const char *call, hs_error *err) {
    if (code == CL_SUCCESS) return true;
    return hs_fail(err, HS_ERR_DEVICE, "OpenCL: %s failed: %s (%d)", call, sv_devices_code(code), (int)code);
}

bool hs_cl_open_bare(hs_cl *cl, hs_error *err) {
    sv_devices devices;
    cl_device_type type = 0;
    memset(cl, 0, sizeof *cl);
    if (!sv_devices_open(&devices, CL_QUEUE_PROFILING_ENABLE, &cl->device, &cl->context, &cl->queue))
        return hs_fail(err, HS_ERR_DEVICE, "%s", devices.why);
    cl_int code = clGetDeviceInfo(cl->device, CL_DEVICE_TYPE, sizeof type, &type, NULL);
    if (!hs_cl_check(code, "clGetDeviceInfo(CL_DEVICE_TYPE)", err)) {
        hs_cl_close(cl);
        return false;
    }
    cl->is_cpu = (type & CL_DEVICE_TYPE_CPU) != 0;
    /* Vectors pay on a CPU; on a GPU the work items themselves are the lanes. */
    cl->lanes = cl->is_cpu ? 16 : 1;
    /* A name longer than the field is an error for OpenCL; for us it is only a caption. */
    code = clGetDeviceInfo(cl->device, CL_DEVICE_NAME, sizeof cl->device_name, cl->device_name, NULL);
    if (code != CL_SUCCESS) memcpy(cl->device_name, "unnamed device", sizeof "unnamed device");
    return true;
}

void hs_cl_close(hs_cl *cl) {
    if (cl->queue) {
        (void)clFinish(cl->queue); /* nothing is left to report to */
        (void)clReleaseCommandQueue(cl->queue);
    }
    if (cl->program) (void)clReleaseProgram(cl->program);
    if (cl->context) (void)clReleaseContext(cl->context);
    memset(cl, 0, sizeof *cl);
}

bool hs_cl_check_images(const hs_cl *cl, hs_error *err) {
    cl_image_format formats[256];
    cl_uint count = 0;
    const cl_int code = clGetSupportedImageFormats(cl->context, CL_MEM_READ_WRITE, CL_MEM_OBJECT_IMAGE2D, 256,
                                                   formats, &count);
    for (cl_uint i = 0; code == CL_SUCCESS && i < count && i < 256; i++)
        if (formats[i].image_channel_order == CL_R && formats[i].image_channel_data_type == CL_UNORM_INT8)
            return true;
    return hs_fail(err, HS_ERR_DEVICE,
                   "carrier image: %s has no images of one channel of 8 bits; take --carrier buffer",
                   cl->device_name);
}
