/* SPDX-License-Identifier: MIT */
/* The host's launches keep the first error, and name the call and the kernel. */
#include "render/host_kernels.h"
#include "support/unit.h"

typedef struct {
    hs_cl cl;
    cl_kernel kernel; /* build_brick_grid(voxels, dims, bricks, maxima) */
    cl_mem buffer;
} fixture;

static int open_device(void **state) {
    static fixture f;
    cl_int code = CL_SUCCESS;
    must(hs_cl_open_lanes(&f.cl, 1, &err));
    f.kernel = clCreateKernel(f.cl.program, "build_brick_grid", &code);
    assert_int_equal(code, CL_SUCCESS);
    f.buffer = clCreateBuffer(f.cl.context, CL_MEM_READ_WRITE, 64, NULL, &code);
    assert_int_equal(code, CL_SUCCESS);
    *state = &f;
    return 0;
}

static int close_device(void **state) {
    fixture *f = *state;
    assert_int_equal(clReleaseKernel(f->kernel), CL_SUCCESS);
    assert_int_equal(clReleaseMemObject(f->buffer), CL_SUCCESS);
    hs_cl_close(&f->cl);
    return 0;
}

static bool run_one(const hs_launch *launch, hs_error *err) {
    const size_t one[3] = {1, 1, 1};
    return hs_launch_run(launch, 3, one, NULL, NULL, err);
}

static void test_launch_runs(void **state) {
    fixture *f = *state;
    const cl_int4 dims = {{2, 2, 2, 0}}, bricks = {{1, 1, 1, 0}};
    const cl_uchar voxels[8] = {1, 7, 3, 0, 200, 5, 6, 4};
    cl_uchar maximum = 0;
    cl_int code =
        clEnqueueWriteBuffer(f->cl.queue, f->buffer, CL_TRUE, 0, sizeof voxels, voxels, 0, NULL, NULL);
    assert_int_equal(code, CL_SUCCESS);
    cl_mem maxima = clCreateBuffer(f->cl.context, CL_MEM_READ_WRITE, 1, NULL, &code);
    assert_int_equal(code, CL_SUCCESS);
    hs_launch launch = hs_launch_begin(&f->cl, f->kernel, "build_brick_grid");
    hs_launch_buffer(&launch, f->buffer);
    hs_launch_arg(&launch, sizeof dims, &dims);
    hs_launch_arg(&launch, sizeof bricks, &bricks);
    hs_launch_buffer(&launch, maxima);
    must(run_one(&launch, &err));
    code = clEnqueueReadBuffer(f->cl.queue, maxima, CL_TRUE, 0, 1, &maximum, 0, NULL, NULL);
    assert_int_equal(code, CL_SUCCESS);
    assert_int_equal(maximum, 200);
    assert_int_equal(clReleaseMemObject(maxima), CL_SUCCESS);
}

/* A null value for dims is CL_INVALID_ARG_VALUE (-50), a fifth argument CL_INVALID_ARG_INDEX (-49): the codes
 * must not mix, and the later one must not win. */
static void test_the_first_error_is_kept(void **state) {
    fixture *f = *state;
    hs_error err = {0};
    const cl_int4 any = {{1, 1, 1, 1}};
    hs_launch launch = hs_launch_begin(&f->cl, f->kernel, "build_brick_grid");
    hs_launch_buffer(&launch, f->buffer);
    hs_launch_arg(&launch, sizeof any, NULL);
    const cl_int first = launch.code;
    assert_int_equal(first, CL_INVALID_ARG_VALUE);
    for (int i = 2; i < 6; i++) hs_launch_arg(&launch, sizeof any, &any);
    assert_int_equal(launch.code, first);
    assert_int_equal(launch.next, 2);
    assert_false(run_one(&launch, &err));
    assert_int_equal(err.code, HS_ERR_DEVICE);
    assert_string_equal(err.text,
                        "OpenCL: clSetKernelArg(build_brick_grid) failed: CL_INVALID_ARG_VALUE (-50)");
}

static void test_a_launch_that_fails(void **state) {
    fixture *f = *state;
    const size_t none[3] = {0, 0, 0};
    hs_launch launch = hs_launch_begin(&f->cl, f->kernel, "build_brick_grid");
    must_not(hs_launch_run(&launch, 4, none, NULL, NULL, &err), HS_ERR_DEVICE,
             "clEnqueueNDRangeKernel(build_brick_grid) failed: CL_INVALID_");
}

UNIT_MAIN(open_device, close_device, test_launch_runs, test_the_first_error_is_kept, test_a_launch_that_fails)
