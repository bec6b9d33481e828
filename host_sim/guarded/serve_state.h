/* SPDX-License-Identifier: MIT */
/* What the guard's child is made of: for the sources of this folder that work on it. */
#ifndef HS_SERVE_STATE_H
#define HS_SERVE_STATE_H

#include "guarded/guard_block.h"
#include "guarded/serve_carrier.h"

typedef struct {
    hs_guard_block *block; /* with the maps behind it */
    hs_plugin plugin;
    hs_carrier carrier;
    bool active;
} hs_server;

/* Notes the call that is made next, for whoever tells how this process ended.
 * `step` of `steps`, or 0 of 0. */
void hs_server_enter(hs_server *server, const char *call, uint32_t step, uint32_t steps);

/* Keeps a failure's reason for the other side. Returns the status. */
sv_status hs_server_fail(hs_server *server, sv_status status, const char *reason);

/* The same with the plugin's own reason; nothing if the status is no error. */
sv_status hs_server_keep(hs_server *server, sv_status status);

#endif
