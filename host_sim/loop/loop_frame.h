/* SPDX-License-Identifier: MIT */
/* A frame of the scan loop, as numbers. */
#ifndef HS_LOOP_FRAME_H
#define HS_LOOP_FRAME_H

#include "loop/loop_options.h"
#include "plugin/plugin_ext.h"

/* What one frame came to. */
typedef struct {
    double ms[HS_STAGE_COUNT];
    bool clipped;            /* the picture was rendered with the plugin's map (hs_outcome_clips) */
    bool sure;               /* and its ghosting with the plugin's confidence */
    sv_status outcome;       /* the plugin's, SV_OK if it was not asked */
    sv_stats stats;          /* the plugin's; zeros if it was not asked or failed */
    sv_points_report points; /* smartvis.points/1; size is 0 if the plugin does not have it or failed */
} hs_frame;

#endif
