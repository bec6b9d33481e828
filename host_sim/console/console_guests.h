/* SPDX-License-Identifier: MIT */
/* Connections that are no page, in their order: however many slow clients there are, threads are left for
 * others. The caller holds a lock of its own. */
#pragma once

#include <civetweb.h>
#include <stdint.h>

#define HS_CONSOLE_SERVED 128 /* connections at a time: a thread each, which costs 16 KiB */

/* Zeroed: none. */
typedef struct {
    struct {
        const struct mg_connection *connection; /* NULL: a free place */
        uint64_t turn;
    } place[HS_CONSOLE_SERVED];
    uint64_t turns; /* so far */
} hs_console_guests;

/* Gives a connection a turn, also one that is new. Who still waits for its client when 64 turns were given
 * after its own is given up. */
void hs_console_guest_turn(hs_console_guests *guests, const struct mg_connection *c);

/* It has ended, or may be silent from now on. */
void hs_console_guest_leave(hs_console_guests *guests, const struct mg_connection *c);

/* Ends the wait of the thread that serves it. The lock is held, and whoever ends a guest waits for it before
 * the library closes the socket: so no other file can have its number. */
void hs_console_shut(const struct mg_connection *c);
