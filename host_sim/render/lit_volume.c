/* SPDX-License-Identifier: MIT */
#include "render/lit_volume.h"

#include "render/brick_grid.h"
#include "render/host_launch.h"
#include "render/smoothing.h"

#include <stdlib.h>

#define SMALL 96u /* voxels along the longest axis: such a volume is not halved */
/* Smoothed voxels along a cube of the scan's share, at least, by the factor: wider than the steps of its
 * faces. */
static const cl_int least_cube[3] = {0, 4, 3};
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
    const uint32_t most = n[0] > n[1] ? (n[0] > n[2] ? n[0] : n[2]) : (n[1] > n[2] ? n[1] : n[2]);
    return most > SMALL ? 2 : 1;
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
    const cl_int cube = block > least_cube[factor] ? block : least_cube[factor];
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

static bool take_memory(hs_lit_volume *lit, hs_error *err) {
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
    if (!take_memory(lit, err)) return false;
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
