/* SPDX-License-Identifier: MIT */
#include "console/console_guests.h"

#include <netdb.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>

enum { MAX_IDLE = 64, MAX_FILES = 1024 };

/* The place of a connection, or HS_CONSOLE_SERVED: it has none. */
static uint32_t place_of(const hs_console_guests *guests, const struct mg_connection *c) {
    uint32_t i = 0;
    while (i < HS_CONSOLE_SERVED && guests->place[i].connection != c) i++;
    return i;
}

/* Whether this is the socket of the request's connection; the library does not tell. */
static bool is_socket_of(int socket, const struct mg_request_info *request) {
    struct sockaddr_storage peer = {0};
    socklen_t bytes = sizeof peer;
    char host[NI_MAXHOST], port[NI_MAXSERV];
    return getpeername(socket, (struct sockaddr *)&peer, &bytes) == 0 &&
           (peer.ss_family == AF_INET || peer.ss_family == AF_INET6) &&
           getnameinfo((struct sockaddr *)&peer, bytes, host, sizeof host, port, sizeof port,
                       NI_NUMERICHOST | NI_NUMERICSERV) == 0 &&
           atoi(port) == request->remote_port && strcmp(host, request->remote_addr) == 0;
}

void hs_console_shut(const struct mg_connection *c) {
    const struct mg_request_info *request = mg_get_request_info(c);
    int socket = 0;
    while (request && socket < MAX_FILES && !is_socket_of(socket, request)) socket++;
    if (request && socket < MAX_FILES) (void)shutdown(socket, SHUT_RDWR);
}

static void give_up(hs_console_guests *guests, uint32_t i) {
    hs_console_shut(guests->place[i].connection);
    guests->place[i].connection = NULL;
}

void hs_console_guest_turn(hs_console_guests *guests, const struct mg_connection *c) {
    uint32_t own = place_of(guests, c);
    if (own == HS_CONSOLE_SERVED) own = place_of(guests, NULL);
    if (own == HS_CONSOLE_SERVED) return;
    guests->place[own].connection = c;
    guests->place[own].turn = ++guests->turns;
    for (uint32_t i = 0; i < HS_CONSOLE_SERVED; i++)
        if (guests->place[i].connection && guests->place[i].turn + MAX_IDLE <= guests->turns)
            give_up(guests, i);
}

void hs_console_guest_leave(hs_console_guests *guests, const struct mg_connection *c) {
    const uint32_t own = place_of(guests, c);
    if (own < HS_CONSOLE_SERVED) guests->place[own].connection = NULL;
}
