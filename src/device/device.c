/* SPDX-License-Identifier: MIT */
#include "device/device.h"

#include "smartvis/device.h"

#include <stdlib.h>
#include <string.h>

enum { NAME_BYTES = 128 };

/* A cache that cannot take kernels ends the host while they are compiled. */
static sv_status check_platform(sv_diag *diag, cl_platform_id platform, bool *rusticl) {
    char name[NAME_BYTES] = "", problem[SVA_CACHE_TEXT];
    const cl_int code = clGetPlatformInfo(platform, CL_PLATFORM_NAME, sizeof name - 1, name, NULL);
    *rusticl = strstr(name, "rusticl") != NULL;
    if (code != CL_SUCCESS) return sva_cl_check(diag, code, "clGetPlatformInfo");
    return !sva_cache_problem(name, problem, sizeof problem)
               ? SV_OK
               : sva_error(diag, SV_ERR_NO_DEVICE, "activate: %s", problem);
}

/* Mesa 25.0's compiler ends its host at method wall, and spreads depths by the spline to other bits. 26.2
 * gives PoCL's bits where a work item has one ray; for rows of rays it does not end, or not well. */
static sv_status check_rusticl(sv_diag *diag, cl_device_id device) {
    char version[NAME_BYTES] = "";
    const cl_int code = clGetDeviceInfo(device, CL_DRIVER_VERSION, sizeof version - 1, version, NULL);
    char *rest = version;
    const long major = strtol(version, &rest, 10), minor = *rest == '.' ? strtol(rest + 1, NULL, 10) : 0;
    if (code == CL_SUCCESS && (major > 26 || (major == 26 && minor >= 2))) return SV_OK;
    return sva_error(
        diag, SV_ERR_NO_DEVICE,
        "activate: the OpenCL platform 'rusticl' of Mesa %s ends its host while it compiles these kernels, "
        "expected 26.2 or later: take a device of another one, such as PoCL's (SMARTVIS_DEVICE=cpu)",
        version);
}

/* What would end the host while kernels are compiled. */
static sv_status check_runtime(sv_diag *diag, cl_device_id device, bool *rusticl) {
    cl_platform_id platform = NULL;
    const cl_int code = clGetDeviceInfo(device, CL_DEVICE_PLATFORM, sizeof platform, (void *)&platform, NULL);
    if (code != CL_SUCCESS) return sva_cl_check(diag, code, "clGetDeviceInfo");
    const sv_status status = check_platform(diag, platform, rusticl);
    return status == SV_OK && *rusticl ? check_rusticl(diag, device) : status;
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
    d->is_cpu = (type & CL_DEVICE_TYPE_CPU) != 0 && !d->rays_only;
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
    sv_status status = check_runtime(diag, device, &out->rays_only);
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
        if (status == SV_OK) status = check_runtime(diag, device, &out->rays_only);
        return status == SV_OK ? query_device(diag, out) : status;
    }
    sv_devices all;
    sv_status status = SV_OK;
    if (sv_devices_find(&all) == 0) return sva_error(diag, SV_ERR_NO_DEVICE, "%s", all.why);
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
