/* SPDX-License-Identifier: MIT */
#include "device/device.h"

#include <stdlib.h>
#include <string.h>

enum { MAX_PLATFORMS = 16, MAX_DEVICES = 32, NAME_BYTES = 128 };

/* ---- which device */

typedef struct {
    cl_device_id id[MAX_DEVICES];
    uint32_t count;
    cl_int code; /* the last error that says why there is none */
} candidates;

/* Adds the devices of a type on all platforms, those that are there already left out. */
static void add_devices(candidates *c, cl_device_type type) {
    cl_platform_id platforms[MAX_PLATFORMS];
    cl_uint count = 0;
    c->code = clGetPlatformIDs(MAX_PLATFORMS, platforms, &count);
    if (c->code != CL_SUCCESS) return;
    for (cl_uint i = 0; i < count && i < MAX_PLATFORMS; i++) {
        cl_device_id found[MAX_DEVICES] = {NULL};
        cl_uint more = 0;
        const cl_int code = clGetDeviceIDs(platforms[i], type, MAX_DEVICES, found, &more);
        if (code != CL_SUCCESS) c->code = code;
        for (cl_uint n = 0; code == CL_SUCCESS && n < more && n < MAX_DEVICES; n++) {
            uint32_t at = 0;
            while (at < c->count && c->id[at] != found[n]) at++;
            if (at == c->count && c->count < MAX_DEVICES) c->id[c->count++] = found[n];
        }
    }
}

/* The devices to try, in this order: GPUs, then all others; SMARTVIS_DEVICE narrows that. */
static sv_status find_devices(sv_diag *diag, candidates *out) {
    const char *wish = getenv("SMARTVIS_DEVICE"), *vendors = getenv("OCL_ICD_VENDORS");
    const bool any = !wish || !*wish, cpu = !any && strcmp(wish, "cpu") == 0;
    *out = (candidates){.code = CL_DEVICE_NOT_FOUND};
    if (!any && !cpu && strcmp(wish, "gpu") != 0)
        return sva_error(diag, SV_ERR_NO_DEVICE, "SMARTVIS_DEVICE is '%s', expected 'cpu' or 'gpu'", wish);
    if (!cpu) add_devices(out, CL_DEVICE_TYPE_GPU);
    if (cpu) add_devices(out, CL_DEVICE_TYPE_CPU);
    if (any) add_devices(out, CL_DEVICE_TYPE_ALL);
    if (out->count > 0) return SV_OK;
    char places[200] = "";
    if (vendors)
        (void)snprintf(places, sizeof places, " OCL_ICD_VENDORS, where drivers are looked for, is '%.100s'.",
                       vendors);
    return sva_error(
        diag, SV_ERR_NO_DEVICE,
        "no OpenCL device%s%s: %s (%d).%s Install a driver (Debian: pocl-opencl-icd); with PoCL, check "
        "that its cache directory (POCL_CACHE_DIR, else ~/.cache/pocl) can be written",
        any ? "" : " for SMARTVIS_DEVICE=", any ? "" : wish, sva_cl_name(out->code), out->code, places);
}

/* Runtimes whose compiler is known to abort on these kernels, and the host with it. */
static sv_status check_runtime(sv_diag *diag, cl_device_id device) {
    cl_platform_id platform = NULL;
    char name[NAME_BYTES] = "";
    cl_int code = clGetDeviceInfo(device, CL_DEVICE_PLATFORM, sizeof platform, (void *)&platform, NULL);
    if (code == CL_SUCCESS) code = clGetPlatformInfo(platform, CL_PLATFORM_NAME, sizeof name - 1, name, NULL);
    if (code != CL_SUCCESS) return sva_cl_check(diag, code, "clGetPlatformInfo");
    if (!strstr(name, "rusticl")) return SV_OK;
    return sva_error(
        diag, SV_ERR_NO_DEVICE,
        "activate: the OpenCL platform '%s' ends its host while it compiles these kernels: take a "
        "device of another one, such as PoCL's (SMARTVIS_DEVICE=cpu)",
        name);
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

/* A context and a queue of the plugin's own on this device. */
static sv_status open_own(sv_diag *diag, cl_device_id device, sv_device *out) {
    cl_int code = CL_SUCCESS;
    *out = (sv_device){.device = device, .owned = true};
    sv_status status = check_runtime(diag, device);
    if (status != SV_OK) return status;
    out->context = clCreateContext(NULL, 1, &device, NULL, NULL, &code);
    status = sva_cl_check(diag, code, "clCreateContext");
    if (status == SV_OK) {
        out->queue = clCreateCommandQueue(out->context, device, CL_QUEUE_PROFILING_ENABLE, &code);
        status = sva_cl_check(diag, code, "clCreateCommandQueue");
    }
    if (status == SV_OK) status = query_device(diag, out);
    if (status != SV_OK) sv_device_close(out);
    return status;
}

sv_status sv_device_open(sv_diag *diag, cl_context context, cl_device_id device, cl_command_queue queue,
                         sv_device *out) {
    *out = (sv_device){.context = context, .device = device, .queue = queue};
    if (context && device && queue) {
        sv_status status = check_host_queue(diag, out);
        if (status == SV_OK) status = check_runtime(diag, device);
        return status == SV_OK ? query_device(diag, out) : status;
    }
    candidates all;
    sv_status status = find_devices(diag, &all);
    if (status != SV_OK) return status;
    for (uint32_t i = 0; i < all.count; i++) {
        status = open_own(diag, all.id[i], out);
        if (status == SV_OK || i + 1 == all.count) break;
        char name[NAME_BYTES] = "";
        (void)clGetDeviceInfo(all.id[i], CL_DEVICE_NAME, sizeof name - 1, name, NULL);
        sva_say(diag, SV_LOG_WARNING, "activate: the device '%s' does not work; trying the next one", name);
    }
    return status;
}

void sv_device_close(sv_device *device) {
    if (device->owned) {
        if (device->queue) (void)clReleaseCommandQueue(device->queue);
        if (device->context) (void)clReleaseContext(device->context);
    }
    *device = (sv_device){0};
}
