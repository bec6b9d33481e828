/* SPDX-License-Identifier: MIT */
/* The OpenCL functions that cl_spy watches: those that this project's plugin calls, and what plugins of
 * others may call. Each tells cl_spy.c what it was called for. */
#undef CL_TARGET_OPENCL_VERSION
#define CL_TARGET_OPENCL_VERSION 200
#define CL_USE_DEPRECATED_OPENCL_1_2_APIS
#include "validate/spy/cl_spy.h"

#include <dlfcn.h>

/* The real function, looked up once. A runtime of an older OpenCL may not have it. */
#define SPY_REAL(name)                                                                                       \
    static __typeof__(&name) real;                                                                           \
    if (!real) *(void **)(&real) = dlsym(RTLD_NEXT, #name)
#define SPY_ENTER(name, kind) const spy_verdict v = spy_enter(#name, kind, __builtin_return_address(0))

/* Calls that return a code. */
#define SPY_CODE_CALL(name, kind, parameters, arguments)                                                     \
    cl_int name parameters {                                                                                 \
        SPY_REAL(name);                                                                                      \
        SPY_ENTER(name, kind);                                                                               \
        if (v.fails) return spy_code();                                                                      \
        return real ? real arguments : CL_INVALID_OPERATION;                                                 \
    }
/* Calls that return an object. */
#define SPY_OBJECT_CALL(type, name, kind, parameters, arguments)                                             \
    type name parameters {                                                                                   \
        SPY_REAL(name);                                                                                      \
        SPY_ENTER(name, kind);                                                                               \
        if (v.fails || !real) {                                                                              \
            if (errcode) *errcode = v.fails ? spy_code() : CL_INVALID_OPERATION;                             \
            return NULL;                                                                                     \
        }                                                                                                    \
        type object = real arguments;                                                                        \
        if (v.ours && object) spy_alive(1);                                                                  \
        return object;                                                                                       \
    }
#define SPY_CREATE_CALL(type, name, parameters, arguments)                                                   \
    SPY_OBJECT_CALL(type, name, SPY_CREATE, parameters, arguments)
#define SPY_RELEASE_CALL(name, type)                                                                         \
    cl_int name(type object) {                                                                               \
        SPY_REAL(name);                                                                                      \
        SPY_ENTER(name, SPY_RELEASE);                                                                        \
        if (v.ours) spy_alive(-1);                                                                           \
        return real(object);                                                                                 \
    }
#define SPY_RETAIN_CALL(name, type)                                                                          \
    cl_int name(type object) {                                                                               \
        SPY_REAL(name);                                                                                      \
        SPY_ENTER(name, SPY_RETAIN);                                                                         \
        if (v.fails) return spy_code();                                                                      \
        if (v.ours) spy_alive(1);                                                                            \
        return real(object);                                                                                 \
    }
/* Commands: their last parameter is the event. */
#define SPY_ENQUEUE_CALL(name, blocks, parameters, arguments)                                                \
    cl_int name parameters {                                                                                 \
        SPY_REAL(name);                                                                                      \
        SPY_ENTER(name, SPY_ENQUEUE);                                                                        \
        if (v.ours && (blocks)) spy_blocks(#name);                                                           \
        if (v.fails) return spy_code();                                                                      \
        const cl_int code = real arguments;                                                                  \
        if (v.ours && code == CL_SUCCESS) spy_enqueued(event);                                               \
        return code;                                                                                         \
    }

/* ---- what the plugin of this project calls */
SPY_CODE_CALL(clGetPlatformIDs, SPY_QUERY, (cl_uint n, cl_platform_id *out, cl_uint *count), (n, out, count))
SPY_CODE_CALL(clGetDeviceIDs, SPY_QUERY,
              (cl_platform_id platform, cl_device_type type, cl_uint n, cl_device_id *out, cl_uint *count),
              (platform, type, n, out, count))
cl_int clGetDeviceInfo(cl_device_id d, cl_device_info what, size_t n, void *out, size_t *size) {
    SPY_REAL(clGetDeviceInfo);
    SPY_ENTER(clGetDeviceInfo, SPY_QUERY);
    if (v.fails) return spy_code();
    const cl_int code = real(d, what, n, out, size);
    if (v.ours && code == CL_SUCCESS) spy_tells_memory(what, out);
    return code;
}
SPY_CODE_CALL(clGetCommandQueueInfo, SPY_QUERY,
              (cl_command_queue q, cl_command_queue_info what, size_t n, void *out, size_t *size),
              (q, what, n, out, size))
SPY_CODE_CALL(clGetMemObjectInfo, SPY_QUERY, (cl_mem m, cl_mem_info what, size_t n, void *out, size_t *size),
              (m, what, n, out, size))
SPY_CODE_CALL(clGetImageInfo, SPY_QUERY, (cl_mem m, cl_image_info what, size_t n, void *out, size_t *size),
              (m, what, n, out, size))
SPY_CODE_CALL(clGetProgramBuildInfo, SPY_QUERY,
              (cl_program p, cl_device_id d, cl_program_build_info what, size_t n, void *out, size_t *size),
              (p, d, what, n, out, size))
SPY_CODE_CALL(clGetEventProfilingInfo, SPY_QUERY,
              (cl_event e, cl_profiling_info what, size_t n, void *out, size_t *size),
              (e, what, n, out, size))
SPY_CODE_CALL(clSetKernelArg, SPY_QUERY, (cl_kernel k, cl_uint i, size_t n, const void *value),
              (k, i, n, value))
SPY_CODE_CALL(clBuildProgram, SPY_BUILD,
              (cl_program p, cl_uint n, const cl_device_id *devices, const char *options,
               void(CL_CALLBACK *notify)(cl_program, void *), void *data),
              (p, n, devices, options, notify, data))

cl_int clFinish(cl_command_queue queue) {
    SPY_REAL(clFinish);
    SPY_ENTER(clFinish, SPY_WAIT);
    const cl_int code = real(queue);
    if (v.ours) spy_finished();
    return v.fails ? spy_code() : code;
}

SPY_CREATE_CALL(cl_context, clCreateContext,
                (const cl_context_properties *properties, cl_uint n, const cl_device_id *devices,
                 void(CL_CALLBACK *notify)(const char *, const void *, size_t, void *), void *data,
                 cl_int *errcode),
                (properties, n, devices, notify, data, errcode))
SPY_CREATE_CALL(cl_command_queue, clCreateCommandQueue,
                (cl_context c, cl_device_id d, cl_command_queue_properties properties, cl_int *errcode),
                (c, d, properties, errcode))
cl_mem clCreateBuffer(cl_context c, cl_mem_flags flags, size_t n, void *host, cl_int *errcode) {
    SPY_REAL(clCreateBuffer);
    SPY_ENTER(clCreateBuffer, SPY_CREATE);
    if (v.fails) {
        if (errcode) *errcode = spy_code();
        return NULL;
    }
    cl_mem object = real(c, flags, n, host, errcode);
    if (v.ours && object) spy_holds(object, 1);
    return object;
}

cl_int clReleaseMemObject(cl_mem object) {
    SPY_REAL(clReleaseMemObject);
    SPY_ENTER(clReleaseMemObject, SPY_RELEASE);
    if (v.ours) spy_holds(object, -1);
    return real(object);
}

SPY_CREATE_CALL(cl_program, clCreateProgramWithSource,
                (cl_context c, cl_uint n, const char **text, const size_t *lengths, cl_int *errcode),
                (c, n, text, lengths, errcode))
SPY_CREATE_CALL(cl_kernel, clCreateKernel, (cl_program p, const char *name, cl_int *errcode),
                (p, name, errcode))

SPY_RELEASE_CALL(clReleaseContext, cl_context)
SPY_RELEASE_CALL(clReleaseCommandQueue, cl_command_queue)
SPY_RELEASE_CALL(clReleaseProgram, cl_program)
SPY_RELEASE_CALL(clReleaseEvent, cl_event)

cl_int clReleaseKernel(cl_kernel kernel) {
    SPY_REAL(clReleaseKernel);
    SPY_ENTER(clReleaseKernel, SPY_RELEASE);
    if (v.ours) spy_alive(-1);
    spy_forgets(kernel);
    return real(kernel);
}

cl_int clEnqueueNDRangeKernel(cl_command_queue q, cl_kernel k, cl_uint dims, const size_t *offset,
                              const size_t *global, const size_t *local, cl_uint n, const cl_event *wait,
                              cl_event *event) {
    SPY_REAL(clEnqueueNDRangeKernel);
    SPY_ENTER(clEnqueueNDRangeKernel, SPY_ENQUEUE);
    if (v.fails) return spy_code();
    const cl_int code = real(q, k, dims, offset, global, local, n, wait, event);
    if (v.ours && code == CL_SUCCESS) {
        spy_enqueued(event);
        spy_launches(k, dims, local);
    }
    return code;
}

SPY_ENQUEUE_CALL(clEnqueueFillBuffer, false,
                 (cl_command_queue q, cl_mem m, const void *pattern, size_t bytes, size_t offset, size_t size,
                  cl_uint n, const cl_event *wait, cl_event *event),
                 (q, m, pattern, bytes, offset, size, n, wait, event))
SPY_ENQUEUE_CALL(clEnqueueWriteBuffer, block,
                 (cl_command_queue q, cl_mem m, cl_bool block, size_t offset, size_t size, const void *from,
                  cl_uint n, const cl_event *wait, cl_event *event),
                 (q, m, block, offset, size, from, n, wait, event))
cl_int clEnqueueReadBuffer(cl_command_queue q, cl_mem m, cl_bool block, size_t offset, size_t size, void *to,
                           cl_uint n, const cl_event *wait, cl_event *event) {
    SPY_REAL(clEnqueueReadBuffer);
    SPY_ENTER(clEnqueueReadBuffer, SPY_ENQUEUE);
    if (v.ours && block) spy_blocks(__func__);
    if (v.fails) return spy_code();
    const cl_int code = real(q, m, block, offset, size, to, n, wait, event);
    if (v.ours && code == CL_SUCCESS) {
        spy_enqueued(event);
        spy_has_read(q, to, size, 1, size);
    }
    return code;
}
cl_int clEnqueueReadBufferRect(cl_command_queue q, cl_mem m, cl_bool block, const size_t *from,
                               const size_t *to, const size_t *region, size_t row, size_t slice,
                               size_t host_row, size_t host_slice, void *host, cl_uint n,
                               const cl_event *wait, cl_event *event) {
    SPY_REAL(clEnqueueReadBufferRect);
    SPY_ENTER(clEnqueueReadBufferRect, SPY_ENQUEUE);
    if (v.ours && block) spy_blocks(__func__);
    if (v.fails) return spy_code();
    const cl_int code =
        real(q, m, block, from, to, region, row, slice, host_row, host_slice, host, n, wait, event);
    if (v.ours && code == CL_SUCCESS) {
        spy_enqueued(event);
        spy_has_read(q, host, region[0], region[1], host_row);
    }
    return code;
}
SPY_ENQUEUE_CALL(clEnqueueCopyBuffer, false,
                 (cl_command_queue q, cl_mem from, cl_mem to, size_t at, size_t offset, size_t size,
                  cl_uint n, const cl_event *wait, cl_event *event),
                 (q, from, to, at, offset, size, n, wait, event))
SPY_ENQUEUE_CALL(clEnqueueCopyImageToBuffer, false,
                 (cl_command_queue q, cl_mem image, cl_mem buffer, const size_t *from, const size_t *region,
                  size_t offset, cl_uint n, const cl_event *wait, cl_event *event),
                 (q, image, buffer, from, region, offset, n, wait, event))

typedef void(CL_CALLBACK *program_notify)(cl_program, void *);
typedef void(CL_CALLBACK *context_notify)(const char *, const void *, size_t, void *);
typedef void(CL_CALLBACK *native)(void *);

/* ---- what asks */
#define INFO_CALL(name, object, what)                                                                        \
    SPY_CODE_CALL(name, SPY_QUERY, (object o, what w, size_t n, void *out, size_t *size),                    \
                  (o, w, n, out, size))
INFO_CALL(clGetPlatformInfo, cl_platform_id, cl_platform_info)
INFO_CALL(clGetContextInfo, cl_context, cl_context_info)
INFO_CALL(clGetProgramInfo, cl_program, cl_program_info)
INFO_CALL(clGetKernelInfo, cl_kernel, cl_kernel_info)
INFO_CALL(clGetEventInfo, cl_event, cl_event_info)
INFO_CALL(clGetSamplerInfo, cl_sampler, cl_sampler_info)
SPY_CODE_CALL(clGetKernelWorkGroupInfo, SPY_QUERY,
              (cl_kernel k, cl_device_id d, cl_kernel_work_group_info w, size_t n, void *out, size_t *size),
              (k, d, w, n, out, size))
SPY_CODE_CALL(clGetKernelArgInfo, SPY_QUERY,
              (cl_kernel k, cl_uint i, cl_kernel_arg_info w, size_t n, void *out, size_t *size),
              (k, i, w, n, out, size))
SPY_CODE_CALL(clGetSupportedImageFormats, SPY_QUERY,
              (cl_context c, cl_mem_flags flags, cl_mem_object_type type, cl_uint n, cl_image_format *out,
               cl_uint *count),
              (c, flags, type, n, out, count))
SPY_CODE_CALL(clFlush, SPY_QUERY, (cl_command_queue q), (q))
SPY_CODE_CALL(clSetUserEventStatus, SPY_QUERY, (cl_event e, cl_int status), (e, status))
SPY_CODE_CALL(clSetEventCallback, SPY_QUERY,
              (cl_event e, cl_int type, void(CL_CALLBACK *notify)(cl_event, cl_int, void *), void *data),
              (e, type, notify, data))
SPY_CODE_CALL(clSetMemObjectDestructorCallback, SPY_QUERY,
              (cl_mem m, void(CL_CALLBACK *notify)(cl_mem, void *), void *data), (m, notify, data))
SPY_CODE_CALL(clWaitForEvents, SPY_WAIT, (cl_uint n, const cl_event *events), (n, events))
SPY_CODE_CALL(clUnloadPlatformCompiler, SPY_QUERY, (cl_platform_id p), (p))

/* ---- what is made, retained and released */
SPY_CREATE_CALL(cl_context, clCreateContextFromType,
                (const cl_context_properties *properties, cl_device_type type, context_notify notify,
                 void *data, cl_int *errcode),
                (properties, type, notify, data, errcode))
SPY_CREATE_CALL(cl_command_queue, clCreateCommandQueueWithProperties,
                (cl_context c, cl_device_id d, const cl_queue_properties *properties, cl_int *errcode),
                (c, d, properties, errcode))
SPY_CREATE_CALL(cl_mem, clCreateSubBuffer,
                (cl_mem m, cl_mem_flags flags, cl_buffer_create_type type, const void *info, cl_int *errcode),
                (m, flags, type, info, errcode))
SPY_CREATE_CALL(cl_mem, clCreateImage,
                (cl_context c, cl_mem_flags flags, const cl_image_format *format, const cl_image_desc *desc,
                 void *host, cl_int *errcode),
                (c, flags, format, desc, host, errcode))
SPY_CREATE_CALL(cl_sampler, clCreateSampler,
                (cl_context c, cl_bool normalised, cl_addressing_mode mode, cl_filter_mode filter,
                 cl_int *errcode),
                (c, normalised, mode, filter, errcode))
SPY_CREATE_CALL(cl_sampler, clCreateSamplerWithProperties,
                (cl_context c, const cl_sampler_properties *properties, cl_int *errcode),
                (c, properties, errcode))
SPY_CREATE_CALL(cl_event, clCreateUserEvent, (cl_context c, cl_int *errcode), (c, errcode))
SPY_CREATE_CALL(cl_program, clCreateProgramWithBinary,
                (cl_context c, cl_uint n, const cl_device_id *devices, const size_t *lengths,
                 const unsigned char **binaries, cl_int *status, cl_int *errcode),
                (c, n, devices, lengths, binaries, status, errcode))
SPY_CREATE_CALL(cl_program, clCreateProgramWithBuiltInKernels,
                (cl_context c, cl_uint n, const cl_device_id *devices, const char *names, cl_int *errcode),
                (c, n, devices, names, errcode))
SPY_OBJECT_CALL(cl_program, clLinkProgram, SPY_BUILD,
                (cl_context c, cl_uint n, const cl_device_id *devices, const char *options, cl_uint inputs,
                 const cl_program *programs, program_notify notify, void *data, cl_int *errcode),
                (c, n, devices, options, inputs, programs, notify, data, errcode))
SPY_CODE_CALL(clCompileProgram, SPY_BUILD,
              (cl_program p, cl_uint n, const cl_device_id *devices, const char *options, cl_uint headers,
               const cl_program *programs, const char **names, program_notify notify, void *data),
              (p, n, devices, options, headers, programs, names, notify, data))

SPY_RETAIN_CALL(clRetainContext, cl_context)
SPY_RETAIN_CALL(clRetainCommandQueue, cl_command_queue)
SPY_RETAIN_CALL(clRetainMemObject, cl_mem)
SPY_RETAIN_CALL(clRetainProgram, cl_program)
SPY_RETAIN_CALL(clRetainKernel, cl_kernel)
SPY_RETAIN_CALL(clRetainEvent, cl_event)
SPY_RETAIN_CALL(clRetainSampler, cl_sampler)
SPY_RELEASE_CALL(clReleaseSampler, cl_sampler)

/* All kernels of a program at once. */
cl_int clCreateKernelsInProgram(cl_program p, cl_uint n, cl_kernel *out, cl_uint *count) {
    SPY_REAL(clCreateKernelsInProgram);
    SPY_ENTER(clCreateKernelsInProgram, SPY_CREATE);
    if (v.fails) return spy_code();
    cl_uint made = 0;
    const cl_int code = real(p, n, out, &made);
    if (count) *count = made;
    if (v.ours && out && code == CL_SUCCESS) spy_alive((int32_t)made);
    return code;
}

/* ---- commands */
#define WAITS    cl_uint n, const cl_event *wait, cl_event *event
#define ORIGINS  const size_t *from, const size_t *to, const size_t *region
#define PITCHES  size_t row, size_t slice, size_t host_row, size_t host_slice
#define ALL_RECT from, to, region, row, slice, host_row, host_slice
SPY_ENQUEUE_CALL(clEnqueueWriteBufferRect, block,
                 (cl_command_queue q, cl_mem m, cl_bool block, ORIGINS, PITCHES, const void *host, WAITS),
                 (q, m, block, ALL_RECT, host, n, wait, event))
SPY_ENQUEUE_CALL(clEnqueueCopyBufferRect, false,
                 (cl_command_queue q, cl_mem source, cl_mem target, ORIGINS, PITCHES, WAITS),
                 (q, source, target, ALL_RECT, n, wait, event))
SPY_ENQUEUE_CALL(clEnqueueReadImage, block,
                 (cl_command_queue q, cl_mem m, cl_bool block, const size_t *from, const size_t *region,
                  size_t row, size_t slice, void *host, WAITS),
                 (q, m, block, from, region, row, slice, host, n, wait, event))
SPY_ENQUEUE_CALL(clEnqueueWriteImage, block,
                 (cl_command_queue q, cl_mem m, cl_bool block, const size_t *from, const size_t *region,
                  size_t row, size_t slice, const void *host, WAITS),
                 (q, m, block, from, region, row, slice, host, n, wait, event))
SPY_ENQUEUE_CALL(clEnqueueFillImage, false,
                 (cl_command_queue q, cl_mem m, const void *colour, const size_t *from, const size_t *region,
                  WAITS),
                 (q, m, colour, from, region, n, wait, event))
SPY_ENQUEUE_CALL(clEnqueueCopyImage, false,
                 (cl_command_queue q, cl_mem source, cl_mem target, ORIGINS, WAITS),
                 (q, source, target, from, to, region, n, wait, event))
SPY_ENQUEUE_CALL(clEnqueueCopyBufferToImage, false,
                 (cl_command_queue q, cl_mem buffer, cl_mem image, size_t offset, const size_t *to,
                  const size_t *region, WAITS),
                 (q, buffer, image, offset, to, region, n, wait, event))
SPY_ENQUEUE_CALL(clEnqueueUnmapMemObject, false, (cl_command_queue q, cl_mem m, void *mapped, WAITS),
                 (q, m, mapped, n, wait, event))
SPY_ENQUEUE_CALL(clEnqueueMigrateMemObjects, false,
                 (cl_command_queue q, cl_uint count, const cl_mem *objects, cl_mem_migration_flags flags,
                  WAITS),
                 (q, count, objects, flags, n, wait, event))
SPY_ENQUEUE_CALL(clEnqueueTask, false, (cl_command_queue q, cl_kernel k, WAITS), (q, k, n, wait, event))
SPY_ENQUEUE_CALL(clEnqueueMarkerWithWaitList, false, (cl_command_queue q, WAITS), (q, n, wait, event))
SPY_ENQUEUE_CALL(clEnqueueBarrierWithWaitList, false, (cl_command_queue q, WAITS), (q, n, wait, event))
SPY_ENQUEUE_CALL(clEnqueueNativeKernel, false,
                 (cl_command_queue q, native function, void *args, size_t bytes, cl_uint objects,
                  const cl_mem *list, const void **places, WAITS),
                 (q, function, args, bytes, objects, list, places, n, wait, event))

#define MAP_CALL(name, parameters, arguments)                                                                \
    void *name parameters {                                                                                  \
        SPY_REAL(name);                                                                                      \
        SPY_ENTER(name, SPY_ENQUEUE);                                                                        \
        if (v.ours && block) spy_blocks(#name);                                                              \
        if (v.fails) {                                                                                       \
            if (errcode) *errcode = spy_code();                                                              \
            return NULL;                                                                                     \
        }                                                                                                    \
        void *mapped = real arguments;                                                                       \
        if (v.ours && mapped) spy_enqueued(event);                                                           \
        return mapped;                                                                                       \
    }
MAP_CALL(clEnqueueMapBuffer,
         (cl_command_queue q, cl_mem m, cl_bool block, cl_map_flags flags, size_t offset, size_t bytes, WAITS,
          cl_int *errcode),
         (q, m, block, flags, offset, bytes, n, wait, event, errcode))
MAP_CALL(clEnqueueMapImage,
         (cl_command_queue q, cl_mem m, cl_bool block, cl_map_flags flags, const size_t *from,
          const size_t *region, size_t *row, size_t *slice, WAITS, cl_int *errcode),
         (q, m, block, flags, from, region, row, slice, n, wait, event, errcode))
