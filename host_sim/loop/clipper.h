/* SPDX-License-Identifier: MIT */
/*
 * The plugin's share of a frame: slabs in, depthmap out. It fails softly: whatever the plugin does, the frame
 * goes on, and the first failure is kept.
 */
#pragma once

#include "loop/slabs.h"
#include "plugin/capabilities.h"
#include "plugin/loader.h"
#include "render/dvr.h"

typedef struct {
    bool own_queue;               /* the plugin picks its own device and queue (SV_CARRIER_HOST only) */
    float spacing_mm[3];          /* of the slabs' voxels */
    bool want_confidence;         /* asks for the confidence of every frame, if the plugin has it */
    const hs_error *refused;      /* why the plugin must not be activated; NULL or code HS_OK: it may be */
    const sv_param_value *values; /* borrowed; see hs_clipper_set_values */
    uint32_t value_count;
} hs_clipper_options;

/* True if a frame that came to this has a map to draw: SV_OK, or SV_PARTIAL, whose pixels without a surface
 * are 0 and clip nothing. */
bool hs_outcome_clips(sv_status outcome);

/* What a call of the plugin came to. */
typedef struct {
    bool clipped;            /* the map may be used: hs_outcome_clips */
    bool has_confidence;     /* and so may its confidence */
    hs_doubt doubt;          /* of a surface that may be used */
    sv_status outcome;       /* the plugin's; SV_ERR_STATE if it is not there or not active */
    sv_stats stats;          /* the plugin's; zeros if it failed */
    sv_points_report points; /* smartvis.points/1; size is 0 if the plugin does not have it or failed */
} hs_clip_outcome;

typedef struct hs_clipper hs_clipper;

/* Makes the memory and activates the plugin (NULL: there is none). `cl`, `slabs` and `plugin` must outlive
 * it. NULL only for failures of the host's own (HS_ERR_DEVICE, HS_ERR_MEMORY); those of the plugin are told
 * by hs_clipper_error. All functions are called from one thread. */
hs_clipper *hs_clipper_create(const hs_cl *cl, const hs_slabs *slabs, const hs_plugin *plugin,
                              const hs_clipper_options *options, hs_error *err);
void hs_clipper_destroy(hs_clipper *clipper);

/* Other parameter values from the next frame on. Borrowed until the next call of this, or the end. */
void hs_clipper_set_values(hs_clipper *clipper, const sv_param_value *values, uint32_t count);
/* Those that are set now. */
const sv_param_value *hs_clipper_values(const hs_clipper *clipper, uint32_t *count);

/* What the next frames shall give beside the depthmap. */
void hs_clipper_want(hs_clipper *clipper, bool status, bool confidence);
bool hs_clipper_wants_confidence(const hs_clipper *clipper);

/* Which volume a frame is about. */
typedef struct {
    uint64_t index;
    uint64_t time_ns; /* when it was acquired; 0: unknown */
    bool continues;   /* the scan of the frame before */
    bool same_volume; /* and the very volume */
    bool moved;       /* the camera, since that frame */
    hs_told told;
} hs_frame_facts;

/* One frame: begin, every slab, end; waits for the queue. The slabs must be converted, and the queue have
 * run. HS_ERR_DEVICE. */
bool hs_clipper_frame(hs_clipper *clipper, hs_frame_facts facts, hs_clip_outcome *clip, hs_error *err);

/* The last successful frame with other values for parameters that are flagged SV_PARAM_ADJUST. */
bool hs_clipper_adjust(hs_clipper *clipper, const sv_param_value *values, uint32_t count,
                       hs_clip_outcome *clip, hs_error *err);

/* Where rays start by the last call's map, for hs_dvr_render: *out, or NULL if `clipped` is false.
 * `with_confidence` adds the confidence. *out points into the clipper. */
const hs_start_depths *hs_clipper_start(const hs_clipper *clipper, bool clipped, bool with_confidence,
                                        hs_start_depths *out);

/* Reads back what the last call left, width * height values of the slabs' layout: the depthmap in slices, the
 * confidence 0 .. 1 (only where hs_clip_outcome.has_confidence). Waits for the queue. HS_ERR_DEVICE. */
bool hs_clipper_read_depth(const hs_clipper *clipper, float *depth, hs_error *err);
/* Another depthmap in place of the last call's; waits. */
bool hs_clipper_write_depth(hs_clipper *clipper, const float *depth, hs_error *err);
bool hs_clipper_read_confidence(const hs_clipper *clipper, float *confidence, hs_error *err);
/* SV_POINT_* of every pixel, of the last frame that was asked for them; owned by the clipper. */
const uint8_t *hs_clipper_status(const hs_clipper *clipper);

/* The plugin's first failure, and the first of its confidence, which is not among the others. Code HS_OK if
 * there was none. Owned by the clipper. */
const hs_error *hs_clipper_error(const hs_clipper *clipper);
const hs_error *hs_clipper_confidence_error(const hs_clipper *clipper);

/* Of the plugin's failures so far nothing is told any more: the next one is the first. */
void hs_clipper_forget_error(hs_clipper *clipper);

/* Switches the plugin's own timing on or off; false if it has none. */
bool hs_clipper_time_stages(const hs_clipper *clipper, bool on);
/* Its times for the last frame; false if it has none. */
bool hs_clipper_stage_times(const hs_clipper *clipper, sv_stage_times *times);
