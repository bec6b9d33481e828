/* SPDX-License-Identifier: MIT */
/* host_sim verify: one command for the machine where a plugin shall run, and one page for its file. */
#include "report/verify.h"

#include "commands/run_line.h"
#include "core/cli.h"
#include "core/paths.h"
#include "core/sha256.h"
#include "core/system.h"
#include "core/text.h"
#include "page/page_html.h"
#include "scene/scene.h"
#include "sv_version.h"

#include <stdio.h>
#include <string.h>
#include <time.h>

enum { MOST_ARGUMENTS = 200, ROWS = 9 };

static const char usage[] =
    "Usage: host_sim verify [--deadline MS] [options of run]\n"
    "Verifies an installation on the machine where it shall run, and writes a page for its file.\n\n"
    "  --deadline MS  99 of 100 frames must take no longer in the plugin [none: times are only told]\n"
    "  --out FOLDER   verify.html, the picture and the depthmap [out/verify]\n"
    "  --frames N     that are timed [200]\n"
    "  --scene, --volume, --reference MAP, ...: as 'host_sim run --help' says: another frame, and the map "
    "that\n"
    "                 was accepted for it. Without options of the kind it is scene D01 at 64^3 with the map "
    "of\n"
    "                 this release\n\n"
    "What is verified: the files' sums, as they were installed; the device; activation, in which the plugin\n"
    "compares the device with its definitions; a known frame with its accepted depthmap; the times.\n"
    "Exit code 1 if something did not hold, 4 if the plugin failed, 5 if there is no device.\n\n";

typedef struct {
    hs_run_line line;
    char *arguments[MOST_ARGUMENTS + 16];
    int count;
    double deadline;           /* ms; 0: none */
    char folder[SYS_PATH];     /* of the scenes, and of ... */
    char accepted[SYS_PATH];   /* ... the release's own map */
    bool own_frame, own_place; /* options name another frame; another folder */
    bool help;
    hs_verify_row rows[ROWS];
    uint32_t row_count;
    hs_code code; /* the plugin's failure, else HS_ERR_FAILED if a row did not hold */
} verify;

/* Options that change neither the frame nor its map. */
static bool keeps_frame(const char *option) {
    static const char *const known[] = {"--out", "--frames", "--guard", "--no-guard", "--tolerance"};
    for (size_t i = 0; i < sizeof known / sizeof *known; i++)
        if (strcmp(option, known[i]) == 0) return true;
    return strncmp(option, "--", 2) != 0;
}

/* What stands before the user's options, which count more. */
static void put(verify *v, char *const *arguments, size_t count) {
    memcpy(v->arguments + v->count, arguments, count * sizeof *arguments);
    v->count += (int)count;
}

static bool has_source(int argc, char **argv) {
    for (int i = 1; i < argc; i++)
        if (strcmp(argv[i], "--scene") == 0 || strcmp(argv[i], "--volume") == 0) return true;
    return false;
}

/* Takes the command's own options, and hands on all others. */
static bool take_options(verify *v, int argc, char **argv, hs_error *err) {
    for (int i = 1; i < argc; i++) {
        if (strcmp(argv[i], "--help") == 0 || strcmp(argv[i], "-h") == 0) return (v->help = true);
        if (strcmp(argv[i], "--deadline") == 0) {
            if (i + 1 == argc) return hs_fail(err, HS_ERR_USAGE, "--deadline: needs a number of ms");
            if (!hs_cli_number("--deadline", argv[++i], 1e-3, 1e6, &v->deadline, err)) return false;
            continue;
        }
        v->own_frame = v->own_frame || !keeps_frame(argv[i]);
        v->own_place = v->own_place || strcmp(argv[i], "--out") == 0;
        put(v, &argv[i], 1);
    }
    return true;
}

static bool read_line(verify *v, int argc, char **argv, hs_error *err) {
    static char *const front[] = {"run",       "--setting", "smartvis", "--few-pictures",
                                  "--picture", "320",       "--frames", "200"};
    static char *const frame[] = {"--scene", "D01", "--size", "64"};
    char *const accepted[] = {"--reference", v->accepted};
    if (argc > MOST_ARGUMENTS)
        return hs_fail(err, HS_ERR_USAGE, "more than %d arguments", MOST_ARGUMENTS - 1);
    put(v, front, sizeof front / sizeof *front);
    if (!has_source(argc, argv)) put(v, frame, sizeof frame / sizeof *frame);
    if (!take_options(v, argc, argv, err)) return false;
    if (v->help) return true;
    hs_scene_folder(v->folder, sizeof v->folder);
    if (!hs_path_join(v->folder, "accepted.mha", v->accepted, sizeof v->accepted, err)) return false;
    if (!v->own_frame) put(v, accepted, sizeof accepted / sizeof *accepted);
    v->arguments[v->count] = NULL;
    if (!hs_run_line_parse(v->count, v->arguments, &v->line, err)) return false;
    if (!v->own_place) v->line.out = "out/verify";
    return true;
}

static hs_verify_row *add(verify *v, const char *name, hs_verify_held held) {
    hs_verify_row *row = &v->rows[v->row_count++];
    *row = (hs_verify_row){.name = name, .held = held};
    return row;
}

static void device_text(cl_device_id device, cl_device_info what, char *out, size_t bytes) {
    if (clGetDeviceInfo(device, what, bytes, out, NULL) != CL_SUCCESS) (void)snprintf(out, bytes, "?");
    out[bytes - 1] = '\0';
}

static void add_facts(verify *v, const hs_run *run) {
    char version[200], driver[200], sum[HS_SHA256_TEXT] = "cannot be read", plugin[200];
    hs_error ignored = {0}; /* the row says it */
    device_text(run->cl.device, CL_DEVICE_VERSION, version, sizeof version);
    device_text(run->cl.device, CL_DRIVER_VERSION, driver, sizeof driver);
    hs_verify_row *row = add(v, "Device", HS_VERIFY_FACT);
    (void)snprintf(row->said, sizeof row->said, "%.200s; %.200s, driver %.200s", run->cl.device_name, version,
                   driver);
    hs_run_plugin_name(run, plugin, sizeof plugin);
    const char *path = run->has_plugin ? run->plugin.path : run->plugin_path;
    (void)hs_sha256_file(path, sum, &ignored);
    row = add(v, "Plugin", HS_VERIFY_FACT);
    (void)snprintf(row->said, sizeof row->said, "%s, %.300s, SHA-256 %s", plugin, path, sum);
}

static void add_frame(verify *v, const hs_run *run) {
    const hs_result_difference *d = &run->difference;
    const hs_verify_held held = d->rays == 0        ? HS_VERIFY_UNASKED
                                : d->different == 0 ? HS_VERIFY_HELD
                                                    : HS_VERIFY_FAILED;
    hs_verify_row *row = add(v, "Accepted frame", held);
    if (d->rays == 0)
        (void)snprintf(row->said, sizeof row->said, "no accepted map was given: --reference MAP");
    else
        (void)snprintf(
            row->said, sizeof row->said, "%llu of %llu rays differ by more than %g mm, the most by %g mm",
            (unsigned long long)d->different, (unsigned long long)d->rays, d->tolerance, d->largest);
}

static void add_times(verify *v, const hs_run *run) {
    const hs_loop_result *r = &run->results[0];
    const hs_timing *t = &r->stage[HS_STAGE_PLUGIN];
    char against[80] = "no deadline was given";
    hs_verify_held held = HS_VERIFY_UNASKED;
    if (v->deadline > 0) {
        held = t->p99 <= v->deadline ? HS_VERIFY_HELD : HS_VERIFY_FAILED;
        (void)snprintf(against, sizeof against, "the deadline is %g ms", v->deadline);
    }
    hs_verify_row *row = add(v, "Times of the plugin", held);
    (void)snprintf(row->said, sizeof row->said,
                   "%u frames: median %.2f ms, 99 of 100 within %.2f ms, the longest %.2f ms; %s", r->frames,
                   t->median, t->p99, t->max, against);
}

/* What the run says of the plugin: activation with its self-test, then every frame. */
static void add_plugin(verify *v, const hs_run *run, const hs_error *activated) {
    const hs_error *failure = activated->code != HS_OK ? activated : hs_run_plugin_error(run);
    hs_verify_row *row = add(v, "Self-test", activated->code == HS_OK ? HS_VERIFY_HELD : HS_VERIFY_FAILED);
    (void)snprintf(row->said, sizeof row->said, "%.1000s",
                   activated->code == HS_OK ? "the plugin was activated, and refused nothing"
                                            : activated->text);
    const hs_loop_result *r = &run->results[0];
    row = add(v, "Frames", failure->code == HS_OK ? HS_VERIFY_HELD : HS_VERIFY_FAILED);
    (void)snprintf(row->said, sizeof row->said, "%u clipped, %u without a surface, %u failed%s%.1000s",
                   r->clipped_frames, r->note_frames, r->failed_frames, failure->code == HS_OK ? "" : ": ",
                   failure->text);
    v->code = failure->code;
}

static const char *word_of(hs_verify_held held) {
    static const char *const words[] = {"holds", "FAILS", "not asked", "is"};
    return words[held];
}

static void print_rows(const verify *v) {
    for (uint32_t i = 0; i < v->row_count; i++)
        hs_print(stdout, "%-20s %-9s  %s\n", v->rows[i].name, word_of(v->rows[i].held), v->rows[i].said);
}

static bool write_page(const verify *v, bool has_picture, hs_error *err) {
    static const char *const heads[] = {"What", "Result", "Details"};
    char path[SYS_PATH], picture[SYS_PATH], when[64];
    const time_t now = time(NULL);
    if (!hs_path_join(v->line.out, "verify.html", path, sizeof path, err) ||
        !hs_path_join(v->line.out, "result.png", picture, sizeof picture, err))
        return false;
    (void)strftime(when, sizeof when, "%Y-%m-%d %H:%M:%S UTC", gmtime(&now));
    hs_page page;
    hs_page_open(&page, path, "SmartVis on this machine");
    hs_page_text(&page, v->code == HS_OK ? "All that was asked for holds." : "Something does not hold.");
    hs_page_text(&page, "host_sim " SV_VERSION ". For research, not a medical device.");
    hs_page_text(&page, when);
    hs_page_table_begin(&page);
    hs_page_table_row(&page, heads, 3);
    for (uint32_t i = 0; i < v->row_count; i++) {
        const hs_verify_row *row = &v->rows[i];
        const char *const cells[] = {row->name, word_of(row->held), row->said};
        hs_page_table_row(&page, cells, 3);
    }
    hs_page_table_end(&page);
    if (has_picture) {
        hs_page_row_begin(&page, "");
        hs_page_picture(&page, picture, "The frame, clipped", "The frame, clipped");
        hs_page_row_end(&page);
    }
    return hs_page_close(&page, err);
}

/* Everything of a run; what fails in the plugin is a row, what fails in the machine ends it. */
static bool try_frames(verify *v, hs_error *err) {
    hs_run run;
    if (!hs_run_open(&run, &v->line.request, err)) return false;
    const hs_error activated = *hs_run_plugin_error(&run);
    add_facts(v, &run);
    bool ok = hs_run_measure(&run, err);
    if (ok) add_plugin(v, &run, &activated);
    if (ok && v->code == HS_OK) {
        ok = hs_run_pictures(&run, v->line.out, err) && hs_run_write(&run, v->line.out, err);
        if (ok) add_frame(v, &run);
        if (ok) add_times(v, &run);
    }
    hs_error ended = {0};
    if (!hs_run_close(&run, &ended) && v->code == HS_OK) v->code = ended.code;
    return ok;
}

static bool run_verify(verify *v, hs_error *err) {
    if (!hs_path_make_folder(v->line.out, err)) return false;
    hs_verify_sums(&v->rows[v->row_count++]);
    if (!try_frames(v, err)) return false;
    const bool has_picture = v->code == HS_OK;
    for (uint32_t i = 0; i < v->row_count; i++)
        if (v->rows[i].held == HS_VERIFY_FAILED && v->code == HS_OK) v->code = HS_ERR_FAILED;
    print_rows(v);
    return write_page(v, has_picture, err);
}

int hs_cmd_verify(int argc, char **argv) {
    static verify v; /* too large for a small stack */
    hs_error err = {0};
    v = (verify){0};
    if (!read_line(&v, argc, argv, &err)) return hs_cli_fail("verify", &err);
    if (v.help) {
        hs_print(stdout, "%s%s", usage, hs_exit_codes_help);
        return HS_OK;
    }
    if (!run_verify(&v, &err)) return hs_cli_fail("verify", &err);
    hs_print(stdout, "The page is %s/verify.html\n", v.line.out);
    return (int)v.code;
}
