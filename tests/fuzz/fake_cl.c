/* SPDX-License-Identifier: MIT */
#include "fuzz/fake_cl.h"

#include "frame/selftest.h"
#include "fuzz/fuzz_target.h"

#include <CL/cl.h>
#include <stdlib.h>
#include <string.h>

#define MEMORY (UINT64_C(64) << 20) /* of the device: formats that need more are refused */

/* What has no field of use is made all the same, so that it must be released. */
struct _cl_context {
    int nothing;
};
struct _cl_command_queue {
    int nothing;
};
struct _cl_event {
    int nothing;
};
struct _cl_program {
    int built;
};
struct _cl_kernel {
    uint32_t args; /* bits of those that are set */
    uint8_t sum;   /* of the last one's bytes, so that they are read */
};
struct _cl_mem {
    uint8_t *data;
    size_t bytes, pitch; /* pitch: of an image */
    cl_context context;
    cl_mem_flags borrowed;
};

static char place[2]; /* addresses that nobody reads */
#define THE_PLATFORM ((cl_platform_id)(void *)&place[0])
#define THE_DEVICE   ((cl_device_id)(void *)&place[1])

static uint32_t fails_in;

void fake_cl_fail(uint32_t nth) {
    fails_in = nth;
}

static cl_int step(void) {
    return fails_in > 0 && --fails_in == 0 ? CL_OUT_OF_RESOURCES : CL_SUCCESS;
}

static void *make(size_t bytes, cl_int *code) {
    *code = step();
    return *code == CL_SUCCESS ? calloc(1, bytes) : NULL;
}

static cl_int tell(const void *value, size_t bytes, size_t room, void *out, size_t *told) {
    if (told) *told = bytes;
    if (out && bytes > room) return CL_INVALID_VALUE;
    if (out) memcpy(out, value, bytes);
    return CL_SUCCESS;
}

/* A command was enqueued, and is done. */
static cl_int done(cl_event *event) {
    const cl_int code = step();
    if (event) *event = NULL;
    if (event && code == CL_SUCCESS) *event = calloc(1, sizeof **event);
    return code;
}

/* ---- the self-test, which no device without kernels passes: it stands in for src/frame/selftest*.c */
sv_status sv_selftest(sv_diag *diag, const sv_device *device, const sv_program *narrow,
                      const sv_program *wide, const sv_config *config, const sv_values *defaults) {
    (void)diag, (void)device, (void)narrow, (void)wide, (void)config, (void)defaults;
    return SV_OK;
}

sv_status sv_selftest_method(sv_diag *diag, const sv_device *device, const sv_program *narrow,
                             const sv_program *wide, const sv_config *config, const sv_values *defaults) {
    return sv_selftest(diag, device, narrow, wide, config, defaults);
}

/* ---- platform, device, context, queue */
cl_int clGetPlatformIDs(cl_uint room, cl_platform_id *out, cl_uint *count) {
    if (out && room) out[0] = THE_PLATFORM;
    if (count) *count = 1;
    return CL_SUCCESS;
}

cl_int clGetDeviceIDs(cl_platform_id platform, cl_device_type type, cl_uint room, cl_device_id *out,
                      cl_uint *count) {
    (void)platform;
    if (type == CL_DEVICE_TYPE_GPU) return CL_DEVICE_NOT_FOUND;
    if (out && room) out[0] = THE_DEVICE;
    if (count) *count = 1;
    return CL_SUCCESS;
}

cl_int clGetPlatformInfo(cl_platform_id platform, cl_platform_info what, size_t room, void *out,
                         size_t *bytes) {
    (void)platform, (void)what;
    return tell("copies", sizeof "copies", room, out, bytes);
}

cl_int clGetDeviceInfo(cl_device_id device, cl_device_info what, size_t room, void *out, size_t *bytes) {
    static const cl_ulong memory = MEMORY, largest = MEMORY / 2;
    static const cl_bool unified = CL_TRUE;
    static const cl_uint units = 2;
    cl_bitfield bits = what == CL_DEVICE_TYPE ? CL_DEVICE_TYPE_CPU : CL_FP_FMA;
    (void)device;
    switch (what) {
    case CL_DEVICE_GLOBAL_MEM_SIZE:
        return tell(&memory, sizeof memory, room, out, bytes);
    case CL_DEVICE_MAX_MEM_ALLOC_SIZE:
        return tell(&largest, sizeof largest, room, out, bytes);
    case CL_DEVICE_HOST_UNIFIED_MEMORY:
        return tell(&unified, sizeof unified, room, out, bytes);
    case CL_DEVICE_MAX_COMPUTE_UNITS:
        return tell(&units, sizeof units, room, out, bytes);
    default:
        return tell(&bits, sizeof bits, room, out, bytes);
    }
}

cl_int clGetSupportedImageFormats(cl_context context, cl_mem_flags flags, cl_mem_object_type type,
                                  cl_uint room, cl_image_format *out, cl_uint *count) {
    (void)context, (void)flags, (void)type;
    if (room) *out = (cl_image_format){CL_R, CL_UNORM_INT8};
    *count = 1;
    return CL_SUCCESS;
}

cl_context clCreateContext(const cl_context_properties *properties, cl_uint count,
                           const cl_device_id *devices,
                           void(CL_CALLBACK *notify)(const char *, const void *, size_t, void *), void *data,
                           cl_int *code) {
    (void)properties, (void)count, (void)devices, (void)notify, (void)data;
    return make(sizeof(struct _cl_context), code);
}

cl_int clReleaseContext(cl_context context) {
    free(context);
    return CL_SUCCESS;
}

cl_command_queue clCreateCommandQueue(cl_context context, cl_device_id device,
                                      cl_command_queue_properties properties, cl_int *code) {
    (void)context, (void)device, (void)properties;
    return make(sizeof(struct _cl_command_queue), code);
}

cl_int clReleaseCommandQueue(cl_command_queue queue) {
    free(queue);
    return CL_SUCCESS;
}

cl_int clGetCommandQueueInfo(cl_command_queue queue, cl_command_queue_info what, size_t room, void *out,
                             size_t *bytes) {
    static const cl_command_queue_properties in_order = 0;
    (void)queue, (void)what;
    return tell(&in_order, sizeof in_order, room, out, bytes);
}

cl_int clFinish(cl_command_queue queue) {
    (void)queue;
    return step();
}

/* ---- programs and kernels */
cl_program clCreateProgramWithSource(cl_context context, cl_uint count, const char **texts,
                                     const size_t *lengths, cl_int *code) {
    (void)context, (void)count, (void)texts, (void)lengths;
    return make(sizeof(struct _cl_program), code);
}

cl_int clBuildProgram(cl_program program, cl_uint count, const cl_device_id *devices, const char *options,
                      void(CL_CALLBACK *notify)(cl_program, void *), void *data) {
    (void)count, (void)devices, (void)options, (void)notify, (void)data;
    program->built = 1;
    return step();
}

cl_int clGetProgramBuildInfo(cl_program program, cl_device_id device, cl_program_build_info what, size_t room,
                             void *out, size_t *bytes) {
    (void)program, (void)device, (void)what;
    return tell("a log", sizeof "a log", room, out, bytes);
}

cl_int clReleaseProgram(cl_program program) {
    free(program);
    return CL_SUCCESS;
}

cl_kernel clCreateKernel(cl_program program, const char *name, cl_int *code) {
    FUZZ_HOLDS(program->built && name[0]);
    return make(sizeof(struct _cl_kernel), code);
}

cl_int clReleaseKernel(cl_kernel kernel) {
    free(kernel);
    return CL_SUCCESS;
}

cl_int clSetKernelArg(cl_kernel kernel, cl_uint index, size_t bytes, const void *value) {
    uint8_t byte = 0;
    FUZZ_HOLDS(index < 32);
    for (size_t i = 0; value && i < bytes; i++) byte ^= ((const uint8_t *)value)[i];
    kernel->args |= 1u << index;
    kernel->sum = byte;
    return CL_SUCCESS;
}

/* Nothing is computed, but a real device would refuse the same. */
cl_int clEnqueueNDRangeKernel(cl_command_queue queue, cl_kernel kernel, cl_uint dims, const size_t *offset,
                              const size_t *global, const size_t *local, cl_uint waits, const cl_event *list,
                              cl_event *event) {
    (void)queue, (void)offset, (void)waits, (void)list;
    FUZZ_HOLDS((kernel->args & (kernel->args + 1)) == 0); /* none was left out */
    for (cl_uint i = 0; i < dims; i++)
        FUZZ_HOLDS(global[i] > 0 && (!local || (local[i] > 0 && global[i] % local[i] == 0)));
    return done(event);
}

/* ---- buffers */
cl_mem clCreateBuffer(cl_context context, cl_mem_flags flags, size_t bytes, void *memory, cl_int *code) {
    cl_mem object = make(sizeof *object, code);
    FUZZ_HOLDS(bytes > 0);
    if (!object) return NULL;
    *object = (struct _cl_mem){memory, bytes, 0, context, flags & CL_MEM_USE_HOST_PTR};
    if (!object->borrowed) object->data = calloc(1, bytes);
    if (object->data && (flags & CL_MEM_COPY_HOST_PTR)) memcpy(object->data, memory, bytes);
    if (object->data) return object;
    free(object);
    *code = CL_MEM_OBJECT_ALLOCATION_FAILURE;
    return NULL;
}

/* Of one byte a pixel, and of rows as long as the memory that it is copied from. */
cl_mem clCreateImage(cl_context context, cl_mem_flags flags, const cl_image_format *format,
                     const cl_image_desc *desc, void *memory, cl_int *code) {
    (void)format;
    FUZZ_HOLDS(desc->image_row_pitch >= desc->image_width);
    cl_mem object = clCreateBuffer(context, flags, desc->image_row_pitch * desc->image_height, memory, code);
    if (object) object->pitch = desc->image_row_pitch;
    return object;
}

cl_int clEnqueueReadImage(cl_command_queue queue, cl_mem object, cl_bool blocking, const size_t *origin,
                          const size_t *region, size_t row, size_t slice, void *to, cl_uint waits,
                          const cl_event *list, cl_event *event) {
    (void)queue, (void)blocking, (void)slice, (void)waits, (void)list;
    for (size_t y = 0; y < region[1]; y++)
        memcpy((uint8_t *)to + y * (row ? row : region[0]),
               object->data + (origin[1] + y) * object->pitch + origin[0], region[0]);
    return done(event);
}

cl_int clReleaseMemObject(cl_mem object) {
    if (!object->borrowed) free(object->data);
    free(object);
    return CL_SUCCESS;
}

cl_int clGetMemObjectInfo(cl_mem object, cl_mem_info what, size_t room, void *out, size_t *bytes) {
    static const cl_mem_object_type buffer = CL_MEM_OBJECT_BUFFER;
    if (what == CL_MEM_TYPE) return tell(&buffer, sizeof buffer, room, out, bytes);
    if (what == CL_MEM_CONTEXT) return tell(&object->context, sizeof object->context, room, out, bytes);
    return tell(&object->bytes, sizeof object->bytes, room, out, bytes);
}

cl_int clEnqueueWriteBuffer(cl_command_queue queue, cl_mem object, cl_bool blocking, size_t offset,
                            size_t bytes, const void *from, cl_uint waits, const cl_event *list,
                            cl_event *event) {
    (void)queue, (void)blocking, (void)waits, (void)list;
    memcpy(object->data + offset, from, bytes);
    return done(event);
}

cl_int clEnqueueReadBuffer(cl_command_queue queue, cl_mem object, cl_bool blocking, size_t offset,
                           size_t bytes, void *to, cl_uint waits, const cl_event *list, cl_event *event) {
    (void)queue, (void)blocking, (void)waits, (void)list;
    memcpy(to, object->data + offset, bytes);
    return done(event);
}

cl_int clEnqueueReadBufferRect(cl_command_queue queue, cl_mem object, cl_bool blocking,
                               const size_t *from_origin, const size_t *to_origin, const size_t *region,
                               size_t from_pitch, size_t from_slice, size_t to_pitch, size_t to_slice,
                               void *to, cl_uint waits, const cl_event *list, cl_event *event) {
    (void)queue, (void)blocking, (void)from_slice, (void)to_slice, (void)waits, (void)list;
    FUZZ_HOLDS(region[2] == 1 && !from_origin[0] && !from_origin[1] && !to_origin[0] && !to_origin[1]);
    for (size_t y = 0; y < region[1]; y++)
        memcpy((uint8_t *)to + y * to_pitch, object->data + y * from_pitch, region[0]);
    return done(event);
}

cl_int clEnqueueCopyBuffer(cl_command_queue queue, cl_mem from, cl_mem to, size_t from_offset,
                           size_t to_offset, size_t bytes, cl_uint waits, const cl_event *list,
                           cl_event *event) {
    (void)queue, (void)waits, (void)list;
    memmove(to->data + to_offset, from->data + from_offset, bytes);
    return done(event);
}

cl_int clEnqueueCopyBufferRect(cl_command_queue queue, cl_mem from, cl_mem to, const size_t *from_origin,
                               const size_t *to_origin, const size_t *region, size_t from_pitch,
                               size_t from_slice, size_t to_pitch, size_t to_slice, cl_uint waits,
                               const cl_event *list, cl_event *event) {
    const size_t first = to_origin[0] + to_origin[1] * to_pitch + to_origin[2] * to_slice;
    (void)queue, (void)waits, (void)list;
    for (size_t z = 0; z < region[2]; z++)
        for (size_t y = 0; y < region[1]; y++)
            memcpy(to->data + first + y * to_pitch + z * to_slice,
                   from->data + from_origin[0] + (from_origin[1] + y) * from_pitch +
                       (from_origin[2] + z) * from_slice,
                   region[0]);
    return done(event);
}

void *clEnqueueMapBuffer(cl_command_queue queue, cl_mem object, cl_bool blocking, cl_map_flags flags,
                         size_t offset, size_t bytes, cl_uint waits, const cl_event *list, cl_event *event,
                         cl_int *code) {
    (void)queue, (void)blocking, (void)flags, (void)waits, (void)list;
    FUZZ_HOLDS(offset <= object->bytes && bytes <= object->bytes - offset);
    *code = done(event);
    return *code == CL_SUCCESS ? object->data + offset : NULL;
}

cl_int clEnqueueUnmapMemObject(cl_command_queue queue, cl_mem object, void *at, cl_uint waits,
                               const cl_event *list, cl_event *event) {
    (void)queue, (void)waits, (void)list;
    FUZZ_HOLDS((uint8_t *)at >= object->data && (uint8_t *)at <= object->data + object->bytes);
    return done(event);
}

cl_int clEnqueueFillBuffer(cl_command_queue queue, cl_mem object, const void *pattern, size_t size,
                           size_t offset, size_t bytes, cl_uint waits, const cl_event *list,
                           cl_event *event) {
    (void)queue, (void)waits, (void)list;
    if (size == 1) memset(object->data + offset, *(const uint8_t *)pattern, bytes);
    for (size_t at = 0; size > 1 && at < bytes; at += size) memcpy(object->data + offset + at, pattern, size);
    return done(event);
}

/* ---- events */
cl_int clGetEventProfilingInfo(cl_event event, cl_profiling_info what, size_t room, void *out,
                               size_t *bytes) {
    const cl_ulong time_ns = what == CL_PROFILING_COMMAND_END;
    return event ? tell(&time_ns, sizeof time_ns, room, out, bytes) : CL_INVALID_EVENT;
}

cl_int clReleaseEvent(cl_event event) {
    free(event);
    return CL_SUCCESS;
}
