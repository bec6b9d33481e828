/* SPDX-License-Identifier: MIT */
/*
 * Extension smartvis.timing/1: where the time of a frame went. It needs a queue with
 * CL_QUEUE_PROFILING_ENABLE (a plugin's own queue has it). Tags and rules are those of smartvis_plugin.h.
 */
#ifndef SMARTVIS_TIMING_H
#define SMARTVIS_TIMING_H

#include "smartvis_plugin.h"

SMARTVIS_BEGIN_C

#define SV_EXT_TIMING "smartvis.timing/1"

/* Milliseconds on the device, by stage. A stage that a method does not have is 0. */
typedef struct sv_stage_times {
    uint32_t size;
    uint32_t reserved;     /* 0 */
    double transfer_ms;    /* copies of slabs to the device; 0 where slabs are read in place */
    double profile_ms;     /* what is done to every slab */
    double threshold_ms;   /* what the whole volume decides, before there is a surface */
    double reconstruct_ms; /* the surface, where the device tells it from threshold */
    double output_ms;      /* results to the host */
} sv_stage_times;

typedef struct sv_ext_timing {
    uint32_t size;
    uint32_t reserved; /* 0 */

    /* [control & active] Switches timing on or off (off after activate): on, each command keeps its event. */
    sv_status(SV_CALL *enable)(const sv_plugin *plugin, uint32_t on);

    /* [control & active] Times of the last frame whose end succeeded; adjust does not change them. Its
     * commands must have run. SV_ERR_STATE if there is no such frame or timing was off, SV_ERR_OPENCL if the
     * queue does not profile. */
    sv_status(SV_CALL *stage_times)(const sv_plugin *plugin, sv_stage_times *out);
} sv_ext_timing;

SMARTVIS_END_C

#endif
