/* SPDX-License-Identifier: MIT */
#include "volume/beams.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define EVEN_STEP 1e-6 /* of a step: closer than any reader of the table can tell */

static double *copy_table(const double *table, uint32_t count) {
    double *copy = malloc(count * sizeof *copy);
    if (copy) memcpy(copy, table, count * sizeof *copy);
    return copy;
}

hs_beams *hs_beams_like(const hs_beams *geometry, hs_error *err) {
    hs_beams *beams = malloc(sizeof *beams);
    if (beams) {
        *beams = *geometry;
        beams->theta = copy_table(geometry->theta, geometry->lines);
        beams->phi = copy_table(geometry->phi, geometry->planes);
        beams->voxels = malloc(hs_beams_count(geometry));
        if (beams->theta && beams->phi && beams->voxels) return beams;
    }
    hs_beams_free(beams);
    (void)hs_fail(err, HS_ERR_MEMORY, "probe geometry: no memory for %zu samples", hs_beams_count(geometry));
    return NULL;
}

void hs_beams_free(hs_beams *beams) {
    if (!beams) return;
    free(beams->theta);
    free(beams->phi);
    free(beams->voxels);
    free(beams);
}

size_t hs_beams_count(const hs_beams *beams) {
    return (size_t)beams->samples * beams->lines * beams->planes;
}

double hs_beams_side(const hs_beams *beams) {
    return beams->mirrored ? 1.0 : -1.0;
}

const char *hs_beams_side_name(const hs_beams *beams) {
    return beams->mirrored ? "sweep + at +y, mirrored" : "sweep + at -y";
}

static void place_at(const hs_beams *beams, double radius, double theta, double phi, double place[3]) {
    const double q = radius * cos(theta) - beams->axis;
    place[0] = radius * sin(theta);
    place[1] = hs_beams_side(beams) * q * sin(phi);
    place[2] = beams->axis + q * cos(phi);
}

void hs_beams_place(const hs_beams *beams, uint32_t i, uint32_t j, uint32_t k, double place[3]) {
    place_at(beams, beams->start + i * beams->pitch, beams->theta[j], beams->phi[k], place);
}

/* The ends of a table, and the angle between them that is nearest to 0: where sine and cosine are extreme. */
static void extreme_angles(const double *table, uint32_t count, double out[3]) {
    const double low = fmin(table[0], table[count - 1]), high = fmax(table[0], table[count - 1]);
    out[0] = low;
    out[1] = high;
    out[2] = fmin(fmax(0.0, low), high);
}

void hs_beams_box(const hs_beams *beams, double low[3], double high[3]) {
    const double radius[2] = {beams->start, beams->start + (beams->samples - 1) * beams->pitch};
    double theta[3], phi[3];
    extreme_angles(beams->theta, beams->lines, theta);
    extreme_angles(beams->phi, beams->planes, phi);
    for (int a = 0; a < 3; a++) {
        low[a] = INFINITY;
        high[a] = -INFINITY;
    }
    for (int n = 0; n < 2 * 3 * 3; n++) {
        double place[3];
        place_at(beams, radius[n % 2], theta[n / 2 % 3], phi[n / 6], place);
        for (int a = 0; a < 3; a++) {
            low[a] = fmin(low[a], place[a]);
            high[a] = fmax(high[a], place[a]);
        }
    }
}

bool hs_beams_even(const double *table, uint32_t count) {
    const double step = (table[count - 1] - table[0]) / (count - 1);
    for (uint32_t i = 0; i < count; i++)
        if (fabs(table[i] - (table[0] + i * step)) > EVEN_STEP * fabs(step)) return false;
    return true;
}

/* Where `angle` lies in a table of `count` (>= 2) angles, 0 .. count - 1, linearly between two of them; -1 if
 * it lies beyond them. */
static double angle_index(const double *table, uint32_t count, double angle) {
    const double sign = table[count - 1] > table[0] ? 1.0 : -1.0, wanted = sign * angle;
    if (!(wanted >= sign * table[0] && wanted <= sign * table[count - 1])) return -1.0;
    /* Most tables are even: the first guess is right but for rounding. */
    const double guess = (angle - table[0]) / (table[count - 1] - table[0]) * (count - 1);
    uint32_t low = (uint32_t)fmin(fmax(guess, 0.0), count - 2.0);
    if (wanted < sign * table[low] || wanted > sign * table[low + 1]) {
        low = 0;
        for (uint32_t high = count - 1; high - low > 1;) {
            const uint32_t middle = low + (high - low) / 2;
            if (wanted < sign * table[middle])
                high = middle;
            else
                low = middle;
        }
    }
    return low + (angle - table[low]) / (table[low + 1] - table[low]);
}

double hs_beams_locate_plane(const hs_beams *beams, double y, double z, double *depth) {
    const double behind_axis = z - beams->axis;
    *depth = sqrt(y * y + behind_axis * behind_axis) + beams->axis;
    return angle_index(beams->phi, beams->planes, atan2(hs_beams_side(beams) * y, behind_axis));
}

bool hs_beams_locate_in_plane(const hs_beams *beams, double x, double depth, double index[2]) {
    index[0] = (sqrt(x * x + depth * depth) - beams->start) / beams->pitch;
    if (!(index[0] >= 0.0 && index[0] <= beams->samples - 1.0)) return false;
    index[1] = angle_index(beams->theta, beams->lines, atan2(x, depth));
    return index[1] >= 0.0;
}

bool hs_beams_locate(const hs_beams *beams, const double place[3], double index[3]) {
    double depth;
    index[2] = hs_beams_locate_plane(beams, place[1], place[2], &depth);
    return index[2] >= 0.0 && hs_beams_locate_in_plane(beams, place[0], depth, index);
}

/* The lower of the two neighbours of an index, which is `count` - 2 at most, and the share of the upper. */
static uint32_t lower(double index, uint32_t count, double *share) {
    const uint32_t i = index < count - 2.0 ? (uint32_t)index : count - 2;
    *share = index - i;
    return i;
}

double hs_beams_sample(const hs_beams *beams, const double index[3]) {
    double fi, fj, fk;
    const uint32_t i = lower(index[0], beams->samples, &fi), j = lower(index[1], beams->lines, &fj),
                   k = lower(index[2], beams->planes, &fk);
    const size_t line = beams->samples, plane = line * beams->lines;
    const uint8_t *at = beams->voxels + k * plane + j * line + i;
    double mean[2];
    for (int p = 0; p < 2; p++, at += plane) {
        const double near = at[0] + fi * (at[1] - at[0]), far = at[line] + fi * (at[line + 1] - at[line]);
        mean[p] = near + fj * (far - near);
    }
    return mean[0] + fk * (mean[1] - mean[0]);
}
