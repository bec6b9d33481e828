/* SPDX-License-Identifier: MIT */
#include "support/ref_beams.h"

#include "support/ref_dvr.h"

#include <math.h>

/* Between which two entries of a table the angle lies, by looking at all of them. */
static double find(const double *table, uint32_t count, double angle, double *margin) {
    double found = -1.0;
    for (uint32_t i = 0; i + 1 < count; i++) {
        const double share = (angle - table[i]) / (table[i + 1] - table[i]);
        if (share >= 0.0 && share <= 1.0) found = i + share;
    }
    const double first = (angle - table[0]) / (table[1] - table[0]);
    const double last = (table[count - 1] - angle) / (table[count - 1] - table[count - 2]);
    *margin = fmin(*margin, fmin(fabs(first), fabs(last)));
    return found;
}

static double weighted(const hs_beams *b, const double index[3]) {
    const uint32_t count[3] = {b->samples, b->lines, b->planes};
    double sum = 0.0;
    for (int corner = 0; corner < 8; corner++) {
        double weight = 1.0;
        size_t at = 0;
        for (int a = 2; a >= 0; a--) {
            const double low = fmin(floor(index[a]), count[a] - 2.0);
            const int upper = corner >> a & 1;
            weight *= upper ? index[a] - low : 1.0 - (index[a] - low);
            at = at * count[a] + (size_t)low + (size_t)upper;
        }
        sum += weight * b->voxels[at];
    }
    return sum;
}

ref_echo ref_beams_at(const hs_beams *b, const double p[3]) {
    const double y = b->mirrored ? p[1] : -p[1], w = p[2] - b->axis;
    const double q = hypot(y, w), c = q + b->axis, r = hypot(p[0], c);
    ref_echo out = {-1.0, INFINITY};
    double index[3] = {(r - b->start) / b->pitch, 0.0, 0.0};
    index[1] = find(b->theta, b->lines, atan2(p[0], c), &out.margin);
    index[2] = find(b->phi, b->planes, atan2(y, w), &out.margin);
    const double last = b->samples - 1.0;
    out.margin = fmin(out.margin, fmin(fabs(index[0]), fabs(last - index[0])));
    if (index[0] < 0.0 || index[0] > last || index[1] < 0.0 || index[2] < 0.0) return out;
    out.echo = weighted(b, index);
    return out;
}

void ref_beams_place(const hs_beams *b, uint32_t i, uint32_t j, uint32_t k, double place[3]) {
    const double r = b->start + i * b->pitch, q = r * cos(b->theta[j]) - b->axis;
    place[0] = r * sin(b->theta[j]);
    place[1] = (b->mirrored ? q : -q) * sin(b->phi[k]);
    place[2] = b->axis + q * cos(b->phi[k]);
}

ref_beams_voxel ref_beams_convert(const hs_volume *volume, const hs_camera *camera,
                                  const hs_slab_layout *layout, const int grid[3], uint32_t x, uint32_t y,
                                  uint32_t z) {
    const int total = grid[0] * grid[1] * grid[2];
    ref_beams_voxel out = {0};
    double sum = 0.0;
    int count = 0, surely = 0;
    for (int n = 0; n < total; n++) {
        const double box[3] = {(x + (n % grid[0] + 0.5) / grid[0]) / layout->width,
                               (y + (n / grid[0] % grid[1] + 0.5) / grid[1]) / layout->height,
                               (z + (n / grid[0] / grid[1] + 0.5) / grid[2]) / layout->slices};
        double place[3];
        ref_position(volume, camera, box, place);
        for (int a = 0; a < 3; a++)
            place[a] = volume->beams->corner[a] + (place[a] + 0.5) * volume->spacing[a];
        const ref_echo one = ref_beams_at(volume->beams, place);
        out.close += one.margin < REF_BEAMS_CLOSE;
        if (one.echo < 0.0) continue;
        surely += one.margin >= REF_BEAMS_CLOSE;
        sum += one.echo;
        count++;
    }
    out.decided = 2 * surely >= total || 2 * (surely + out.close) < total;
    if (2 * count < total) return out;
    out.mean = fmax(sum / count, 1.0);
    out.value = (int)floor(out.mean + 0.5);
    return out;
}
