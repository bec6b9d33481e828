/* SPDX-License-Identifier: MIT */
#include "opencl/host_cl.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define MAX_PLATFORMS 16

static const struct {
    cl_int code;
    const char *name;
} code_names[] = {
    {CL_DEVICE_NOT_FOUND, "CL_DEVICE_NOT_FOUND"},
    {CL_DEVICE_NOT_AVAILABLE, "CL_DEVICE_NOT_AVAILABLE"},
    {CL_COMPILER_NOT_AVAILABLE, "CL_COMPILER_NOT_AVAILABLE"},
    {CL_MEM_OBJECT_ALLOCATION_FAILURE, "CL_MEM_OBJECT_ALLOCATION_FAILURE"},
    {CL_OUT_OF_RESOURCES, "CL_OUT_OF_RESOURCES"},
    {CL_OUT_OF_HOST_MEMORY, "CL_OUT_OF_HOST_MEMORY"},
    {CL_PROFILING_INFO_NOT_AVAILABLE, "CL_PROFILING_INFO_NOT_AVAILABLE"},
    {CL_BUILD_PROGRAM_FAILURE, "CL_BUILD_PROGRAM_FAILURE"},
    {CL_MISALIGNED_SUB_BUFFER_OFFSET, "CL_MISALIGNED_SUB_BUFFER_OFFSET"},
    {CL_EXEC_STATUS_ERROR_FOR_EVENTS_IN_WAIT_LIST, "CL_EXEC_STATUS_ERROR_FOR_EVENTS_IN_WAIT_LIST"},
    {CL_INVALID_VALUE, "CL_INVALID_VALUE"},
    {CL_INVALID_DEVICE, "CL_INVALID_DEVICE"},
    {CL_INVALID_CONTEXT, "CL_INVALID_CONTEXT"},
    {CL_INVALID_COMMAND_QUEUE, "CL_INVALID_COMMAND_QUEUE"},
    {CL_INVALID_HOST_PTR, "CL_INVALID_HOST_PTR"},
    {CL_INVALID_MEM_OBJECT, "CL_INVALID_MEM_OBJECT"},
    {CL_INVALID_BUILD_OPTIONS, "CL_INVALID_BUILD_OPTIONS"},
    {CL_INVALID_PROGRAM, "CL_INVALID_PROGRAM"},
    {CL_INVALID_PROGRAM_EXECUTABLE, "CL_INVALID_PROGRAM_EXECUTABLE"},
    {CL_INVALID_KERNEL_NAME, "CL_INVALID_KERNEL_NAME"},
    {CL_INVALID_KERNEL, "CL_INVALID_KERNEL"},
    {CL_INVALID_ARG_INDEX, "CL_INVALID_ARG_INDEX"},
    {CL_INVALID_ARG_VALUE, "CL_INVALID_ARG_VALUE"},
    {CL_INVALID_ARG_SIZE, "CL_INVALID_ARG_SIZE"},
    {CL_INVALID_KERNEL_ARGS, "CL_INVALID_KERNEL_ARGS"},
    {CL_INVALID_WORK_DIMENSION, "CL_INVALID_WORK_DIMENSION"},
    {CL_INVALID_WORK_GROUP_SIZE, "CL_INVALID_WORK_GROUP_SIZE"},
    {CL_INVALID_WORK_ITEM_SIZE, "CL_INVALID_WORK_ITEM_SIZE"},
    {CL_INVALID_GLOBAL_OFFSET, "CL_INVALID_GLOBAL_OFFSET"},
    {CL_INVALID_EVENT_WAIT_LIST, "CL_INVALID_EVENT_WAIT_LIST"},
    {CL_INVALID_EVENT, "CL_INVALID_EVENT"},
    {CL_INVALID_OPERATION, "CL_INVALID_OPERATION"},
    {CL_INVALID_BUFFER_SIZE, "CL_INVALID_BUFFER_SIZE"},
    {CL_INVALID_GLOBAL_WORK_SIZE, "CL_INVALID_GLOBAL_WORK_SIZE"},
    {-1001, "CL_PLATFORM_NOT_FOUND_KHR"},
};

bool hs_cl_check(cl_int code, const char *call, hs_error *err) {
    if (code == CL_SUCCESS) return true;
    const char *name = "unknown code";
    for (size_t i = 0; i < sizeof code_names / sizeof code_names[0]; i++) {
        if (code_names[i].code == code) name = code_names[i].name;
    }
    return hs_fail(err, HS_ERR_DEVICE, "OpenCL: %s failed: %s (%d)", call, name, (int)code);
}

/* The first device of `type` on any platform; NULL if there is none. */
static cl_device_id find_device(const cl_platform_id *platforms, cl_uint count, cl_device_type type) {
    for (cl_uint i = 0; i < count; i++) {
        cl_device_id device = NULL;
        if (clGetDeviceIDs(platforms[i], type, 1, &device, NULL) == CL_SUCCESS && device) return device;
    }
    return NULL;
}

static bool select_device(hs_cl *cl, hs_error *err) {
    static const char cure[] =
        "install an OpenCL driver (Debian: pocl-opencl-icd), and see that the kernel cache "
        "folder (POCL_CACHE_DIR, else ~/.cache/pocl) can be written";
    const char *wish = getenv("SMARTVIS_DEVICE");
    bool want_cpu = wish && strcmp(wish, "cpu") == 0;
    bool want_gpu = wish && strcmp(wish, "gpu") == 0;
    if (wish && *wish && !want_cpu && !want_gpu) {
        return hs_fail(err, HS_ERR_DEVICE, "SMARTVIS_DEVICE is '%s', expected 'cpu' or 'gpu'", wish);
    }
    cl_platform_id platforms[MAX_PLATFORMS];
    cl_uint count = 0;
    cl_int code = clGetPlatformIDs(MAX_PLATFORMS, platforms, &count);
    const char *vendors = getenv("OCL_ICD_VENDORS");
    if (code != CL_SUCCESS || count == 0)
        return hs_fail(err, HS_ERR_DEVICE, "no OpenCL platform (clGetPlatformIDs: %d): %s%.100s%s%s",
                       (int)code, vendors ? "OCL_ICD_VENDORS, where drivers are looked for, is '" : "",
                       vendors ? vendors : "", vendors ? "'; " : "", cure);
    if (count > MAX_PLATFORMS) count = MAX_PLATFORMS;
    if (!want_cpu) cl->device = find_device(platforms, count, CL_DEVICE_TYPE_GPU);
    if (!cl->device && !want_gpu) cl->device = find_device(platforms, count, CL_DEVICE_TYPE_CPU);
    if (!cl->device && !want_cpu && !want_gpu) {
        cl->device = find_device(platforms, count, CL_DEVICE_TYPE_ALL);
    }
    if (cl->device) return true;
    return hs_fail(err, HS_ERR_DEVICE, "no OpenCL device%s%s on %u platform(s): %s",
                   want_cpu || want_gpu ? " for SMARTVIS_DEVICE=" : "", want_cpu || want_gpu ? wish : "",
                   (unsigned)count, cure);
}

bool hs_cl_open_bare(hs_cl *cl, hs_error *err) {
    memset(cl, 0, sizeof *cl);
    if (!select_device(cl, err)) return false;
    cl_device_type type = 0;
    cl_int code = clGetDeviceInfo(cl->device, CL_DEVICE_TYPE, sizeof type, &type, NULL);
    if (!hs_cl_check(code, "clGetDeviceInfo(CL_DEVICE_TYPE)", err)) goto fail;
    cl->is_cpu = (type & CL_DEVICE_TYPE_CPU) != 0;
    /* Vectors pay on a CPU; on a GPU the work items themselves are the lanes. */
    cl->lanes = cl->is_cpu ? 16 : 1;
    /* A name longer than the field is an error for OpenCL; for us it is only a caption. */
    code = clGetDeviceInfo(cl->device, CL_DEVICE_NAME, sizeof cl->device_name, cl->device_name, NULL);
    if (code != CL_SUCCESS) memcpy(cl->device_name, "unnamed device", sizeof "unnamed device");
    cl->context = clCreateContext(NULL, 1, &cl->device, NULL, NULL, &code);
    if (!hs_cl_check(code, "clCreateContext", err)) goto fail;
    cl->queue = clCreateCommandQueue(cl->context, cl->device, CL_QUEUE_PROFILING_ENABLE, &code);
    if (!hs_cl_check(code, "clCreateCommandQueue", err)) goto fail;
    return true;
fail:
    hs_cl_close(cl);
    return false;
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
