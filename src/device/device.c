/* SPDX-License-Identifier: MIT */
#include "device/device.h"

#include <stdlib.h>
#include <string.h>

enum { MAX_PLATFORMS = 16 };

/* The first device of a type on any platform, or NULL. *code is the last error that says why not. */
static cl_device_id first_device(cl_device_type type, cl_int *code) {
    cl_platform_id platforms[MAX_PLATFORMS];
    cl_uint count = 0;
    *code = clGetPlatformIDs(MAX_PLATFORMS, platforms, &count);
    if (*code != CL_SUCCESS) return NULL;
    if (count > MAX_PLATFORMS) count = MAX_PLATFORMS;
    for (cl_uint i = 0; i < count; i++) {
        cl_device_id device = NULL;
        *code = clGetDeviceIDs(platforms[i], type, 1, &device, NULL);
        if (*code == CL_SUCCESS && device) return device;
    }
    return NULL;
}

static sv_status select_device(sv_diag *diag, cl_device_id *device) {
    const char *wish = getenv("SMARTVIS_DEVICE");
    cl_int code = CL_SUCCESS;
    *device = NULL;
    if (wish && *wish && strcmp(wish, "cpu") != 0 && strcmp(wish, "gpu") != 0)
        return sva_error(diag, SV_ERR_NO_DEVICE, "SMARTVIS_DEVICE is '%s', expected 'cpu' or 'gpu'", wish);
    if (!wish || strcmp(wish, "cpu") != 0) *device = first_device(CL_DEVICE_TYPE_GPU, &code);
    if (!*device && (!wish || strcmp(wish, "gpu") != 0)) *device = first_device(CL_DEVICE_TYPE_ALL, &code);
    if (*device) return SV_OK;
    return sva_error(
        diag, SV_ERR_NO_DEVICE,
        "no OpenCL device: %s (%d). Install a driver (Debian: pocl-opencl-icd); with PoCL, check that its "
        "cache directory (POCL_CACHE_DIR, else ~/.cache/pocl) can be written",
        sva_cl_name(code), code);
}

/* Asks for the facts that choose the kernels. */
static sv_status query_device(sv_diag *diag, sv_device *d) {
    cl_device_type type = 0;
    cl_bool unified = CL_FALSE;
    cl_int code = clGetDeviceInfo(d->device, CL_DEVICE_TYPE, sizeof type, &type, NULL);
    if (code == CL_SUCCESS)
        code = clGetDeviceInfo(d->device, CL_DEVICE_HOST_UNIFIED_MEMORY, sizeof unified, &unified, NULL);
    if (code == CL_SUCCESS)
        code = clGetDeviceInfo(d->device, CL_DEVICE_MAX_COMPUTE_UNITS, sizeof d->compute_units,
                               &d->compute_units, NULL);
    cl_device_fp_config doubles = 0;
    if (code == CL_SUCCESS)
        code = clGetDeviceInfo(d->device, CL_DEVICE_DOUBLE_FP_CONFIG, sizeof doubles, &doubles, NULL);
    if (code == CL_SUCCESS)
        code = clGetDeviceInfo(d->device, CL_DEVICE_GLOBAL_MEM_SIZE, sizeof d->memory, &d->memory, NULL);
    if (code == CL_SUCCESS)
        code = clGetDeviceInfo(d->device, CL_DEVICE_MAX_MEM_ALLOC_SIZE, sizeof d->largest_buffer,
                               &d->largest_buffer, NULL);
    d->has_doubles = doubles != 0;
    d->is_cpu = (type & CL_DEVICE_TYPE_CPU) != 0;
    d->shares_memory = d->is_cpu && unified;
    return sva_cl_check(diag, code, "clGetDeviceInfo");
}

static sv_status check_host_queue(sv_diag *diag, const sv_device *d) {
    cl_command_queue_properties properties = 0;
    const cl_int code =
        clGetCommandQueueInfo(d->queue, CL_QUEUE_PROPERTIES, sizeof properties, &properties, NULL);
    const sv_status status = sva_cl_check(diag, code, "clGetCommandQueueInfo");
    if (status == SV_OK && (properties & CL_QUEUE_OUT_OF_ORDER_EXEC_MODE_ENABLE))
        return sva_blame(diag, SV_ERR_FORMAT,
                         "activate: the queue is out-of-order, expected an in-order queue");
    return status;
}

sv_status sv_device_open(sv_diag *diag, cl_context context, cl_device_id device, cl_command_queue queue,
                         sv_device *out) {
    *out = (sv_device){.context = context, .device = device, .queue = queue};
    if (context && device && queue) {
        const sv_status status = check_host_queue(diag, out);
        return status == SV_OK ? query_device(diag, out) : status;
    }
    out->owned = true;
    sv_status status = select_device(diag, &out->device);
    if (status != SV_OK) return status;
    cl_int code = CL_SUCCESS;
    out->context = clCreateContext(NULL, 1, &out->device, NULL, NULL, &code);
    status = sva_cl_check(diag, code, "clCreateContext");
    if (status == SV_OK) {
        out->queue = clCreateCommandQueue(out->context, out->device, CL_QUEUE_PROFILING_ENABLE, &code);
        status = sva_cl_check(diag, code, "clCreateCommandQueue");
    }
    if (status == SV_OK) status = query_device(diag, out);
    if (status != SV_OK) sv_device_close(out);
    return status;
}

void sv_device_close(sv_device *device) {
    if (device->owned) {
        if (device->queue) (void)clReleaseCommandQueue(device->queue);
        if (device->context) (void)clReleaseContext(device->context);
    }
    *device = (sv_device){0};
}
