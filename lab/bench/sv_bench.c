/* SPDX-License-Identifier: MIT */
/* sv_bench: a plugin's speed beside plain C. */
#include "bench/bench.h"
#include "bench/bench_results.h"
#include "core/cli.h"
#include "core/options.h"
#include "core/system.h"
#include "guard/child.h"
#include "guarded/in_child.h"
#include "sv_version.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { SIZES = 3, MAX_SLABS = 8, MAX_RESULTS = 2 * SIZES * MAX_SLABS * BENCH_ROUTES };

static const uint32_t sizes[SIZES] = {128, 171, 512}; /* voxels an axis that --size chooses from */
static const uint32_t kernels[SIZES] = {23, 23, 55};  /* k, by size */

typedef enum { PART_PLUGIN, PART_WORST, PARTS } part;

static const char *const part_names[PARTS] = {"plugin", "worst"};

typedef struct {
    char usual[1024]; /* where the plugin lies by default */
    const char *plugin, *id;
    uint32_t frames;
    bool size[SIZES], route[BENCH_ROUTES];
    uint32_t slabs[MAX_SLABS], slab_count; /* 0: the whole volume */
    bool part[PARTS], version;
    hs_guard_options guard;
} options;

static const char intro[] =
    "Usage: sv_bench [options]\n"
    "Times a plugin's frames beside plain C.\n"
    "\n"
    "A frame is timed in turns with the same work in plain C, on two threads; then with method wall, if\n"
    "the plugin has it.\n"
    "The plugin's map is compared with plain C's before anything is timed. A plugin without the parameters "
    "q\n"
    "and kernel is timed as it is. '--only worst' prints what a frame costs at worst.\n\n";

/* Says on stderr what went wrong; returns the exit code. */
static int fail(const hs_error *err) {
    (void)fprintf(stderr, "sv_bench: %s\n", err->text);
    if (err->code == HS_ERR_USAGE) (void)fprintf(stderr, "Try 'sv_bench --help'.\n");
    return (int)err->code;
}

static bool take_route(void *all, const char *text, hs_error *err) {
    options *const o = all;
    for (int i = 0; i < BENCH_ROUTES; i++)
        if (strcmp(text, bench_route_key((bench_route)i)) == 0) return o->route[i] = true;
    return hs_fail(err, HS_ERR_USAGE, "--route: there is no '%s'; see --help", text);
}

static bool take_slab(void *all, const char *text, hs_error *err) {
    options *const o = all;
    if (o->slab_count == MAX_SLABS)
        return hs_fail(err, HS_ERR_USAGE, "--slab: given more than %d times", MAX_SLABS);
    return hs_cli_u32("--slab", text, 0, 512, &o->slabs[o->slab_count++], err);
}

static bool take_part(void *all, const char *text, hs_error *err) {
    options *const o = all;
    bool found = false;
    for (int i = 0; i < PARTS; i++) found |= o->part[i] = strcmp(text, part_names[i]) == 0;
    return found || hs_fail(err, HS_ERR_USAGE, "--only: '%s' is neither 'plugin' nor 'worst'", text);
}

static bool take_quick(void *all, const char *text, hs_error *err) {
    options *const o = all;
    (void)text;
    (void)err;
    o->frames = 20;
    o->slabs[0] = 32;
    o->slab_count = 1;
    return o->route[BENCH_PLACE_OWN] = o->route[BENCH_BUFFER_HOST] = true;
}

/* What was not chosen is all chosen. */
static void choose_all_if_none(bool *chosen, int count) {
    bool any = false;
    for (int i = 0; i < count; i++) any = any || chosen[i];
    for (int i = 0; i < count; i++) chosen[i] = chosen[i] || !any;
}

/* What was not chosen takes its default. */
static void fill_defaults(options *o) {
    if (o->frames == 0) o->frames = o->part[PART_WORST] ? 10000 : 100;
    choose_all_if_none(o->size, SIZES);
    choose_all_if_none(o->route, BENCH_ROUTES);
    if (o->slab_count > 0) return;
    static const uint32_t usual[] = {16, 32, 0};
    memcpy(o->slabs, usual, sizeof usual);
    o->slab_count = sizeof usual / sizeof *usual;
}

static bool take_size(void *all, const char *text, hs_error *err) {
    options *const o = all;
    for (int i = 0; i < SIZES; i++)
        if (strtoul(text, NULL, 10) == sizes[i]) return o->size[i] = true;
    return hs_fail(err, HS_ERR_USAGE, "--size: %s is none of 128, 171, 512", text);
}

#define AT(field) offsetof(options, field)
static const hs_option known[] = {
    HS_TEXT("plugin", "PATH", AT(plugin), "plugin library [smartvis beside this program]"),
    HS_TEXT("id", "ID", AT(id), "the library's plugin of that id (default: its first)"),
    HS_TAKEN("only", "PART", 0, take_part,
             "'plugin' (the default), or 'worst': 10000 frames of each combination, as the plugin\n"
             "stands"),
    HS_TAKEN("size", "N", 0, take_size, "volumes of N voxels an axis only: 128, 171 or 512; may be repeated"),
    HS_TAKEN("slab", "N", 0, take_slab,
             "slices of a slab, 0 for the whole volume in one; may be repeated (default: 16, 32, 0)"),
    HS_TAKEN("route", "NAME", 0, take_route,
             "how slabs get to the plugin; may be repeated (default: all)\n"
             "  place-own    host memory, read in place; the plugin's own queue\n"
             "  place-host   host memory, read in place; the host's queue\n"
             "  copy-own     host memory, copied; the plugin's own queue\n"
             "  copy-host    host memory, copied; the host's queue\n"
             "  buffer-host  OpenCL buffer; the host's queue"),
    HS_IN(COUNT, "frames", "N", AT(frames), 1, 100000,
          "timed frames of each combination (default 100; of 'worst' 10000)"),
    HS_TAKEN("quick", NULL, 0, take_quick, "20 frames; slabs of 32; routes place-own and buffer-host"),
    HS_GUARD_ROWS(AT(guard)),
    HS_FLAG("version", AT(version), "versions of this program and of the ABI"),
    HS_OPTIONS_END,
};

static void print_help(void) {
    printf("%s", intro);
    hs_options_print(known);
    printf("\nExit codes as host_sim's; 1: the plugin's map is not plain C's.\n");
}

static bool parse_options(int argc, char **argv, options *o, bool *wants_help, hs_error *err) {
    *o = (options){.part = {[PART_PLUGIN] = true}};
    hs_guard_defaults(&o->guard);
    hs_plugin_default_path(o->usual, sizeof o->usual);
    o->plugin = o->usual;
    int next = argc;
    if (!hs_options_read(argc, argv, known, o, &next, wants_help, err) ||
        !hs_cli_no_more(argc, argv, next, err))
        return false;
    fill_defaults(o);
    return true;
}

/* A run's own: what is opened and what has been measured. */
typedef struct {
    options o;
    hs_cl cl;
    hs_plugin plugin;
    bench_plugin_result results[MAX_RESULTS];
    bench_report report;
} bench_run;

/* All chosen ways of one slab length. `method` as in bench_plugin_setup. */
static bool run_routes(bench_run *run, int size, uint32_t slab_slices, const char *method, hs_error *err) {
    const bench_plugin_setup setup = {
        .plugin = &run->plugin, .cl = &run->cl, .frames = run->o.frames, .method = method};
    uint8_t *voxels = bench_volume_make(sizes[size], err);
    if (!voxels) return false;
    bool ok = true;
    for (int route = 0; ok && route < BENCH_ROUTES; route++) {
        if (!run->o.route[route]) continue;
        if (!hs_plugin_takes(run->plugin.instance->descriptor, bench_route_handover((bench_route)route))) {
            printf("%-34s %4u | left out: the plugin takes no such slabs\n",
                   bench_route_label((bench_route)route), slab_slices);
            continue;
        }
        const bench_variant variant = {sizes[size], kernels[size], slab_slices, (bench_route)route};
        bench_plugin_result *result = &run->results[run->report.plugin_count];
        hs_progress progress;
        hs_progress_begin(&progress, bench_route_label(variant.route), run->o.frames);
        ok = bench_plugin_run(&setup, voxels, &variant, &progress, result, err);
        hs_progress_end(&progress);
        if (!ok) break;
        if (!method) bench_print_plugin(result);
        run->report.plugin_count++;
    }
    free(voxels);
    return ok;
}

/* A method on the same volumes. */
static bool run_method(bench_run *run, hs_error *err) {
    if (!bench_plugin_has_method(&run->plugin, BENCH_METHOD)) return true;
    for (int size = 0; size < SIZES; size++) {
        if (!run->o.size[size]) continue;
        for (uint32_t s = 0; s < run->o.slab_count; s++) {
            const uint32_t slab = run->o.slabs[s] ? run->o.slabs[s] : sizes[size];
            if (!run_routes(run, size, slab, BENCH_METHOD, err)) return false;
        }
    }
    bench_print_method(&run->report, BENCH_METHOD);
    return true;
}

static bool run_plugin_part(bench_run *run, hs_error *err) {
    const bool foreign = bench_plugin_is_foreign(&run->plugin);
    for (int size = 0; size < SIZES; size++) {
        if (!run->o.size[size]) continue;
        if (!foreign) bench_print_plugin_head(sizes[size], kernels[size]);
        for (uint32_t s = 0; s < run->o.slab_count; s++) {
            const uint32_t slab = run->o.slabs[s] ? run->o.slabs[s] : sizes[size];
            if (!run_routes(run, size, slab, foreign ? BENCH_OWN : NULL, err)) return false;
        }
    }
    if (foreign) bench_print_method(&run->report, BENCH_OWN);
    bench_print_stages(run->results, run->report.plugin_count);
    return run_method(run, err);
}

/* The plugin with its own defaults, in as many frames as it takes to meet the rare ones. */
static bool run_worst_part(bench_run *run, hs_error *err) {
    for (int size = 0; size < SIZES; size++)
        for (uint32_t s = 0; run->o.size[size] && s < run->o.slab_count; s++) {
            const uint32_t slab = run->o.slabs[s] ? run->o.slabs[s] : sizes[size];
            if (!run_routes(run, size, slab, BENCH_OWN, err)) return false;
        }
    bench_print_worst(&run->report);
    return true;
}

static bool (*const part_runs[PARTS])(bench_run *run, hs_error *err) = {
    [PART_PLUGIN] = run_plugin_part, [PART_WORST] = run_worst_part};

static bool measure(bench_run *run, hs_error *err) {
    bench_machine_ask(&run->report.machine, &run->cl, &run->plugin);
    bench_machine_print(&run->report.machine);
    run->report.plugin = run->results;
    for (int i = 0; i < PARTS; i++)
        if (run->o.part[i] && !part_runs[i](run, err)) return false;
    return true;
}

/* Opens what a run needs, measures, and closes it. Returns the exit code. */
static int open_and_measure(void *context) {
    bench_run *run = context;
    hs_error err = {HS_OK, ""};
    const bool device = hs_cl_open(&run->cl, &err);
    const bool plugin =
        device && hs_plugin_open(&run->plugin, run->o.plugin, run->o.id, SV_LOG_WARNING, &err);
    const bool ok = plugin && measure(run, &err);
    if (plugin) hs_plugin_close(&run->plugin);
    if (device) hs_cl_close(&run->cl);
    return ok ? HS_OK : fail(&err);
}

/* In a process of its own, whose output is its own, too. */
static int measure_and_finish(void *context) {
    return hs_cli_finish("sv_bench", open_and_measure(context));
}

int main(int argc, char **argv) {
    hs_error err = {HS_OK, ""};
    bool wants_help = false;
    int code = HS_OK;
    bench_run *run = calloc(1, sizeof *run);
    argv = sys_arguments(&argc, argv);
    (void)hs_child_take(&argc, argv);
    if (!run) {
        (void)hs_fail(&err, HS_ERR_MEMORY, "no memory for the results");
        return fail(&err);
    }
    const bool ok = parse_options(argc, argv, &run->o, &wants_help, &err);
    if (wants_help)
        print_help();
    else if (ok && run->o.version)
        printf("sv_bench " SV_VERSION ", plugin ABI %u.%u\n", SV_ABI_MAJOR, SV_ABI_MINOR);
    else if (ok)
        code = hs_work_in_child(&run->o.guard, run->o.plugin, "it was timed", measure_and_finish, run, &err);
    free(run);
    return err.code == HS_OK ? hs_cli_finish("sv_bench", code) : fail(&err);
}
