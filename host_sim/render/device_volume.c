/* SPDX-License-Identifier: MIT */
#include "render/device_volume.h"

#include "render/device_bytes.h"

#include <stdlib.h>

struct hs_device_volume {
    const hs_cl *cl;
    uint32_t n[3];          /* voxels */
    double spacing[3];      /* mm */
    hs_device_bytes voxels; /* n[0] * n[1] * n[2] bytes, x fastest */
    hs_device_beams *beams; /* what the volume is the Cartesian copy of, or NULL */
    /* Made of the voxels when somebody asks. */
    hs_brick_grid *bricks;
    hs_halved *halved;
    hs_lit_volume *lit;
};

/* Trilinear lookups read two neighbours in x. A volume one voxel wide has no second one, so the kernels
 * (which give it weight 0) need a byte behind the last voxel: such a volume is copied, never wrapped. */
static bool wraps_host_memory(const hs_device_volume *dv) {
    return dv->cl->is_cpu && dv->n[0] > 1;
}

/* Volumes of a sequence are all in probe geometry, or none is. */
static bool bring_beams(hs_device_volume *dv, const hs_beams *beams, hs_error *err) {
    if (!beams) return true;
    if (dv->beams) return hs_device_beams_replace(dv->beams, beams, err);
    dv->beams = hs_device_beams_create(dv->cl, beams, err);
    return dv->beams != NULL;
}

static bool upload(hs_device_volume *dv, const hs_volume *volume, hs_error *err) {
    return bring_beams(dv, volume->beams, err) && hs_device_bytes_bring(&dv->voxels, volume->voxels, err);
}

static bool init(hs_device_volume *dv, const hs_volume *volume, hs_error *err) {
    const uint32_t n[3] = {volume->nx, volume->ny, volume->nz};
    cl_int4 dims = {{0}};
    uint64_t count = 1;
    for (int k = 0; k < 3; k++) {
        if (n[k] == 0 || n[k] > HS_VOLUME_MAX_AXIS) { /* the kernels' rows are as long as that (MAX_ROW) */
            return hs_fail(err, HS_ERR_INPUT, "%s: size %c is %u, expected 1 .. %u", volume->name, "xyz"[k],
                           n[k], HS_VOLUME_MAX_AXIS);
        }
        dv->n[k] = n[k];
        dv->spacing[k] = volume->spacing[k];
        dims.s[k] = (cl_int)n[k];
        count *= n[k];
    }
    if (count >= 1ull << 31) { /* the kernels index voxels with 31 bits */
        return hs_fail(err, HS_ERR_INPUT, "%s: %u x %u x %u voxels, expected at most 2^31 - 1 in all",
                       volume->name, n[0], n[1], n[2]);
    }
    return hs_device_bytes_init(&dv->voxels, dv->cl, (size_t)count, wraps_host_memory(dv), err) &&
           (dv->bricks = hs_brick_grid_create(dv->cl, dims, err)) &&
           (dv->halved = hs_halved_create(dv->cl, n, hs_lit_volume_factor(n) == 2, err)) &&
           (dv->lit = hs_lit_volume_create(dv->cl, n, err)) && upload(dv, volume, err);
}

hs_device_volume *hs_device_volume_create(const hs_cl *cl, const hs_volume *volume, hs_error *err) {
    hs_device_volume *dv = calloc(1, sizeof *dv);
    if (!dv) {
        hs_fail(err, HS_ERR_MEMORY, "%s: no memory for the device volume", volume->name);
        return NULL;
    }
    dv->cl = cl;
    if (init(dv, volume, err)) return dv;
    hs_device_volume_destroy(dv);
    return NULL;
}

bool hs_device_volume_replace(hs_device_volume *dv, const hs_volume *volume, hs_error *err) {
    if (volume->nx != dv->n[0] || volume->ny != dv->n[1] || volume->nz != dv->n[2]) {
        return hs_fail(err, HS_ERR_INPUT, "%s: %u x %u x %u voxels in a sequence of %u x %u x %u",
                       volume->name, volume->nx, volume->ny, volume->nz, dv->n[0], dv->n[1], dv->n[2]);
    }
    if ((dv->beams != NULL) != (volume->beams != NULL))
        return hs_fail(err, HS_ERR_INPUT, "%s: %s in a sequence that is not", volume->name,
                       volume->beams ? "in probe geometry" : "Cartesian");
    for (int k = 0; k < 3; k++) dv->spacing[k] = volume->spacing[k];
    hs_brick_grid_expire(dv->bricks);
    hs_halved_expire(dv->halved);
    hs_lit_volume_expire(dv->lit);
    return upload(dv, volume, err);
}

void hs_device_volume_destroy(hs_device_volume *dv) {
    if (!dv) return;
    /* The host memory may go as soon as this returns, so nothing may be reading it any more. */
    (void)clFinish(dv->cl->queue);
    hs_lit_volume_destroy(dv->lit);
    hs_halved_destroy(dv->halved);
    hs_brick_grid_destroy(dv->bricks);
    hs_device_beams_destroy(dv->beams);
    hs_device_bytes_free(&dv->voxels);
    free(dv);
}

hs_device_view hs_device_volume_view(const hs_device_volume *dv) {
    return (hs_device_view){.shape = {.nx = dv->n[0],
                                      .ny = dv->n[1],
                                      .nz = dv->n[2],
                                      .spacing = {dv->spacing[0], dv->spacing[1], dv->spacing[2]}},
                            .voxels = dv->voxels.buffer,
                            .beams = dv->beams};
}

bool hs_device_volume_bricks(const hs_device_volume *dv, hs_brick_view *view, hs_error *err) {
    return hs_brick_grid_make(dv->bricks, dv->voxels.buffer, view, err);
}

bool hs_device_volume_halved(const hs_device_volume *dv, hs_halved_view *view, hs_error *err) {
    return hs_halved_make(dv->halved, dv->voxels.buffer, view, err);
}

bool hs_device_volume_lit(const hs_device_volume *dv, float threshold_low, float threshold_high,
                          hs_lit_view *view, hs_error *err) {
    return hs_lit_volume_make(dv->lit, dv->voxels.buffer, dv->halved, threshold_low, threshold_high, view,
                              err);
}
