/* SPDX-License-Identifier: MIT */
/* What a frame tells of the probe and its beams, for methods and their definitions. */
#pragma once

#include "smartvis/probe.h"

#include <stdbool.h>
#include <stdint.h>

/* The fields of sv_frame with the same meaning (smartvis_plugin.h draws them); what is not told is 0. */
typedef struct {
    float rotation[9]; /* probe_rotation */
    float side[3];     /* probe_side */
    uint32_t kind;     /* beams: SV_BEAMS_* */
    float apex_mm[3], sweep_mm;
    bool same_volume; /* as the frame before */
} sv_beams;

/* What a frame says of them; fields behind its size count as not told. */
static inline sv_beams sv_beams_of(const sv_frame *frame) {
    sv_beams b = {.same_volume = (frame->flags & SV_FRAME_SAME_VOLUME) != 0};
    sv_probe_of(frame, b.rotation, b.side);
    b.kind = sv_probe_beams_of(frame, b.apex_mm, &b.sweep_mm);
    return b;
}
