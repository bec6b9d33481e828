/* SPDX-License-Identifier: MIT */
#include "render/host_kernels.h"

#include "hs_kernels_embedded.h"
#include "smartvis/author_programs.h"

#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define MAX_LOG_LINES 12

/* Records the build failure with the first lines of the log, as many as a message holds. */
static bool fail_build(const hs_cl *cl, cl_program program, cl_int code, hs_error *err) {
    size_t bytes = 0;
    char *log = NULL;
    if (clGetProgramBuildInfo(program, cl->device, CL_PROGRAM_BUILD_LOG, 0, NULL, &bytes) == CL_SUCCESS) {
        log = calloc(bytes + 1, 1);
    }
    if (log &&
        clGetProgramBuildInfo(program, cl->device, CL_PROGRAM_BUILD_LOG, bytes, log, NULL) != CL_SUCCESS) {
        log[0] = '\0';
    }
    if (log) {
        char *end = log;
        for (int line = 0; line < MAX_LOG_LINES && *end; line++) {
            end += strcspn(end, "\n");
            if (*end) end++;
        }
        *end = '\0';
    }
    hs_fail(err, HS_ERR_DEVICE, "OpenCL: the host's kernels do not build on %s (%d):\n%s", cl->device_name,
            (int)code, log && *log ? log : "(no build log)");
    free(log);
    return false;
}

/* Builds kernels that are written for cl->lanes as the host's own are (cl/base.cl). HS_ERR_DEVICE with the
 * first lines of the build log. The caller releases *program, also after a failure, unless it is NULL. Why a
 * program is not kept for the next process, the plugin tells for both. */
static bool build_program(hs_cl *cl, const unsigned char *text, size_t bytes, cl_program *program,
                          hs_error *err) {
    const char *options = cl->lanes == 16 ? "-cl-std=CL1.2 -w -DLANES=16" : "-cl-std=CL1.2 -w -DLANES=1";
    const char *source = (const char *)text;
    sva_built built;
    sva_program_build(cl->context, cl->device, 1, &source, &bytes, options, &built);
    *program = built.program;
    cl->quick = built.quick != 0;
    if (!*program) return hs_cl_check(built.code, built.call, err);
    return built.code == CL_SUCCESS || fail_build(cl, *program, built.code, err);
}

bool hs_cl_open(hs_cl *cl, hs_error *err) {
    return hs_cl_open_lanes(cl, 0, err);
}

bool hs_cl_open_lanes(hs_cl *cl, uint32_t lanes, hs_error *err) {
    memset(cl, 0, sizeof *cl);
    if (lanes != 0 && lanes != 1 && lanes != 16) {
        return hs_fail(err, HS_ERR_USAGE, "OpenCL: %u lanes, expected 1 or 16", lanes);
    }
    if (!hs_cl_open_bare(cl, err)) return false;
    if (lanes) cl->lanes = lanes;
    if (build_program(cl, hs_kernel_source, hs_kernel_source_size, &cl->program, err)) return true;
    hs_cl_close(cl);
    return false;
}

/* clCreateKernel or clCreateBuffer, and what it was to make. */
static bool check_object(cl_int code, const char *call, const char *what, hs_error *err) {
    char text[128];
    (void)snprintf(text, sizeof text, "%s(%s)", call, what);
    return hs_cl_check(code, text, err);
}

bool hs_cl_take_kernel(const hs_cl *cl, const char *name, cl_kernel *kernel, hs_error *err) {
    cl_int code = CL_SUCCESS;
    if (!*kernel) *kernel = clCreateKernel(cl->program, name, &code);
    return check_object(code, "clCreateKernel", name, err);
}

bool hs_cl_take_buffer(const hs_cl *cl, size_t bytes, const char *what, cl_mem *buffer, hs_error *err) {
    cl_int code = CL_SUCCESS;
    if (!*buffer) *buffer = clCreateBuffer(cl->context, CL_MEM_READ_WRITE, bytes, NULL, &code);
    return check_object(code, "clCreateBuffer", what, err);
}

bool hs_cl_take_voxels(const hs_cl *cl, cl_int4 dims, const char *what, cl_mem *buffer, hs_error *err) {
    const size_t bytes = (size_t)dims.s[0] * (size_t)dims.s[1] * (size_t)dims.s[2] + 1;
    return hs_cl_take_buffer(cl, bytes, what, buffer, err);
}

bool hs_cl_check_size(cl_mem buffer, uint64_t bytes, const char *what, hs_error *err) {
    size_t size = 0;
    cl_int code = clGetMemObjectInfo(buffer, CL_MEM_SIZE, sizeof size, &size, NULL);
    if (!hs_cl_check(code, "clGetMemObjectInfo(CL_MEM_SIZE)", err)) return false;
    if (size >= bytes) return true;
    return hs_fail(err, HS_ERR_DEVICE, "OpenCL: the buffer for %s has %zu bytes, expected at least %" PRIu64,
                   what, size, bytes);
}

/* The same for volumes of all sizes, because PoCL compiles a kernel for every size of its groups. */
enum { ROWS_OF_GROUP = 8 };

hs_launch hs_launch_begin(const hs_cl *cl, cl_kernel kernel, const char *name) {
    return (hs_launch){.cl = cl, .kernel = kernel, .name = name, .code = CL_SUCCESS};
}

void hs_launch_arg(hs_launch *launch, size_t bytes, const void *value) {
    if (launch->code == CL_SUCCESS)
        launch->code = clSetKernelArg(launch->kernel, launch->next++, bytes, value);
}

void hs_launch_buffer(hs_launch *launch, cl_mem buffer) {
    hs_launch_arg(launch, sizeof buffer, buffer ? &buffer : NULL);
}

bool hs_launch_run(const hs_launch *launch, cl_uint dimensions, const size_t *global, const size_t *local,
                   cl_event *event, hs_error *err) {
    const char *call = "clSetKernelArg";
    cl_int code = launch->code;
    if (code == CL_SUCCESS) {
        call = "clEnqueueNDRangeKernel";
        code = clEnqueueNDRangeKernel(launch->cl->queue, launch->kernel, dimensions, NULL, global, local, 0,
                                      NULL, event);
    }
    char what[128];
    (void)snprintf(what, sizeof what, "%s(%s)", call, launch->name);
    return hs_cl_check(code, what, err);
}

bool hs_launch_items(const hs_launch *launch, cl_uint dimensions, const size_t *global, cl_event *event,
                     hs_error *err) {
    static const size_t one[3] = {1, 1, 1};
    return hs_launch_run(launch, dimensions, global, launch->cl->is_cpu ? one : NULL, event, err);
}

bool hs_launch_rows(const hs_launch *launch, cl_int4 dims, hs_error *err) {
    static const size_t group[3] = {1, ROWS_OF_GROUP, 1};
    const size_t x = (size_t)dims.s[0], y = (size_t)dims.s[1], z = (size_t)dims.s[2];
    const size_t rows[3] = {1, (y + ROWS_OF_GROUP - 1) / ROWS_OF_GROUP * ROWS_OF_GROUP, z};
    if (launch->cl->lanes == 1) return hs_launch_items(launch, 3, (const size_t[]){x, y, z}, NULL, err);
    return hs_launch_run(launch, 3, rows, group, NULL, err);
}

bool hs_launch_slices(const hs_launch *launch, cl_int4 dims, hs_error *err) {
    const size_t x = (size_t)dims.s[0], y = (size_t)dims.s[1], z = (size_t)dims.s[2];
    const bool slices = launch->cl->lanes > 1;
    return hs_launch_items(launch, 3, (const size_t[]){slices ? 1 : x, slices ? 1 : y, z}, NULL, err);
}
