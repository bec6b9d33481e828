/* SPDX-License-Identifier: MIT */
#include "validate/drive/drive_device.h"

#include <stdlib.h>
#include <string.h>

enum { MOST_PLATFORMS = 16 };

static cl_device_id first_of(cl_device_type type) {
    cl_platform_id platforms[MOST_PLATFORMS];
    cl_uint count = 0;
    cl_device_id device = NULL;
    if (clGetPlatformIDs(MOST_PLATFORMS, platforms, &count) != CL_SUCCESS) return NULL;
    for (cl_uint i = 0; i < count && i < MOST_PLATFORMS && !device; i++)
        if (clGetDeviceIDs(platforms[i], type, 1, &device, NULL) != CL_SUCCESS) device = NULL;
    return device;
}

void v_device_open(v_run *run, v_device *d) {
    const char *wanted = getenv("SMARTVIS_DEVICE");
    cl_int code = CL_SUCCESS;
    memset(d, 0, sizeof *d);
    v_where(run, "the validator's own OpenCL calls");
    if (!wanted || strcmp(wanted, "cpu") != 0) d->device = first_of(CL_DEVICE_TYPE_GPU);
    if (!d->device && wanted && strcmp(wanted, "cpu") == 0) d->device = first_of(CL_DEVICE_TYPE_CPU);
    if (!d->device && !wanted) d->device = first_of(CL_DEVICE_TYPE_ALL);
    if (!d->device) v_skip(run, "there is no OpenCL device");
    d->context = clCreateContext(NULL, 1, &d->device, NULL, NULL, &code);
    if (code == CL_SUCCESS) d->queue = clCreateCommandQueue(d->context, d->device, 0, &code);
    if (code != CL_SUCCESS) v_skip(run, "the OpenCL device cannot be opened: %d", (int)code);
}

void v_device_close(v_device *d) {
    if (d->queue) (void)clReleaseCommandQueue(d->queue);
    if (d->context) (void)clReleaseContext(d->context);
    memset(d, 0, sizeof *d);
}
