/* SPDX-License-Identifier: MIT */
/*
 * The scan loop: volume -> scan conversion -> slabs -> plugin -> depthmap -> DVR -> picture, N times, in the
 * three settings of the thesis' Figure 5.21, with the time of every stage as in its Table 5.4.
 *
 * Memory and OpenCL objects are made by hs_loop_create; a frame allocates nothing, compiles nothing and
 * creates no OpenCL object. All functions of a loop are called from one thread.
 */
#pragma once

#include "loop/loop_options.h"
#include "loop/screen.h"
#include "loop/source.h"
#include "plugin/loader.h"

/*
 * Builds a loop. `cl`, `source`, `plugin` and options->values must outlive it. `plugin` may be NULL: then
 * even the setting "smartvis" renders unclipped. A plugin that cannot be activated does not fail the loop
 * either: see hs_loop_plugin_error. NULL with HS_ERR_USAGE (an option out of range), HS_ERR_INPUT
 * (hs_loop_options.from), or with HS_ERR_DEVICE or HS_ERR_MEMORY.
 */
hs_loop *hs_loop_create(const hs_cl *cl, const hs_source *source, const hs_plugin *plugin,
                        const hs_loop_options *options, hs_error *err);
void hs_loop_destroy(hs_loop *loop);

/* Pixels across the low-resolution volume of such a loop: options->lowres or, if that is 0, as many as 1 mm
 * each needs, at least a third of the source's and at most as many as it has. */
uint32_t hs_loop_lowres(const hs_source *source, const hs_loop_options *options);

/* What it was built with, and the low-resolution volume with its slabs. Owned by the loop. */
const hs_loop_options *hs_loop_get_options(const hs_loop *loop);
const hs_slab_layout *hs_loop_layout(const hs_loop *loop);

/* The camera of frame `index`, in the box that holds every frame of the run. */
void hs_loop_camera(const hs_loop *loop, uint32_t index, hs_camera *camera);

/* The same camera with the picture's window for a box: hs_loop_options.zoom. *share is the window's side as a
 * part of the box' (hs_start_depths.share). */
void hs_loop_window(const hs_loop *loop, uint32_t index, hs_camera *window, float *share);

/* One frame of `setting`, with the camera and volume of frame `index` (0 .. frames - 1). A failing plugin is
 * no error of the frame: it renders unclipped, and hs_loop_plugin_error tells. False: HS_ERR_DEVICE. */
bool hs_loop_frame(hs_loop *loop, hs_setting setting, uint32_t index, hs_frame *frame, hs_error *err);

/* One with the plugin, but without a picture. */
bool hs_loop_frame_undrawn(hs_loop *loop, uint32_t index, hs_frame *frame, hs_error *err);

/*
 * For who decides from frame to frame what must be done anew.
 *
 * hs_loop_want: whether the plugin is asked for points and confidence, too. hs_loop_look: another camera from
 * the next frame on; the loop must be turnable. hs_loop_ask: the plugin's share of frame `index`, whose
 * volume was brought and converted (hs_loop_convert); it continues the one before, if camera and volumes do.
 * hs_loop_draw: enqueues the result of `frame`, the last one, or the full volume (NULL), with the loop's
 * window, on any screen. hs_loop_bring: enqueues the way of frame `index`' volume to the device, unless it is
 * there. hs_loop_reactivate: the plugin's share anew, with another plugin (or NULL), other values of what
 * only activate reads, or another handover; everything else stays. What is read of `asked` are the plugin's
 * options. HS_ERR_DEVICE, HS_ERR_MEMORY, for hs_loop_bring the source's; after a failed hs_loop_reactivate
 * the loop can only be destroyed.
 */
void hs_loop_want(hs_loop *loop, bool status, bool confidence);
void hs_loop_look(hs_loop *loop, double yaw, double pitch, double roll, double zoom);
bool hs_loop_bring(hs_loop *loop, uint32_t index, hs_error *err);
bool hs_loop_ask(hs_loop *loop, uint32_t index, hs_frame *frame, hs_error *err);
bool hs_loop_draw(hs_loop *loop, hs_screen *screen, uint32_t index, const hs_frame *frame, hs_error *err);
bool hs_loop_reactivate(hs_loop *loop, const hs_plugin *plugin, const hs_loop_options *asked, hs_error *err);

/* Other parameter values from the next frame on. Borrowed until this is called again or the loop is
 * destroyed. Those flagged SV_PARAM_REACTIVATE must be what they were. */
void hs_loop_set_values(hs_loop *loop, const sv_param_value *values, uint32_t count);

/* Other marks (hs_loop_options.marks) from the next frame on. Borrowed likewise. */
void hs_loop_set_marks(hs_loop *loop, const hs_mark *marks, uint32_t count);

/* The plugin's first error since the loop was created; code HS_OK if there was none. Owned by the loop. */
const hs_error *hs_loop_plugin_error(const hs_loop *loop);

/* The first time the plugin's confidence failed, or was none; the picture is then as if it had none. Not
 * among the plugin's other errors. Code HS_OK if that never was. Owned by the loop. */
const hs_error *hs_loop_confidence_error(const hs_loop *loop);
