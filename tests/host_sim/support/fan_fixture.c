/* SPDX-License-Identifier: MIT */
#include "support/fan_fixture.h"

#include "support/unit.h"

#include <math.h>

#define WHOLE                                                                                                \
    {0, 0, 0}, {                                                                                             \
        1, 1, 1                                                                                              \
    }
const fan_shape fan_shapes[FANS] = {{57, 90, 23, 0.47, 0.56, 0.6, WHOLE},
                                    {41.6, 80, -19.2, 0.62, 0.74, 0.7, WHOLE},
                                    {57, 80, 23, 0.5, 0.56, 0.6, {0.35, 0, 0.02}, {1, 1, 0.9}},
                                    {57, 80, 23, 0.5, 0.5, 0.6, {0.1, 0.08, 0}, {0.95, 1, 1}},
                                    {11, 60, 6, 0.9, 1.1, 0.6, WHOLE},
                                    {50, 90, 4, 0.6, 0.6, 1.4, WHOLE}};

hs_volume fan_copy(const fan_shape *g) {
    double theta[2] = {-g->theta, g->theta}, phi[2] = {-g->phi, g->phi};
    hs_beams shape = {.samples = 2, .lines = 2, .planes = 2, .pitch = g->depth, .start = g->start};
    hs_error err = {0};
    hs_volume v;
    shape.axis = g->axis;
    shape.theta = theta;
    shape.phi = phi;
    hs_beams *b = hs_beams_like(&shape, &err);
    assert_non_null(b);
    memset(b->voxels, 100, hs_beams_count(b));
    if (!hs_beams_cartesian_init(&v, b, g->spacing, &err)) fail_msg("%s", err.text);
    hs_beams_cartesian_fill(&v);
    return v;
}

hs_volume fan_seen_from(const hs_volume *v, const fan_shape *g, hs_probe face, double apex[3]) {
    const uint32_t n[3] = {v->nx, v->ny, v->nz};
    uint32_t first[3], count[3], size[3] = {0};
    double axes[9];
    hs_volume out;
    for (int k = 0; k < 3; k++) {
        first[k] = (uint32_t)(g->from[k] * n[k]);
        count[k] = (uint32_t)(g->to[k] * n[k]) - first[k];
    }
    hs_probe_axes(v, face, axes);
    for (int m = 0; m < 3; m++)
        for (int k = 0; k < 3; k++)
            if (axes[m * 3 + k] != 0.0) size[m] = count[k];
    must(hs_volume_init(&out, size[0], size[1], size[2], &err));
    const ptrdiff_t strides[3] = {1, size[0], (ptrdiff_t)size[0] * size[1]};
    ptrdiff_t origin = 0, step[3] = {0}; /* in `out`, of the axes of `v` */
    for (int m = 0; m < 3; m++) {
        out.spacing[m] = v->spacing[m];
        apex[m] = 0.0;
        for (int k = 0; k < 3; k++) {
            const double a = axes[m * 3 + k], from = -v->beams->corner[k] - first[k] * v->spacing[k];
            apex[m] += a * from + (a < 0.0 ? size[m] * v->spacing[m] : 0.0);
            step[k] += (ptrdiff_t)a * strides[m];
            if (a < 0.0) origin += (size[m] - 1) * strides[m];
        }
    }
    for (size_t z = 0; z < count[2]; z++)
        for (size_t y = 0; y < count[1]; y++) {
            const size_t row = ((z + first[2]) * n[1] + y + first[1]) * n[0] + first[0];
            uint8_t *to = out.voxels + origin + (ptrdiff_t)z * step[2] + (ptrdiff_t)y * step[1];
            for (size_t x = 0; x < count[0]; x++) to[(ptrdiff_t)x * step[0]] = v->voxels[row + x];
        }
    return out;
}
