/* SPDX-License-Identifier: MIT */
#include "render/derived_volume.h"

#include <stdlib.h>

#define BRICK_EDGE 8   /* 1 << BRICK_SHIFT in cl/base.cl */
#define SMALL      96u /* voxels along the longest axis: such a volume is not halved */
#define CELLS      48  /* along the longest axis, about: light does not depend on the volume's resolution */
/* Smoothed voxels along a cube of the scan's share, at least, by the factor: wider than the steps of its
 * faces. */
static const cl_int min_cube[3] = {0, 4, 3};

typedef enum { BRICKS, HALVE, SMOOTH, SHARE, KEEP, OPACITY, STEPS } step;
static const char *const kernel_names[STEPS] = {
    [BRICKS] = "build_brick_grid", [HALVE] = "halve_volume", [SMOOTH] = "lit_smooth",
    [SHARE] = "lit_scanned",       [KEEP] = "lit_keep",      [OPACITY] = "lit_opacity"};

struct hs_derived {
    const hs_cl *cl;
    cl_int4 source; /* voxels */
    cl_kernel kernel[STEPS];
    hs_brick_view bricks;
    hs_halved_view halved;
    hs_lit_view lit;
    cl_mem smoothed_once, share_once; /* between two smoothings */
    bool has_bricks, has_halved, has_lit, has_opacity;
    float low, high; /* what `lit.opacity` was made with */
};

static cl_int4 bricks_of(cl_int4 dims) {
    cl_int4 count = {{0}};
    for (int k = 0; k < 3; k++)
        count.s[k] = dims.s[k] > 1 ? (dims.s[k] - 1 + BRICK_EDGE - 1) / BRICK_EDGE : 1;
    return count;
}

static hs_lit_view lit_of(const uint32_t n[3]) {
    const uint32_t most = n[0] > n[1] ? n[0] : n[1];
    hs_lit_view v = {.factor = most > SMALL || n[2] > SMALL ? 2 : 1};
    cl_int count[3], longest = 0;
    for (int k = 0; k < 3; k++) {
        count[k] = (cl_int)((n[k] + v.factor - 1) / v.factor);
        v.dims.s[k] = count[k] + 2 * HS_LIT_BORDER;
        if (count[k] > longest) longest = count[k];
    }
    const cl_int block = longest > CELLS ? (longest + CELLS / 2) / CELLS : 1;
    const cl_int cube = block > min_cube[v.factor] ? block : min_cube[v.factor];
    for (int k = 0; k < 3; k++) {
        v.cells.s[k] = (v.dims.s[k] + block - 1) / block;
        v.share.dims.s[k] = (count[k] + cube - 1) / cube + 2 * HS_SCAN_SHARE_BORDER;
    }
    v.cells.s[3] = block;
    v.share.dims.s[3] = cube;
    v.bricks.count = bricks_of(v.dims);
    return v;
}

hs_derived *hs_derived_create(const hs_cl *cl, const uint32_t n[3], hs_error *err) {
    hs_derived *d = hs_memory(1, sizeof *d, "what is made of a volume", err);
    if (!d) return NULL;
    d->cl = cl;
    d->lit = lit_of(n);
    for (int k = 0; k < 3; k++) {
        d->source.s[k] = (cl_int)n[k];
        d->halved.dims.s[k] = (cl_int)((n[k] + 1) / 2);
    }
    d->halved.dims.s[3] = HS_HALVED_BORDER;
    d->bricks.count = bricks_of(d->source);
    return d;
}

void hs_derived_destroy(hs_derived *d) {
    if (!d) return;
    const cl_mem buffers[] = {d->bricks.maxima,     d->halved.mean,       d->halved.marked,
                              d->lit.smooth,        d->lit.bricks.maxima, d->lit.opacity,
                              d->lit.share.scanned, d->smoothed_once,     d->share_once};
    for (int i = 0; i < STEPS; i++)
        if (d->kernel[i]) (void)clReleaseKernel(d->kernel[i]);
    for (size_t i = 0; i < sizeof buffers / sizeof *buffers; i++)
        if (buffers[i]) (void)clReleaseMemObject(buffers[i]);
    free(d);
}

void hs_derived_expire(hs_derived *d) {
    d->has_bricks = d->has_halved = d->has_lit = d->has_opacity = false;
}

/* Begins a step's launch with its first two arguments. */
static bool begin(hs_derived *d, step which, cl_mem from, cl_int4 dims, hs_launch *launch, hs_error *err) {
    if (!hs_cl_take_kernel(d->cl, kernel_names[which], &d->kernel[which], err)) return false;
    *launch = hs_launch_begin(d->cl, d->kernel[which], kernel_names[which]);
    hs_launch_buffer(launch, from);
    hs_launch_arg(launch, sizeof dims, &dims);
    return true;
}

static bool find_bricks(hs_derived *d, cl_mem voxels, cl_int4 dims, hs_brick_view *bricks, hs_error *err) {
    hs_launch launch;
    if (!hs_cl_take_voxels(d->cl, bricks->count, "brick grid", &bricks->maxima, err) ||
        !begin(d, BRICKS, voxels, dims, &launch, err))
        return false;
    hs_launch_arg(&launch, sizeof bricks->count, &bricks->count);
    hs_launch_buffer(&launch, bricks->maxima);
    return hs_launch_rows(&launch, bricks->count, err);
}

bool hs_derived_bricks(hs_derived *d, cl_mem voxels, hs_brick_view *view, hs_error *err) {
    if (!d->has_bricks && !find_bricks(d, voxels, d->source, &d->bricks, err)) return false;
    d->has_bricks = true;
    *view = d->bricks;
    return true;
}

/* Lookups read the next voxel along every axis, even of the last voxel, whose neighbours then do not count.
 * The border is never written again. */
static bool take_halved(hs_derived *d, cl_mem *buffer, cl_int border, const char *what, hs_error *err) {
    const cl_uchar nothing = 0;
    size_t n[3];
    if (*buffer) return true;
    for (int k = 0; k < 3; k++) n[k] = (size_t)d->halved.dims.s[k] + 2 * (size_t)border;
    const size_t bytes = n[0] * n[1] * n[2] + n[0] * n[1] + n[0] + 2;
    if (!hs_cl_take_buffer(d->cl, bytes, what, buffer, err)) return false;
    const cl_int code = clEnqueueFillBuffer(d->cl->queue, *buffer, &nothing, 1, 0, bytes, 0, NULL, NULL);
    return hs_cl_check(code, "clEnqueueFillBuffer(halved volume)", err);
}

static bool halve(hs_derived *d, cl_mem voxels, hs_error *err) {
    const bool with_mean = d->lit.factor == 2;
    cl_int4 dims = d->halved.dims;
    hs_launch launch;
    if (!take_halved(d, &d->halved.marked, 0, "halved volume", err) ||
        (with_mean &&
         !take_halved(d, &d->halved.mean, HS_HALVED_BORDER, "halved volume with a border", err)) ||
        !begin(d, HALVE, voxels, d->source, &launch, err))
        return false;
    if (!with_mean) dims.s[3] = -1;
    hs_launch_arg(&launch, sizeof dims, &dims);
    hs_launch_buffer(&launch, d->halved.mean);
    hs_launch_buffer(&launch, d->halved.marked);
    return hs_launch_slices(&launch, dims, err);
}

bool hs_derived_halved(hs_derived *d, cl_mem voxels, hs_halved_view *view, hs_error *err) {
    if (!d->has_halved && !halve(d, voxels, err)) return false;
    d->has_halved = true;
    *view = d->halved;
    return true;
}

static bool smooth_once(hs_derived *d, cl_mem from, cl_mem to, cl_int4 dims, hs_error *err) {
    hs_launch launch;
    if (!begin(d, SMOOTH, from, dims, &launch, err)) return false;
    hs_launch_buffer(&launch, to);
    return hs_launch_slices(&launch, dims, err);
}

/* Enqueues the smoothing of dims.xyz voxels (one byte each, x fastest), 1028 in x at most, whose outermost
 * ones become 0. `to` may be `from`. */
static bool smooth(hs_derived *d, cl_mem from, cl_mem to, cl_mem *between, cl_int4 dims, hs_error *err) {
    return hs_cl_take_voxels(d->cl, dims, "smoothed once", between, err) &&
           smooth_once(d, from, *between, dims, err) && smooth_once(d, *between, to, dims, err);
}

/* `marks`, the halved voxels or the source's: from `all` on all of one was scanned, one less is a half of
 * `all` 2 and nothing of `all` 1. */
static bool share_scan(hs_derived *d, cl_mem marks, cl_int4 dims, cl_int all, hs_error *err) {
    hs_scan_share_view *v = &d->lit.share;
    hs_launch sum;
    dims.s[3] = all;
    if (!hs_cl_take_voxels(d->cl, v->dims, "share of the scan", &v->scanned, err) ||
        !begin(d, SHARE, marks, dims, &sum, err))
        return false;
    hs_launch_arg(&sum, sizeof v->dims, &v->dims);
    hs_launch_buffer(&sum, v->scanned);
    return hs_launch_rows(&sum, v->dims, err) &&
           smooth(d, v->scanned, v->scanned, &d->share_once, v->dims, err);
}

/* The voxels with their border: the halved volume's, or a copy of a small volume's. And what was scanned. */
static bool find_source(hs_derived *d, cl_mem voxels, cl_mem *source, hs_error *err) {
    hs_lit_view *v = &d->lit;
    hs_halved_view half;
    hs_launch keep;
    if (v->factor == 2) {
        if (!hs_derived_halved(d, voxels, &half, err)) return false;
        *source = half.mean;
        return share_scan(d, half.marked, half.dims, 2, err);
    }
    *source = v->smooth; /* the second smoothing writes there, when nobody needs the source any more */
    if (!begin(d, KEEP, voxels, d->source, &keep, err)) return false;
    hs_launch_arg(&keep, sizeof v->dims, &v->dims);
    hs_launch_buffer(&keep, v->smooth);
    return hs_launch_rows(&keep, v->dims, err) && share_scan(d, voxels, d->source, 1, err);
}

static bool make_lit(hs_derived *d, cl_mem voxels, hs_error *err) {
    hs_lit_view *v = &d->lit;
    cl_mem source;
    return hs_cl_take_voxels(d->cl, v->dims, "smoothed volume", &v->smooth, err) &&
           find_source(d, voxels, &source, err) &&
           smooth(d, source, v->smooth, &d->smoothed_once, v->dims, err) &&
           find_bricks(d, v->smooth, v->dims, &v->bricks, err);
}

static bool make_opacity(hs_derived *d, float low, float high, hs_error *err) {
    const double from = (double)low * 255.0, to = (double)high * 255.0;
    const cl_float4 window = {{(cl_float)from, (cl_float)(1.0 / (to - from)), 0.0f, 0.0f}};
    hs_lit_view *v = &d->lit;
    hs_launch opacity;
    if (!hs_cl_take_voxels(d->cl, v->cells, "opacities", &v->opacity, err) ||
        !begin(d, OPACITY, v->smooth, v->dims, &opacity, err))
        return false;
    hs_launch_arg(&opacity, sizeof v->cells, &v->cells);
    hs_launch_arg(&opacity, sizeof window, &window);
    hs_launch_buffer(&opacity, v->opacity);
    return hs_launch_rows(&opacity, v->cells, err);
}

bool hs_derived_lit(hs_derived *d, cl_mem voxels, float threshold_low, float threshold_high,
                    hs_lit_view *view, hs_error *err) {
    if (!d->has_lit && !make_lit(d, voxels, err)) return false;
    d->has_lit = true;
    if (!d->has_opacity || d->low < threshold_low || d->low > threshold_low || d->high < threshold_high ||
        d->high > threshold_high) {
        if (!make_opacity(d, threshold_low, threshold_high, err)) return false;
        d->has_opacity = true;
        d->low = threshold_low;
        d->high = threshold_high;
    }
    *view = d->lit;
    return true;
}
