/* SPDX-License-Identifier: MIT */
#include "render/lit_volume.h"

#include "render/host_launch.h"

#include <stdlib.h>

#define BRICK_EDGE 8u  /* 1 << BRICK_SHIFT in cl/base.cl */
#define SMALL      96u /* voxels along the longest axis: such a volume is not halved */
#define PASSES     2   /* of smoothing, to and fro between two buffers */
#define CELLS      48u /* along the longest axis, about: light does not depend on the volume's resolution */

typedef enum { HALVE, KEEP, SMOOTH, BRICKS, OPACITY, STEPS } step;
static const char *const kernel_names[STEPS] = {"lit_halve", "lit_keep", "lit_smooth", "build_brick_grid",
                                                "lit_opacity"};

struct hs_lit_volume {
    const hs_cl *cl;
    cl_int4 source; /* voxels */
    hs_lit_view view;
    cl_mem half; /* halved, not yet smoothed */
    cl_kernel kernel[STEPS];
    bool fresh, has_opacity;
    float low, high; /* what `opacity` was made with */
};

hs_lit_volume *hs_lit_volume_create(const hs_cl *cl, const uint32_t n[3], hs_error *err) {
    hs_lit_volume *lit = calloc(1, sizeof *lit);
    if (!lit) {
        (void)hs_fail(err, HS_ERR_MEMORY, "lit volume: no memory");
        return NULL;
    }
    cl_int longest = 0;
    lit->cl = cl;
    const uint32_t most = n[0] > n[1] ? (n[0] > n[2] ? n[0] : n[2]) : (n[1] > n[2] ? n[1] : n[2]);
    const uint32_t factor = lit->view.factor = most > SMALL ? 2 : 1;
    for (int k = 0; k < 3; k++) {
        const cl_int count = (cl_int)((n[k] + factor - 1) / factor);
        lit->source.s[k] = (cl_int)n[k];
        lit->view.dims.s[k] = count + 2 * HS_LIT_BORDER;
        lit->view.bricks.s[k] = (lit->view.dims.s[k] - 1 + (cl_int)BRICK_EDGE - 1) / (cl_int)BRICK_EDGE;
        if (count > longest) longest = count;
    }
    const cl_int block = longest > (cl_int)CELLS ? (longest + (cl_int)CELLS / 2) / (cl_int)CELLS : 1;
    for (int k = 0; k < 3; k++) lit->view.cells.s[k] = (lit->view.dims.s[k] + block - 1) / block;
    lit->view.cells.s[3] = block;
    return lit;
}

void hs_lit_volume_destroy(hs_lit_volume *lit) {
    if (!lit) return;
    for (int i = 0; i < STEPS; i++)
        if (lit->kernel[i]) (void)clReleaseKernel(lit->kernel[i]);
    const cl_mem buffers[] = {lit->half, lit->view.smooth, lit->view.brick_maxima, lit->view.opacity};
    for (size_t i = 0; i < sizeof buffers / sizeof *buffers; i++)
        if (buffers[i]) (void)clReleaseMemObject(buffers[i]);
    free(lit);
}

void hs_lit_volume_expire(hs_lit_volume *lit) {
    lit->fresh = lit->has_opacity = false;
}

static size_t count_of(cl_int4 dims) {
    return (size_t)dims.s[0] * (size_t)dims.s[1] * (size_t)dims.s[2];
}

/* Trilinear lookups read a byte behind the last voxel of a row (base_rays.cl): one more. */
static bool take_buffer(hs_lit_volume *lit, cl_mem *buffer, cl_int4 dims, const char *call, hs_error *err) {
    cl_int code = CL_SUCCESS;
    if (!*buffer)
        *buffer = clCreateBuffer(lit->cl->context, CL_MEM_READ_WRITE, count_of(dims) + 1, NULL, &code);
    return hs_cl_check(code, call, err);
}

static bool take_memory(hs_lit_volume *lit, hs_error *err) {
    for (int i = 0; i < STEPS; i++) {
        cl_int code = CL_SUCCESS;
        if (!lit->kernel[i]) lit->kernel[i] = clCreateKernel(lit->cl->program, kernel_names[i], &code);
        if (!hs_cl_check(code, "clCreateKernel(lit volume)", err)) return false;
    }
    hs_lit_view *v = &lit->view;
    return take_buffer(lit, &lit->half, v->dims, "clCreateBuffer(halved volume)", err) &&
           take_buffer(lit, &v->smooth, v->dims, "clCreateBuffer(smoothed volume)", err) &&
           take_buffer(lit, &v->brick_maxima, v->bricks, "clCreateBuffer(smoothed bricks)", err) &&
           take_buffer(lit, &v->opacity, v->cells, "clCreateBuffer(opacities)", err);
}

/* CPU: a work item makes a row, and is a work group, so that all cores get some. */
static bool run_over(hs_lit_volume *lit, hs_launch *launch, cl_int4 dims, hs_error *err) {
    const bool rows = lit->cl->lanes > 1;
    const size_t global[3] = {rows ? 1 : (size_t)dims.s[0], (size_t)dims.s[1], (size_t)dims.s[2]};
    const size_t local[3] = {1, 1, 1};
    return hs_launch_run(launch, 3, global, rows ? local : NULL, NULL, err);
}

static hs_launch begin(const hs_lit_volume *lit, step which, cl_mem from, const cl_int4 *dims) {
    hs_launch launch = hs_launch_begin(lit->cl, lit->kernel[which], kernel_names[which]);
    hs_launch_buffer(&launch, from);
    hs_launch_arg(&launch, sizeof *dims, dims);
    return launch;
}

static bool make_smooth(hs_lit_volume *lit, cl_mem voxels, hs_error *err) {
    hs_lit_view *v = &lit->view;
    const cl_mem to_and_fro[2] = {v->smooth, lit->half};
    hs_launch halve = begin(lit, v->factor == 2 ? HALVE : KEEP, voxels, &lit->source);
    hs_launch_arg(&halve, sizeof v->dims, &v->dims);
    hs_launch_buffer(&halve, to_and_fro[PASSES % 2]);
    hs_launch bricks = begin(lit, BRICKS, v->smooth, &v->dims);
    hs_launch_arg(&bricks, sizeof v->bricks, &v->bricks);
    hs_launch_buffer(&bricks, v->brick_maxima);
    if (!run_over(lit, &halve, v->dims, err)) return false;
    for (int i = PASSES; i > 0; i--) { /* the last one ends in `smooth` */
        hs_launch smooth = begin(lit, SMOOTH, to_and_fro[i % 2], &v->dims);
        hs_launch_buffer(&smooth, to_and_fro[1 - i % 2]);
        if (!run_over(lit, &smooth, v->dims, err)) return false;
    }
    return run_over(lit, &bricks, v->bricks, err);
}

static bool make_opacity(hs_lit_volume *lit, float low, float high, hs_error *err) {
    const double from = (double)low * 255.0, to = (double)high * 255.0;
    const cl_float4 window = {{(cl_float)from, (cl_float)(1.0 / (to - from)), 0.0f, 0.0f}};
    hs_lit_view *v = &lit->view;
    hs_launch opacity = begin(lit, OPACITY, v->smooth, &v->dims);
    hs_launch_arg(&opacity, sizeof v->cells, &v->cells);
    hs_launch_arg(&opacity, sizeof window, &window);
    hs_launch_buffer(&opacity, v->opacity);
    return run_over(lit, &opacity, v->cells, err);
}

bool hs_lit_volume_make(hs_lit_volume *lit, cl_mem voxels, float threshold_low, float threshold_high,
                        hs_lit_view *view, hs_error *err) {
    if (!take_memory(lit, err)) return false;
    if (!lit->fresh && !make_smooth(lit, voxels, err)) return false;
    lit->fresh = true;
    if (!lit->has_opacity || lit->low < threshold_low || lit->low > threshold_low ||
        lit->high < threshold_high || lit->high > threshold_high) {
        if (!make_opacity(lit, threshold_low, threshold_high, err)) return false;
        lit->has_opacity = true;
        lit->low = threshold_low;
        lit->high = threshold_high;
    }
    *view = lit->view;
    return true;
}
