/* SPDX-License-Identifier: MIT */
#include "loop/lowres.h"

#include <math.h>

#define VOXEL_MM      1.0
#define SOURCE_VOXELS 3.0    /* per axis of a low-resolution one, at most: "about a third" (thesis 5.4) */
#define MAX_AXIS      8192.0 /* sv_format allows no more */
#define MAX_UNASKED   1200.0 /* pixels: a third of the diagonal of 2048^3 cubic voxels */

static uint32_t axis_count(double count) {
    return (uint32_t)fmin(fmax(floor(count + 0.5), 1.0), MAX_AXIS);
}

static double voxel_of(const hs_volume *volume, uint32_t lowres, double extent) {
    const double finest = fmin(volume->spacing[0], fmin(volume->spacing[1], volume->spacing[2]));
    if (lowres) return extent / lowres;
    return fmax(fmin(VOXEL_MM, SOURCE_VOXELS * finest), finest);
}

uint32_t hs_lowres_across(const hs_volume *volume, uint32_t lowres, double extent) {
    return axis_count(extent / voxel_of(volume, lowres, extent));
}

bool hs_lowres_size(const hs_volume *volume, uint32_t lowres, const hs_camera *box, uint32_t size[3],
                    hs_error *err) {
    const double voxel = voxel_of(volume, lowres, box->extent);
    if (lowres > MAX_AXIS)
        return hs_fail(err, HS_ERR_USAGE, "low resolution: %u pixels, allowed are 1 .. %g (0: 1 mm a pixel)",
                       lowres, MAX_AXIS);
    if (!lowres && box->extent / voxel > MAX_UNASKED)
        return hs_fail(
            err, HS_ERR_INPUT,
            "%s: voxels of %g x %g x %g mm: pixels of %g mm are %.0f across, at most %g are made without "
            "--lowres",
            volume->name, volume->spacing[0], volume->spacing[1], volume->spacing[2], voxel,
            box->extent / voxel, MAX_UNASKED);
    size[0] = size[1] = axis_count(box->extent / voxel);
    size[2] = axis_count(box->depth_extent / voxel);
    return true;
}
