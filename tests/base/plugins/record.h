/* SPDX-License-Identifier: MIT */
/* What the recording plugin (contract/plugins/recorder.c) saw of its last frame: its extension
 * "test.record/1". */
#pragma once

#include "smartvis_plugin.h"

#define RECORD_ID "test.record/1"

enum { RECORD_RAYS = 64 * 64 };

typedef struct {
    uint32_t size;
    uint32_t frames;
    sv_format format; /* without values */
    sv_frame frame;   /* the same */
    sv_scanned scanned[RECORD_RAYS];
} record;
