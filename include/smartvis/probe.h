/* SPDX-License-Identifier: MIT */
/*
 * A helper for plugins and hosts, header-only and optional: what a frame says of the probe and its beams
 * (sv_frame, probe_rotation and what follows it), and whether that can be.
 *
 * A fan of beams is a part of a torus, drawn in the probe's axes:
 *
 *     across the sweep (x, z)        along the sweep (y, z)
 *
 *                A                             A          A  the apex, beam_apex_mm: where the lines of the
 *               /|\                            :             middle plane meet
 *              / | \                           o          o  the axis of the sweep, which runs along x:
 *             / .-. \                         /|\            beam_sweep_mm from the apex, along z
 *            /.'   '.\ the probe's face      /.-.\
 *           /         \                     /     \
 *           '-._____.-'                    '-.___.-'
 *
 * At radius r of the line at angle th in the plane at angle ph, from the apex:
 *
 *     h = r cos th - beam_sweep_mm      x = r sin th   y = h sin ph   z = beam_sweep_mm + h cos ph
 *
 * A fan that is swept along a straight line is one whose axis is very far, and so is the apex of parallel
 * lines that are swept about an axis: take 100,000 mm, which is the most.
 */
#ifndef SMARTVIS_PROBE_H
#define SMARTVIS_PROBE_H

#include "smartvis_plugin.h"

#include <stdio.h>

SMARTVIS_BEGIN_C

#define SV_PROBE_TOLERANCE   0.001f
#define SV_PROBE_FARTHEST_MM 100000.0f

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

/* How the beams run, SV_BEAMS_*, with 3 values and 1; SV_BEAMS_UNKNOWN and zeros where the frame does not say
 * it, or is older. Not checked. */
static inline uint32_t sv_probe_beams_of(const sv_frame *frame, float *apex_mm, float *sweep_mm) {
    const int told = SV_HAS(frame, reserved_beams);
    for (int i = 0; i < 3; i++) apex_mm[i] = told ? frame->beam_apex_mm[i] : 0.0f;
    *sweep_mm = told ? frame->beam_sweep_mm : 0.0f;
    return told ? frame->beams : 0u;
}

/* As sv_probe_holds, of the beams alone; `known`: the frame tells a rotation. */
static inline int sv_probe_beams_hold(const sv_frame *frame, int known, char *text, size_t bytes) {
    float fan[4];
    int within = 1; /* NaN is not */
    const uint32_t beams = sv_probe_beams_of(frame, fan, fan + 3);
    const uint32_t reserved = SV_HAS(frame, reserved_beams) ? frame->reserved_beams : 0;
    const float farthest = beams == SV_BEAMS_FAN ? SV_PROBE_FARTHEST_MM : 0.0f;
    for (int i = 0; i < 4; i++) within &= fan[i] <= farthest && fan[i] >= -farthest;
    if (beams > SV_BEAMS_FAN)
        (void)snprintf(text, bytes, "beams is %u, expected 0 to %u", (unsigned)beams, (unsigned)SV_BEAMS_FAN);
    else if (reserved != 0)
        (void)snprintf(text, bytes, "reserved_beams is %u, expected 0", (unsigned)reserved);
    else if (beams != SV_BEAMS_UNKNOWN && !known)
        (void)snprintf(text, bytes, "beams is %u without probe_rotation", (unsigned)beams);
    else if (!within)
        (void)snprintf(text, bytes, "beam_apex_mm is %g %g %g and beam_sweep_mm %g, expected %s",
                       (double)fan[0], (double)fan[1], (double)fan[2], (double)fan[3],
                       beams == SV_BEAMS_FAN ? "-100000 to 100000" : "0 where beams is no fan");
    else
        return 1;
    return 0;
}

/* 1 if the frame says nothing of the probe, or what the header allows; else 0, and `text` names the field,
 * its values and what was expected (200 bytes are enough). */
static inline int sv_probe_holds(const sv_frame *frame, char *text, size_t bytes) {
    float r[9], side[3];
    int known = 0;
    sv_probe_of(frame, r, side);
    for (int i = 0; i < 9; i++) known |= r[i] != 0.0f;
    if (known && !sv_probe_is_rotation(r)) {
        (void)snprintf(text, bytes,
                       "probe_rotation is %g %g %g, %g %g %g, %g %g %g, expected a rotation or zeros",
                       (double)r[0], (double)r[1], (double)r[2], (double)r[3], (double)r[4], (double)r[5],
                       (double)r[6], (double)r[7], (double)r[8]);
        return 0;
    }
    const int none = side[0] == 0.0f && side[1] == 0.0f && side[2] == 0.0f;
    const int opposite =
        sv_probe_near(side[0], -r[2]) && sv_probe_near(side[1], -r[5]) && sv_probe_near(side[2], -r[8]);
    if (known ? opposite : none || sv_probe_near(sv_probe_dot(side, side), 1.0f))
        return sv_probe_beams_hold(frame, known, text, bytes);
    if (known)
        (void)snprintf(
            text, bytes,
            "probe_side is %g %g %g, expected the opposite of the rotation's third column, %g %g %g",
            (double)side[0], (double)side[1], (double)side[2], (double)-r[2], (double)-r[5], (double)-r[8]);
    else
        (void)snprintf(text, bytes, "probe_side is %g %g %g, expected a unit vector or zeros",
                       (double)side[0], (double)side[1], (double)side[2]);
    return 0;
}

SMARTVIS_END_C

#endif
