/* SPDX-License-Identifier: MIT */
/* Leaks on purpose, for test_leak_detector.sh: leak_probe none|host|buffer|program|overflow|shift.
 * `none` builds and runs a kernel and cleans up; the others do the same and make one mistake. */
#include <CL/cl.h>

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const char source[] = "__kernel void twice(__global float *x) { x[get_global_id(0)] *= 2.0f; }";

static void *volatile keep; /* so that no compiler removes the mistake */

static void lose_host_memory(void) {
    keep = malloc(77);
    keep = NULL;
}

static void read_past_end(size_t size) {
    volatile char *bytes = calloc(size, 1);
    if (bytes && bytes[size]) puts("unlikely");
    free((void *)bytes);
}

static int shift_too_far(int amount) {
    return 1 << amount;
}

/* Runs one kernel; leaves the buffer or the program unreleased if told to. False if OpenCL does not work. */
static int run_kernel(int lose_buffer, int lose_program) {
    cl_platform_id platform;
    cl_device_id device;
    if (clGetPlatformIDs(1, &platform, NULL) != CL_SUCCESS ||
        clGetDeviceIDs(platform, CL_DEVICE_TYPE_ALL, 1, &device, NULL) != CL_SUCCESS)
        return 0;
    cl_int code;
    cl_context context = clCreateContext(NULL, 1, &device, NULL, NULL, &code);
    cl_command_queue queue = clCreateCommandQueue(context, device, 0, &code);
    const char *text = source;
    cl_program program = clCreateProgramWithSource(context, 1, &text, NULL, &code);
    int ok = clBuildProgram(program, 1, &device, "", NULL, NULL) == CL_SUCCESS;
    cl_kernel kernel = clCreateKernel(program, "twice", &code);
    cl_mem buffer = clCreateBuffer(context, CL_MEM_READ_WRITE, 4096, NULL, &code);
    const size_t global = 1024;
    ok = ok && clSetKernelArg(kernel, 0, sizeof(buffer), &buffer) == CL_SUCCESS &&
         clEnqueueNDRangeKernel(queue, kernel, 1, NULL, &global, NULL, 0, NULL, NULL) == CL_SUCCESS &&
         clFinish(queue) == CL_SUCCESS;
    clReleaseKernel(kernel);
    if (!lose_buffer) clReleaseMemObject(buffer);
    if (!lose_program) clReleaseProgram(program);
    clReleaseCommandQueue(queue);
    clReleaseContext(context);
    return ok;
}

int main(int argc, char **argv) {
    const char *mistake = argc > 1 ? argv[1] : "none";
    if (!run_kernel(strcmp(mistake, "buffer") == 0, strcmp(mistake, "program") == 0)) {
        fputs("leak_probe: OpenCL does not work here\n", stderr);
        return 77;
    }
    if (strcmp(mistake, "host") == 0) lose_host_memory();
    if (strcmp(mistake, "overflow") == 0) read_past_end((size_t)argc + 6);
    if (strcmp(mistake, "shift") == 0 && shift_too_far(argc + 40) == 0) puts("shifted");
    puts("leak_probe: done");
    return 0;
}
