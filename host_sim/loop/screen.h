/* SPDX-License-Identifier: MIT */
/* The loop's renderer with the pictures it draws into. */
#pragma once

#include "render/dvr.h"

typedef struct hs_screen hs_screen;

/* `cl` must outlive it. NULL with HS_ERR_USAGE (a setting out of range, named), HS_ERR_DEVICE or
 * HS_ERR_MEMORY. All functions are called from one thread. */
hs_screen *hs_screen_create(const hs_cl *cl, const hs_dvr_settings *settings, hs_error *err);
void hs_screen_destroy(hs_screen *screen);

/* Makes what the look needs of the volume, and its memory, before the first picture (hs_dvr_prepare). */
bool hs_screen_prepare(hs_screen *screen, const hs_device_volume *volume, hs_error *err);

/* Enqueues the picture, and its termination depths if asked for (see hs_dvr_render); does not wait. `start`
 * NULL: the full volume. HS_ERR_DEVICE. */
bool hs_screen_render(hs_screen *screen, const hs_device_volume *volume, const hs_camera *camera,
                      const hs_start_depths *start, bool with_termination, hs_error *err);

/* Enqueues the termination depths alone, of rays that all start at `step` of their steps (> 0). */
bool hs_screen_render_from(hs_screen *screen, const hs_device_volume *volume, const hs_camera *camera,
                           uint32_t step, hs_error *err);

/* Wait for the queue and read back: the last picture as RGBA, 4 bytes a pixel, or its termination depths in
 * steps. HS_ERR_DEVICE. */
bool hs_screen_read(const hs_screen *screen, uint8_t *rgba, hs_error *err);
bool hs_screen_read_termination(const hs_screen *screen, float *termination, hs_error *err);

/* Steps of a ray that crosses the whole box. */
uint32_t hs_screen_steps(const hs_screen *screen, const hs_device_volume *volume, const hs_camera *camera);
