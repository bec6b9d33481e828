/* SPDX-License-Identifier: MIT */
/* What every enqueued command needs: the device's queue, who hears of failures, and who takes the time. */
#ifndef SV_QUEUE_H
#define SV_QUEUE_H

#include "device/device.h"
#include "device/timing.h"

/* Bytes of the buffers that were asked for: all together, and the largest one. */
typedef struct {
    uint64_t bytes, largest;
} sv_tally;

typedef struct {
    sv_diag *diag;
    const sv_device *device;
    sv_timing *timing; /* NULL: no times are taken */
    sv_tally *tally;   /* not NULL: buffers are counted here, and none is made (buffer.h) */
} sv_queue;

#endif
