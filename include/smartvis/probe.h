/* SPDX-License-Identifier: MIT */
/*
 * A helper for plugins and hosts, header-only and optional: what a frame says of the probe (sv_frame,
 * probe_rotation and probe_side), and whether that can be.
 */
#ifndef SMARTVIS_PROBE_H
#define SMARTVIS_PROBE_H

#include "smartvis_plugin.h"

#include <stdio.h>

#ifdef __cplusplus
extern "C" {
#endif

#define SV_PROBE_TOLERANCE 0.001f

/* NaN is near to nothing. */
static inline int sv_probe_near(float value, float expected) {
    return value - expected <= SV_PROBE_TOLERANCE && expected - value <= SV_PROBE_TOLERANCE;
}

static inline float sv_probe_dot(const float *a, const float *b) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static inline int sv_probe_is_rotation(const float *r) {
    const float turned[3] = {r[1] * r[5] - r[2] * r[4], r[2] * r[3] - r[0] * r[5], r[0] * r[4] - r[1] * r[3]};
    return sv_probe_near(sv_probe_dot(r, r), 1.0f) && sv_probe_near(sv_probe_dot(r + 3, r + 3), 1.0f) &&
           sv_probe_near(sv_probe_dot(r, r + 3), 0.0f) && sv_probe_near(turned[0], r[6]) &&
           sv_probe_near(turned[1], r[7]) && sv_probe_near(turned[2], r[8]);
}

/* What the frame says, 9 and 3 values; zeros where it says nothing, or is older than 1.1. Not checked. */
static inline void sv_probe_of(const sv_frame *frame, float *rotation, float *side) {
    for (int i = 0; i < 9; i++) rotation[i] = SV_HAS(frame, probe_rotation) ? frame->probe_rotation[i] : 0.0f;
    for (int i = 0; i < 3; i++) side[i] = SV_HAS(frame, probe_side) ? frame->probe_side[i] : 0.0f;
}

/* 1 if the frame says nothing of the probe, or what the header allows; else 0, and `text` names the field,
 * its values and what was expected (200 bytes are enough). */
static inline int sv_probe_holds(const sv_frame *frame, char *text, size_t bytes) {
    float r[9], side[3], known = 0.0f;
    sv_probe_of(frame, r, side);
    for (int i = 0; i < 9; i++) known = r[i] == 0.0f ? known : 1.0f;
    if (known > 0.0f && !sv_probe_is_rotation(r)) {
        (void)snprintf(text, bytes,
                       "probe_rotation is %g %g %g, %g %g %g, %g %g %g, expected a rotation or zeros",
                       (double)r[0], (double)r[1], (double)r[2], (double)r[3], (double)r[4], (double)r[5],
                       (double)r[6], (double)r[7], (double)r[8]);
        return 0;
    }
    const int none = side[0] == 0.0f && side[1] == 0.0f && side[2] == 0.0f;
    const int opposite =
        sv_probe_near(side[0], -r[2]) && sv_probe_near(side[1], -r[5]) && sv_probe_near(side[2], -r[8]);
    if (known > 0.0f ? opposite : none || sv_probe_near(sv_probe_dot(side, side), 1.0f)) return 1;
    if (known > 0.0f)
        (void)snprintf(
            text, bytes,
            "probe_side is %g %g %g, expected the opposite of the rotation's third column, %g %g %g",
            (double)side[0], (double)side[1], (double)side[2], (double)-r[2], (double)-r[5], (double)-r[8]);
    else
        (void)snprintf(text, bytes, "probe_side is %g %g %g, expected a unit vector or zeros",
                       (double)side[0], (double)side[1], (double)side[2]);
    return 0;
}

#ifdef __cplusplus
}
#endif

#endif
