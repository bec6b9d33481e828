/* SPDX-License-Identifier: MIT */
/* host_sim console: the scan loop on a web page, live. */
#include "console/console.h"

#include "base/cli.h"
#include "base/progress.h"
#include "base/text.h"
#include "guarded/guard_options.h"

#include <getopt.h>
#include <signal.h>
#include <stdio.h>
#include <string.h>
#include <time.h>

#define MOST_LIBRARIES 16u
#define GRACE_S        2.0 /* after the last page: it may be one that loads again */

static const char help_text[] =
    "Usage: host_sim console [FOLDER...] [options]\n"
    "Serves a page on which the scan loop runs live, and prints its address. Open it in a browser of this "
    "machine.\n"
    "\n"
    "  FOLDER           volumes of these folders (.mha, .mhd, .vol) can be opened, and nothing outside of "
    "them\n"
    "  --plugin PATH    library to offer, a path or a name; repeatable [smartvis]\n"
    "  --out DIR        folder for results that the page writes [out/console]\n"
    "  --port N         port to listen on; 0 is any that is free [0]\n"
    "  --listen ADDR    address to listen on; others than this machine can then reach the console, if they "
    "know the\n"
    "                   token, and everything goes over the net as it is [127.0.0.1]\n"
    "  --stay           goes on when the last page is closed\n"
    "%s"
    "  --help           this text\n"
    "\n"
    "Ends at Ctrl-C, and when the last page is closed.\n"
    "\n";

typedef struct {
    hs_console_shared shared;
    hs_console_address address;
    const char *libraries[MOST_LIBRARIES];
    uint32_t library_count;
    bool stay, help;
} console_line;

enum { OPT_PLUGIN = 256, OPT_OUT, OPT_PORT, OPT_LISTEN, OPT_STAY, OPT_HELP };

static bool take_option(console_line *line, int option, const char *text, hs_error *err) {
    if (hs_guard_line_is(option)) return hs_guard_line_take(option, text, &line->shared.offers.guard, err);
    switch (option) {
    case OPT_PLUGIN:
        if (line->library_count == MOST_LIBRARIES)
            return hs_fail(err, HS_ERR_USAGE, "--plugin: given more than %u times", MOST_LIBRARIES);
        line->libraries[line->library_count++] = text;
        return true;
    case OPT_OUT:
        line->shared.out = text;
        return true;
    case OPT_PORT:
        return hs_cli_u32("--port", text, 0, 65535, &line->address.port, err);
    case OPT_LISTEN:
        line->address.listen = text;
        return true;
    case OPT_STAY:
        return (line->stay = true);
    default:
        return (line->help = true);
    }
}

static bool parse(int argc, char **argv, console_line *line, hs_error *err) {
    static const struct option options[] = {
        {"plugin", required_argument, NULL, OPT_PLUGIN}, {"out", required_argument, NULL, OPT_OUT},
        {"port", required_argument, NULL, OPT_PORT},     {"listen", required_argument, NULL, OPT_LISTEN},
        {"stay", no_argument, NULL, OPT_STAY},           HS_GUARD_OPTIONS,
        {"help", no_argument, NULL, OPT_HELP},           {0}};
    int option;
    *line = (console_line){.shared = {.out = "out/console"}};
    hs_guard_defaults(&line->shared.offers.guard);
    optind = 1;
    opterr = 0;
    while (!line->help && (option = getopt_long(argc, argv, ":", options, NULL)) != -1)
        if (!hs_cli_known(option, argv, err) || !take_option(line, option, optarg, err)) return false;
    for (int i = optind; i < argc && !line->help; i++)
        if (!hs_console_files_add(&line->shared.files, argv[i], err)) return false;
    return true;
}

static bool offer_plugins(console_line *line, hs_error *err) {
    hs_console_offers *offers = &line->shared.offers;
    bool ok = line->library_count > 0 || hs_console_offer_library(offers, NULL, err);
    for (uint32_t i = 0; ok && i < line->library_count; i++)
        ok = hs_console_offer_library(offers, line->libraries[i], err);
    for (uint32_t i = 0; ok && i < offers->count; i++)
        if (offers->offer[i].failure.code != HS_OK)
            hs_print(stderr, "host_sim console: %s\n", offers->offer[i].failure.text);
    return ok;
}

static volatile sig_atomic_t stopped;

static void stop(int number) {
    (void)number;
    stopped = 1;
}

/* A second signal ends the program at once. */
static void watch_signals(void) {
    struct sigaction action = {.sa_handler = stop, .sa_flags = (int)SA_RESETHAND};
    (void)sigemptyset(&action.sa_mask);
    (void)sigaction(SIGINT, &action, NULL);
    (void)sigaction(SIGTERM, &action, NULL);
}

static void wait_for_end(hs_console_server *server, bool stay) {
    static const struct timespec pause = {.tv_nsec = 50000000};
    double last = hs_now();
    while (!stopped) {
        uint32_t ever;
        if (hs_console_server_pages(server, &ever) > 0 || ever == 0) last = hs_now();
        if (!stay && hs_now() - last > GRACE_S) return;
        (void)nanosleep(&pause, NULL);
    }
}

static bool serve(console_line *line, hs_error *err) {
    char address[256];
    if (!offer_plugins(line, err)) return false;
    watch_signals();
    hs_console_server *server = hs_console_server_open(&line->shared, &line->address, err);
    if (!server) return false;
    hs_console_server_address(server, address, sizeof address);
    (void)printf("Console  %s\n", address);
    (void)fflush(stdout);
    wait_for_end(server, line->stay);
    hs_console_server_close(server);
    return true;
}

int hs_cmd_console(int argc, char **argv) {
    console_line line;
    hs_error err = {0};
    bool ok = parse(argc, argv, &line, &err);
    if (ok && line.help)
        (void)printf(help_text, hs_guard_line_help);
    else
        ok = ok && serve(&line, &err);
    hs_console_files_free(&line.shared.files);
    if (ok && line.help) (void)printf("%s", hs_exit_codes_help);
    return ok ? HS_OK : hs_cli_fail("console", &err);
}
