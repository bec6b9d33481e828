/* SPDX-License-Identifier: MIT */
/*
 * The scan loop: volume -> scan conversion -> slabs -> plugin -> depthmap -> DVR -> picture, N times, in the
 * three settings of the thesis' Figure 5.21, with the time of every stage as in its Table 5.4.
 *
 * Memory and OpenCL objects are made by hs_loop_create; a frame allocates nothing, compiles nothing and
 * creates no OpenCL object. All functions of a loop are called from one thread.
 */
#ifndef HS_LOOP_H
#define HS_LOOP_H

#include "base/progress.h"
#include "loop/source.h"
#include "plugin/loader.h"
#include "plugin/plugin_ext.h"
#include "render/dvr.h"

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
    double yaw, pitch; /* degrees; 0, 0 looks from the probe */
    double
        orbit; /* degrees of yaw from the first to the last frame, half to either side of `yaw`; 0: still */
    uint32_t frames;      /* volumes a run takes, >= 1 */
    uint32_t lowres;      /* pixels across the low-resolution volume; 0: a third of the source's resolution */
    uint32_t slab_slices; /* slices of a full slab, >= 1; more than the volume has: one slab */
    uint32_t carrier;     /* SV_CARRIER_* */
    bool own_queue;       /* the plugin picks its own device and queue (SV_CARRIER_HOST only) */
    bool live; /* uploads every frame's volume anew, as a scan does; always so for several volumes */
    hs_dvr_settings dvr;          /* the renderer, the picture's size included. With a ghost (width and doubt
                                     above 0) the plugin's confidence widens it, if the plugin has any. */
    const sv_param_value *values; /* plugin parameters; must outlive the loop */
    uint32_t value_count;
} hs_loop_options;

/* Yaw of frame `index` in degrees: the orbit lies half to either side of options->yaw. */
double hs_loop_yaw(const hs_loop_options *options, uint32_t index);

/* Still camera at 0, 0; 100 frames; a third; slabs of 16; the host's queue with buffers; hs_dvr_defaults. */
void hs_loop_defaults(hs_loop_options *options);

/* The stages of a frame. Each is timed by the wall clock from the host's enqueue until the device has
 * finished. */
typedef enum {
    HS_STAGE_UPLOAD,  /* a new volume to the device, with the renderer's grid of maxima; 0 if it stays */
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
    bool clipped;            /* the picture was rendered with the plugin's map: its status was SV_OK */
    bool sure;               /* and its ghosting with the plugin's confidence */
    sv_status outcome;       /* the plugin's, SV_OK if it was not asked */
    sv_stats stats;          /* the plugin's; zeros if it was not asked or failed */
    sv_points_report points; /* smartvis.points/1; size is 0 if the plugin does not have it or failed */
} hs_frame;

typedef struct hs_loop hs_loop;

/*
 * Builds a loop. `cl`, `source`, `plugin` and options->values must outlive it. `plugin` may be NULL: then
 * even the setting "smartvis" renders unclipped. A plugin that cannot be activated does not fail the loop
 * either: see hs_loop_plugin_error. NULL with HS_ERR_USAGE (an option out of range), HS_ERR_DEVICE or
 * HS_ERR_MEMORY.
 */
hs_loop *hs_loop_create(const hs_cl *cl, const hs_source *source, const hs_plugin *plugin,
                        const hs_loop_options *options, hs_error *err);
void hs_loop_destroy(hs_loop *loop);

/* The low-resolution volume and its slabs. */
const hs_slab_layout *hs_loop_layout(const hs_loop *loop);

/* One frame of `setting`, with the camera and volume of frame `index` (0 .. frames - 1). A failing plugin is
 * no error of the frame: it renders unclipped, and hs_loop_plugin_error tells. False: HS_ERR_DEVICE. */
bool hs_loop_frame(hs_loop *loop, hs_setting setting, uint32_t index, hs_frame *frame, hs_error *err);

/* Other parameter values from the next frame on. Borrowed until this is called again or the loop is
 * destroyed. Those flagged SV_PARAM_REACTIVATE must be what they were. */
void hs_loop_set_values(hs_loop *loop, const sv_param_value *values, uint32_t count);

/* The first error of the plugin since the loop was created; code HS_OK if there was none. */
const hs_error *hs_loop_plugin_error(const hs_loop *loop);

/* The first time the plugin's confidence failed, or was none; the picture is then as if it had none. Not
 * among the plugin's other errors. Code HS_OK if that never was. */
const hs_error *hs_loop_confidence_error(const hs_loop *loop);

/* Median and 95th percentile (nearest rank) in ms. */
typedef struct {
    double median, p95;
} hs_timing;

/* One setting over all frames. */
typedef struct {
    hs_setting setting;
    uint32_t frames;
    uint32_t clipped_frames; /* rendered with the plugin's map */
    uint32_t note_frames;    /* the plugin gave a positive status: rendered unclipped */
    uint32_t failed_frames;  /* the plugin failed or was not there: rendered unclipped */
    hs_timing stage[HS_STAGE_COUNT];
    double volumes_per_second; /* 1000 / median of the whole loop */
    double plugin_share;       /* median of the plugin / median of the loop, 0 .. 1 */
    sv_status outcome;         /* of the last frame, with its statistics */
    sv_stats stats;
    sv_points_report points;
    bool has_plugin_stages;       /* the plugin has smartvis.timing/1 and it gave times: */
    sv_stage_times plugin_stages; /* medians of a few extra frames, measured apart because events cost time */
} hs_loop_result;

/* Runs options->frames frames of one setting after one that is not counted. `progress` may be NULL; it is
 * told about every frame. */
bool hs_loop_run(hs_loop *loop, hs_setting setting, hs_progress *progress, hs_loop_result *result,
                 hs_error *err);

/*
 * Everything pictures are made of, for one frame of the setting "smartvis". Pictures are width * height RGBA
 * bytes; maps are map_width * map_height values. Free with hs_view_free.
 */
typedef struct {
    uint32_t width, height;
    uint8_t *result;         /* as the loop renders it */
    uint8_t *full;           /* unclipped, same camera */
    uint8_t *truth;          /* the scene's ground truth, same camera; NULL if there is none */
    uint8_t *mip;            /* maximum intensity projection, one byte a pixel */
    float *termination;      /* of the result: see hs_dvr_render */
    float *full_termination; /* of the full volume */
    uint32_t map_width, map_height, slices;
    float *depth;    /* the plugin's depthmap, in low-resolution slices; zeros if it was not used */
    uint8_t *status; /* SV_POINT_* */
    float *sure;     /* the plugin's confidence, 0 .. 1; NULL if it gave none */
    hs_camera camera;
    hs_frame frame;
} hs_view;

bool hs_loop_view(hs_loop *loop, uint32_t index, hs_view *view, hs_error *err);

/* Frame `index` once more with the primary parameter at `value`, after hs_loop_frame has run it: by the
 * plugin's adjust where the parameter allows it, else as a whole frame. `rgba` (4 bytes a pixel) receives the
 * picture. */
bool hs_loop_turn(hs_loop *loop, uint32_t index, const sv_param_info *primary, double value, uint8_t *rgba,
                  hs_error *err);
void hs_view_free(hs_view *view);

#endif
