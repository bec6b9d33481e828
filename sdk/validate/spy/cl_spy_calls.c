/* SPDX-License-Identifier: MIT */
/* The OpenCL functions that cl_spy watches: those that this project's plugin calls, and what plugins of
 * others may call. Each tells cl_spy.c what it was called for. */
#undef CL_TARGET_OPENCL_VERSION
#define CL_TARGET_OPENCL_VERSION 200
#define CL_USE_DEPRECATED_OPENCL_1_2_APIS
#include "validate/spy/cl_spy.h"
#include "validate/spy/library.h"

/* Parameters of these types, named a, b and so on; and the names alone. */
#define SPY_PARAMETERS1(A)                                A a
#define SPY_PARAMETERS2(A, B)                             SPY_PARAMETERS1(A), B b
#define SPY_PARAMETERS3(A, B, C)                          SPY_PARAMETERS2(A, B), C c
#define SPY_PARAMETERS4(A, B, C, D)                       SPY_PARAMETERS3(A, B, C), D d
#define SPY_PARAMETERS5(A, B, C, D, E)                    SPY_PARAMETERS4(A, B, C, D), E e
#define SPY_PARAMETERS6(A, B, C, D, E, F)                 SPY_PARAMETERS5(A, B, C, D, E), F f
#define SPY_PARAMETERS7(A, B, C, D, E, F, G)              SPY_PARAMETERS6(A, B, C, D, E, F), G g
#define SPY_PARAMETERS8(A, B, C, D, E, F, G, H)           SPY_PARAMETERS7(A, B, C, D, E, F, G), H h
#define SPY_PARAMETERS9(A, B, C, D, E, F, G, H, I)        SPY_PARAMETERS8(A, B, C, D, E, F, G, H), I i
#define SPY_PARAMETERS10(A, B, C, D, E, F, G, H, I, J)    SPY_PARAMETERS9(A, B, C, D, E, F, G, H, I), J j
#define SPY_PARAMETERS11(A, B, C, D, E, F, G, H, I, J, K) SPY_PARAMETERS10(A, B, C, D, E, F, G, H, I, J), K k
#define SPY_NAMES1                                        a
#define SPY_NAMES2                                        SPY_NAMES1, b
#define SPY_NAMES3                                        SPY_NAMES2, c
#define SPY_NAMES4                                        SPY_NAMES3, d
#define SPY_NAMES5                                        SPY_NAMES4, e
#define SPY_NAMES6                                        SPY_NAMES5, f
#define SPY_NAMES7                                        SPY_NAMES6, g
#define SPY_NAMES8                                        SPY_NAMES7, h
#define SPY_NAMES9                                        SPY_NAMES8, i
#define SPY_NAMES10                                       SPY_NAMES9, j
#define SPY_NAMES11                                       SPY_NAMES10, k

/* The real function, looked up once. A runtime of an older OpenCL may not have it. */
#define SPY_REAL(name)                                                                                       \
    static __typeof__(&name) real;                                                                           \
    if (!real) *(void **)(&real) = library_next(#name)
#define SPY_ENTER(name, kind)                                                                                \
    SPY_REAL(name);                                                                                          \
    const spy_verdict v __attribute__((cleanup(spy_leave))) =                                                \
        spy_enter(#name, kind, __builtin_return_address(0))

/* In what follows, `count` types are those of the first parameters, and `then` is done behind a success of
 * the watched library's. Calls that return a code: */
#define SPY_CODE_CALL_THEN(name, kind, then, count, ...)                                                     \
    cl_int name(SPY_PARAMETERS##count(__VA_ARGS__)) {                                                        \
        SPY_ENTER(name, kind);                                                                               \
        if (v.fails) return spy_code();                                                                      \
        const cl_int code = real ? real(SPY_NAMES##count) : CL_INVALID_OPERATION;                            \
        if (v.ours && code == CL_SUCCESS) then;                                                              \
        return code;                                                                                         \
    }
#define SPY_CODE_CALL(name, kind, ...) SPY_CODE_CALL_THEN(name, kind, (void)0, __VA_ARGS__)
#define SPY_INFO_CALL(name, object, what)                                                                    \
    SPY_CODE_CALL(name, SPY_QUERY, 5, object, what, size_t, void *, size_t *)
#define SPY_RETAIN_CALL(name, type) SPY_CODE_CALL_THEN(name, SPY_RETAIN, spy_alive(1), 1, type)
/* Calls that return an object, and have a place for a code at their end: */
#define SPY_OBJECT_CALL(type, name, kind, then, count, ...)                                                  \
    type name(SPY_PARAMETERS##count(__VA_ARGS__), cl_int *errcode) {                                         \
        SPY_ENTER(name, kind);                                                                               \
        if (v.fails || !real) {                                                                              \
            if (errcode) *errcode = v.fails ? spy_code() : CL_INVALID_OPERATION;                             \
            return NULL;                                                                                     \
        }                                                                                                    \
        type object = real(SPY_NAMES##count, errcode);                                                       \
        if (v.ours && object) then;                                                                          \
        return object;                                                                                       \
    }
#define SPY_CREATE_CALL(type, name, ...) SPY_OBJECT_CALL(type, name, SPY_CREATE, spy_alive(1), __VA_ARGS__)
#define SPY_RELEASE_CALL(name, type, gone)                                                                   \
    cl_int name(type object) {                                                                               \
        SPY_ENTER(name, SPY_RELEASE);                                                                        \
        if (v.ours) gone;                                                                                    \
        return real(object);                                                                                 \
    }
/* Commands: their last parameters are what they wait for, and their event. */
#define SPY_COMMAND_THEN(name, blocks, then, count, ...)                                                     \
    cl_int name(SPY_PARAMETERS##count(__VA_ARGS__), cl_uint n, const cl_event *wait, cl_event *event) {      \
        SPY_ENTER(name, SPY_ENQUEUE);                                                                        \
        if (v.ours && (blocks)) spy_blocks(#name);                                                           \
        if (v.fails) return spy_code();                                                                      \
        const cl_int code = real(SPY_NAMES##count, n, wait, event);                                          \
        if (v.ours && code == CL_SUCCESS) {                                                                  \
            spy_enqueued(event);                                                                             \
            then;                                                                                            \
        }                                                                                                    \
        return code;                                                                                         \
    }
#define SPY_COMMAND(name, blocks, ...) SPY_COMMAND_THEN(name, blocks, (void)0, __VA_ARGS__)
#define SPY_MAP_CALL(name, count, ...)                                                                       \
    void *name(SPY_PARAMETERS##count(__VA_ARGS__), cl_uint n, const cl_event *wait, cl_event *event,         \
               cl_int *errcode) {                                                                            \
        SPY_ENTER(name, SPY_ENQUEUE);                                                                        \
        if (v.ours && c) spy_blocks(#name);                                                                  \
        if (v.fails) {                                                                                       \
            if (errcode) *errcode = spy_code();                                                              \
            return NULL;                                                                                     \
        }                                                                                                    \
        void *mapped = real(SPY_NAMES##count, n, wait, event, errcode);                                      \
        if (v.ours && mapped) spy_enqueued(event);                                                           \
        return mapped;                                                                                       \
    }

typedef void(CL_CALLBACK *context_notify)(const char *, const void *, size_t, void *);
typedef void(CL_CALLBACK *program_notify)(cl_program, void *);
typedef void(CL_CALLBACK *event_notify)(cl_event, cl_int, void *);
typedef void(CL_CALLBACK *memory_notify)(cl_mem, void *);
typedef void(CL_CALLBACK *native)(void *);
typedef const size_t *sizes;

/* ---- what asks */
SPY_CODE_CALL(clGetPlatformIDs, SPY_QUERY, 3, cl_uint, cl_platform_id *, cl_uint *)
SPY_CODE_CALL(clGetDeviceIDs, SPY_QUERY, 5, cl_platform_id, cl_device_type, cl_uint, cl_device_id *,
              cl_uint *)
SPY_CODE_CALL_THEN(clGetDeviceInfo, SPY_QUERY, spy_tells_memory(b, d), 5, cl_device_id, cl_device_info,
                   size_t, void *, size_t *)
SPY_INFO_CALL(clGetPlatformInfo, cl_platform_id, cl_platform_info)
SPY_INFO_CALL(clGetContextInfo, cl_context, cl_context_info)
SPY_INFO_CALL(clGetCommandQueueInfo, cl_command_queue, cl_command_queue_info)
SPY_INFO_CALL(clGetMemObjectInfo, cl_mem, cl_mem_info)
SPY_INFO_CALL(clGetImageInfo, cl_mem, cl_image_info)
SPY_INFO_CALL(clGetProgramInfo, cl_program, cl_program_info)
SPY_INFO_CALL(clGetKernelInfo, cl_kernel, cl_kernel_info)
SPY_INFO_CALL(clGetEventInfo, cl_event, cl_event_info)
SPY_INFO_CALL(clGetEventProfilingInfo, cl_event, cl_profiling_info)
SPY_INFO_CALL(clGetSamplerInfo, cl_sampler, cl_sampler_info)
SPY_CODE_CALL(clGetProgramBuildInfo, SPY_QUERY, 6, cl_program, cl_device_id, cl_program_build_info, size_t,
              void *, size_t *)
SPY_CODE_CALL(clGetKernelWorkGroupInfo, SPY_QUERY, 6, cl_kernel, cl_device_id, cl_kernel_work_group_info,
              size_t, void *, size_t *)
SPY_CODE_CALL(clGetKernelArgInfo, SPY_QUERY, 6, cl_kernel, cl_uint, cl_kernel_arg_info, size_t, void *,
              size_t *)
SPY_CODE_CALL(clGetSupportedImageFormats, SPY_QUERY, 6, cl_context, cl_mem_flags, cl_mem_object_type, cl_uint,
              cl_image_format *, cl_uint *)
SPY_CODE_CALL(clSetKernelArg, SPY_QUERY, 4, cl_kernel, cl_uint, size_t, const void *)
SPY_CODE_CALL(clFlush, SPY_QUERY, 1, cl_command_queue)
SPY_CODE_CALL(clSetUserEventStatus, SPY_QUERY, 2, cl_event, cl_int)
SPY_CODE_CALL(clSetEventCallback, SPY_QUERY, 4, cl_event, cl_int, event_notify, void *)
SPY_CODE_CALL(clSetMemObjectDestructorCallback, SPY_QUERY, 3, cl_mem, memory_notify, void *)
SPY_CODE_CALL(clUnloadPlatformCompiler, SPY_QUERY, 1, cl_platform_id)

/* ---- what waits, and what builds */
SPY_CODE_CALL(clWaitForEvents, SPY_WAIT, 2, cl_uint, const cl_event *)
cl_int clFinish(cl_command_queue queue) {
    SPY_ENTER(clFinish, SPY_WAIT);
    const cl_int code = real(queue);
    if (v.ours) spy_finished();
    return v.fails ? spy_code() : code;
}
SPY_CODE_CALL(clBuildProgram, SPY_BUILD, 6, cl_program, cl_uint, const cl_device_id *, const char *,
              program_notify, void *)
SPY_CODE_CALL(clCompileProgram, SPY_BUILD, 9, cl_program, cl_uint, const cl_device_id *, const char *,
              cl_uint, const cl_program *, const char **, program_notify, void *)
SPY_OBJECT_CALL(cl_program, clLinkProgram, SPY_BUILD, spy_alive(1), 8, cl_context, cl_uint,
                const cl_device_id *, const char *, cl_uint, const cl_program *, program_notify, void *)

/* ---- what is made, retained and released */
SPY_CREATE_CALL(cl_context, clCreateContext, 5, const cl_context_properties *, cl_uint, const cl_device_id *,
                context_notify, void *)
SPY_CREATE_CALL(cl_context, clCreateContextFromType, 4, const cl_context_properties *, cl_device_type,
                context_notify, void *)
SPY_CREATE_CALL(cl_command_queue, clCreateCommandQueue, 3, cl_context, cl_device_id,
                cl_command_queue_properties)
SPY_CREATE_CALL(cl_command_queue, clCreateCommandQueueWithProperties, 3, cl_context, cl_device_id,
                const cl_queue_properties *)
SPY_OBJECT_CALL(cl_mem, clCreateBuffer, SPY_CREATE, spy_holds(object, 1), 4, cl_context, cl_mem_flags, size_t,
                void *)
SPY_CREATE_CALL(cl_mem, clCreateSubBuffer, 4, cl_mem, cl_mem_flags, cl_buffer_create_type, const void *)
SPY_CREATE_CALL(cl_mem, clCreateImage, 5, cl_context, cl_mem_flags, const cl_image_format *,
                const cl_image_desc *, void *)
SPY_CREATE_CALL(cl_sampler, clCreateSampler, 4, cl_context, cl_bool, cl_addressing_mode, cl_filter_mode)
SPY_CREATE_CALL(cl_sampler, clCreateSamplerWithProperties, 2, cl_context, const cl_sampler_properties *)
SPY_CREATE_CALL(cl_event, clCreateUserEvent, 1, cl_context)
SPY_CREATE_CALL(cl_program, clCreateProgramWithSource, 4, cl_context, cl_uint, const char **, sizes)
SPY_CREATE_CALL(cl_program, clCreateProgramWithBinary, 6, cl_context, cl_uint, const cl_device_id *, sizes,
                const unsigned char **, cl_int *)
SPY_CREATE_CALL(cl_program, clCreateProgramWithBuiltInKernels, 4, cl_context, cl_uint, const cl_device_id *,
                const char *)
SPY_CREATE_CALL(cl_kernel, clCreateKernel, 2, cl_program, const char *)
/* All kernels of a program at once. */
cl_int clCreateKernelsInProgram(cl_program p, cl_uint n, cl_kernel *out, cl_uint *count) {
    SPY_ENTER(clCreateKernelsInProgram, SPY_CREATE);
    if (v.fails) return spy_code();
    cl_uint made = 0;
    const cl_int code = real(p, n, out, &made);
    if (count) *count = made;
    if (v.ours && out && code == CL_SUCCESS) spy_alive((int32_t)made);
    return code;
}

SPY_RETAIN_CALL(clRetainContext, cl_context)
SPY_RETAIN_CALL(clRetainCommandQueue, cl_command_queue)
SPY_RETAIN_CALL(clRetainMemObject, cl_mem)
SPY_RETAIN_CALL(clRetainProgram, cl_program)
SPY_RETAIN_CALL(clRetainKernel, cl_kernel)
SPY_RETAIN_CALL(clRetainEvent, cl_event)
SPY_RETAIN_CALL(clRetainSampler, cl_sampler)

SPY_RELEASE_CALL(clReleaseContext, cl_context, spy_alive(-1))
SPY_RELEASE_CALL(clReleaseCommandQueue, cl_command_queue, spy_alive(-1))
SPY_RELEASE_CALL(clReleaseMemObject, cl_mem, spy_holds(object, -1))
SPY_RELEASE_CALL(clReleaseProgram, cl_program, spy_alive(-1))
SPY_RELEASE_CALL(clReleaseEvent, cl_event, spy_alive(-1))
SPY_RELEASE_CALL(clReleaseSampler, cl_sampler, spy_alive(-1))
cl_int clReleaseKernel(cl_kernel kernel) {
    SPY_ENTER(clReleaseKernel, SPY_RELEASE);
    if (v.ours) spy_alive(-1);
    spy_forgets(kernel);
    return real(kernel);
}

/* ---- commands */
/* A launch that is followed has an event, asked for or not. */
cl_int clEnqueueNDRangeKernel(SPY_PARAMETERS6(cl_command_queue, cl_kernel, cl_uint, sizes, sizes, sizes),
                              cl_uint n, const cl_event *wait, cl_event *event) {
    SPY_ENTER(clEnqueueNDRangeKernel, SPY_ENQUEUE);
    cl_event own = NULL, *told = event || !spy_wants_work() ? event : &own;
    if (v.fails) return spy_code();
    const cl_int code = real(SPY_NAMES6, n, wait, told);
    if (code == CL_SUCCESS && told && spy_wants_work()) spy_follows(b, *told);
    if (own) (void)clReleaseEvent(own);
    if (!v.ours || code != CL_SUCCESS) return code;
    spy_enqueued(event);
    spy_launches(b, c, f);
    return code;
}
SPY_COMMAND_THEN(clEnqueueReadBuffer, c, spy_has_read(a, f, e, 1, e), 6, cl_command_queue, cl_mem, cl_bool,
                 size_t, size_t, void *)
SPY_COMMAND_THEN(clEnqueueReadBufferRect, c, spy_has_read(a, k, f[0], f[1], i), 11, cl_command_queue, cl_mem,
                 cl_bool, sizes, sizes, sizes, size_t, size_t, size_t, size_t, void *)
SPY_COMMAND(clEnqueueWriteBuffer, c, 6, cl_command_queue, cl_mem, cl_bool, size_t, size_t, const void *)
SPY_COMMAND(clEnqueueWriteBufferRect, c, 11, cl_command_queue, cl_mem, cl_bool, sizes, sizes, sizes, size_t,
            size_t, size_t, size_t, const void *)
SPY_COMMAND(clEnqueueFillBuffer, false, 6, cl_command_queue, cl_mem, const void *, size_t, size_t, size_t)
SPY_COMMAND(clEnqueueCopyBuffer, false, 6, cl_command_queue, cl_mem, cl_mem, size_t, size_t, size_t)
SPY_COMMAND(clEnqueueCopyBufferRect, false, 10, cl_command_queue, cl_mem, cl_mem, sizes, sizes, sizes, size_t,
            size_t, size_t, size_t)
SPY_COMMAND(clEnqueueReadImage, c, 8, cl_command_queue, cl_mem, cl_bool, sizes, sizes, size_t, size_t, void *)
SPY_COMMAND(clEnqueueWriteImage, c, 8, cl_command_queue, cl_mem, cl_bool, sizes, sizes, size_t, size_t,
            const void *)
SPY_COMMAND(clEnqueueFillImage, false, 5, cl_command_queue, cl_mem, const void *, sizes, sizes)
SPY_COMMAND(clEnqueueCopyImage, false, 6, cl_command_queue, cl_mem, cl_mem, sizes, sizes, sizes)
SPY_COMMAND(clEnqueueCopyImageToBuffer, false, 6, cl_command_queue, cl_mem, cl_mem, sizes, sizes, size_t)
SPY_COMMAND(clEnqueueCopyBufferToImage, false, 6, cl_command_queue, cl_mem, cl_mem, size_t, sizes, sizes)
SPY_COMMAND(clEnqueueUnmapMemObject, false, 3, cl_command_queue, cl_mem, void *)
SPY_COMMAND(clEnqueueMigrateMemObjects, false, 4, cl_command_queue, cl_uint, const cl_mem *,
            cl_mem_migration_flags)
SPY_COMMAND(clEnqueueTask, false, 2, cl_command_queue, cl_kernel)
SPY_COMMAND(clEnqueueMarkerWithWaitList, false, 1, cl_command_queue)
SPY_COMMAND(clEnqueueBarrierWithWaitList, false, 1, cl_command_queue)
SPY_COMMAND(clEnqueueNativeKernel, false, 7, cl_command_queue, native, void *, size_t, cl_uint,
            const cl_mem *, const void **)
SPY_MAP_CALL(clEnqueueMapBuffer, 6, cl_command_queue, cl_mem, cl_bool, cl_map_flags, size_t, size_t)
SPY_MAP_CALL(clEnqueueMapImage, 8, cl_command_queue, cl_mem, cl_bool, cl_map_flags, sizes, sizes, size_t *,
             size_t *)
