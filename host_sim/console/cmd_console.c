/* SPDX-License-Identifier: MIT */
/* host_sim console: the scan loop on a web page, live. */
#include "console/console.h"

#include "core/cli.h"
#include "core/options.h"
#include "core/progress.h"
#include "core/text.h"
#include "guarded/guard_options.h"
#include "loop/source_options.h"

#include <malloc.h>
#include <signal.h>
#include <stdio.h>
#include <time.h>
#include <unistd.h>

#define MAX_LIBRARIES 16u
#define GRACE_S       30.0 /* after the last page: it may load again, or its network be back */

typedef struct {
    hs_console_shared shared;
    hs_console_address address;
    const char *libraries[MAX_LIBRARIES];
    uint32_t library_count;
    bool stay, help;
} console_line;

static bool take_plugin(void *target, const char *text, hs_error *err) {
    console_line *const line = target;
    return hs_cli_append("--plugin", text, line->libraries, &line->library_count, MAX_LIBRARIES, err);
}

#define AT(field) offsetof(console_line, field)
static const hs_option options[] = {
    HS_TAKEN(
        "plugin", "PATH", 0, take_plugin,
        "library to offer before SmartVis, a path or a name; repeatable. One that is built anew is loaded "
        "again"),
    HS_TEXT("out", "DIR", AT(shared.out), "folder for results that the page writes [out/console]"),
    HS_IN(COUNT, "port", "N", AT(address.port), 0, 65535, "port to listen on; 0 is any that is free [0]"),
    HS_TEXT("listen", "ADDR", AT(address.listen),
            "address to listen on; others than this machine can then reach the console, if they know the\n"
            "token, and everything goes over the net as it is [127.0.0.1]"),
    HS_TEXT("behind", "URL", AT(address.behind),
            "address under which a proxy shows the page, https://HOST/PATH/: its requests are then let in"),
    HS_IN(COUNT, "lowres", "N", AT(shared.lowres), 1, 8192,
          "pixels across the plugin's volume: fewer of them are quicker and cost quality [a pixel is 1 mm "
          "wide,\n"
          "no finer than the source and no coarser than three of its voxels]"),
    HS_SOURCE_ROWS(AT(shared.read)),
    HS_IN(COUNT, "reader", "N", AT(shared.files.reader), 3, 65535,
          "socket of who reads other formats and writes DICOM: \"smartvis console\" has one [nobody]"),
    HS_FLAG("stay", AT(stay), "goes on when the last page is closed"),
    HS_GUARD_ROWS(AT(shared.offers.guard)),
    HS_OPTIONS_END,
};

static const char usage[] =
    "Usage: host_sim console [FOLDER...] [options]\n"
    "Serves a page on which the scan loop runs live, and prints its address. Open it in a browser "
    "of this machine.\n"
    "\n"
    "  FOLDER                volumes of these folders (.mha, .mhd, .vol) can be opened, and nothing "
    "outside of them\n";

static bool parse(int argc, char **argv, console_line *line, hs_error *err) {
    int next = argc;
    *line = (console_line){.shared = {.out = "out/console"}};
    hs_guard_defaults(&line->shared.offers.guard);
    if (!hs_options_read(argc, argv, options, line, &next, &line->help, err)) return false;
    for (int i = next; i < argc && !line->help; i++)
        if (!hs_console_files_add(&line->shared.files, argv[i], err)) return false;
    return line->help || !line->shared.files.reader ||
           hs_console_check_reader(line->shared.files.reader, err);
}

static bool offer_plugins(console_line *line, hs_error *err) {
    hs_console_offers *offers = &line->shared.offers;
    bool ok = true;
    for (uint32_t i = 0; ok && i < line->library_count; i++)
        ok = hs_console_offer_library(offers, line->libraries[i], err);
    ok = ok && hs_console_offer_ours(offers, err);
    for (uint32_t i = 0; ok && i < offers->count; i++)
        if (offers->offer[i].failure.code != HS_OK)
            hs_print(stderr, "host_sim console: %s\n", offers->offer[i].failure.text);
    return ok;
}

static volatile sig_atomic_t stopped;

/* A second signal ends the program at once: by itself, since the first process of a container has no signal
 * that ends it. */
static void stop(int number) {
    if (stopped) _exit(128 + number);
    stopped = 1;
}

/* A terminal that has gone ends it as well, unless whoever started it has it ignored (nohup). */
static void watch_signals(void) {
    static const int numbers[] = {SIGINT, SIGTERM, SIGHUP};
    struct sigaction action = {.sa_handler = stop}, before;
    (void)sigemptyset(&action.sa_mask);
    for (size_t i = 0; i < sizeof numbers / sizeof *numbers; i++)
        if (numbers[i] != SIGHUP || sigaction(SIGHUP, NULL, &before) != 0 || before.sa_handler != SIG_IGN)
            (void)sigaction(numbers[i], &action, NULL);
}

static void wait_for_end(hs_console_server *server, bool stay) {
    static const struct timespec pause = {.tv_nsec = 50000000};
    double last = hs_now();
    uint32_t before = 0, ever;
    while (!stopped) {
        if (hs_console_server_pages(server, &ever) > 0 || ever == 0 || ever != before) last = hs_now();
        before = ever;
        if (!stay && hs_now() - last > GRACE_S) return;
        (void)nanosleep(&pause, NULL);
    }
}

static bool serve(console_line *line, hs_error *err) {
    char address[640];
    watch_signals();
    if (!offer_plugins(line, err)) return false;
    hs_console_drop_open(&line->shared.files);
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
#ifdef __GLIBC__
    (void)mallopt(M_ARENA_MAX, 2); /* threads come and go with pages, and each would leave an arena behind */
#endif
    bool ok = parse(argc, argv, &line, &err);
    if (ok && line.help)
        (void)hs_options_help(usage, options, "Ends at Ctrl-C, and 30 s after the last page was closed.\n\n");
    else
        ok = ok && serve(&line, &err);
    hs_console_drop_close(&line.shared.files);
    hs_console_files_free(&line.shared.files);
    return ok ? HS_OK : hs_cli_fail("console", &err);
}
