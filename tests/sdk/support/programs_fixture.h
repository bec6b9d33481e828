/* SPDX-License-Identifier: MIT */
/*
 * Programs of smartvis/author_programs.h on the device that there is, with calls counted and a few answers
 * changed on their way. Included before anything else that includes that header.
 */
#pragma once

#include <CL/cl.h>

#include "support/files.h"

#include "smartvis/device.h"
#include <stdbool.h>
#include <sys/resource.h>
#include <time.h>

/* What stands between: calls so far, and what else is answered. */
static uint32_t from_source, from_binary;
static const char *told_driver, *told_name, *told_version;
static bool optimised; /* the last program */
static bool refused;

static cl_program count_source(cl_context c, cl_uint n, const char **texts, const size_t *bytes,
                               cl_int *code) {
    from_source++;
    return clCreateProgramWithSource(c, n, texts, bytes, code);
}

static cl_program count_binary(cl_context c, cl_uint n, const cl_device_id *devices, const size_t *bytes,
                               const unsigned char **binaries, cl_int *status, cl_int *code) {
    from_binary++;
    if (!refused) return clCreateProgramWithBinary(c, n, devices, bytes, binaries, status, code);
    *code = CL_INVALID_BINARY;
    return NULL;
}

static cl_int tell_device(cl_device_id d, cl_device_info what, size_t bytes, void *out, size_t *size) {
    if (!told_driver || what != CL_DRIVER_VERSION) return clGetDeviceInfo(d, what, bytes, out, size);
    (void)snprintf(out, bytes, "%s", told_driver);
    return CL_SUCCESS;
}

static cl_int tell_platform(cl_platform_id p, cl_platform_info what, size_t bytes, void *out, size_t *size) {
    const char *told = what == CL_PLATFORM_NAME      ? told_name
                       : what == CL_PLATFORM_VERSION ? told_version
                                                     : NULL;
    if (!told) return clGetPlatformInfo(p, what, bytes, out, size);
    (void)snprintf(out, bytes, "%s", told);
    return CL_SUCCESS;
}

static cl_int see_options(cl_program program, cl_uint n, const cl_device_id *devices, const char *options,
                          void(CL_CALLBACK *done)(cl_program, void *), void *with) {
    optimised = strstr(options, "-cl-opt-disable") == NULL;
    return clBuildProgram(program, n, devices, options, done, with);
}

#define clCreateProgramWithSource count_source
#define clCreateProgramWithBinary count_binary
#define clGetDeviceInfo           tell_device
#define clGetPlatformInfo         tell_platform
#define clBuildProgram            see_options
#include "smartvis/author_programs.h"

static cl_device_id device;
static cl_context context;
static cl_command_queue queue;

static const char text[] = "kernel void answer(global uint *out) { out[0] = NUMBER + 2; }";

static int setup(void **state) {
    sv_devices devices;
    return files_setup(state) == 0 && sv_devices_open(&devices, 0, &device, &context, &queue) ? 0 : -1;
}

static int teardown(void **state) {
    (void)clReleaseCommandQueue(queue);
    (void)clReleaseContext(context);
    return files_teardown(state);
}

static void remove_all(void *what) {
    sva_kept_empty();
    (void)rmdir(what);
}

/* A folder of the test's own, empty and named. */
static const char *begin(const char *name) {
    const char *folder = files_path(name);
    told_driver = told_name = told_version = NULL;
    refused = false;
    assert_int_equal(setenv("SMARTVIS_KERNEL_CACHE", folder, 1), 0);
    unit_keep(remove_all, (void *)folder); /* NOLINT(cppcoreguidelines-pro-type-const-cast) */
    return folder;
}

static cl_uint answer_of(cl_program program) {
    cl_uint answer = 0;
    const size_t one = 1;
    cl_kernel kernel = clCreateKernel(program, "answer", NULL);
    cl_mem out = clCreateBuffer(context, CL_MEM_READ_WRITE, sizeof answer, NULL, NULL);
    assert_int_equal(clSetKernelArg(kernel, 0, sizeof out, (void *)&out), CL_SUCCESS);
    assert_int_equal(clEnqueueNDRangeKernel(queue, kernel, 1, NULL, &one, &one, 0, NULL, NULL), CL_SUCCESS);
    assert_int_equal(clEnqueueReadBuffer(queue, out, CL_TRUE, 0, sizeof answer, &answer, 0, NULL, NULL),
                     CL_SUCCESS);
    (void)clReleaseMemObject(out);
    (void)clReleaseKernel(kernel);
    return answer;
}

static sva_built build(const char *source, const char *options) {
    const size_t bytes = strlen(source);
    sva_built built;
    from_source = from_binary = 0;
    sva_program_build(context, device, 1, &source, &bytes, options, &built);
    assert_int_equal(built.code, CL_SUCCESS);
    return built;
}

/* The one file that is kept in the folder. */
static const char *file_in(const char *folder, size_t *bytes) {
    const char *path = NULL;
    struct stat info;
    DIR *all = opendir(folder);
    assert_non_null(all);
    for (const struct dirent *e; (e = readdir(all)) != NULL;) {
        if (e->d_name[0] == '.') continue;
        assert_null(path);
        path = unit_text("%s/%s", folder, e->d_name);
    }
    (void)closedir(all);
    assert_non_null(path);
    assert_int_equal(stat(path, &info), 0);
    assert_int_equal(info.st_mode & ALLPERMS, S_IRUSR | S_IWUSR);
    if (bytes) *bytes = (size_t)info.st_size;
    return path;
}
