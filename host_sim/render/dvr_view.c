/* SPDX-License-Identifier: MIT */
#include "render/dvr_view.h"

#include <math.h>

/* Grey levels below T_L from which on a brick counts as transparent: more than any rounding of a sample. */
#define SKIP_MARGIN 1e-3

double hs_dvr_slices(const hs_volume *shape, const hs_camera *camera) {
    double finest = fmin(shape->spacing[0], fmin(shape->spacing[1], shape->spacing[2]));
    return fmax(1.0, round(camera->depth_extent / finest));
}

cl_float4 hs_dvr_float4(const double v[3], double factor) {
    cl_float4 out = {{(cl_float)(v[0] * factor), (cl_float)(v[1] * factor), (cl_float)(v[2] * factor), 0.0f}};
    return out;
}

cl_float4 hs_dvr_to_map(const hs_dvr_settings *settings, const hs_start_depths *depths) {
    const double share = depths->share > 0.0f ? (double)depths->share : 1.0;
    cl_float4 out = {{(cl_float)(share * depths->width / settings->width),
                      (cl_float)(share * depths->height / settings->height),
                      (cl_float)(0.5 * (1.0 - share) * depths->width),
                      (cl_float)(0.5 * (1.0 - share) * depths->height)}};
    return out;
}

cl_int hs_dvr_transparent(const hs_dvr_settings *s) {
    if (!s->skip_empty) return -1;
    return (cl_int)fmax(ceil((double)s->threshold_low * 255.0 - SKIP_MARGIN) - 1.0, 0.0);
}

/*
 * CPU: a work item renders 4 x 4 pixels (PACKET_W, PACKET_H in cl/base.cl), a work group a stripe of them:
 * long enough to cost nothing, short enough that no core waits for another. GPU: a square of pixels, whose
 * rays stay close.
 */
bool hs_dvr_launch(const hs_launch *launch, const hs_dvr_settings *settings, cl_event *event, hs_error *err) {
    const bool packets = launch->cl->lanes > 1;
    const size_t edge = packets ? 4 : 1;
    const size_t local[2] = {packets ? 32 : 8, packets ? 1 : 8};
    const size_t picture[2] = {settings->width, settings->height};
    size_t global[2];
    for (int k = 0; k < 2; k++) {
        size_t items = (picture[k] + edge - 1) / edge;
        global[k] = (items + local[k] - 1) / local[k] * local[k];
    }
    return hs_launch_run(launch, 2, global, local, event, err);
}
