/* SPDX-License-Identifier: MIT */
/* A plugin with its settings, and what it is active for. */
#pragma once

#include "door/door.h"
#include "loop/clipper.h"

struct svh_clipper {
    svh_host *host;
    hs_plugin plugin;
    sv_param_value *values; /* those that are set */
    uint32_t value_count;
    sv_param_value *fixed; /* the plugin is active with these, for this grid ... */
    uint32_t fixed_count;
    uint32_t n[3];
    float spacing_mm[3];
    bool gaps;
    hs_slabs *slabs; /* ... in these; NULL: it is not active */
    hs_clipper *clipper;
    float *depth, *confidence; /* maps of the last frame */
    uint64_t index;            /* of the next frame */
    bool has_before;
    svh_volume *volume; /* the last one, with its camera and marks */
    hs_camera camera;
    hs_mark *marks;
    uint32_t mark_count;
    sv_stage_times times; /* of the last frame, if they were asked for */
    char why[HS_REASON_BYTES];
};

/* True if the numbers are the same; NaN is like none. */
bool door_same(const double *a, const double *b, size_t count);

/* Makes the plugin active for such volumes, unless it is. What it says against it shows in its first frame.
 */
bool door_activate(svh_clipper *clipper, svh_volume *volume, const svh_view *view, const hs_camera *camera,
                   hs_error *err);

/* Ends the activation, if there is one. */
void door_deactivate(svh_clipper *clipper);

/* Of those that are set, the values that only activation reads. NULL with HS_ERR_MEMORY. */
sv_param_value *door_fixed(const svh_clipper *clipper, uint32_t *count, hs_error *err);

/* mm between the voxels of the grid, as a format tells them: zeros if the volume's are not known. */
void door_spacing(const svh_volume *volume, const svh_view *view, float out[3]);
