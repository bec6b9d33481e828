/* SPDX-License-Identifier: MIT */
/* What a plugin can do, by its descriptor: known before activate compiles anything. */
#ifndef HS_CAPABILITIES_H
#define HS_CAPABILITIES_H

#include "base/error.h"
#include "smartvis_plugin.h"

/* How a host hands slabs over. */
typedef struct {
    uint32_t carrier; /* SV_CARRIER_* */
    bool own_queue;   /* the plugin picks its own device and queue (SV_CARRIER_HOST only) */
} hs_handover;

/* True if the plugin takes slabs that way, and 8-bit voxels at all. */
bool hs_plugin_takes(const sv_descriptor *descriptor, hs_handover how);

/*
 * The way that slabs go to a plugin: as `wanted` if the plugin takes that; else, unless the user insists on
 * it, host memory, on the host's queue if it may be, as every plugin takes it. HS_ERR_PLUGIN says what the
 * plugin does take; *out is then as it was. `path` is the library's, for the message.
 */
bool hs_plugin_choose_handover(const sv_descriptor *descriptor, const char *path, hs_handover wanted,
                               bool insists, hs_handover *out, hs_error *err);

/* How a plugin is told which voxels were scanned. */
typedef enum {
    HS_FAN_BEST = 0, /* ranges if it takes them, else padding if it heeds that, else nothing */
    HS_FAN_RANGES,   /* sv_frame.scanned */
    HS_FAN_PADDING,  /* sv_format.padding_value is 0 */
    HS_FAN_NOTHING   /* every voxel counts as scanned */
} hs_fan;

/* `wanted`, with HS_FAN_BEST resolved. HS_ERR_PLUGIN if the plugin does not take
 * ranges that were asked for. */
bool hs_plugin_choose_fan(const sv_descriptor *descriptor, const char *path, hs_fan wanted, hs_fan *out,
                          hs_error *err);

/* "ranges", "padding", "nothing". */
const char *hs_fan_name(hs_fan fan);

#endif
