/* SPDX-License-Identifier: MIT */
/* Where a frame's time went: the event of every command, by stage (extension smartvis.timing/1). */
#pragma once

#include "device/diag.h"
#include "smartvis/timing.h"

#include <stdbool.h>

typedef enum {
    SV_STAGE_TRANSFER,
    SV_STAGE_PROFILE,
    SV_STAGE_THRESHOLD,
    SV_STAGE_RECONSTRUCT,
    SV_STAGE_OUTPUT,
    SV_STAGE_COUNT
} sv_stage;

typedef struct {
    bool enabled;
    bool complete; /* the events are those of a frame whose end succeeded */
    uint32_t count, capacity;
    struct {
        cl_event event;
        sv_stage stage;
    } * commands; /* allocated by sv_timing_create */
} sv_timing;

/* Seconds of a clock that only goes forward. */
double sv_seconds(void);

/* Bytes of memory that such a timing takes. */
size_t sv_timing_bytes(uint32_t capacity);
sv_status sv_timing_create(sv_timing *timing, sv_diag *diag, uint32_t capacity);
void sv_timing_destroy(sv_timing *timing);

/* Forgets the events of the frame before. */
void sv_timing_reset(sv_timing *timing);

/* Returns where an enqueue call puts its event, or NULL while timing is off. */
cl_event *sv_timing_slot(sv_timing *timing, sv_stage stage);

/* Sums the stages of the last frame. */
sv_status sv_timing_read(const sv_timing *timing, sv_diag *diag, sv_stage_times *out);
