/* SPDX-License-Identifier: MIT */
/* What a scan loop runs, and how: its settings, its stages, its options, and a frame as numbers. */
#pragma once

#include "loop/marks.h"
#include "plugin/capabilities.h"
#include "render/dvr.h"
#include "smartvis_plugin.h"

typedef struct hs_loop hs_loop;

/* What a frame consists of (thesis, Figure 5.21). Only the last clips: the others render the full volume. */
typedef enum {
    HS_SETTING_DVR,      /* DVR alone */
    HS_SETTING_CONVERT,  /* scan conversion, DVR */
    HS_SETTING_SMARTVIS, /* scan conversion, plugin, DVR started at the depthmap */
    HS_SETTING_COUNT
} hs_setting;

/* "dvr", "convert", "smartvis": for command lines and files. */
const char *hs_setting_key(hs_setting setting);
/* "DVR", "DVR + scan conversion", "DVR + scan conversion + plugin": for a person. */
const char *hs_setting_label(hs_setting setting);

typedef struct {
    hs_from from;      /* where the camera is while yaw and pitch are 0; HS_ERR_INPUT if the volume must say
                          how it lies and does not */
    double yaw, pitch; /* degrees */
    double roll;       /* the same, of the picture about its middle, clockwise */
    /* Degrees of yaw from the first to the last frame, half to either side of `yaw`; 0: still. */
    double orbit;
    /* One box for every direction, a cube with the volume's diagonal: the camera may then be turned between
     * frames (hs_loop_look). */
    bool turnable;
    /* The picture shows 1 / zoom of the box' side; of a turnable box, of the side of the box at yaw and pitch
     * 0. 0 counts as 1. */
    double zoom;
    uint32_t frames;      /* volumes a run takes, >= 1 */
    uint32_t lowres;      /* pixels across the low-resolution volume; 0: hs_loop_lowres */
    uint32_t slab_slices; /* slices of a full slab, >= 1; more than the volume has: one slab */
    uint32_t carrier;     /* SV_CARRIER_* */
    bool own_queue;       /* the plugin picks its own device and queue (SV_CARRIER_HOST only) */
    bool carrier_fixed; /* a plugin that takes slabs in another way only is an error; else they go that way */
    hs_fan fan;         /* how the plugin is told what was scanned: the loop fills it in */
    bool live;          /* uploads every frame's volume anew, as a scan does; always so for several volumes */
    /* The renderer, the picture's size included. With a ghost (width and doubt above 0) the plugin's
     * confidence widens it, if the plugin has any. */
    hs_dvr_settings dvr;
    const sv_param_value *values; /* plugin parameters; must outlive the loop */
    uint32_t value_count;
    const hs_mark *marks; /* change the plugin's map, if it has one; must outlive the loop */
    uint32_t mark_count;
} hs_loop_options;

#define HS_LOOP_MAX_ZOOM 32.0

/* Still camera at 0, 0; 100 frames; hs_loop_lowres; slabs of 16; the host's queue with buffers;
 * hs_dvr_defaults. */
void hs_loop_defaults(hs_loop_options *options);

/* Draws in this look, at the exposure that suits it. */
void hs_loop_for_pictures(hs_loop_options *options, hs_look look);

/* Yaw of frame `index` in degrees: the orbit lies half to either side of options->yaw. */
double hs_loop_yaw(const hs_loop_options *options, uint32_t index);

/* The stages of a frame. Each is timed by the wall clock, from the host's enqueue to the device's end. */
typedef enum {
    HS_STAGE_UPLOAD,  /* a new volume to the device, with what the renderer makes of it; 0 if it stays */
    HS_STAGE_CONVERT, /* scan conversion of all slabs into the plugin's carrier */
    HS_STAGE_PLUGIN,  /* begin, slab x n, end, and the depthmap on its way to the renderer */
    HS_STAGE_DVR,     /* the picture */
    HS_STAGE_LOOP,    /* the whole frame */
    HS_STAGE_COUNT
} hs_stage;

/* "upload", "scan conversion", ...: for a person. */
const char *hs_stage_label(hs_stage stage);

/* What one frame came to. */
typedef struct {
    double ms[HS_STAGE_COUNT];
    bool clipped;            /* the picture was rendered with the plugin's map (hs_outcome_clips) */
    bool has_confidence;     /* and its ghosting with the plugin's confidence */
    hs_doubt doubt;          /* of the map that it was rendered with */
    sv_status outcome;       /* the plugin's, SV_OK if it was not asked */
    sv_stats stats;          /* the plugin's; zeros if it was not asked or failed */
    sv_points_report points; /* smartvis.points/1; size is 0 if the plugin does not have it or failed */
} hs_frame;
