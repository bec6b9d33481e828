/* SPDX-License-Identifier: MIT */
/* What a plugin can do: by its descriptor, known before activate compiles anything, and by its extensions. */
#pragma once

#include "core/error.h"
#include "plugin/reason.h"
#include "smartvis/confidence.h"
#include "smartvis/needs.h"
#include "smartvis/points.h"
#include "smartvis/timing.h"
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
    HS_FAN_RANGES,  /* sv_frame.scanned */
    HS_FAN_PADDING, /* sv_format.padding_value is 0 */
    HS_FAN_NOTHING  /* every voxel counts as scanned */
} hs_fan;

/* By ranges if it takes them, else by padding if it heeds that, else by nothing. */
hs_fan hs_plugin_fan(const sv_descriptor *descriptor);

/* "ranges", "padding" or "nothing", for a person. */
const char *hs_fan_name(hs_fan fan);

/* [any] The table, or NULL if the plugin does not have it, or not whole. The plugin's, until destroy. */
const sv_ext_timing *hs_plugin_timing(const sv_plugin *instance);
const sv_ext_confidence *hs_plugin_confidence(const sv_plugin *instance);
const sv_ext_needs *hs_plugin_needs(const sv_plugin *instance);

/* [control & active] Which rule of the plugin's found no surface in the last frame, or a doubtful one, in
 * words for who holds the probe. False: the plugin does not tell. Waits for the queue. */
bool hs_plugin_reason(const sv_plugin *instance, sv_confidence_report *out, char words[HS_REASON_BYTES]);

/* A surface that was clipped at although the plugin doubts it: so much was found, and it is sure from
 * `wanted` on. `wanted` is 0 if it does not doubt it, or does not tell. */
typedef struct {
    float found, wanted;
} hs_doubt;

/* [control & active] That of the last frame. Waits for the queue. */
hs_doubt hs_plugin_doubt(const sv_plugin *instance);

/* "Clipped although doubtful (14 %, sure from 30 %): the fetus may be cut."; false without a doubt. */
bool hs_doubt_words(hs_doubt doubt, char *words, size_t bytes);

/* [frame & active, after end or adjust] Asks for the report on the last frame's points. With the host's queue
 * it is valid, and its memory must stay, until the queue has run. out->size is 0 if the plugin does not tell:
 * the report is for people to read, so a failure costs the frame nothing. */
void hs_plugin_points(const sv_plugin *instance, sv_points_report *out);
