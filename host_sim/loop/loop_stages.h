/* SPDX-License-Identifier: MIT */
/*
 * Single stages of a frame, with what they leave read back to the host: for measuring a plugin without
 * drawing a picture for every setting. All work on the volume that is on the device, which is the source's
 * first in a loop that ran no frame, and wait for the device. False: HS_ERR_DEVICE.
 */
#ifndef HS_LOOP_STAGES_H
#define HS_LOOP_STAGES_H

#include "loop/loop.h"

/* Scan conversion for frame `index`. The slabs stay as they are until the next one. */
bool hs_loop_convert(hs_loop *loop, uint32_t index, hs_error *err);

/* The plugin's share of frame `index`: begin, slabs, end, with the loop's values. `map` (may be NULL)
 * receives the depthmap, width * height slices of the loop's layout, or zeros, which clip nothing, if it may
 * not be used. Times are not measured: frame->ms is zero. A failing plugin is no error
 * (hs_loop_plugin_error). */
bool hs_loop_clip(hs_loop *loop, uint32_t index, hs_frame *frame, float *map, hs_error *err);

/* The same for the last frame with another value of a parameter that is flagged SV_PARAM_ADJUST. */
bool hs_loop_adjust(hs_loop *loop, sv_param_value value, hs_frame *frame, float *map, hs_error *err);

/*
 * Where the rays end: a pixel's value is the depth in steps at which its opacity reached the renderer's
 * limit, or hs_loop_ray_steps if it never did (hs_dvr_render). As many values as the picture has pixels. Rays
 * start where the map of `frame`, the last one, tells (NULL: none, the full volume); or all at one step (>
 * 0); or at the front of another volume, of the source's size, that is uploaded for it.
 */
bool hs_loop_ray_ends(hs_loop *loop, uint32_t index, const hs_frame *frame, float *ends, hs_error *err);
bool hs_loop_ray_ends_from(hs_loop *loop, uint32_t index, uint32_t step, float *ends, hs_error *err);
bool hs_loop_ray_ends_in(hs_loop *loop, uint32_t index, const hs_volume *other, float *ends, hs_error *err);

/* Steps of a ray of frame `index` that crosses the whole box. */
uint32_t hs_loop_ray_steps(const hs_loop *loop, uint32_t index);

#endif
