/* SPDX-License-Identifier: MIT */
/* Which slices of every ray of the low-resolution volume were scanned: what a host tells its
 * plugins in sv_frame.scanned. */
#ifndef HS_SCANNED_RAYS_H
#define HS_SCANNED_RAYS_H

#include "render/scan_convert.h"

/* The ranges of one frame on the device. Zeroed: nothing to free. */
typedef struct {
    const hs_cl *cl;
    cl_kernel kernel;
    cl_mem ranges; /* width * height pairs of 16 bits, first and end, row by row: sv_scanned */
} hs_scanned_rays;

/* Makes the buffer for slabs of this layout. HS_ERR_DEVICE. */
bool hs_scanned_rays_create(hs_scanned_rays *rays, const hs_cl *cl, const hs_slab_layout *layout,
                            hs_error *err);
void hs_scanned_rays_destroy(hs_scanned_rays *rays);

/* Enqueues the search in the slabs that `source` was converted to for `camera`, which say where nothing can
 * have been scanned: slab i begins i * stride bytes from the start of `slabs`. Does not wait. HS_ERR_DEVICE.
 */
bool hs_scanned_rays_find(const hs_scanned_rays *rays, const hs_slab_layout *layout,
                          const hs_device_volume *source, const hs_camera *camera, cl_mem slabs,
                          size_t stride, hs_error *err);

#endif
