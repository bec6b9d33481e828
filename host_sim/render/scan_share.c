/* SPDX-License-Identifier: MIT */
#include "render/scan_share.h"

#include "render/host_launch.h"

#include <stdlib.h>

typedef enum { SUM, SMOOTH, STEPS } step;
static const char *const kernel_names[STEPS] = {"lit_scanned", "lit_smooth"};

struct hs_scan_share {
    const hs_cl *cl;
    cl_int4 marks; /* w: set when they are made */
    hs_scan_share_view view;
    cl_mem between; /* after the first smoothing */
    cl_kernel kernel[STEPS];
};

hs_scan_share *hs_scan_share_create(const hs_cl *cl, const uint32_t n[3], uint32_t edge, hs_error *err) {
    hs_scan_share *share = calloc(1, sizeof *share);
    if (!share) {
        (void)hs_fail(err, HS_ERR_MEMORY, "share of the scan: no memory");
        return NULL;
    }
    share->cl = cl;
    for (int k = 0; k < 3; k++) {
        share->marks.s[k] = (cl_int)n[k];
        share->view.dims.s[k] = (cl_int)((n[k] + edge - 1) / edge) + 2 * HS_SCAN_SHARE_BORDER;
    }
    share->view.dims.s[3] = (cl_int)edge;
    return share;
}

void hs_scan_share_destroy(hs_scan_share *share) {
    if (!share) return;
    for (int i = 0; i < STEPS; i++)
        if (share->kernel[i]) (void)clReleaseKernel(share->kernel[i]);
    if (share->between) (void)clReleaseMemObject(share->between);
    if (share->view.scanned) (void)clReleaseMemObject(share->view.scanned);
    free(share);
}

/* Trilinear lookups read a byte behind the last cube of a row (base_rays.cl): one more. */
static bool take_buffer(hs_scan_share *share, cl_mem *buffer, const char *what, hs_error *err) {
    const cl_int *n = share->view.dims.s;
    const size_t bytes = (size_t)n[0] * (size_t)n[1] * (size_t)n[2] + 1;
    return hs_cl_take_buffer(share->cl, bytes, what, buffer, err);
}

static bool take_memory(hs_scan_share *share, hs_error *err) {
    for (int i = 0; i < STEPS; i++)
        if (!hs_cl_take_kernel(share->cl, kernel_names[i], &share->kernel[i], err)) return false;
    return take_buffer(share, &share->between, "share of the scan smoothed once", err) &&
           take_buffer(share, &share->view.scanned, "share of the scan", err);
}

static bool smooth_once(hs_scan_share *share, cl_mem from, cl_mem to, hs_error *err) {
    hs_launch smooth = hs_launch_begin(share->cl, share->kernel[SMOOTH], kernel_names[SMOOTH]);
    hs_launch_buffer(&smooth, from);
    hs_launch_arg(&smooth, sizeof share->view.dims, &share->view.dims);
    hs_launch_buffer(&smooth, to);
    return hs_launch_slices(&smooth, share->view.dims, err);
}

bool hs_scan_share_make(hs_scan_share *share, cl_mem marks, uint32_t all, hs_scan_share_view *view,
                        hs_error *err) {
    if (!take_memory(share, err)) return false;
    share->marks.s[3] = (cl_int)all;
    hs_launch sum = hs_launch_begin(share->cl, share->kernel[SUM], kernel_names[SUM]);
    hs_launch_buffer(&sum, marks);
    hs_launch_arg(&sum, sizeof share->marks, &share->marks);
    hs_launch_arg(&sum, sizeof share->view.dims, &share->view.dims);
    hs_launch_buffer(&sum, share->view.scanned);
    if (!hs_launch_rows(&sum, share->view.dims, err) ||
        !smooth_once(share, share->view.scanned, share->between, err) ||
        !smooth_once(share, share->between, share->view.scanned, err))
        return false;
    *view = share->view;
    return true;
}
