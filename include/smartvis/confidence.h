/* SPDX-License-Identifier: MIT */
/*
 * Extension smartvis.confidence/1: how sure the surface of the last frame is, pixel by pixel. Tags and rules
 * are those of smartvis_plugin.h.
 */
#ifndef SMARTVIS_CONFIDENCE_H
#define SMARTVIS_CONFIDENCE_H

#include "smartvis_plugin.h"

SMARTVIS_BEGIN_C

#define SV_EXT_CONFIDENCE "smartvis.confidence/1"

/* Why there is no surface, or why it is doubtful. */
typedef enum sv_reason {
    SV_REASON_NONE = 0,     /* there is one, or the method does not tell */
    SV_REASON_NO_FLUID = 1, /* too little of what is as dark as fluid lies where a surface would */
    SV_REASON_EMPTY = 2,    /* too little was scanned, or all of it has one grey level */
    SV_REASON_NO_FETUS = 3, /* too little of the view shows tissue brighter than the wall behind it */
    SV_REASON_DOUBTFUL =
        4,             /* as SV_REASON_NO_FLUID, but it may be right; there is a surface if it is asked for */
    SV_REASON_OPEN = 5 /* as SV_REASON_NO_FLUID: the scan begins in the fluid, so nothing hides the fetus */
} sv_reason;

typedef struct sv_confidence_report {
    uint32_t size;
    float fluid_threshold; /* T_L that was found from the volume's own grey levels, 0 .. 1 */
    uint32_t rays; /* that have a scanned voxel; a method that works on blocks counts columns of blocks */
    uint32_t open_rays;  /* of these, with fluid behind tissue; too few of them: SV_NO_SURFACE */
    uint32_t reason;     /* sv_reason */
    float found, wanted; /* the share that the reason is about, 0 .. 1, and from where on it would be none */
    uint32_t try_id; /* the parameter that takes the doubtful surface all the same, and its value; 0: none */
    float try_value;
} sv_confidence_report;

typedef struct sv_ext_confidence {
    uint32_t size;
    uint32_t reserved; /* 0 */

    /* [control & active] Waits for the queue and reads the last frame whose end succeeded, `out` as far as
     * out->size goes. `map`: width *
     * height float32, row by row, 0 (nothing is known) .. 1 (no other depth comes near in cost, and all rays
     * nearby show fluid); all 0 without a surface. The surface lies nearer to the viewer where it is low; a
     * host may widen its ghosting window there. `map` or `out` may be NULL. SV_ERR_STATE if there is no such
     * frame, or the active method gives no confidence. */
    sv_status(SV_CALL *read)(const sv_plugin *plugin, float *map, sv_confidence_report *out);

    /* [control & active] or [frame & active] 1 if the active method gives a map, else 0. It stays the same
     * until deactivate. */
    uint32_t(SV_CALL *offered)(const sv_plugin *plugin);

    /* [frame & active, after a successful end or adjust] The map of the last frame on the frame path, into
     * either `map` or `object`, an OpenCL buffer, at `offset` bytes (a multiple of 4). Host queue: enqueued
     * behind the frame's own commands and valid when the queue has run; the memory must stay until then. Own
     * queue: `map` only; valid when it returns. SV_ERR_STATE as `read`; SV_ERR_ARGUMENT for none or both, or
     * an object that the queue cannot reach or that is too small. */
    sv_status(SV_CALL *write)(const sv_plugin *plugin, float *map, struct _cl_mem *object, uint64_t offset);
} sv_ext_confidence;

SMARTVIS_END_C

#endif
