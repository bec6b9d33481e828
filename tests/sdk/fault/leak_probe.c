/* SPDX-License-Identifier: MIT */
/* Leaks on purpose, for test_leak_detector.sh: leak_probe none|host|buffer|program|overflow|shift, or
 * leak_probe thread LIBRARY. `none` builds and runs a kernel and cleans up; the others do the same and make
 * one mistake. `thread` makes none: when the process ends, a thread still has variables of its own of the
 * library. */
#include <CL/cl.h>

#include <dlfcn.h>
#include <pthread.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

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

typedef struct {
    long *(*of_this_thread)(void);
    pthread_barrier_t touched;
    long *numbers;
} thread_use;

static void *touch_and_stay(void *argument) {
    thread_use *use = argument;
    use->numbers = use->of_this_thread();
    use->numbers[0] = 1;
    (void)pthread_barrier_wait(&use->touched);
    for (;;) (void)pause();
    return NULL;
}

/* False if the library does not load. Says where in its page the block lies: a thread's first of its size
 * begins a page. */
static int keep_thread_variables(const char *library) {
    static thread_use use; /* the thread outlives this function */
    void *handle = dlopen(library, RTLD_NOW);
    void *symbol = handle ? dlsym(handle, "of_this_thread") : NULL;
    pthread_t thread;
    if (!symbol || pthread_barrier_init(&use.touched, NULL, 2) != 0) return 0;
    memcpy(&use.of_this_thread, &symbol, sizeof symbol);
    if (pthread_create(&thread, NULL, touch_and_stay, &use) != 0) return 0;
    (void)pthread_barrier_wait(&use.touched);
    printf("leak_probe: %u bytes into the page\n", (unsigned)((uintptr_t)use.numbers % 4096));
    return 1;
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
    if (strcmp(mistake, "thread") == 0 && argc > 2) return keep_thread_variables(argv[2]) ? 0 : 1;
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
