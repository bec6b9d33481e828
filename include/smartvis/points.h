/* SPDX-License-Identifier: MIT */
/*
 * Extension smartvis.points/1: what a method that starts from initial points (thesis 3.2, Algorithm 4.1)
 * found out about the last frame. Tags and rules are those of smartvis_plugin.h.
 */
#ifndef SMARTVIS_POINTS_H
#define SMARTVIS_POINTS_H

#include "smartvis_plugin.h"

SMARTVIS_BEGIN_C

#define SV_EXT_POINTS "smartvis.points/1"

typedef struct sv_points_report {
    uint32_t size;
    uint32_t empty_points; /* initial points whose interval is empty: depth 0, "clip nothing here" */
    uint32_t passes;       /* passes or steps of the surface reconstruction; 1 if it has none */
    float volume_max;      /* largest intensity, 0 .. 1; what was not scanned does not count */
    float bone_threshold;  /* the T_B that was used, 0 .. 1: a ray is bone above it */
    uint32_t sure_points;  /* bone rays whose interval is long enough to be sure it is fluid */
} sv_points_report;

typedef struct sv_ext_points {
    uint32_t size;
    uint32_t reserved; /* 0 */

    /* [frame & active, after a successful end or adjust] Writes the report of the last frame, up to
     * out->size, which the host sets. Host queue: enqueued behind the frame's own commands and valid when the
     * queue has run; the memory must stay until then. Own queue: valid when it returns. SV_ERR_STATE if there
     * is no such frame, or its method looks for no points. */
    sv_status(SV_CALL *write)(const sv_plugin *plugin, sv_points_report *out);
} sv_ext_points;

SMARTVIS_END_C

#endif
