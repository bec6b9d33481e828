/* SPDX-License-Identifier: MIT */
/*
 * Which OpenCL device a host takes, or a plugin that the host gives no queue: a helper, header-only and
 * optional, that hosts, plugins and tools of SmartVis share. It needs <CL/cl.h> before it.
 *
 * The order is: GPUs, then CPUs, then all others, each as the platforms list them. The environment variable
 * SMARTVIS_DEVICE, "cpu" or "gpu", leaves the others out; unset or empty it leaves out none. The first device
 * that can be opened is taken. PoCL's are left out where its kernel cache takes nothing, and the process
 * keeps its signal handlers, which a runtime takes when it is asked for devices (smartvis/author_runtime.h).
 */
#ifndef SMARTVIS_DEVICE_H
#define SMARTVIS_DEVICE_H

#ifndef CL_VERSION_1_2
#error "include <CL/cl.h> with CL_TARGET_OPENCL_VERSION 120 or later before smartvis/device.h"
#endif

#include "smartvis/author_runtime.h"
#include "smartvis_plugin.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

SMARTVIS_BEGIN_C

enum { SV_DEVICES_PLATFORMS = 16, SV_DEVICES_MAX = 32, SV_DEVICES_TEXT_BYTES = 1000 };

typedef struct sv_devices {
    uint32_t count;
    cl_device_id id[SV_DEVICES_MAX]; /* in the order in which they are to be tried */
    char why[SV_DEVICES_TEXT_BYTES]; /* why there is none, and what helps; else "" */
} sv_devices;

/* The name of an OpenCL code, "CL_INVALID_VALUE". */
static inline const char *sv_devices_code(cl_int code) {
#define SV_DEVICES_NAME(code)                                                                                \
    case code:                                                                                               \
        return #code
    switch (code) {
        SV_DEVICES_NAME(CL_DEVICE_NOT_FOUND);
        SV_DEVICES_NAME(CL_DEVICE_NOT_AVAILABLE);
        SV_DEVICES_NAME(CL_COMPILER_NOT_AVAILABLE);
        SV_DEVICES_NAME(CL_MEM_OBJECT_ALLOCATION_FAILURE);
        SV_DEVICES_NAME(CL_OUT_OF_RESOURCES);
        SV_DEVICES_NAME(CL_OUT_OF_HOST_MEMORY);
        SV_DEVICES_NAME(CL_PROFILING_INFO_NOT_AVAILABLE);
        SV_DEVICES_NAME(CL_MEM_COPY_OVERLAP);
        SV_DEVICES_NAME(CL_IMAGE_FORMAT_MISMATCH);
        SV_DEVICES_NAME(CL_BUILD_PROGRAM_FAILURE);
        SV_DEVICES_NAME(CL_MISALIGNED_SUB_BUFFER_OFFSET);
        SV_DEVICES_NAME(CL_EXEC_STATUS_ERROR_FOR_EVENTS_IN_WAIT_LIST);
        SV_DEVICES_NAME(CL_INVALID_VALUE);
        SV_DEVICES_NAME(CL_INVALID_DEVICE_TYPE);
        SV_DEVICES_NAME(CL_INVALID_PLATFORM);
        SV_DEVICES_NAME(CL_INVALID_DEVICE);
        SV_DEVICES_NAME(CL_INVALID_CONTEXT);
        SV_DEVICES_NAME(CL_INVALID_QUEUE_PROPERTIES);
        SV_DEVICES_NAME(CL_INVALID_COMMAND_QUEUE);
        SV_DEVICES_NAME(CL_INVALID_HOST_PTR);
        SV_DEVICES_NAME(CL_INVALID_MEM_OBJECT);
        SV_DEVICES_NAME(CL_INVALID_IMAGE_SIZE);
        SV_DEVICES_NAME(CL_INVALID_BINARY);
        SV_DEVICES_NAME(CL_INVALID_BUILD_OPTIONS);
        SV_DEVICES_NAME(CL_INVALID_PROGRAM);
        SV_DEVICES_NAME(CL_INVALID_PROGRAM_EXECUTABLE);
        SV_DEVICES_NAME(CL_INVALID_KERNEL_NAME);
        SV_DEVICES_NAME(CL_INVALID_KERNEL);
        SV_DEVICES_NAME(CL_INVALID_ARG_INDEX);
        SV_DEVICES_NAME(CL_INVALID_ARG_VALUE);
        SV_DEVICES_NAME(CL_INVALID_ARG_SIZE);
        SV_DEVICES_NAME(CL_INVALID_KERNEL_ARGS);
        SV_DEVICES_NAME(CL_INVALID_WORK_DIMENSION);
        SV_DEVICES_NAME(CL_INVALID_WORK_GROUP_SIZE);
        SV_DEVICES_NAME(CL_INVALID_WORK_ITEM_SIZE);
        SV_DEVICES_NAME(CL_INVALID_GLOBAL_OFFSET);
        SV_DEVICES_NAME(CL_INVALID_EVENT_WAIT_LIST);
        SV_DEVICES_NAME(CL_INVALID_EVENT);
        SV_DEVICES_NAME(CL_INVALID_OPERATION);
        SV_DEVICES_NAME(CL_INVALID_BUFFER_SIZE);
        SV_DEVICES_NAME(CL_INVALID_GLOBAL_WORK_SIZE);
    case -1001:
        return "CL_PLATFORM_NOT_FOUND_KHR";
    default:
        return "unnamed OpenCL code";
    }
#undef SV_DEVICES_NAME
}

/* Internal: adds a platform's devices of a type, those that are there already left out. */
static inline cl_int sv_devices_add_(sv_devices *d, cl_platform_id platform, cl_device_type type) {
    cl_device_id found[SV_DEVICES_MAX];
    cl_uint count = 0;
    memset(found, 0, sizeof found);
    const cl_int code = clGetDeviceIDs(platform, type, SV_DEVICES_MAX, found, &count);
    for (cl_uint n = 0; code == CL_SUCCESS && n < count && n < SV_DEVICES_MAX; n++) {
        uint32_t at = 0;
        while (at < d->count && d->id[at] != found[n]) at++;
        if (at == d->count && d->count < SV_DEVICES_MAX) d->id[d->count++] = found[n];
    }
    return code;
}

/* Internal: says why there is none. */
static inline void sv_devices_tell_(sv_devices *d, const char *wish, cl_uint platforms, cl_int code) {
    const char *vendors = getenv("OCL_ICD_VENDORS");
    char places[200] = "";
    if (vendors)
        (void)snprintf(places, sizeof places, " OCL_ICD_VENDORS, where drivers are looked for, is '%.100s'.",
                       vendors);
    (void)snprintf(
        d->why, sizeof d->why,
        "no OpenCL %s%s%s: %s (%d).%s Install a driver (Debian: pocl-opencl-icd); with PoCL, check "
        "that its cache directory (POCL_CACHE_DIR, else ~/.cache/pocl) can be written",
        platforms > 0 ? "device" : "platform", *wish ? " for SMARTVIS_DEVICE=" : "", wish,
        sv_devices_code(code), (int)code, places);
}

/* Internal: true if what a platform's devices compile cannot be kept; d->why says so. */
static inline int sv_devices_cannot_compile_(sv_devices *d, cl_platform_id platform) {
    char name[100];
    memset(name, 0, sizeof name);
    (void)clGetPlatformInfo(platform, CL_PLATFORM_NAME, sizeof name - 1, name, NULL);
    return sva_cache_problem(name, d->why, sizeof d->why);
}

/* Finds the devices there are. Returns how many; if 0, out->why says why. */
static inline uint32_t sv_devices_find(sv_devices *out) {
    static const cl_device_type order[] = {CL_DEVICE_TYPE_GPU, CL_DEVICE_TYPE_CPU, CL_DEVICE_TYPE_ALL};
    cl_platform_id platforms[SV_DEVICES_PLATFORMS];
    cl_uint count = 0, useful = 0;
    cl_int code = CL_SUCCESS;
    sva_handlers host;
    const char *wish = getenv("SMARTVIS_DEVICE");
    memset(out, 0, sizeof *out);
    if (!wish) wish = "";
    const int cpu = strcmp(wish, "cpu") == 0, gpu = strcmp(wish, "gpu") == 0;
    if (*wish && !cpu && !gpu) {
        (void)snprintf(out->why, sizeof out->why, "SMARTVIS_DEVICE is '%.100s', expected 'cpu' or 'gpu'",
                       wish);
        return 0;
    }
    code = clGetPlatformIDs(SV_DEVICES_PLATFORMS, platforms, &count);
    if (code != CL_SUCCESS) count = 0;
    if (count > SV_DEVICES_PLATFORMS) count = SV_DEVICES_PLATFORMS;
    sva_handlers_keep(&host);
    for (cl_uint i = 0; i < count; i++)
        if (!sv_devices_cannot_compile_(out, platforms[i])) platforms[useful++] = platforms[i];
    for (int type = cpu; type < (gpu ? 1 : cpu ? 2 : 3); type++)
        for (cl_uint i = 0; i < useful; i++) code = sv_devices_add_(out, platforms[i], order[type]);
    sva_handlers_put_back(&host);
    if (out->count > 0) out->why[0] = '\0';
    if (out->count == 0 && !out->why[0]) sv_devices_tell_(out, wish, count, code);
    return out->count;
}

/* Finds the devices and opens the first on which a context and an in-order queue of these properties can be
 * made. 1, and the caller releases both; or 0: d->why says why, and all three are NULL. */
static inline int sv_devices_open(sv_devices *d, cl_command_queue_properties properties, cl_device_id *device,
                                  cl_context *context, cl_command_queue *queue) {
    cl_int code = CL_SUCCESS;
    (void)sv_devices_find(d);
    for (uint32_t i = 0; i < d->count; i++) {
        const char *call = "clCreateContext";
        *context = clCreateContext(NULL, 1, &d->id[i], NULL, NULL, &code);
        if (code == CL_SUCCESS) {
            call = "clCreateCommandQueue";
            *queue = clCreateCommandQueue(*context, d->id[i], properties, &code);
            *device = d->id[i];
            if (code == CL_SUCCESS) return 1;
            (void)clReleaseContext(*context);
        }
        (void)snprintf(d->why, sizeof d->why, "the OpenCL device cannot be opened: %s: %s (%d)", call,
                       sv_devices_code(code), (int)code);
    }
    *device = NULL;
    *context = NULL;
    *queue = NULL;
    return 0;
}

SMARTVIS_END_C

#endif
