/* SPDX-License-Identifier: MIT */
/* OpenCL for plugins with kernels: objects, program, slabs and results. A part of smartvis/author_cl.h, which
 * says how to use it; it needs <CL/cl.h> before it. */
#ifndef SMARTVIS_AUTHOR_DEVICE_H
#define SMARTVIS_AUTHOR_DEVICE_H

#include "smartvis/author.h"
#include "smartvis/author_objects.h"
#include "smartvis/author_programs.h"

SMARTVIS_BEGIN_C

enum { SVA_CL_OBJECTS = 16 };

typedef struct sva_cl {
    cl_context context;
    cl_device_id device;
    cl_command_queue queue;
    cl_program program;
    cl_mem rays;   /* ray_bytes of every ray, all zero at begin */
    cl_mem depth;  /* float32 of every ray; SVA_NO_DEPTH: without a surface */
    cl_mem points; /* uchar of every ray: SV_POINT_* */

    /* The helper uses these alone. */
    cl_mem staged_slab, staged_scanned, stats;
    cl_mem scanned; /* of the frame, or NULL without ranges */
    cl_ulong scanned_offset;
    size_t group[2]; /* rays that PoCL computes on one stack; 0: the runtime chooses */
    uint32_t settle; /* index of sva_settle; sva_outcome comes behind it */
    cl_mem buffers[SVA_CL_OBJECTS];
    cl_kernel kernels[SVA_CL_OBJECTS]; /* in the order of sva_cl_open */
    uint32_t buffer_count, kernel_count;
} sva_cl;

/* An argument of a kernel: a variable's size and address. */
typedef struct sva_cl_arg {
    size_t size;
    const void *value;
} sva_cl_arg;
/* clang-format off */
#define SVA_ARG(variable) {sizeof(variable), &(variable)}
/* clang-format on */

/* What kernels see before their own source (which CMake's smartvis_kernels makes of a .cl file): WIDTH and
 * HEIGHT, and for a kernel of sva_cl_slab
 *
 *     kernel void name(SVA_SLAB, ...)                    with the slab's slices first .. first + count - 1
 *     uchar voxel = SVA_VOXEL(x, y, s);                  s: 0 .. count - 1
 *     if (SVA_SCANNED(x, y, s, voxel)) ...
 */
static const char sva_cl_prelude[] =
    "#pragma OPENCL FP_CONTRACT OFF\n"
    "#define SVA_NO_DEPTH (-FLT_MAX)\n"
    "#define SVA_SLAB global const uchar *sva_slab, ulong sva_at, global const ushort2 *sva_ranges, "
    "ulong sva_ranges_at, uint first, uint count\n"
    "#define SVA_VOXEL(x, y, s) sva_slab[sva_at + (ulong)(((s) / TILES_X) * TILE_H + (y)) * ROW_PITCH + "
    "((s) % TILES_X) * TILE_W + (x)]\n"
    "#define SVA_SCANNED(x, y, s, voxel) "
    "((voxel) != PADDING && sva_in(sva_ranges, sva_ranges_at, x, y, first + (s)))\n"
    "bool sva_in(global const ushort2 *ranges, ulong offset, uint x, uint y, uint z) {\n"
    "    if (!ranges) return true;\n"
    "    const ushort2 range = ranges[offset / 4 + (ulong)y * WIDTH + x];\n"
    "    return z >= range.x && z < range.y;\n"
    "}\n"
    /* stats: outcome, rays, points, unfilled, as in sv_stats */
    "kernel void sva_settle(global float *depth, global const uchar *points, global uint *stats) {\n"
    "    const size_t ray = get_global_id(1) * WIDTH + get_global_id(0);\n"
    "    if (points[ray] != 0) atomic_inc(stats + 2);\n"
    "    if (isfinite(depth[ray]) && depth[ray] != SVA_NO_DEPTH) return;\n"
    "    depth[ray] = 0.0f;\n"
    "    atomic_inc(stats + 3);\n"
    "}\n"
    "kernel void sva_outcome(global uint *stats) {\n"
    "    stats[1] = WIDTH * HEIGHT;\n"
    "    stats[0] = stats[3] == 0 ? 0 : stats[3] == stats[1] ? 1 : 2;\n"
    "}\n"
    "#line 1\n";

/* ---------------------------------------------------------------------------- activate, deactivate -- */

/* [control] A buffer that sva_cl_close releases; at most SVA_CL_OBJECTS of them. */
static inline sv_status sva_cl_buffer(sva *a, size_t bytes, cl_mem *out) {
    sva_cl *cl = (sva_cl *)a->own;
    cl_int code = CL_SUCCESS;
    if (cl->buffer_count == SVA_CL_OBJECTS)
        return sva_error(a, SV_ERR_INTERNAL, "activate: too many buffers");
    *out = clCreateBuffer(cl->context, CL_MEM_READ_WRITE, bytes, NULL, &code);
    if (code == CL_SUCCESS) cl->buffers[cl->buffer_count++] = *out;
    return sva_cl_check(a, code, "clCreateBuffer");
}

/* Makes a kernel; a name that the source does not have is refused with the names there are. */
static inline sv_status sva_cl_kernel(sva *a, const char *name) {
    sva_cl *cl = (sva_cl *)a->own;
    char names[300];
    cl_int code = CL_SUCCESS;
    if (cl->kernel_count == SVA_CL_OBJECTS)
        return sva_error(a, SV_ERR_INTERNAL, "activate: too many kernels");
    cl_kernel kernel = clCreateKernel(cl->program, name, &code);
    memset(names, 0, sizeof names);
    if (code == CL_INVALID_KERNEL_NAME)
        (void)clGetProgramInfo(cl->program, CL_PROGRAM_KERNEL_NAMES, sizeof names - 1, names, NULL);
    if (code != CL_SUCCESS)
        return sva_error(a, SV_ERR_OPENCL, "kernel %s: %s (%d)%s%s", name, sva_cl_name(code), (int)code,
                         names[0] ? "; the source has " : "", names);
    cl->kernels[cl->kernel_count++] = kernel;
    return SV_OK;
}

/* [control] Frees all that sva_cl_open, sva_cl_buffer and sva_cl_kernel made, whole or in part. */
static inline void sva_cl_close(sva *a) {
    sva_cl *cl = (sva_cl *)a->own;
    if (a->method->own_bytes < sizeof *cl) return;
    if (cl->queue) (void)clFinish(cl->queue);
    while (cl->buffer_count > 0) (void)clReleaseMemObject(cl->buffers[--cl->buffer_count]);
    while (cl->kernel_count > 0) (void)clReleaseKernel(cl->kernels[--cl->kernel_count]);
    if (cl->program) (void)clReleaseProgram(cl->program);
    if (!a->format.queue && cl->queue) (void)clReleaseCommandQueue(cl->queue);
    if (!a->format.queue && cl->context) (void)clReleaseContext(cl->context);
    memset(cl, 0, sizeof *cl);
}

/* The host's device, or the one that smartvis/device.h finds. */
static inline sv_status sva_cl_find_device(sva *a) {
    sva_cl *cl = (sva_cl *)a->own;
    sv_devices devices;
    cl->context = a->format.context;
    cl->device = a->format.device;
    cl->queue = a->format.queue;
    if (cl->queue || sv_devices_open(&devices, 0, &cl->device, &cl->context, &cl->queue)) return SV_OK;
    return sva_error(a, SV_ERR_NO_DEVICE, "activate: %s", devices.why);
}

/* A CPU's thread keeps what a group's kernels hold, an array of their own among it, on its stack. Groups as
 * the runtime chooses them have up to 4096 rays. */
static inline void sva_cl_choose_group(sva *a) {
    const uint32_t most = 32;
    sva_cl *cl = (sva_cl *)a->own;
    cl_device_type type = 0;
    cl->group[0] = cl->group[1] = 0;
    (void)clGetDeviceInfo(cl->device, CL_DEVICE_TYPE, sizeof type, &type, NULL);
    if (!(type & CL_DEVICE_TYPE_CPU)) return;
    cl->group[0] = a->format.width < most ? a->format.width : most;
    cl->group[1] = 1;
    while (a->format.width % cl->group[0] != 0) cl->group[0]--;
}

/* Tells the host's log what the compiler said, cut to 4,000 characters, line by line; the first error is the
 * reason. */
static inline sv_status sva_cl_tell_build(sva *a, cl_int code) {
    sva_cl *cl = (sva_cl *)a->own;
    char log[4000], *end = log;
    const char *first = NULL;
    memset(log, 0, sizeof log);
    (void)clGetProgramBuildInfo(cl->program, cl->device, CL_PROGRAM_BUILD_LOG, sizeof log - 1, log, NULL);
    while (*end) {
        const char *line = end;
        end += strcspn(end, "\n");
        if (*end) *end++ = '\0';
        if (*line) sva_log(a, SV_LOG_ERROR, line);
        if (!first && strstr(line, "error")) first = line;
    }
    return sva_error(a, SV_ERR_BUILD, "clBuildProgram: %s (%d): %.200s", sva_cl_name(code), (int)code,
                     first ? first : log);
}

static inline sv_status sva_cl_build(sva *a, const char *source) {
    sva_cl *cl = (sva_cl *)a->own;
    const sv_format *f = &a->format;
    const char *sources[] = {sva_cl_prelude, source};
    const size_t bytes[] = {sizeof sva_cl_prelude - 1, strlen(source)};
    char options[200];
    sva_built built;
    (void)snprintf(options, sizeof options,
                   "-D WIDTH=%uu -D HEIGHT=%uu -D TILES_X=%uu -D TILE_W=%uu -D TILE_H=%uu -D ROW_PITCH=%uu "
                   "-D PADDING=%d",
                   (unsigned)f->width, (unsigned)f->height, (unsigned)f->tiles_x, (unsigned)f->tile_w,
                   (unsigned)f->tile_h, (unsigned)f->row_pitch, (int)a->padding);
    sva_program_build(cl->context, cl->device, 2, sources, bytes, options, &built);
    cl->program = built.program;
    if (built.code != CL_SUCCESS)
        return cl->program ? sva_cl_tell_build(a, built.code) : sva_cl_check(a, built.code, built.call);
    if (built.why[0]) sva_say(a, SV_LOG_WARNING, "activate: %s", built.why);
    return SV_OK;
}

/* What a method with kernels must have in its table. */
static inline sv_status sva_cl_check_method(sva *a) {
    const sva_method *m = a->method;
    const char *missing = !m->deactivate ? "deactivate" : !m->begin ? "begin" : !m->output ? "output" : NULL;
    if (m->own_bytes < sizeof(sva_cl))
        return sva_error(a, SV_ERR_INTERNAL,
                         "sva_cl_open: sva_method.own_bytes is %lu, expected at least sizeof(sva_cl), %lu",
                         (unsigned long)m->own_bytes, (unsigned long)sizeof(sva_cl));
    if (!missing) return SV_OK;
    return sva_error(a, SV_ERR_INTERNAL, "sva_cl_open: sva_method.%s is NULL, expected %s", missing,
                     !m->deactivate ? "sva_cl_close"
                     : !m->begin    ? "sva_cl_begin"
                                    : "sva_cl_output");
}

/* [control] The device, the program, its kernels by their names, and the helper's buffers. */
static inline sv_status sva_cl_open(sva *a, const char *source, const char *const *kernels, uint32_t count) {
    sva_cl *cl = (sva_cl *)a->own;
    const size_t rays = sva_rays(a);
    sva_handlers host;
    sv_status s = sva_cl_check_method(a);
    if (s != SV_OK) return s;
    sva_handlers_keep(&host); /* a compiler takes them, too */
    s = sva_cl_find_device(a);
    if (s == SV_OK) sva_cl_choose_group(a);
    if (s == SV_OK) s = sva_cl_build(a, source);
    sva_handlers_put_back(&host);
    for (uint32_t i = 0; i < count && s == SV_OK; i++) s = sva_cl_kernel(a, kernels[i]);
    cl->settle = cl->kernel_count;
    if (s == SV_OK) s = sva_cl_kernel(a, "sva_settle");
    if (s == SV_OK) s = sva_cl_kernel(a, "sva_outcome");
    if (s == SV_OK) s = sva_cl_buffer(a, rays * (a->method->ray_bytes + !a->method->ray_bytes), &cl->rays);
    if (s == SV_OK) s = sva_cl_buffer(a, rays * sizeof(cl_float), &cl->depth);
    if (s == SV_OK) s = sva_cl_buffer(a, rays, &cl->points);
    if (s == SV_OK) s = sva_cl_buffer(a, 4 * sizeof(cl_uint), &cl->stats);
    if (s == SV_OK && a->format.flags & SV_FORMAT_SCANNED)
        s = sva_cl_buffer(a, rays * sizeof(sv_scanned), &cl->staged_scanned);
    if (s == SV_OK && a->format.carrier == SV_CARRIER_HOST)
        s = sva_cl_buffer(a, (size_t)sva_slab_bytes(&a->format, a->format.max_slab_slices), &cl->staged_slab);
    return s;
}

/* -------------------------------------------------------------------------------------- frame path -- */

static inline sv_status sva_cl_zero(sva *a, cl_mem buffer, size_t bytes) {
    const cl_uchar zero = 0;
    cl_command_queue queue = ((sva_cl *)a->own)->queue;
    return sva_cl_check(a, clEnqueueFillBuffer(queue, buffer, &zero, 1, 0, bytes, 0, NULL, NULL),
                        "clEnqueueFillBuffer");
}

/* Host memory into a buffer. The host's queue does not wait; with an own queue the memory is free again. */
static inline sv_status sva_cl_upload(sva *a, cl_mem to, const void *from, size_t bytes) {
    sva_cl *cl = (sva_cl *)a->own;
    const cl_bool wait = a->format.queue ? CL_FALSE : CL_TRUE;
    return sva_cl_check(a, clEnqueueWriteBuffer(cl->queue, to, wait, 0, bytes, from, 0, NULL, NULL),
                        "clEnqueueWriteBuffer");
}

/* [frame] A method's begin: the frame's ranges to sva_cl.scanned, and sva_cl.rays is zeroed. */
static inline sv_status sva_cl_begin(sva *a) {
    sva_cl *cl = (sva_cl *)a->own;
    const size_t bytes = sva_rays(a) * sizeof(sv_scanned), rays = sva_rays(a) * a->method->ray_bytes;
    cl->scanned = a->frame.scanned ? cl->staged_scanned : a->frame.scanned_object;
    cl->scanned_offset = a->frame.scanned_object ? a->frame.scanned_offset : 0;
    sv_status s = SV_OK;
    if (a->frame.scanned)
        s = sva_cl_upload(a, cl->scanned, a->frame.scanned, bytes);
    else if (cl->scanned)
        s = sva_cl_check_object(a, "begin: scanned_object", cl->scanned, SV_CARRIER_BUFFER,
                                cl->scanned_offset, bytes, SV_ERR_ARGUMENT);
    return s == SV_OK && rays > 0 ? sva_cl_zero(a, cl->rays, rays) : s;
}

/* SV_OK, or SV_ERR_OPENCL with the names of the call and the kernel. */
static inline sv_status sva_cl_tell_kernel(sva *a, uint32_t kernel, cl_int code, const char *call) {
    char name[100], what[160];
    if (code == CL_SUCCESS) return SV_OK;
    memset(name, 0, sizeof name);
    (void)clGetKernelInfo(((sva_cl *)a->own)->kernels[kernel], CL_KERNEL_FUNCTION_NAME, sizeof name - 1, name,
                          NULL);
    (void)snprintf(what, sizeof what, "%s of kernel %s", call, name);
    return sva_cl_check(a, code, what);
}

/* Sets arguments from number `at` on. */
static inline sv_status sva_cl_set(sva *a, uint32_t kernel, uint32_t at, const sva_cl_arg *args,
                                   uint32_t count) {
    sva_cl *cl = (sva_cl *)a->own;
    cl_int code = CL_SUCCESS;
    for (uint32_t i = 0; i < count && code == CL_SUCCESS; i++) {
        if (a->method->ray_bytes == 0 && args[i].size == sizeof cl->rays &&
            memcmp(args[i].value, &cl->rays, sizeof cl->rays) == 0)
            return sva_error(a, SV_ERR_INTERNAL, "a kernel takes sva_cl.rays, and sva_method.ray_bytes is 0");
        code = clSetKernelArg(cl->kernels[kernel], at + i, args[i].size, args[i].value);
    }
    return sva_cl_tell_kernel(a, kernel, code, "clSetKernelArg");
}

static inline sv_status sva_cl_enqueue(sva *a, uint32_t kernel) {
    sva_cl *cl = (sva_cl *)a->own;
    const size_t all[2] = {a->format.width, a->format.height};
    const cl_int code = clEnqueueNDRangeKernel(cl->queue, cl->kernels[kernel], 2, NULL, all,
                                               cl->group[0] ? cl->group : NULL, 0, NULL, NULL);
    return sva_cl_tell_kernel(a, kernel, code, "clEnqueueNDRangeKernel");
}

/* [frame] Launches a kernel on every ray, with these arguments. */
static inline sv_status sva_cl_launch(sva *a, uint32_t kernel, const sva_cl_arg *args, uint32_t count) {
    const sv_status s = sva_cl_set(a, kernel, 0, args, count);
    return s == SV_OK ? sva_cl_enqueue(a, kernel) : s;
}

/* [frame] In slab: launches a kernel on every ray, with SVA_SLAB and these arguments behind it. */
static inline sv_status sva_cl_slab(sva *a, const sv_slab *slab, uint32_t kernel, const sva_cl_arg *args,
                                    uint32_t count) {
    sva_cl *cl = (sva_cl *)a->own;
    const size_t bytes = (size_t)sva_slab_bytes(&a->format, slab->slice_count);
    const cl_mem voxels = slab->memory ? cl->staged_slab : slab->object;
    const cl_ulong offset = slab->memory ? 0 : slab->offset;
    const sva_cl_arg first[] = {SVA_ARG(voxels),
                                SVA_ARG(offset),
                                SVA_ARG(cl->scanned),
                                SVA_ARG(cl->scanned_offset),
                                SVA_ARG(slab->first_slice),
                                SVA_ARG(slab->slice_count)};
    sv_status s = slab->memory ? sva_cl_upload(a, voxels, slab->memory, bytes) : sva_cl_check_slab(a, slab);
    if (s == SV_OK) s = sva_cl_set(a, kernel, 0, first, 6);
    if (s == SV_OK) s = sva_cl_set(a, kernel, 6, args, count);
    return s == SV_OK ? sva_cl_enqueue(a, kernel) : s;
}

/* sva_cl.depth and sva_cl.points become what may leave; counts them into sva_cl.stats. */
static inline sv_status sva_cl_settle(sva *a) {
    sva_cl *cl = (sva_cl *)a->own;
    const size_t one = 1;
    const sva_cl_arg args[] = {SVA_ARG(cl->depth), SVA_ARG(cl->points), SVA_ARG(cl->stats)};
    sv_status s = sva_cl_zero(a, cl->stats, 4 * sizeof(cl_uint));
    if (s == SV_OK) s = sva_cl_launch(a, cl->settle, args, 3);
    if (s != SV_OK) return s;
    const cl_kernel outcome = cl->kernels[cl->settle + 1];
    cl_int code = clSetKernelArg(outcome, 0, sizeof cl->stats, &cl->stats);
    if (code == CL_SUCCESS)
        code = clEnqueueNDRangeKernel(cl->queue, outcome, 1, NULL, &one, NULL, 0, NULL, NULL);
    return sva_cl_check(a, code, "sva_outcome");
}

/* [frame] A method's `output`: settles and gives out. An own queue is waited for and tells the outcome. */
static inline sv_status sva_cl_output(sva *a, const sv_result *r) {
    sva_cl *cl = (sva_cl *)a->own;
    const size_t zero[3] = {0, 0, 0}, row = a->format.width * sizeof(cl_float),
                 bytes = row * a->format.height;
    const size_t region[3] = {row, a->format.height, 1},
                 stats = sizeof(sv_stats) - offsetof(sv_stats, outcome);
    const size_t pitch = r->depth_pitch ? r->depth_pitch : row;
    cl_int code = CL_SUCCESS;
    sv_status s = SV_OK;
    if (r->depth_object)
        s = sva_cl_check_object(a, "depth_object", r->depth_object, SV_CARRIER_BUFFER, r->depth_offset, bytes,
                                SV_ERR_ARGUMENT);
    if (s == SV_OK) s = sva_cl_settle(a);
    if (s != SV_OK) return s;
    if (r->depth)
        code = clEnqueueReadBufferRect(cl->queue, cl->depth, CL_FALSE, zero, zero, region, row, 0, pitch, 0,
                                       r->depth, 0, NULL, NULL);
    else
        code = clEnqueueCopyBuffer(cl->queue, cl->depth, r->depth_object, 0, (size_t)r->depth_offset, bytes,
                                   0, NULL, NULL);
    if (code == CL_SUCCESS && r->status)
        code = clEnqueueReadBuffer(cl->queue, cl->points, CL_FALSE, 0, sva_rays(a), r->status, 0, NULL, NULL);
    if (code == CL_SUCCESS && r->stats)
        code =
            clEnqueueReadBuffer(cl->queue, cl->stats, CL_FALSE, 0, stats, &r->stats->outcome, 0, NULL, NULL);
    if (a->format.queue) return sva_cl_check(a, code, "results");
    if (code == CL_SUCCESS)
        code =
            clEnqueueReadBuffer(cl->queue, cl->stats, CL_FALSE, 0, stats, &a->stats.outcome, 0, NULL, NULL);
    /* After a failure, too: nothing may write to the host's memory when end has returned. */
    const cl_int waited = clFinish(cl->queue);
    if (code != CL_SUCCESS || waited != CL_SUCCESS) return sva_cl_check(a, code ? code : waited, "results");
    if (a->stats.outcome == SV_OK) return SV_OK;
    return sva_error(a, a->stats.outcome, "%u of %u pixels are without a surface",
                     (unsigned)a->stats.unfilled, (unsigned)a->stats.rays);
}

SMARTVIS_END_C

#endif
