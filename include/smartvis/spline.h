/* SPDX-License-Identifier: MIT */
/*
 * Extension smartvis.spline/1: what the thin-plate spline (thesis 3.3.3, Eq. 3.2 to 3.15) of the last frame
 * came to. Tags and rules are those of smartvis_plugin.h.
 */
#ifndef SMARTVIS_SPLINE_H
#define SMARTVIS_SPLINE_H

#include "smartvis_plugin.h"

SMARTVIS_BEGIN_C

#define SV_EXT_SPLINE "smartvis.spline/1"

typedef struct sv_spline_report {
    uint32_t size;
    uint32_t points;     /* control points, after merging; 0: the frame had no initial point */
    uint32_t merge_grid; /* cells per side that points were merged on; 0: not merged */
    uint32_t rank;       /* of the plane: 3, or 2 for collinear points, or 1 for a single one */
    uint32_t dropped;    /* unknowns left out because their pivot was as good as 0 */
    float condition;   /* ratio of the largest to the smallest pivot: at most the matrix' condition number */
    float residual;    /* largest error of the solved equations at a control point, slices */
    uint32_t reserved; /* 0 */
} sv_spline_report;

typedef struct sv_ext_spline {
    uint32_t size;
    uint32_t reserved; /* 0 */

    /* [control & active] Waits for the queue and reads the report of the last frame whose end succeeded.
     * SV_ERR_STATE if there is none, or the active method is not the spline. */
    sv_status(SV_CALL *report)(const sv_plugin *plugin, sv_spline_report *out);
} sv_ext_spline;

SMARTVIS_END_C

#endif
