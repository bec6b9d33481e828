/* SPDX-License-Identifier: MIT */
/* A plugin at work on volumes in memory, known by its ABI only: one instance with its settings, active for
 * whatever size came last. */
#ifndef JUDGE_SESSION_H
#define JUDGE_SESSION_H

#include "plugin/capabilities.h"
#include "plugin/loader.h"

enum { SURF_MAX_VALUES = 16 };

/* A volume, x fastest, then y, then z. Borrowed. */
typedef struct {
    const uint8_t *voxels;
    uint32_t width, height, slices;
    double spacing_mm[3]; /* all 0: not known */
    /* Ray i was scanned in slices first[i] .. end[i] - 1. Both NULL: voxels of 0 were not scanned. */
    const uint16_t *first, *end;
} surf_volume;

/* Owned by the caller; must not move while open. */
typedef struct {
    hs_plugin plugin;
    sv_param_value fixed[SURF_MAX_VALUES], values[SURF_MAX_VALUES]; /* of activate, and of frames */
    uint32_t fixed_count, value_count;
    bool active, ranged;
    uint32_t width, height, slices;
    double spacing_mm[3];
    sv_scanned *scanned;
    float *depth;      /* of the last frame, slices; all 0 if it has no surface */
    float *confidence; /* after surf_session_confidence: 0 .. 1; all 0 if there is none */
    bool sure;         /* the method gives a confidence */
    sv_status outcome;
    sv_stats stats;
} surf_session;

/* Opens a library; `settings` are "key=value" texts, parted by spaces. HS_ERR_PLUGIN or HS_ERR_USAGE. */
bool surf_session_open(surf_session *s, const char *path, const char *settings, hs_error *err);
void surf_session_close(surf_session *s);
bool surf_session_set(surf_session *s, const char *key, double value, hs_error *err);

/* A whole frame. A status of "no surface" is a success. */
bool surf_session_frame(surf_session *s, const surf_volume *volume, hs_error *err);

/* False if the frame that was just run has no surface. */
bool surf_session_clips(const surf_session *s);

/* Reads the confidence of the frame that was just run; `report` may be NULL. Nothing if !sure. */
bool surf_session_confidence(surf_session *s, sv_confidence_report *report, hs_error *err);

#endif
