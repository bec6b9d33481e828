/* SPDX-License-Identifier: MIT */
#include "judge/wall_judge.h"

#include <math.h>

#define TOLERANCE 2.0f /* slices of 128 */

uint32_t wall_first_drawn(float depth, uint32_t nz) {
    if (!(depth > 0.0f)) return 0;
    const float first = ceilf(depth - 1e-3f);
    return first >= (float)nz ? nz : (uint32_t)first;
}

float wall_ray_end(const wall_case *c, const uint8_t *voxels, size_t pixel, float depth) {
    return wall_termination(voxels, (size_t)c->nx * c->ny, c->nz, pixel, wall_first_drawn(depth, c->nz));
}

wall_score wall_judge(const wall_case *c, const uint8_t *original, const float *depth,
                      const float *confidence, wall_calibration *calibration) {
    const size_t plane = (size_t)c->nx * c->ny;
    const float scale = 128.0f / (float)c->nz;
    double sum = 0.0;
    uint64_t rays = 0, fetus = 0, cut = 0, left = 0;
    for (size_t i = 0; i < plane; i++) {
        if (c->label[i] == 0) continue;
        const float error = scale * (c->truth[i] - wall_ray_end(c, original, i, depth[i]));
        sum += fabs((double)error);
        rays++;
        left += error > TOLERANCE;
        fetus += c->label[i] == 2;
        cut += c->label[i] == 2 && error < -TOLERANCE;
        const int bin = (int)(confidence[i] * (WALL_BINS - 1) + 0.5f);
        if (fabsf(error) > TOLERANCE)
            calibration->wrong[bin]++;
        else
            calibration->right[bin]++;
    }
    return (wall_score){rays ? sum / (double)rays : 0.0, fetus ? (double)cut / (double)fetus : 0.0,
                        rays ? (double)left / (double)rays : 0.0};
}

double wall_auc(const wall_calibration *t) {
    double right = 0.0, wrong = 0.0, pairs = 0.0;
    for (int i = 0; i < WALL_BINS; i++) { /* rays of less confidence have been counted */
        pairs += (double)t->right[i] * (wrong + 0.5 * (double)t->wrong[i]);
        right += (double)t->right[i];
        wrong += (double)t->wrong[i];
    }
    return right > 0.0 && wrong > 0.0 ? pairs / (right * wrong) : 1.0;
}

bool wall_reliability(const wall_calibration *t, double low, double high, uint64_t least, double *right,
                      double *mean) {
    uint64_t good = 0, all = 0;
    double sum = 0.0;
    for (int i = 0; i < WALL_BINS; i++) {
        const double confidence = (double)i / (WALL_BINS - 1);
        if (confidence < low || confidence >= high) continue;
        good += t->right[i];
        all += t->right[i] + t->wrong[i];
        sum += confidence * (double)(t->right[i] + t->wrong[i]);
    }
    if (all == 0 || all < least) return false;
    *right = (double)good / (double)all;
    *mean = sum / (double)all;
    return true;
}

double wall_cut_anywhere(const wall_case *c, const float *depth) {
    const size_t plane = (size_t)c->nx * c->ny;
    const float scale = 128.0f / (float)c->nz;
    uint64_t rays = 0, cut = 0;
    for (size_t i = 0; i < plane; i++) {
        const float whole = wall_termination(c->full, plane, c->nz, i, 0);
        if (whole >= (float)c->nz) continue;
        rays++;
        cut += scale * (wall_ray_end(c, c->full, i, depth[i]) - whole) > TOLERANCE;
    }
    return rays ? (double)cut / (double)rays : 0.0;
}
