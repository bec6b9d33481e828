/* SPDX-License-Identifier: MIT */
/* The guard's child: loads the plugin and does what the channel orders, until it is closed. */
#ifndef HS_SERVE_H
#define HS_SERVE_H

/* The hidden command guard-child. Returns the exit code: HS_ERR_USAGE if the process was not started by a
 * guard. */
int hs_guard_serve(void);

#endif
