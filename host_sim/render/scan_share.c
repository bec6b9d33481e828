/* SPDX-License-Identifier: MIT */
#include "render/scan_share.h"

#include "render/host_launch.h"
#include "render/smoothing.h"

#include <stdlib.h>

static const char kernel_name[] = "lit_scanned";

struct hs_scan_share {
    const hs_cl *cl;
    cl_int4 marks; /* w: set when they are made */
    hs_scan_share_view view;
    cl_kernel kernel;
    hs_smoothing smoothing;
};

hs_scan_share *hs_scan_share_create(const hs_cl *cl, const uint32_t n[3], uint32_t edge, hs_error *err) {
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

void hs_scan_share_destroy(hs_scan_share *share) {
    if (!share) return;
    hs_smoothing_free(&share->smoothing);
    if (share->kernel) (void)clReleaseKernel(share->kernel);
    if (share->view.scanned) (void)clReleaseMemObject(share->view.scanned);
    free(share);
}

bool hs_scan_share_make(hs_scan_share *share, cl_mem marks, uint32_t all, hs_scan_share_view *view,
                        hs_error *err) {
    if (!hs_cl_take_kernel(share->cl, kernel_name, &share->kernel, err) ||
        !hs_cl_take_voxels(share->cl, share->view.dims, "share of the scan", &share->view.scanned, err))
        return false;
    share->marks.s[3] = (cl_int)all;
    hs_launch sum = hs_launch_begin(share->cl, share->kernel, kernel_name);
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
