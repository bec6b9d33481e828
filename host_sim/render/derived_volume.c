/* SPDX-License-Identifier: MIT */
#include "render/derived_volume.h"

#include "render/host_cl.h"

#include <stdlib.h>

/* Zeroed but for `cl`: no memory taken yet. `cl` must outlive it. */
typedef struct {
    const hs_cl *cl;
    cl_kernel kernel;
    cl_mem between; /* after the first smoothing */
} hs_smoothing;

typedef struct hs_scan_share hs_scan_share;

#define BRICK_EDGE 8 /* 1 << BRICK_SHIFT in cl/base.cl */

struct hs_brick_grid {
    const hs_cl *cl;
    cl_int4 dims; /* voxels */
    hs_brick_view view;
    cl_kernel kernel;
    bool fresh;
};

hs_brick_grid *hs_brick_grid_create(const hs_cl *cl, cl_int4 dims, hs_error *err) {
    hs_brick_grid *grid = calloc(1, sizeof *grid);
    if (!grid) {
        (void)hs_fail(err, HS_ERR_MEMORY, "brick grid: no memory");
        return NULL;
    }
    grid->cl = cl;
    for (int k = 0; k < 3; k++) {
        grid->dims.s[k] = dims.s[k];
        grid->view.count.s[k] = dims.s[k] > 1 ? (dims.s[k] - 1 + BRICK_EDGE - 1) / BRICK_EDGE : 1;
    }
    return grid;
}

void hs_brick_grid_destroy(hs_brick_grid *grid) {
    if (!grid) return;
    if (grid->kernel) (void)clReleaseKernel(grid->kernel);
    if (grid->view.maxima) (void)clReleaseMemObject(grid->view.maxima);
    free(grid);
}

void hs_brick_grid_expire(hs_brick_grid *grid) {
    grid->fresh = false;
}

static bool take_brick_memory(hs_brick_grid *grid, hs_error *err) {
    const cl_int4 n = grid->view.count;
    const size_t bytes = (size_t)n.s[0] * (size_t)n.s[1] * (size_t)n.s[2];
    return hs_cl_take_kernel(grid->cl, "build_brick_grid", &grid->kernel, err) &&
           hs_cl_take_buffer(grid->cl, bytes, "brick grid", &grid->view.maxima, err);
}

static bool enqueue_bricks(hs_brick_grid *grid, cl_mem voxels, hs_error *err) {
    const cl_int4 n = grid->view.count;
    hs_launch launch = hs_launch_begin(grid->cl, grid->kernel, "build_brick_grid");
    hs_launch_buffer(&launch, voxels);
    hs_launch_arg(&launch, sizeof grid->dims, &grid->dims);
    hs_launch_arg(&launch, sizeof n, &n);
    hs_launch_buffer(&launch, grid->view.maxima);
    return hs_launch_rows(&launch, n, err);
}

bool hs_brick_grid_make(hs_brick_grid *grid, cl_mem voxels, hs_brick_view *view, hs_error *err) {
    if (!take_brick_memory(grid, err)) return false;
    if (!grid->fresh && !enqueue_bricks(grid, voxels, err)) return false;
    grid->fresh = true;
    *view = grid->view;
    return true;
}

struct hs_halved {
    const hs_cl *cl;
    cl_int4 source; /* voxels */
    hs_halved_view view;
    cl_kernel kernel;
    bool with_mean, fresh;
};

hs_halved *hs_halved_create(const hs_cl *cl, const uint32_t n[3], bool with_mean, hs_error *err) {
    hs_halved *halved = calloc(1, sizeof *halved);
    if (!halved) {
        (void)hs_fail(err, HS_ERR_MEMORY, "halved volume: no memory");
        return NULL;
    }
    halved->cl = cl;
    halved->with_mean = with_mean;
    for (int k = 0; k < 3; k++) {
        halved->source.s[k] = (cl_int)n[k];
        halved->view.dims.s[k] = (cl_int)((n[k] + 1) / 2);
    }
    halved->view.dims.s[3] = HS_HALVED_BORDER;
    return halved;
}

void hs_halved_destroy(hs_halved *halved) {
    if (!halved) return;
    if (halved->kernel) (void)clReleaseKernel(halved->kernel);
    if (halved->view.mean) (void)clReleaseMemObject(halved->view.mean);
    if (halved->view.marked) (void)clReleaseMemObject(halved->view.marked);
    free(halved);
}

void hs_halved_expire(hs_halved *halved) {
    halved->fresh = false;
}

/* Lookups read the next voxel along every axis, even of the last voxel, whose
 * neighbours then do not count. */
static size_t bytes_of(cl_int4 dims, cl_int border) {
    size_t n[3];
    for (int k = 0; k < 3; k++) n[k] = (size_t)dims.s[k] + 2 * (size_t)border;
    return n[0] * n[1] * n[2] + n[0] * n[1] + n[0] + 2;
}

static bool take_buffer(hs_halved *halved, cl_mem *buffer, cl_int border, const char *what, hs_error *err) {
    const size_t bytes = bytes_of(halved->view.dims, border);
    const cl_uchar nothing = 0;
    if (*buffer) return true;
    if (!hs_cl_take_buffer(halved->cl, bytes, what, buffer, err)) return false;
    /* The border is never written again. */
    const cl_int code = clEnqueueFillBuffer(halved->cl->queue, *buffer, &nothing, 1, 0, bytes, 0, NULL, NULL);
    return hs_cl_check(code, "clEnqueueFillBuffer(halved volume)", err);
}

static bool take_halved_memory(hs_halved *halved, hs_error *err) {
    return hs_cl_take_kernel(halved->cl, "halve_volume", &halved->kernel, err) &&
           take_buffer(halved, &halved->view.marked, 0, "halved volume", err) &&
           (!halved->with_mean ||
            take_buffer(halved, &halved->view.mean, HS_HALVED_BORDER, "halved volume with a border", err));
}

static bool enqueue_halving(hs_halved *halved, cl_mem voxels, hs_error *err) {
    cl_int4 dims = halved->view.dims;
    if (!halved->with_mean) dims.s[3] = -1;
    hs_launch launch = hs_launch_begin(halved->cl, halved->kernel, "halve_volume");
    hs_launch_buffer(&launch, voxels);
    hs_launch_arg(&launch, sizeof halved->source, &halved->source);
    hs_launch_arg(&launch, sizeof dims, &dims);
    hs_launch_buffer(&launch, halved->view.mean);
    hs_launch_buffer(&launch, halved->view.marked);
    return hs_launch_slices(&launch, dims, err);
}

bool hs_halved_make(hs_halved *halved, cl_mem voxels, hs_halved_view *view, hs_error *err) {
    if (!take_halved_memory(halved, err)) return false;
    if (!halved->fresh && !enqueue_halving(halved, voxels, err)) return false;
    halved->fresh = true;
    *view = halved->view;
    return true;
}

static const char smooth_kernel[] = "lit_smooth";

static bool smooth_once(const hs_smoothing *s, cl_mem from, cl_mem to, cl_int4 dims, hs_error *err) {
    hs_launch launch = hs_launch_begin(s->cl, s->kernel, smooth_kernel);
    hs_launch_buffer(&launch, from);
    hs_launch_arg(&launch, sizeof dims, &dims);
    hs_launch_buffer(&launch, to);
    return hs_launch_slices(&launch, dims, err);
}

/* Enqueues the smoothing of dims.xyz voxels (one byte each, x fastest), 1028 in x at most, whose outermost
 * ones become 0; does not wait. `to` may be `from`. Takes its memory the first time, for these dims.
 * HS_ERR_DEVICE. */
static bool hs_smoothing_run(hs_smoothing *s, cl_mem from, cl_mem to, cl_int4 dims, hs_error *err) {
    return hs_cl_take_kernel(s->cl, smooth_kernel, &s->kernel, err) &&
           hs_cl_take_voxels(s->cl, dims, "smoothed once", &s->between, err) &&
           smooth_once(s, from, s->between, dims, err) && smooth_once(s, s->between, to, dims, err);
}

static void hs_smoothing_free(hs_smoothing *s) {
    if (s->kernel) (void)clReleaseKernel(s->kernel);
    if (s->between) (void)clReleaseMemObject(s->between);
    *s = (hs_smoothing){0};
}

static const char share_kernel[] = "lit_scanned";

struct hs_scan_share {
    const hs_cl *cl;
    cl_int4 marks; /* w: set when they are made */
    hs_scan_share_view view;
    cl_kernel kernel;
    hs_smoothing smoothing;
};

/* For n[0] * n[1] * n[2] marks, in cubes of edge^3 of them; edge is 21 at most. Takes no memory of the device
 * yet. NULL with HS_ERR_MEMORY. `cl` must outlive it. */
static hs_scan_share *hs_scan_share_create(const hs_cl *cl, const uint32_t n[3], uint32_t edge,
                                           hs_error *err) {
    hs_scan_share *share = calloc(1, sizeof *share);
    if (!share) {
        (void)hs_fail(err, HS_ERR_MEMORY, "share of the scan: no memory");
        return NULL;
    }
    share->cl = share->smoothing.cl = cl;
    for (int k = 0; k < 3; k++) {
        share->marks.s[k] = (cl_int)n[k];
        share->view.dims.s[k] = (cl_int)((n[k] + edge - 1) / edge) + 2 * HS_SCAN_SHARE_BORDER;
    }
    share->view.dims.s[3] = (cl_int)edge;
    return share;
}

static void hs_scan_share_destroy(hs_scan_share *share) {
    if (!share) return;
    hs_smoothing_free(&share->smoothing);
    if (share->kernel) (void)clReleaseKernel(share->kernel);
    if (share->view.scanned) (void)clReleaseMemObject(share->view.scanned);
    free(share);
}

/* Enqueues it for these marks (one byte each, x fastest): from `all` on all of one was scanned, one less is a
 * half of `all` 2 and nothing of `all` 1. Takes its memory the first time; does not wait. HS_ERR_DEVICE. */
static bool hs_scan_share_make(hs_scan_share *share, cl_mem marks, uint32_t all, hs_scan_share_view *view,
                               hs_error *err) {
    if (!hs_cl_take_kernel(share->cl, share_kernel, &share->kernel, err) ||
        !hs_cl_take_voxels(share->cl, share->view.dims, "share of the scan", &share->view.scanned, err))
        return false;
    share->marks.s[3] = (cl_int)all;
    hs_launch sum = hs_launch_begin(share->cl, share->kernel, share_kernel);
    hs_launch_buffer(&sum, marks);
    hs_launch_arg(&sum, sizeof share->marks, &share->marks);
    hs_launch_arg(&sum, sizeof share->view.dims, &share->view.dims);
    hs_launch_buffer(&sum, share->view.scanned);
    if (!hs_launch_rows(&sum, share->view.dims, err) ||
        !hs_smoothing_run(&share->smoothing, share->view.scanned, share->view.scanned, share->view.dims, err))
        return false;
    *view = share->view;
    return true;
}

#define SMALL 96u /* voxels along the longest axis: such a volume is not halved */
/* Smoothed voxels along a cube of the scan's share, at least, by the factor: wider than the steps of its
 * faces. */
static const cl_int min_cube[3] = {0, 4, 3};
#define CELLS 48u /* along the longest axis, about: light does not depend on the volume's resolution */

typedef enum { KEEP, OPACITY, STEPS } step;
static const char *const kernel_names[STEPS] = {"lit_keep", "lit_opacity"};

struct hs_lit_volume {
    const hs_cl *cl;
    cl_int4 source; /* voxels */
    hs_lit_view view;
    hs_brick_grid *bricks;
    hs_scan_share *share;
    hs_smoothing smoothing;
    cl_kernel kernel[STEPS];
    bool fresh, has_opacity;
    float low, high; /* what `opacity` was made with */
};

uint32_t hs_lit_volume_factor(const uint32_t n[3]) {
    const uint32_t longest = n[0] > n[1] ? (n[0] > n[2] ? n[0] : n[2]) : (n[1] > n[2] ? n[1] : n[2]);
    return longest > SMALL ? 2 : 1;
}

hs_lit_volume *hs_lit_volume_create(const hs_cl *cl, const uint32_t n[3], hs_error *err) {
    hs_lit_volume *lit = calloc(1, sizeof *lit);
    if (!lit) {
        (void)hs_fail(err, HS_ERR_MEMORY, "lit volume: no memory");
        return NULL;
    }
    cl_int longest = 0;
    uint32_t counts[3];
    lit->cl = lit->smoothing.cl = cl;
    const uint32_t factor = lit->view.factor = hs_lit_volume_factor(n);
    for (int k = 0; k < 3; k++) {
        const cl_int count = (cl_int)(counts[k] = (n[k] + factor - 1) / factor);
        lit->source.s[k] = (cl_int)n[k];
        lit->view.dims.s[k] = count + 2 * HS_LIT_BORDER;
        if (count > longest) longest = count;
    }
    const cl_int block = longest > (cl_int)CELLS ? (longest + (cl_int)CELLS / 2) / (cl_int)CELLS : 1;
    for (int k = 0; k < 3; k++) lit->view.cells.s[k] = (lit->view.dims.s[k] + block - 1) / block;
    lit->view.cells.s[3] = block;
    const cl_int cube = block > min_cube[factor] ? block : min_cube[factor];
    if ((lit->bricks = hs_brick_grid_create(cl, lit->view.dims, err)) &&
        (lit->share = hs_scan_share_create(cl, counts, (uint32_t)cube, err)))
        return lit;
    hs_lit_volume_destroy(lit);
    return NULL;
}

void hs_lit_volume_destroy(hs_lit_volume *lit) {
    if (!lit) return;
    for (int i = 0; i < STEPS; i++)
        if (lit->kernel[i]) (void)clReleaseKernel(lit->kernel[i]);
    hs_brick_grid_destroy(lit->bricks);
    hs_scan_share_destroy(lit->share);
    hs_smoothing_free(&lit->smoothing);
    if (lit->view.smooth) (void)clReleaseMemObject(lit->view.smooth);
    if (lit->view.opacity) (void)clReleaseMemObject(lit->view.opacity);
    free(lit);
}

void hs_lit_volume_expire(hs_lit_volume *lit) {
    lit->fresh = lit->has_opacity = false;
    hs_brick_grid_expire(lit->bricks);
}

static bool take_lit_memory(hs_lit_volume *lit, hs_error *err) {
    for (int i = 0; i < STEPS; i++)
        if (!hs_cl_take_kernel(lit->cl, kernel_names[i], &lit->kernel[i], err)) return false;
    hs_lit_view *v = &lit->view;
    return hs_cl_take_voxels(lit->cl, v->dims, "smoothed volume", &v->smooth, err) &&
           hs_cl_take_voxels(lit->cl, v->cells, "opacities", &v->opacity, err);
}

static hs_launch begin(const hs_lit_volume *lit, step which, cl_mem from, const cl_int4 *dims) {
    hs_launch launch = hs_launch_begin(lit->cl, lit->kernel[which], kernel_names[which]);
    hs_launch_buffer(&launch, from);
    hs_launch_arg(&launch, sizeof *dims, dims);
    return launch;
}

/* The voxels with their border: the halved volume's, or a copy of a small volume's. And what was scanned. */
static bool find_source(hs_lit_volume *lit, cl_mem voxels, hs_halved *halved, cl_mem *source, hs_error *err) {
    hs_lit_view *v = &lit->view;
    hs_halved_view half;
    if (v->factor == 2) {
        if (!hs_halved_make(halved, voxels, &half, err)) return false;
        *source = half.mean;
        return hs_scan_share_make(lit->share, half.marked, 2, &v->share, err);
    }
    *source = v->smooth; /* the second smoothing writes there, when nobody needs the source any more */
    hs_launch keep = begin(lit, KEEP, voxels, &lit->source);
    hs_launch_arg(&keep, sizeof v->dims, &v->dims);
    hs_launch_buffer(&keep, v->smooth);
    return hs_launch_rows(&keep, v->dims, err) && hs_scan_share_make(lit->share, voxels, 1, &v->share, err);
}

static bool make_smooth(hs_lit_volume *lit, cl_mem voxels, hs_halved *halved, hs_error *err) {
    hs_lit_view *v = &lit->view;
    hs_brick_view bricks;
    cl_mem source;
    if (!find_source(lit, voxels, halved, &source, err) ||
        !hs_smoothing_run(&lit->smoothing, source, v->smooth, v->dims, err) ||
        !hs_brick_grid_make(lit->bricks, v->smooth, &bricks, err))
        return false;
    v->brick_maxima = bricks.maxima;
    v->bricks = bricks.count;
    return true;
}

static bool make_opacity(hs_lit_volume *lit, float low, float high, hs_error *err) {
    const double from = (double)low * 255.0, to = (double)high * 255.0;
    const cl_float4 window = {{(cl_float)from, (cl_float)(1.0 / (to - from)), 0.0f, 0.0f}};
    hs_lit_view *v = &lit->view;
    hs_launch opacity = begin(lit, OPACITY, v->smooth, &v->dims);
    hs_launch_arg(&opacity, sizeof v->cells, &v->cells);
    hs_launch_arg(&opacity, sizeof window, &window);
    hs_launch_buffer(&opacity, v->opacity);
    return hs_launch_rows(&opacity, v->cells, err);
}

bool hs_lit_volume_make(hs_lit_volume *lit, cl_mem voxels, hs_halved *halved, float threshold_low,
                        float threshold_high, hs_lit_view *view, hs_error *err) {
    if (!take_lit_memory(lit, err)) return false;
    if (!lit->fresh && !make_smooth(lit, voxels, halved, err)) return false;
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
