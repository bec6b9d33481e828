/* SPDX-License-Identifier: MIT */
/* The extensions of a plugin that the host uses, found and checked in one place. */
#ifndef HS_PLUGIN_EXT_H
#define HS_PLUGIN_EXT_H

#include "smartvis/confidence.h"
#include "smartvis/points.h"
#include "smartvis/spline.h"
#include "smartvis/timing.h"

/* [any] The table, or NULL if the plugin does not have it, or not whole. The plugin's, until destroy. */
const sv_ext_timing *hs_plugin_timing(const sv_plugin *instance);
const sv_ext_confidence *hs_plugin_confidence(const sv_plugin *instance);
const sv_ext_spline *hs_plugin_spline(const sv_plugin *instance);

/* [frame & active, after end or adjust] Asks for the report on the last frame's points. With the host's queue
 * it is valid, and its memory must stay, until the queue has run. out->size is 0 if the plugin does not tell:
 * the report is for people to read, so a failure costs the frame nothing. */
void hs_plugin_points(const sv_plugin *instance, sv_points_report *out);

#endif
