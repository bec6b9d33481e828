/* SPDX-License-Identifier: MIT */
/* sv_replay: plays a recording into a plugin, and says whether it does the same (docs/recording.md). */
#include "core/cli.h"
#include "core/options.h"
#include "core/system.h"
#include "core/text.h"
#include "guard/child.h"
#include "guarded/in_child.h"
#include "replay/replay.h"
#include "sv_version.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static bool take_set(void *target, const char *text, hs_error *err) {
    rp_options *const o = target;
    return hs_cli_append("--set", text, o->sets, &o->set_count, RP_MAX_SETS, err);
}

static bool take_carrier(void *target, const char *text, hs_error *err) {
    static const char *const names[] = {"host", "buffer", "image"};
    rp_options *const o = target;
    uint32_t index;
    if (!hs_cli_select("--carrier", text, names, 3, &index, err)) return false;
    o->carrier = SV_CARRIER_HOST + index;
    return true;
}

#define AT(field) offsetof(rp_options, field)
static const hs_option options[] = {
    HS_TEXT("plugin", "PATH", AT(plugin), "library to play it into, a path or a name [smartvis]"),
    HS_TEXT("id", "ID", AT(id), "the library's plugin of that id [its first]"),
    HS_TAKEN("set", "KEY=VALUE", 0, take_set, "a parameter's value instead of what was recorded; repeatable"),
    HS_TAKEN("carrier", "NAME", 0, take_carrier,
             "slabs in host memory, OpenCL buffers or images: host, buffer, image [as recorded]"),
    HS_FLAG("own-queue", AT(own_queue), "slabs in host memory, on the plugin's own queue"),
    HS_TEXT("out", "FOLDER", AT(out), "volume and map of a frame, for host_sim run to draw"),
    HS_IN(COUNT, "frame", "N", AT(frame), 0, 4294967294.0, "which frame that is, 0 the first [the last]"),
    HS_IN(NUMBER, "seconds", "S", AT(seconds), 0.1, 1e6,
          "that it may play, without the first activate, or show [8, and 4 for each MB of the recording]"),
    HS_TEXT("show", "FOLDER", AT(show), "a page of all frames: depthmaps, outcomes, the log; none is played"),
    HS_FLAG("list", AT(list), "print every call of the recording, and play none"),
    HS_FLAG("verbose", AT(verbose), "print what the plugin logs, and what it logged"),
    HS_GUARD_ROWS(AT(guard)),
    HS_OPTIONS_END,
};

static void print_help(void) {
    printf("Usage: sv_replay FILE [options]\n"
           "Plays a recording of the checking layer into a plugin, and says whether its maps, statuses and "
           "logs are the same bits,\nelse where they part.\n\n");
    hs_options_print(options);
    printf(
        "\nAll of it is played in a process of its own, which may take 1 GiB, and half of one for each MB of "
        "the recording,\nunless --guard-memory says otherwise. With --guard the plugin has another one, as "
        "host_sim runs it: then neither\nits log nor what begin and slab return can be compared. "
        "--no-guard: all of it in this process, for a debugger.\n\n"
        "%s1: something is not the same. A recording that is cut off is played as far as it goes, and "
        "ends with 3.\n",
        hs_exit_codes_help);
}

static void print_report(const rp_options *o, const rp_report *r, bool whole) {
    hs_print(stdout, "%s: %s %s: %u frames, %u calls", o->file, r->id, r->version, r->frames, r->calls);
    if (r->left_out) hs_print(stdout, "; %u calls broke a rule of the header and are left out", r->left_out);
    hs_print(stdout, "\n%u maps and %u lines of the log compared", r->maps, r->lines);
    if (!r->maps_kept && r->frames) hs_print(stdout, "; the recording holds no voxels and no maps");
    if (!r->fresh && r->frames)
        hs_print(stdout, "; the first frame continues one that is not there, which a plugin may remember");
    const double bytes = rp_file_bytes(o);
    if (r->voxel_bytes > 0 && bytes > 0.0)
        hs_print(stdout, "\n%.1f MB for %.1f MB of voxels", bytes * 1e-6, (double)r->voxel_bytes * 1e-6);
    hs_print(stdout, "\n%.1f ms in begin, slab and end, recorded %.1f ms\n", r->ms, r->recorded_ms);
    for (uint32_t i = 0; i < r->differences && i < RP_MAX_TOLD; i++) hs_print(stdout, "%s\n", r->told[i]);
    if (r->differences > RP_MAX_TOLD) hs_print(stdout, "and %u more\n", r->differences - RP_MAX_TOLD);
    hs_print(stdout, "%s\n", r->differences ? "NOT THE SAME" : whole ? "the same" : "the same so far");
}

static int play(void *context) {
    const rp_options *o = context;
    hs_error err = {0};
    rp_report *report = calloc(1, sizeof *report);
    bool ok = report || hs_fail(&err, HS_ERR_MEMORY, "no memory");
    ok = ok && rp_play(o, report, &err);
    if (report && (ok || err.code == HS_ERR_INPUT) && report->calls > 0) print_report(o, report, ok);
    if (ok && o->out) ok = rp_export(o, report, &err);
    const bool same = report && report->differences == 0;
    if (report) rp_frame_free(&report->drawn);
    free(report);
    if (ok) return hs_cli_finish("sv_replay", same ? HS_OK : HS_ERR_FAILED);
    hs_print(stderr, "sv_replay: %s\n", err.text);
    return (int)err.code;
}

int main(int argc, char **argv) {
    char path[1024];
    hs_error err = {0};
    bool help = false;
    argv = sys_arguments(&argc, argv);
    (void)hs_child_take(&argc, argv);
    int next = argc, code = HS_OK;
    hs_plugin_default_path(path, sizeof path);
    rp_options o = {.plugin = path, .frame = RP_LAST};
    hs_guard_defaults(&o.guard);
    o.guard.memory_bytes = 0;
    if (argc == 2 && strcmp(argv[1], "--version") == 0) {
        printf("sv_replay %s, recordings of version %u\n", SV_VERSION, REC_VERSION);
        return HS_OK;
    }
    bool ok = hs_options_read(argc, argv, options, &o, &next, &help, &err);
    if (ok && help) {
        print_help();
        return hs_cli_finish("sv_replay", HS_OK);
    }
    if (ok && next + 1 != argc)
        ok = hs_fail(&err, HS_ERR_USAGE, "expected one recording, %d given", argc - next);
    if (ok && o.frame != RP_LAST && !o.out)
        ok = hs_fail(&err, HS_ERR_USAGE, "--frame %u: is for --out FOLDER", o.frame);
    if (ok) o.file = argv[next];
    if (ok) rp_set_bounds(&o);
    if (ok && o.list) ok = rp_list(o.file, &err);
    if (ok && o.show) ok = rp_show(&o, &err);
    hs_guard_options whole = o.guard;
    if (o.guard.choice == HS_GUARD_AUTO) whole.choice = HS_GUARD_ON;
    if (ok && !o.list && !o.show)
        code = hs_work_in_child(&whole, o.plugin, "it was played to", play, &o, &err);
    if (err.code == HS_OK) return hs_cli_finish("sv_replay", code);
    hs_print(stderr, "sv_replay: %s\n", err.text);
    if (err.code == HS_ERR_USAGE) hs_print(stderr, "sv_replay --help tells what there is.\n");
    return (int)err.code;
}
