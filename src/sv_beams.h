/* SPDX-License-Identifier: MIT */
/* What a frame tells of the probe and its beams, for methods and their definitions. */
#ifndef SV_BEAMS_H
#define SV_BEAMS_H

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

#endif
