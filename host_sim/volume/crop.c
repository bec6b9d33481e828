/* SPDX-License-Identifier: MIT */
#include "volume/crop.h"

#include <math.h>
#include <string.h>

#define NOTHING 1e-6 /* voxels that an end may be off by rounding */

bool hs_crop_same(const hs_crop *a, const hs_crop *b) {
    bool same = a->used == b->used;
    for (int k = 0; k < 3 && a->used; k++) same = same && a->low[k] == b->low[k] && a->high[k] == b->high[k];
    return same;
}

/* The voxels of an axis that it keeps: first .. end - 1. */
static void find_range(const hs_crop *crop, const hs_volume *volume, uint32_t first[3], uint32_t end[3]) {
    const uint32_t size[3] = {volume->nx, volume->ny, volume->nz};
    for (int k = 0; k < 3; k++) {
        const double low = ceil(crop->low[k] / volume->spacing[k] - NOTHING);
        const double high = floor(crop->high[k] / volume->spacing[k] + NOTHING) + 1.0;
        first[k] = (uint32_t)fmin(fmax(low, 0.0), size[k]);
        end[k] = (uint32_t)fmin(fmax(high, first[k]), size[k]);
    }
}

bool hs_crop_check(const hs_crop *crop, const hs_volume *volume, hs_error *err) {
    uint32_t first[3], end[3];
    find_range(crop, volume, first, end);
    return (first[0] < end[0] && first[1] < end[1] && first[2] < end[2]) ||
           hs_fail(err, HS_ERR_INPUT, "box %g,%g,%g,%g,%g,%g: holds no voxel of %s", crop->low[0],
                   crop->low[1], crop->low[2], crop->high[0], crop->high[1], crop->high[2], volume->name);
}

bool hs_crop_meets(const hs_crop *crop, const double a[3], const double b[3]) {
    double first = 0.0, last = 1.0;
    for (int k = 0; k < 3; k++) {
        const double way = b[k] - a[k], low = crop->low[k] - a[k], high = crop->high[k] - a[k];
        if (fabs(way) < NOTHING) {
            if (low > NOTHING || high < -NOTHING) return false;
            continue;
        }
        first = fmax(first, fmin(low / way, high / way));
        last = fmin(last, fmax(low / way, high / way));
    }
    return first <= last;
}

void hs_crop_apply(const hs_crop *crop, const hs_volume *volume, uint8_t *bytes) {
    uint32_t first[3], end[3];
    find_range(crop, volume, first, end);
    for (uint32_t z = 0; z < volume->nz; z++)
        for (uint32_t y = 0; y < volume->ny; y++, bytes += volume->nx) {
            const bool holds = z >= first[2] && z < end[2] && y >= first[1] && y < end[1];
            memset(bytes, 0, holds ? first[0] : volume->nx);
            if (holds) memset(bytes + end[0], 0, volume->nx - end[0]);
        }
}
