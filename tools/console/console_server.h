/* SPDX-License-Identifier: MIT */
/* The console's web server: its page by HTTP, and everything that lives by WebSocket. docs/console.md has
 * what it refuses and why. */
#ifndef HS_CONSOLE_SERVER_H
#define HS_CONSOLE_SERVER_H

#include "console/console_access.h"
#include "console/console_page.h"

typedef struct {
    const char *listen; /* address; NULL: 127.0.0.1 */
    uint32_t port;      /* 0: any that is free */
} hs_console_address;

typedef struct hs_console_server hs_console_server;

/* Starts listening. `shared` must outlive it. NULL with HS_ERR_USAGE (an address that is none), HS_ERR_FAILED
 * (it is taken, or may not be listened on) or HS_ERR_MEMORY. */
hs_console_server *hs_console_server_open(const hs_console_shared *shared, const hs_console_address *address,
                                          hs_error *err);

/* The address to open, with its token. */
void hs_console_server_address(const hs_console_server *server, char *out, size_t bytes);

/* Pages that are open now, and how many there ever were. Any thread. */
uint32_t hs_console_server_pages(hs_console_server *server, uint32_t *ever);

/* Closes every page and stops. */
void hs_console_server_close(hs_console_server *server);

#endif
