/* SPDX-License-Identifier: MIT */
#include "console/console.h"
#include "console/console_guests.h"

#include "core/progress.h"
#include "core/text.h"
#include "hs_page_css.h"
#include "hs_page_html.h"
#include "hs_page_js.h"

#include <arpa/inet.h>
#include <civetweb.h>
#include <netdb.h>
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <time.h>
#include <unistd.h>

#define TEXT_OF(number) #number
#define AS_TEXT(number) TEXT_OF(number)
#define DROP_PART_S     30.0 /* for 256 KiB of a file, if another one waits */
enum { MAX_PAGES = 4, OPCODE = 0x0f, WHOLE = 0x80 };

struct hs_console_server {
    const hs_console_shared *shared;
    struct mg_context *web;
    char token[HS_CONSOLE_TOKEN];
    char host[64]; /* as it stands in the address */
    bool loopback;
    char behind[512], origin[256]; /* a proxy's address and origin; "": there is none */
    pthread_mutex_t lock;          /* of what follows, and held until the server has started */
    uint32_t port;
    uint32_t pages, ever;
    const struct mg_connection *dropper; /* whose file comes; NULL: none does */
    double drop_due;                     /* until then it has its place, also if another one comes */
    hs_console_guests guests;
};

/* ------------------------------------------------------------------------------------------- guests -- */

/* Every connection, before it has said anything. */
static int begin_guest(const struct mg_connection *c, void **data) {
    (void)data;
    hs_console_server *server = mg_get_user_data(mg_get_context(c));
    (void)pthread_mutex_lock(&server->lock);
    hs_console_guest_turn(&server->guests, c);
    (void)pthread_mutex_unlock(&server->lock);
    return 0;
}

static void end_guest(const struct mg_connection *c) {
    hs_console_server *server = mg_get_user_data(mg_get_context(c));
    (void)pthread_mutex_lock(&server->lock);
    hs_console_guest_leave(&server->guests, c);
    (void)pthread_mutex_unlock(&server->lock);
}

/* ------------------------------------------------------------------------------------------- files -- */

/* Nothing from elsewhere, and nothing for elsewhere. */
static const char headers[] =
    "Cache-Control: no-store\r\n"
    "Content-Security-Policy: default-src 'none'; script-src 'self'; style-src 'self'; "
    "img-src 'self' blob: data:; connect-src 'self'; base-uri 'none'; form-action 'none'; "
    "frame-ancestors 'none'\r\n"
    "X-Content-Type-Options: nosniff\r\n"
    "Referrer-Policy: no-referrer\r\n"
    "Cross-Origin-Resource-Policy: same-origin\r\n"
    "Cross-Origin-Opener-Policy: same-origin\r\n"
    "Connection: close\r\n";

static void put_head(struct mg_connection *c, int status, const char *type, size_t bytes) {
    (void)mg_printf(c, "HTTP/1.1 %d %s\r\nContent-Type: %s; charset=utf-8\r\nContent-Length: %zu\r\n%s\r\n",
                    status, mg_get_response_code_text(c, status), type, bytes, headers);
}

static int answer(struct mg_connection *c, int status, const char *type, const void *body, size_t bytes) {
    const struct mg_request_info *request = mg_get_request_info(c); /* what could not be read has none */
    const bool head = request && request->request_method && strcmp(request->request_method, "HEAD") == 0;
    put_head(c, status, type, bytes);
    if (!head) (void)mg_write(c, body, bytes);
    return status;
}

static int refuse(struct mg_connection *c, int status, const char *text) {
    return answer(c, status, "text/plain", text, strlen(text));
}

/* What the library refuses by itself. 0: it has been answered. */
static int answer_error(struct mg_connection *c, int status, const char *message) {
    (void)message; /* it may name files */
    (void)refuse(c, status, "This cannot be answered.\n");
    return 0;
}

/* Whether a header is what a request by way of the proxy has: `skip` letters into its origin. */
static bool is_proxys(const hs_console_server *server, const char *header, size_t skip) {
    return server->origin[0] != '\0' && header && strcmp(header, server->origin + skip) == 0;
}

static bool names_proxy(const hs_console_server *server, const struct mg_connection *c) {
    const char *slashes = strstr(server->origin, "://");
    return slashes && is_proxys(server, mg_get_header(c, "Host"), (size_t)(slashes - server->origin) + 3);
}

/* Whether the request, which is whole, names this server. */
static bool is_for_us(hs_console_server *server, const struct mg_connection *c) {
    (void)pthread_mutex_lock(&server->lock);
    hs_console_guest_turn(&server->guests, c);
    (void)pthread_mutex_unlock(&server->lock);
    return names_proxy(server, c) || hs_console_host_is_ours(mg_get_header(c, "Host"), server->loopback);
}

/* Whether the page of the request is this server's, and has the token. */
static bool is_our_page(const hs_console_server *server, const struct mg_connection *c) {
    const char *origin = mg_get_header(c, "Origin"), *host = mg_get_header(c, "Host");
    return (is_proxys(server, origin, 0) ||
            (!names_proxy(server, c) && hs_console_origin_is_ours(origin, host))) &&
           hs_console_token_fits(mg_get_request_info(c)->query_string, server->token);
}

/* A part, for which there was time. */
static int receive(void *connection, void *out, size_t bytes) {
    hs_console_server *server = mg_get_user_data(mg_get_context(connection));
    const int came = mg_read(connection, out, bytes);
    (void)pthread_mutex_lock(&server->lock);
    server->drop_due = hs_now() + DROP_PART_S;
    (void)pthread_mutex_unlock(&server->lock);
    return came;
}

/* Takes the place from a page that sends no whole part in time. The lock is held, but while this waits. */
static void take_place(hs_console_server *server) {
    static const struct timespec pause = {.tv_nsec = 20000000};
    if (!server->dropper || hs_now() < server->drop_due) return;
    hs_console_shut(server->dropper);
    for (int n = 0; server->dropper && n < 100; n++) {
        (void)pthread_mutex_unlock(&server->lock);
        (void)nanosleep(&pause, NULL);
        (void)pthread_mutex_lock(&server->lock);
    }
}

/* One at a time, and no more than there is room for. A page may be slow, as long as no other one waits. */
static bool begin_drop(hs_console_server *server, const struct mg_connection *c, uint64_t bytes) {
    (void)pthread_mutex_lock(&server->lock);
    take_place(server);
    const bool ok = !server->dropper && bytes <= hs_console_drop_room(&server->shared->files);
    if (ok) hs_console_guest_leave(&server->guests, c);
    if (ok) server->dropper = c;
    if (ok) server->drop_due = hs_now() + DROP_PART_S;
    (void)pthread_mutex_unlock(&server->lock);
    return ok;
}

static void end_drop(hs_console_server *server) {
    (void)pthread_mutex_lock(&server->lock);
    server->dropper = NULL;
    (void)pthread_mutex_unlock(&server->lock);
}

/* What a page hands over, with what its query calls `field`. 200: *made tells what became of it; else it has
 * been answered. */
static int take_file(hs_console_server *server, struct mg_connection *c, const char *field,
                     hs_console_taker take, char **made) {
    char given[512];
    hs_error err = {0};
    const struct mg_request_info *request = mg_get_request_info(c);
    const uint64_t bytes = request->content_length > 0 ? (uint64_t)request->content_length : 0;
    const char *query = request->query_string ? request->query_string : "";
    if (!is_our_page(server, c)) return refuse(c, 403, "Only the console's own page may drop a file.");
    if (mg_get_var(query, strlen(query), field, given, sizeof given) < 0)
        return refuse(c, 400, "A file has a name.");
    if (bytes == 0) return refuse(c, 411, "The file is empty.");
    if (!begin_drop(server, c, bytes))
        return refuse(c, 413, "The console takes one file at a time, and 2 GiB of them until it ends.");
    const bool ok = take(&server->shared->files, given, bytes, receive, c, made, &err);
    end_drop(server);
    return ok ? 200 : refuse(c, 400, err.text);
}

/* A volume that was dropped on a page. Answers with its paths in the folder of such files. */
static int take_drop(hs_console_server *server, struct mg_connection *c) {
    char *made = NULL;
    const int status = take_file(server, c, "name", hs_console_take_volume, &made);
    if (status == 200) (void)answer(c, status, "application/json", made, strlen(made));
    free(made);
    return status;
}

static int send_file(struct mg_connection *c, const char *path) {
    char part[16384];
    FILE *file = fopen(path, "rb");
    if (!file || fseeko(file, 0, SEEK_END) != 0) {
        if (file) (void)fclose(file);
        return refuse(c, 500, "The file has gone.");
    }
    put_head(c, 200, "application/dicom", (size_t)ftello(file));
    rewind(file);
    for (size_t came; (came = fread(part, 1, sizeof part, file)) > 0 && mg_write(c, part, came) > 0;)
        continue;
    (void)fclose(file);
    return 200;
}

/* A picture of a page, which becomes DICOM. */
static int make_dicom(hs_console_server *server, struct mg_connection *c) {
    char *made = NULL;
    int status = take_file(server, c, "of", hs_console_take_picture, &made);
    if (status == 200) {
        status = send_file(c, made);
        (void)unlink(made);
    }
    free(made);
    return status;
}

/* Every request, before anything else looks at it. 0: it goes on to the WebSocket. */
static int begin_request(struct mg_connection *c) {
    hs_console_server *server = mg_get_user_data(mg_get_context(c));
    const struct mg_request_info *request = mg_get_request_info(c);
    const char *uri = request->local_uri ? request->local_uri : "";
    if (!is_for_us(server, c))
        return refuse(c, 403, "This console is reached by the address that it printed.\n");
    if (strstr(uri, "%00") || (request->query_string && strstr(request->query_string, "%00")))
        return refuse(c, 400, "An address has no zero bytes.\n");
    if (strcmp(request->request_method, "POST") == 0 && strcmp(uri, "/drop") == 0)
        return take_drop(server, c);
    if (strcmp(request->request_method, "POST") == 0 && strcmp(uri, "/dicom") == 0)
        return make_dicom(server, c);
    if (strcmp(request->request_method, "GET") != 0 && strcmp(request->request_method, "HEAD") != 0)
        return refuse(c, 405, "Only GET and HEAD.\n");
    if (strcmp(uri, "/live") == 0) return 0;
    if (strcmp(uri, "/console.css") == 0)
        return answer(c, 200, "text/css", hs_page_css_text, hs_page_css_text_size);
    if (strcmp(uri, "/console.js") == 0)
        return answer(c, 200, "text/javascript", hs_page_js_text, hs_page_js_text_size);
    if (strcmp(uri, "/") != 0) return refuse(c, 404, "There is no such page.\n");
    if (!hs_console_token_fits(request->query_string, server->token))
        return refuse(c, 403,
                      "The token is wrong: open the address that the console printed when it started.\n");
    return answer(c, 200, "text/html", hs_page_html_text, hs_page_html_text_size);
}

/* -------------------------------------------------------------------------------------------- pages -- */

static bool send_to_page(void *connection, bool binary, const uint8_t *data, size_t bytes) {
    return mg_websocket_write(connection, binary ? MG_WEBSOCKET_OPCODE_BINARY : MG_WEBSOCKET_OPCODE_TEXT,
                              (const char *)data, bytes) > 0;
}

/* 0 lets the page in. */
static int connect_page(const struct mg_connection *c, void *context) {
    hs_console_server *server = context;
    if (!is_for_us(server, c) || !is_our_page(server, c)) return 1;
    (void)pthread_mutex_lock(&server->lock);
    const bool full = server->pages == MAX_PAGES;
    if (!full) {
        server->pages++;
        server->ever++;
        hs_console_guest_leave(&server->guests, c); /* a page may be silent */
    }
    (void)pthread_mutex_unlock(&server->lock);
    return full;
}

static void ready_page(struct mg_connection *c, void *context) {
    const hs_console_server *server = context;
    hs_error err = {0};
    hs_console_page *page = hs_console_page_open(server->shared, send_to_page, c, &err);
    if (!page) hs_print(stderr, "host_sim console: %s\n", err.text);
    mg_set_user_connection_data(c, page);
}

/* A message is one frame of text. 0 closes the page. */
static int hear_page(struct mg_connection *c, int bits, char *data, size_t bytes, void *context) {
    (void)context;
    hs_console_page *page = mg_get_user_connection_data(c);
    const int opcode = bits & OPCODE;
    if (opcode == MG_WEBSOCKET_OPCODE_PING || opcode == MG_WEBSOCKET_OPCODE_PONG) return 1;
    return page && opcode == MG_WEBSOCKET_OPCODE_TEXT && (bits & WHOLE) &&
           hs_console_page_say(page, data, bytes);
}

static void close_page(const struct mg_connection *c, void *context) {
    hs_console_server *server = context;
    hs_console_page_close(mg_get_user_connection_data(c));
    (void)pthread_mutex_lock(&server->lock);
    server->pages--;
    (void)pthread_mutex_unlock(&server->lock);
}

/* ------------------------------------------------------------------------------------------- server -- */

static bool take_address(hs_console_server *server, const hs_console_address *address, hs_error *err) {
    const char *listen = address->listen ? address->listen : "127.0.0.1";
    uint8_t bytes[16];
    const bool four = inet_pton(AF_INET, listen, bytes) == 1,
               six = !four && inet_pton(AF_INET6, listen, bytes) == 1;
    static const uint8_t one[16] = {[15] = 1};
    if (!four && !six)
        return hs_fail(err, HS_ERR_USAGE, "--listen: '%s' is no address of IPv4 or IPv6", listen);
    if (address->behind && (strlen(address->behind) >= sizeof server->behind ||
                            !hs_console_behind(address->behind, server->origin, sizeof server->origin)))
        return hs_fail(err, HS_ERR_USAGE,
                       "--behind: '%.100s', expected http(s)://HOST/ or http(s)://HOST/PATH/",
                       address->behind);
    if (address->behind) (void)snprintf(server->behind, sizeof server->behind, "%s", address->behind);
    if (six && !mg_check_feature(MG_FEATURES_IPV6))
        return hs_fail(err, HS_ERR_USAGE, "--listen %s: this machine's web server, libcivetweb, has no IPv6",
                       listen);
    server->loopback = four ? bytes[0] == 127 : memcmp(bytes, one, sizeof one) == 0;
    (void)snprintf(server->host, sizeof server->host, six ? "[%s]" : "%s", listen);
    return true;
}

/* What the library has to say, why it did not start for example. */
static int note_message(const struct mg_connection *c, const char *message) {
    (void)c;
    hs_print(stderr, "host_sim console: %s\n", message);
    return 1;
}

static bool start(hs_console_server *server, const hs_console_address *address, hs_error *err) {
    char where[96];
    (void)snprintf(where, sizeof where, "%s:%u", server->host, address->port);
    const char *options[] = {"listening_ports",
                             where,
                             "num_threads",
                             AS_TEXT(HS_CONSOLE_SERVED),
                             "connection_queue",
                             AS_TEXT(HS_CONSOLE_SERVED),
                             "listen_backlog", /* many at once need not knock twice */
                             "1024",
                             "max_request_size",
                             "8192",
                             "request_timeout_ms", /* for a request to be whole, and for a write to go on */
                             "3000",
                             "websocket_timeout_ms",
                             "20000",
                             "enable_websocket_ping_pong",
                             "yes",
                             "decode_url", /* it would end at a zero byte */
                             "no",
                             "enable_keep_alive",
                             "no",
                             "tcp_nodelay",
                             "1",
                             NULL};
    const struct mg_callbacks callbacks = {.init_connection = begin_guest,
                                           .connection_close = end_guest,
                                           .begin_request = begin_request,
                                           .log_message = note_message,
                                           .http_error = answer_error};
    struct mg_server_port port;
    (void)mg_init_library(0);
    server->web = mg_start(&callbacks, server, options);
    if (!server->web)
        return hs_fail(err, HS_ERR_FAILED,
                       "console: cannot listen on %s: is it taken, or not of this machine?", where);
    mg_set_websocket_handler(server->web, "/live", connect_page, ready_page, hear_page, close_page, server);
    if (mg_get_server_ports(server->web, 1, &port) < 1)
        return hs_fail(err, HS_ERR_FAILED, "console: listens on no port");
    server->port = (uint32_t)port.port;
    return true;
}

hs_console_server *hs_console_server_open(const hs_console_shared *shared, const hs_console_address *address,
                                          hs_error *err) {
    hs_console_server *server = calloc(1, sizeof *server);
    if (!server) {
        (void)hs_fail(err, HS_ERR_MEMORY, "console: no memory");
        return NULL;
    }
    server->shared = shared;
    (void)pthread_mutex_init(&server->lock, NULL);
    (void)pthread_mutex_lock(&server->lock);
    const bool ok = take_address(server, address, err) && hs_console_make_token(server->token, err) &&
                    start(server, address, err);
    (void)pthread_mutex_unlock(&server->lock);
    if (ok) return server;
    hs_console_server_close(server);
    return NULL;
}

void hs_console_server_address(const hs_console_server *server, char *out, size_t bytes) {
    if (server->behind[0] != '\0')
        (void)snprintf(out, bytes, "%s?t=%s", server->behind, server->token);
    else
        (void)snprintf(out, bytes, "http://%s:%u/?t=%s", server->host, server->port, server->token);
}

uint32_t hs_console_server_pages(hs_console_server *server, uint32_t *ever) {
    (void)pthread_mutex_lock(&server->lock);
    const uint32_t pages = server->pages;
    *ever = server->ever;
    (void)pthread_mutex_unlock(&server->lock);
    return pages;
}

void hs_console_server_close(hs_console_server *server) {
    if (!server) return;
    if (server->web) {
        mg_stop(server->web);
        (void)mg_exit_library();
    }
    (void)pthread_mutex_destroy(&server->lock);
    free(server);
}
