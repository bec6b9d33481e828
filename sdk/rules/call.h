/* SPDX-License-Identifier: MIT */
/* One call that passes between host and plugin: what the checking layer sees, and what a recording keeps. */
#pragma once

#include "smartvis_plugin.h"

#include <stdbool.h>

/* [control] and [frame] calls; the rest only asks. */
typedef enum {
    RC_CREATE,
    RC_DESTROY,
    RC_ACTIVATE,
    RC_DEACTIVATE,
    RC_BEGIN,
    RC_SLAB,
    RC_END,
    RC_ADJUST,
    RC_CALLS
} rc_kind;

typedef struct {
    rc_kind kind;
    const sv_plugin *plugin;      /* the plugin's own instance; NULL before create has returned */
    const sv_format *format;      /* activate: as the host gave it, may be NULL; so are those below */
    const sv_frame *frame;        /* begin */
    const sv_slab *slab;          /* slab */
    const sv_result *result;      /* end, adjust */
    const sv_param_value *values; /* adjust; activate and begin have theirs in the struct */
    uint32_t value_count;
    sv_status status;  /* what the plugin returned; SV_OK before, and for calls that return nothing */
    uint64_t start_ns; /* when the host made it, by CLOCK_MONOTONIC; 0 if it was not passed on */
    uint64_t took_ns;  /* by the plugin alone; 0 before the call */
    bool sound;        /* nothing was found wrong: with its state, and with sizes, shapes and objects */
} rc_call;
