/* SPDX-License-Identifier: MIT */
/*
 * Depths of 10^4 slices with detail of 10^-2, k = 3, 512 x 512 (spec 8): the mean filter's error stays below
 * 1e-3 slice, half of which is the step of a float32 at that depth. An interval's ends are whole samples, so
 * such detail reaches the filter only behind another stage, by way of the float32 maps
 * (cl/mean/mean_maps.cl); this test drives the kernels from there on, as src/method/method_mean.c does.
 */
#include "support/surfaces.h"

#include "common/sv_shared.h"
#include "mean/mean_shared.h"
#include "ref/ref_mean.h"

#include <math.h>

enum { SIDE = 512, PIXELS = SIDE * SIDE, SLICES = 10064, K = 3, BANDS = 4 };
static const double PROMISE = 1e-3;

typedef struct {
    rig *r;
    cl_program program;
    sv_job job;
    cl_mem maps, sums[2], scratch, surfaces, status, record;
    uint32_t points;
} filter;

static cl_mem buffer(const rig *r, size_t bytes, const void *from) {
    const cl_uchar zero = 0;
    cl_mem b = rig_buffer(r, bytes);
    const cl_int code = from ? clEnqueueWriteBuffer(r->queue, b, CL_TRUE, 0, bytes, from, 0, NULL, NULL)
                             : clEnqueueFillBuffer(r->queue, b, &zero, 1, 0, bytes, 0, NULL, NULL);
    assert_int_equal(code, CL_SUCCESS);
    return b;
}

static void build(filter *f) {
    const char *source = "#include \"mean/reconstruct.cl\"\n#include \"mean/mean_maps.cl\"\n";
    const char *folder = getenv("SV_SOURCE_DIR");
    char options[512];
    cl_int code = CL_SUCCESS;
    assert_non_null(folder);
    (void)snprintf(options, sizeof options,
                   "-cl-std=CL1.2 -cl-fp32-correctly-rounded-divide-sqrt -DSV_WIDE_SUMS=1 -I%s/cl", folder);
    f->program = clCreateProgramWithSource(f->r->context, 1, &source, NULL, &code);
    assert_int_equal(code, CL_SUCCESS);
    assert_int_equal(clBuildProgram(f->program, 1, &f->r->device, options, NULL, NULL), CL_SUCCESS);
}

typedef struct {
    const void *value;
    size_t bytes;
} argument;
#define ARGUMENT(x)                                                                                          \
    { &(x), sizeof(x) }

static void launch(filter *f, const char *name, const argument *list, cl_uint count, size_t x, size_t y) {
    cl_int code = CL_SUCCESS;
    cl_kernel kernel = clCreateKernel(f->program, name, &code);
    assert_int_equal(code, CL_SUCCESS);
    for (cl_uint i = 0; i < count; i++)
        assert_int_equal(clSetKernelArg(kernel, i, list[i].bytes, list[i].value), CL_SUCCESS);
    const size_t global[2] = {x, y}, local[2] = {1, 1};
    code = clEnqueueNDRangeKernel(f->r->queue, kernel, y ? 2 : 1, NULL, global, local, 0, NULL, NULL);
    assert_int_equal(code, CL_SUCCESS);
    assert_int_equal(clReleaseKernel(kernel), CL_SUCCESS);
}

/* S(q) in the maps to the surface, with all passes that it takes. */
static void run(filter *f, float *surface, uint32_t *record) {
    const cl_uint wide = 1, planes = 1, width = SIDE, height = SIDE;
    const argument load[] = {ARGUMENT(f->job),  ARGUMENT(wide),       ARGUMENT(planes),
                             ARGUMENT(f->maps), ARGUMENT(f->sums[0]), ARGUMENT(f->sums[0])};
    launch(f, "mean_load", load, 6, SIDE, SIDE);
    for (cl_uint pass = 0; pass < f->job.pass_limit; pass++) {
        const argument mean[] = {ARGUMENT(f->job),
                                 ARGUMENT(pass),
                                 ARGUMENT(f->sums[pass % 2]),
                                 ARGUMENT(f->sums[1 - pass % 2]),
                                 ARGUMENT(f->surfaces),
                                 ARGUMENT(f->status),
                                 ARGUMENT(f->scratch),
                                 ARGUMENT(f->record)};
        launch(f, "band_mean", mean, 8, BANDS, 0);
    }
    const argument last[] = {ARGUMENT(f->job.pass_limit), ARGUMENT(f->record)};
    launch(f, "band_record", last, 2, 1, 0);
    const argument store[] = {ARGUMENT(width), ARGUMENT(height), ARGUMENT(f->surfaces)};
    launch(f, "mean_store", store, 3, SIDE / SV_LANES, SIDE);
    assert_int_equal(clEnqueueReadBuffer(f->r->queue, f->surfaces, CL_TRUE, 0, PIXELS * sizeof *surface,
                                         surface, 0, NULL, NULL),
                     CL_SUCCESS);
    assert_int_equal(clEnqueueReadBuffer(f->r->queue, f->record, CL_TRUE, 0, SV_REC_PASS0 * sizeof *record,
                                         record, 0, NULL, NULL),
                     CL_SUCCESS);
}

static void make(filter *f, rig *r, const float *depth, const uint8_t *status, uint32_t points) {
    const size_t stride = SIDE + SV_ROW_SLACK, real = sizeof(cl_ulong);
    *f = (filter){.r = r, .points = points};
    f->job = (sv_job){.width = SIDE, .padded_width = SIDE, .height = SIDE, .k = K};
    sv_fill_weights(0.5, &f->job.weight_initial, &f->job.weight_filled);
    const sv_fixed format = sv_fixed_format(SIDE, SIDE, SLICES, K, f->job.weight_initial);
    assert_true(format.wide); /* 32-bit sums are left out of such depths */
    f->job.fraction = format.fraction;
    f->job.pass_limit = sv_pass_limit(SIDE, SIDE, K);
    uint32_t *record = unit_memory((SV_REC_PASS0 + f->job.pass_limit) * sizeof *record);
    record[SV_REC_POINTS] = points;
    f->maps = buffer(r, PIXELS * sizeof *depth, depth);
    for (int n = 0; n < 2; n++) f->sums[n] = buffer(r, SV_SUM_PLANES * (size_t)PIXELS * real, NULL);
    f->scratch = buffer(r, BANDS * SV_SCRATCH_ROWS * stride * real, NULL);
    f->surfaces = buffer(r, 2 * (size_t)PIXELS * sizeof(float), NULL);
    f->status = buffer(r, PIXELS, status);
    f->record = buffer(r, (SV_REC_PASS0 + f->job.pass_limit) * sizeof *record, record);
    build(f);
}

/* A layer 10^4 slices deep whose points differ by hundredths of a slice from pixel to pixel. */
static double deep(uint32_t x, uint32_t y, uint32_t *random) {
    return 1e4 + 20.0 * sin(x / 40.0) * cos(y / 55.0) + 0.01 * (unit_random(random) % 10);
}

static void check(rig *r, const surface_points *p, const char *what) {
    float *depth = unit_memory(PIXELS * sizeof *depth), *surface = unit_memory(PIXELS * sizeof *surface);
    double *exact = unit_memory(2 * (size_t)PIXELS * sizeof *exact), *expected = exact + PIXELS;
    uint32_t random = 12345, points = 0, record[SV_REC_PASS0];
    for (uint32_t i = 0; i < PIXELS; i++) {
        depth[i] = p->status[i] ? (float)deep(i % SIDE, i / SIDE, &random) : INFINITY;
        exact[i] = (double)depth[i]; /* the same initial depths */
        points += p->status[i];
    }
    filter f;
    sv_ref_fill fill;
    make(&f, r, depth, p->status, points);
    run(&f, surface, record);
    assert_int_equal(clReleaseProgram(f.program), CL_SUCCESS);
    assert_true(sv_ref_mean(p->status, exact, SIDE, SIDE, K, 0.5, expected, &fill));
    assert_int_equal(record[SV_REC_PASSES], fill.passes);
    assert_int_equal(record[SV_REC_UNFILLED], 0);
    double worst = 0.0, shallowest = INFINITY;
    for (size_t i = 0; i < PIXELS; i++) {
        worst = fmax(worst, fabs((double)surface[i] - expected[i]));
        shallowest = fmin(shallowest, expected[i]);
    }
    print_message(
        "depths from %.0f, detail 0.01, k = 3, 512 x 512, %s: error %.2e slices after %u passes, bound "
        "%.0e\n",
        shallowest, what, worst, fill.passes, PROMISE);
    assert_true(shallowest > 9970.0);
    assert_true(worst <= PROMISE);
}

static void deep_scattered(void **state) {
    surface_points p = surface_scattered(SIDE, SIDE, 60, PIXELS / 10, 19);
    check(*state, &p, "scattered points");
}
static void deep_patches(void **state) {
    surface_points p = surface_patches(SIDE, SIDE, 60, 7);
    check(*state, &p, "patches");
}

UNIT_MAIN_OF(NULL, NULL, RIG_TEST(deep_scattered), RIG_TEST(deep_patches))
