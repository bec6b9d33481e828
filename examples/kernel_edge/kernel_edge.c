/* SPDX-License-Identifier: MIT */
/* A whole plugin with OpenCL kernels. It computes what first_edge.c does, slab by slab on the host's queue:
 * of every ray it keeps where the fluid begins and ends, and how much of it there was. */
#define CL_TARGET_OPENCL_VERSION 120
#include <CL/cl.h>

#include "kernels_edge.h"
#include "smartvis/author_cl.h"

enum { Q = 1, LEVEL, GAP };
enum { FIND, PLACE, KERNELS };

static sv_status activate(sva *a) {
    static const char *const kernels[KERNELS] = {"find", "place"};
    const sv_status status = sva_cl_open(a, kernels_edge, kernels, KERNELS);
    return status == SV_OK ? sva_cl_rehearse(a) : status;
}

static sv_status find(sva *a, const sv_slab *slab) {
    const float level = (float)(255.0 * sva_value(a, LEVEL));
    const float gap = (float)(sva_value(a, GAP) / a->format.spacing_mm[2]);
    const sva_cl_arg args[] = {SVA_ARG(((sva_cl *)a->own)->rays), SVA_ARG(level), SVA_ARG(gap)};
    return sva_cl_slab(a, slab, FIND, args, 3);
}

static sv_status place(sva *a, float *depth) { /* NOLINT(readability-non-const-parameter) */
    const sva_cl *cl = a->own;
    const float q = (float)sva_value(a, Q);
    const sva_cl_arg args[] = {SVA_ARG(cl->rays), SVA_ARG(q), SVA_ARG(cl->depth), SVA_ARG(cl->points)};
    (void)depth; /* NULL: the map is on the device */
    return sva_cl_launch(a, PLACE, args, 4);
}

static const sva_param params[] = {
    SVA_PARAM(Q, SV_PARAM_FLOAT, SV_PARAM_PRIMARY | SV_PARAM_ADJUST, "q", "Surface position", "",
              "0: at the fetus; 1: at the tissue before it.", 0.0, 1.0, 0.25, 0.01),
    SVA_PARAM(LEVEL, SV_PARAM_FLOAT, 0, "level", "Fluid level", "", "Darker voxels are fluid.", 0.0, 1.0, 0.2,
              0.01),
    SVA_PARAM(GAP, SV_PARAM_FLOAT, 0, "gap", "Shortest gap", "mm", "Less fluid does not count.", 0.0, 50.0,
              4.0, 0.5)};

static const sv_descriptor descriptor =
    SVA_DESCRIPTOR_OF("org.smartvis.example.kernel_edge", "First edge, with kernels", "SmartVis examples",
                      "1.0.0", "The first edge from fluid to tissue on every ray.",
                      SV_FEATURE_SCANNED | SV_FEATURE_PADDING | SV_FEATURE_ADJUST,
                      SV_BIT(SV_CARRIER_HOST) | SV_BIT(SV_CARRIER_BUFFER), SV_QUEUE_OWN | SV_QUEUE_HOST);

static const sva_method method = {.descriptor = &descriptor,
                                  .params = params,
                                  .param_count = 3,
                                  .own_bytes = sizeof(sva_cl),
                                  .ray_bytes = sizeof(cl_uint3),
                                  .activate = activate,
                                  .deactivate = sva_cl_close,
                                  .begin = sva_cl_begin,
                                  .slab = find,
                                  .finish = place,
                                  .adjust = place,
                                  .output = sva_cl_output};
SVA_ENTRY(method);
