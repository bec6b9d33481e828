/* SPDX-License-Identifier: MIT */
/* Wrong plugins: OpenCL, on the frame path and elsewhere. The base has kernels, and takes the host's
 * queue. */
#define CL_TARGET_OPENCL_VERSION 120
#include <CL/cl.h>
#include <pthread.h>

#include "kernels_wrong.h"
#include "smartvis/author_cl.h"
#include "smartvis/needs.h"
#include "wrong_base.h"

enum { FIND, PLACE, KERNELS };

/* ---- the base's method */
static sv_status open_device(sva *a) {
    static const char *const kernels[KERNELS] = {"find", "place"};
    const sv_status status = sva_cl_open(a, kernels_wrong, kernels, KERNELS);
    return status == SV_OK && !WRONG_IS(cold_frame) ? sva_cl_rehearse(a) : status;
}

static sv_status find(sva *a, const sv_slab *s) {
    const float level = (float)(255.0 * sva_value(a, LEVEL));
    const cl_uint gap = (cl_uint)sva_value(a, GAP);
    const cl_uint step = !WRONG_IS(hang_in_kernel);
    const sva_cl_arg args[] = {SVA_ARG(((sva_cl *)a->own)->rays), SVA_ARG(level), SVA_ARG(gap),
                               SVA_ARG(step)};
    return sva_cl_slab(a, s, FIND, args, 4);
}

static sv_status place(sva *a, float *depth) { /* NOLINT(readability-non-const-parameter) */
    const sva_cl *cl = (const sva_cl *)a->own;
    float q = (float)(0.5 * sva_value(a, Q) + 0.25 * sva_value(a, SIDE));
    if (WRONG_IS(carriers_differ) && a->format.carrier == SV_CARRIER_BUFFER) q *= 0.5f;
    const sva_cl_arg args[] = {SVA_ARG(cl->rays), SVA_ARG(q), SVA_ARG(cl->depth), SVA_ARG(cl->points)};
    return sva_cl_launch(a, PLACE, args, 4);
}

/* ---- what is wrong */
static void make_a_buffer(const sva *a, int keep) {
    const sva_cl *cl = (const sva_cl *)a->own;
    cl_int code = CL_SUCCESS;
    cl_mem buffer = clCreateBuffer(cl->context, CL_MEM_READ_WRITE, 4096, NULL, &code);
    if (WRONG_IS(crash_on_opencl_error)) (void)*(const volatile char *)buffer;
    if (buffer && !keep) (void)clReleaseMemObject(buffer);
}

static void build_a_program(const sva *a) {
    static const char *text = "kernel void nothing(global int *x) { x[0] = 0; }";
    const sva_cl *cl = (const sva_cl *)a->own;
    cl_program program = clCreateProgramWithSource(cl->context, 1, &text, NULL, NULL);
    if (!program) return;
    (void)clBuildProgram(program, 1, &cl->device, "", NULL, NULL);
    (void)clReleaseProgram(program);
}

static void *open_gate(void *gate) {
    (void)sleep(2);
    (void)clSetUserEventStatus((cl_event)gate, CL_COMPLETE);
    return NULL;
}

/* As where a runtime compiles: for seconds a launch does not begin, and then a call does not come back. Once
 * in a process, for no later frame may take as long. */
static void wait_for_seconds(const sva *a) {
    static const size_t rays[2] = {1, 1};
    static int turn;
    const sva_cl *cl = (const sva_cl *)a->own;
    for (; turn < 2; turn++) {
        pthread_t thread;
        cl_event gate = clCreateUserEvent(cl->context, NULL);
        if (!gate || pthread_create(&thread, NULL, open_gate, gate) != 0) return;
        if (turn == 0)
            (void)clEnqueueNDRangeKernel(cl->queue, cl->kernels[PLACE], 2, NULL, rays, NULL, 1, &gate, NULL);
        else
            (void)clWaitForEvents(1, &gate);
        (void)pthread_join(thread, NULL);
        (void)clReleaseEvent(gate);
        (void)usleep(300000); /* beside it, and soon over */
    }
}

/* The first byte, in front of what the host told of. */
static void write_a_byte(const sva *a, cl_mem object) {
    static const cl_uchar byte = 42;
    (void)clEnqueueWriteBuffer(((const sva_cl *)a->own)->queue, object, CL_FALSE, 0, 1, &byte, 0, NULL, NULL);
}

static sv_status activate(const sv_plugin *plugin, const sv_format *format) {
    sva *a = wrong_self(plugin);
    if (WRONG_IS(refuses_buffers) && format && format->carrier == SV_CARRIER_BUFFER)
        return sva_error(a, SV_ERR_FORMAT, "activate: no buffers here");
    const sv_status status = sva_activate(plugin, format);
    if (status != SV_OK) return status;
    if (WRONG_IS(leaks_buffer)) make_a_buffer(a, 1);
    if (WRONG_IS(crash_on_opencl_error)) make_a_buffer(a, 0);
    if (WRONG_IS(retains_queue) && a->format.queue) (void)clRetainCommandQueue(a->format.queue);
    return status;
}

static sv_status begin(const sv_plugin *plugin, const sv_frame *frame) {
    sva *a = wrong_self(plugin);
    const cl_context own = a->format.context;
    if (WRONG_IS(takes_foreign_objects) && frame && frame->scanned_object)
        (void)clGetMemObjectInfo(frame->scanned_object, CL_MEM_CONTEXT, sizeof own,
                                 (void *)&a->format.context, NULL);
    const sv_status status = sva_begin(plugin, frame);
    a->format.context = own;
    if (status == SV_OK && WRONG_IS(frame_builds)) build_a_program(a);
    if (status == SV_OK && WRONG_IS(frame_waits_long)) wait_for_seconds(a);
    return status;
}

static sv_status slab(const sv_plugin *plugin, const sv_slab *s) {
    sva *a = wrong_self(plugin);
    const uint32_t state = a->state;
    const sv_status status = sva_slab(plugin, s);
    if (status == SV_OK && WRONG_IS(hang_beside_opencl)) wrong_hang();
    if (status == SV_OK && WRONG_IS(writes_into_object) && s->object) write_a_byte(a, s->object);
    if (status == SV_OK && WRONG_IS(frame_creates_buffer)) make_a_buffer(a, 0);
    if (status != SV_ERR_OPENCL || !WRONG_IS(ignores_opencl_errors)) return status;
    a->state = state;
    a->reason[0] = '\0';
    return SV_OK;
}

static sv_status end(const sv_plugin *plugin, const sv_result *result) {
    sva *a = wrong_self(plugin);
    const sva_cl *cl = (const sva_cl *)a->own;
    const cl_uint zero = 0;
    if (a->state == SVA_SLABS && WRONG_IS(frame_blocks))
        (void)clEnqueueWriteBuffer(cl->queue, cl->stats, CL_TRUE, 0, sizeof zero, &zero, 0, NULL, NULL);
    if (a->state == SVA_SLABS && WRONG_IS(end_minus_78))
        return sva_error(a, -78, "end: the map is the host's");
    const sv_status status = sva_end(plugin, result);
    if (status >= 0 && WRONG_IS(writes_past_object) && result->depth_object)
        write_a_byte(a, result->depth_object);
    if (status == SV_OK && WRONG_IS(frame_finishes)) (void)clFinish(cl->queue);
    return status;
}

static sv_status nothing_is_needed(const sv_plugin *plugin, const sv_format *format,
                                   const sv_param_value *values, uint32_t count,
                                   const sv_needs_device *device, sv_needs *out) {
    const sv_needs nothing = {out->size, 0, 0, 0, 0, 0, 0};
    (void)plugin, (void)format, (void)values, (void)count, (void)device;
    *out = nothing;
    return SV_OK;
}

static const void *extension(const sv_plugin *plugin, const char *id) {
    static const sv_ext_needs needs = {sizeof needs, 0, nothing_is_needed};
    return strcmp(id, SV_EXT_NEEDS) == 0 ? &needs : sva_get_extension(plugin, id);
}

static void misbehave(sv_plugin *api) {
    cl_uint platforms = 0;
    if (WRONG_IS(create_calls_opencl)) (void)clGetPlatformIDs(0, NULL, &platforms);
    api->activate = activate;
    api->begin = begin;
    api->slab = slab;
    api->end = end;
    if (WRONG_IS(needs_nothing)) api->get_extension = extension;
}

static const sv_descriptor descriptor =
    SVA_DESCRIPTOR_OF("org.smartvis.test.wrong", "Wrong", "SmartVis tests", "1.0.0",
                      "A plugin for tests that is wrong in one way at most.", WRONG_FEATURES,
                      SV_BIT(SV_CARRIER_HOST) | SV_BIT(SV_CARRIER_BUFFER), SV_QUEUE_OWN | SV_QUEUE_HOST);
static const sva_method method = {.descriptor = &descriptor,
                                  .params = wrong_params,
                                  .param_count = PARAMS,
                                  .own_bytes = sizeof(sva_cl),
                                  .ray_bytes = sizeof(cl_uint3),
                                  .activate = open_device,
                                  .deactivate = sva_cl_close,
                                  .begin = sva_cl_begin,
                                  .slab = find,
                                  .finish = place,
                                  .adjust = place,
                                  .output = sva_cl_output};
WRONG_ENTRY(method, misbehave);
