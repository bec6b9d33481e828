/* SPDX-License-Identifier: MIT */
/* Who may talk to the console: pure checks of what a request says, and the token that its address carries. */
#ifndef HS_CONSOLE_ACCESS_H
#define HS_CONSOLE_ACCESS_H

#include "base/error.h"

#include <stddef.h>
#include <stdint.h>

enum { HS_CONSOLE_TOKEN = 33 }; /* 128 random bits as hexadecimal digits, and a NUL */

/* A new token from the system's random numbers. HS_ERR_FAILED. */
bool hs_console_make_token(char token[HS_CONSOLE_TOKEN], hs_error *err);

/* True if the query ("t=...&...", or NULL) has this token; takes the same time wherever they differ. */
bool hs_console_token_fits(const char *query, const char *token);

/* True if the header Host (or NULL) names this server: a number and no name, or "localhost", at this port. A
 * name may be made to lead here by whoever owns it (DNS rebinding); a number may not. `loopback`: the server
 * listens on this machine only, so the number is one of its own. */
bool hs_console_host_is_ours(const char *host, uint32_t port, bool loopback);

/* True if the header Origin (or NULL) is that of a page which this server sent: "http://" and its Host. */
bool hs_console_origin_is_ours(const char *origin, const char *host);

#endif
