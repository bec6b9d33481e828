/* SPDX-License-Identifier: MIT */
/* sv_bench: a plugin's speed beside plain C, and the host's renderer and scan loop around it. */
#include "base/cli.h"
#include "base/options.h"
#include "bench/bench.h"
#include "bench/bench_results.h"
#include "guarded/in_child.h"
#include "plugin/loader_param.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define GRIDS_SCENE "D01"
#define GRIDS_SIZE  256u

enum {
    MAX_VALUES = 16,
    MAX_SLABS = 8,
    MAX_RESULTS = (1 + BENCH_METHODS) * BENCH_SIZES * MAX_SLABS * BENCH_ROUTES
};

static const uint32_t kernels[BENCH_SIZES] = {23, 23, 55}; /* k, by size */

typedef enum {
    PART_PLUGIN,
    PART_WORST,
    PART_FRAME,
    PART_GROWTH,
    PART_GUARD,
    PART_CONVERT,
    PART_LOOP,
    PART_GRIDS,
    PARTS
} part;

static const char *const part_names[PARTS] = {
    [PART_PLUGIN] = "plugin", [PART_WORST] = "worst",     [PART_FRAME] = "frame", [PART_GROWTH] = "growth",
    [PART_GUARD] = "guard",   [PART_CONVERT] = "convert", [PART_LOOP] = "loop",   [PART_GRIDS] = "grids"};

typedef struct {
    char usual[1024]; /* where the plugin lies by default */
    const char *plugin, *id, *scene, *scan, *csv, *json;
    uint32_t frames, host_frames, host_size;
    bool size[BENCH_SIZES], route[BENCH_ROUTES];
    uint32_t slabs[MAX_SLABS], slab_count; /* 0: the whole volume */
    bool part[PARTS], version;
    const char *value_texts[MAX_VALUES];
    uint32_t value_count;
    hs_guard_options guard;
} options;

static const char intro[] =
    "Usage: sv_bench [options]\n"
    "Times a plugin's frames beside plain C, and the host's renderer and scan loop around them.\n"
    "\n"
    "A frame is timed in turns with (a) reading the volume's bytes once and (b) the same work in plain C, "
    "both\n"
    "on two threads; then its methods cost and wall, if it has them; then the host's scan loop around the "
    "plugin.\n"
    "Last, the renderer of a probe's volume in the Cartesian copy and in the probe's own grid.\n"
    "The plugin's map is compared with plain C's before anything is timed. A plugin without the parameters "
    "q\n"
    "and kernel is timed as it is. '--only worst' prints what a frame costs at worst.\n\n";

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
    return found ||
           hs_fail(
               err, HS_ERR_USAGE,
               "--only: '%s' is none of 'plugin', 'worst', 'frame', 'growth', 'guard', 'convert', 'loop' and "
               "'grids'",
               text);
}

static bool take_quick(void *all, const char *text, hs_error *err) {
    options *const o = all;
    (void)text;
    (void)err;
    o->frames = 20;
    o->host_frames = 5;
    o->slabs[0] = 32;
    o->slab_count = 1;
    return o->route[BENCH_PLACE_OWN] = o->route[BENCH_BUFFER_HOST] = true;
}

/* What was not chosen takes its default. */
static void fill_defaults(options *o) {
    if (o->frames == 0) o->frames = o->part[PART_WORST] ? 10000 : 100;
    (void)bench_choose_all_if_none(o->size, BENCH_SIZES);
    (void)bench_choose_all_if_none(o->route, BENCH_ROUTES);
    if (o->slab_count > 0) return;
    static const uint32_t usual[] = {16, 32, 0};
    memcpy(o->slabs, usual, sizeof usual);
    o->slab_count = sizeof usual / sizeof *usual;
}

static bool take_param(void *all, const char *text, hs_error *err) {
    options *const o = all;
    return hs_cli_append("--param", text, o->value_texts, &o->value_count, MAX_VALUES, err);
}

static bool take_size(void *all, const char *text, hs_error *err) {
    return bench_parse_size(text, ((options *)all)->size, err);
}

#define AT(field) offsetof(options, field)
static const hs_option known[] = {
    {"plugin", "PATH", "plugin library (default: smartvis.so beside this program)\n", HS_OPTION_TEXT,
     AT(plugin), 0, 0, NULL},
    {"id", "ID", "the library's plugin of that id (default: its first)\n", HS_OPTION_TEXT, AT(id), 0, 0,
     NULL},
    {"param", "KEY=VALUE",
     "a parameter of the plugin, e.g. strategy=bands; may be repeated. Parameters that\n"
     "change the result make the comparison with plain C fail\n",
     HS_OPTION_TAKEN, 0, 0, 0, take_param},
    {"only", "PART",
     "'plugin', 'frame', 'guard', 'convert', 'loop' or 'grids' (default: all of these); or\n"
     "'worst': 10000 frames of each combination, as the plugin stands; or 'growth': time\n"
     "by voxels and by pixels\n",
     HS_OPTION_TAKEN, 0, 0, 0, take_part},
    {"size", "N", "volumes of N voxels an axis only: 128, 171 or 512; may be repeated\n", HS_OPTION_TAKEN, 0,
     0, 0, take_size},
    {"slab", "N", "slices of a slab, 0 for the whole volume in one; may be repeated (default: 16, 32, 0)\n",
     HS_OPTION_TAKEN, 0, 0, 0, take_slab},
    {"route", "NAME",
     "how slabs get to the plugin; may be repeated (default: all)\n"
     "  place-own    host memory, read in place; the plugin's own queue\n"
     "  place-host   host memory, read in place; the host's queue\n"
     "  copy-own     host memory, copied; the plugin's own queue\n"
     "  copy-host    host memory, copied; the host's queue\n"
     "  buffer-host  OpenCL buffer; the host's queue\n",
     HS_OPTION_TAKEN, 0, 0, 0, take_route},
    {"frames", "N", "timed frames of each combination (default 100; of 'worst' 10000)\n", HS_OPTION_COUNT,
     AT(frames), 1, 100000, NULL},
    {"loop-frames", "N", "timed frames of each camera and setting of the scan loop (default 20)\n",
     HS_OPTION_COUNT, AT(host_frames), 1, 100000, NULL},
    {"loop-size", "N", "voxels an axis of the scan loop's volume (default 400)\n", HS_OPTION_COUNT,
     AT(host_size), 32, 1024, NULL},
    {"scene", "NAME",
     "a scene for the scan loop: E01 .. D02 or a scene file (default: the layered volume\n"
     "that the plugin is timed on)\n",
     HS_OPTION_TEXT, AT(scene), 0, 0, NULL},
    {"scan", "FILE", "a scan file for 'convert': MetaImage, or Kretz in probe geometry\n", HS_OPTION_TEXT,
     AT(scan), 0, 0, NULL},
    {"quick", NULL, "20 frames, 5 of the loop; slabs of 32; routes place-own and buffer-host\n",
     HS_OPTION_TAKEN, 0, 0, 0, take_quick},
    HS_GUARD_ROWS(AT(guard)),
    {"csv", "FILE", "all numbers as CSV\n", HS_OPTION_TEXT, AT(csv), 0, 0, NULL},
    {"json", "FILE", "all numbers as JSON\n", HS_OPTION_TEXT, AT(json), 0, 0, NULL},
    {"version", NULL, "versions of this program and of the ABI\n", HS_OPTION_FLAG, AT(version), 0, 0, NULL},
    {NULL, NULL, NULL, HS_OPTION_FLAG, 0, 0, 0, NULL},
};

static void print_help(void) {
    printf("%s", intro);
    hs_options_print(known);
    printf("\nExit codes as host_sim's; 1: the plugin's map is not plain C's. A target that does not hold is "
           "no failure.\n");
}

static bool parse_options(int argc, char **argv, options *o, bool *wants_help, hs_error *err) {
    *o = (options){.host_frames = 20, .host_size = 400};
    for (int i = 0; i < PARTS; i++) o->part[i] = i != PART_GROWTH && i != PART_WORST;
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
    bench_team *team;
    sv_param_value values[MAX_VALUES];
    bench_plugin_result results[MAX_RESULTS];
    bench_convert_result convert;
    bench_host_result host;
    bench_grids_result grids;
    bench_report report;
} bench_run;

/* All chosen ways of one slab length. `method` as in bench_plugin_setup. */
static bool run_routes(bench_run *run, int size, uint32_t slab_slices, const char *method, hs_error *err) {
    const bench_plugin_setup setup = {.plugin = &run->plugin,
                                      .cl = &run->cl,
                                      .team = run->team,
                                      .frames = run->o.frames,
                                      .values = run->values,
                                      .value_count = run->o.value_count,
                                      .method = method};
    bench_slabs slabs;
    if (!bench_slabs_create(&slabs, bench_sizes[size], slab_slices, err)) return false;
    bool ok = true;
    for (int route = 0; ok && route < BENCH_ROUTES; route++) {
        if (!run->o.route[route]) continue;
        if (!hs_plugin_takes(run->plugin.instance->descriptor, bench_route_handover((bench_route)route))) {
            printf("%-34s %4u | left out: the plugin takes no such slabs\n",
                   bench_route_label((bench_route)route), slabs.layout.slab_slices);
            continue;
        }
        const bench_variant variant = {bench_sizes[size], kernels[size], slabs.layout.slab_slices,
                                       (bench_route)route};
        bench_plugin_result *result = &run->results[run->report.plugin_count];
        hs_progress progress;
        hs_progress_begin(&progress, bench_route_label(variant.route), run->o.frames);
        ok = bench_plugin_run(&setup, &slabs, &variant, &progress, result, err);
        hs_progress_end(&progress);
        if (!ok) break;
        if (!method) bench_print_plugin(result);
        run->report.plugin_count++;
    }
    bench_slabs_destroy(&slabs);
    return ok;
}

/* A method on the same volumes, as large as it is timed on. */
static bool run_method(bench_run *run, const bench_method *method, hs_error *err) {
    if (!bench_plugin_has_method(&run->plugin, method->name)) return true;
    for (int size = 0; size < BENCH_SIZES; size++) {
        if (!run->o.size[size] || bench_sizes[size] > method->largest) continue;
        for (uint32_t s = 0; s < run->o.slab_count; s++) {
            const uint32_t slab = run->o.slabs[s] ? run->o.slabs[s] : bench_sizes[size];
            if (!run_routes(run, size, slab, method->name, err)) return false;
        }
    }
    bench_print_method(&run->report, method->name);
    return true;
}

static bool run_plugin_part(bench_run *run, hs_error *err) {
    const bool foreign = bench_plugin_is_foreign(&run->plugin);
    for (int size = 0; size < BENCH_SIZES; size++) {
        if (!run->o.size[size]) continue;
        if (!foreign) bench_print_plugin_head(bench_sizes[size], kernels[size]);
        for (uint32_t s = 0; s < run->o.slab_count; s++) {
            const uint32_t slab = run->o.slabs[s] ? run->o.slabs[s] : bench_sizes[size];
            if (!run_routes(run, size, slab, foreign ? BENCH_OWN : NULL, err)) return false;
        }
    }
    if (foreign) bench_print_method(&run->report, BENCH_OWN);
    bench_print_stages(run->results, run->report.plugin_count);
    for (int i = 0; i < BENCH_METHODS; i++)
        if (!run_method(run, &bench_methods[i], err)) return false;
    return true;
}

/* The plugin with its own defaults, in as many frames as it takes to meet the rare ones. */
static bool run_worst_part(bench_run *run, hs_error *err) {
    for (int size = 0; size < BENCH_SIZES; size++)
        for (uint32_t s = 0; run->o.size[size] && s < run->o.slab_count; s++) {
            const uint32_t slab = run->o.slabs[s] ? run->o.slabs[s] : bench_sizes[size];
            if (!run_routes(run, size, slab, BENCH_OWN, err)) return false;
        }
    bench_print_worst(&run->report);
    return true;
}

/* Both ways of every size; a plugin of the user's is started both ways, too. */
static bool run_guard_part(bench_run *run, hs_error *err) {
    const bench_guard_setup setup = {.path = run->o.plugin,
                                     .id = run->o.id,
                                     .cl = &run->cl,
                                     .frames = run->o.frames,
                                     .values = run->values,
                                     .value_count = run->o.value_count};
    bench_guard_print_head();
    for (int size = 0; size < BENCH_SIZES; size++) {
        bench_guard_result result;
        if (!run->o.size[size]) continue;
        if (!bench_guard_run(&setup, bench_sizes[size], &result, err)) return false;
        bench_guard_print(&result);
    }
    return true;
}

static bool run_convert_part(bench_run *run, hs_error *err) {
    const bench_convert_setup setup = {.cl = &run->cl, .team = run->team, .frames = run->o.host_frames};
    hs_source source = {0};
    hs_volume volume = {0};
    const hs_volume *list[1];
    const char *named = run->o.scan ? run->o.scan : run->o.scene;
    const bool ok = (run->o.scan ? hs_source_open_files(&source, &run->o.scan, 1, NULL, err)
                                 : bench_open_source(named, run->o.host_size, &source, &volume, list, err)) &&
                    bench_convert_run(&setup, hs_source_bring(&source, 0, err), &run->convert, err);
    if (ok) bench_print_convert(&run->convert);
    bench_close_source(named, &source, &volume);
    return ok;
}

/* The loop as a scan runs it. */
static bool run_live_part(bench_run *run, const bench_host_setup *setup, hs_error *err) {
    bench_loop_result result;
    hs_source source = {0};
    hs_volume volume = {0};
    const hs_volume *list[1];
    const bool ok = bench_open_source(setup->scene, setup->size, &source, &volume, list, err) &&
                    bench_loop_run(setup, run->team, &source, &result, err);
    if (ok) bench_print_loop(&result);
    bench_close_source(setup->scene, &source, &volume);
    return ok;
}

static bench_host_setup host_setup(const bench_run *run) {
    return (bench_host_setup){.plugin = &run->plugin,
                              .cl = &run->cl,
                              .frames = run->o.host_frames,
                              .scene = run->o.scene,
                              .size = run->o.host_size,
                              .values = run->values,
                              .value_count = run->o.value_count};
}

static bool run_host_part(bench_run *run, hs_error *err) {
    const bench_host_setup setup = host_setup(run);
    if (!bench_host_run(&setup, &run->host, err)) return false;
    bench_print_host(&run->host);
    run->report.host = &run->host;
    return run_live_part(run, &setup, err);
}

static bool run_frame_part(bench_run *run, hs_error *err) {
    const bench_host_setup setup = host_setup(run);
    bench_frame_result result;
    if (!bench_frame_run(&setup, run->team, &result, err)) return false;
    bench_print_frame(&result);
    return true;
}

static bool run_growth_part(bench_run *run, hs_error *err) {
    const bench_plugin_setup setup = {.plugin = &run->plugin,
                                      .cl = &run->cl,
                                      .team = run->team,
                                      .frames = run->o.frames,
                                      .values = run->values,
                                      .value_count = run->o.value_count};
    return bench_growth_run(&setup, err);
}

/* A scene, since the layered volume fills no fan. */
static bool run_grids_part(bench_run *run, hs_error *err) {
    const char *scene = run->o.scene ? run->o.scene : GRIDS_SCENE;
    if (!bench_grids_run(&run->cl, scene, GRIDS_SIZE, run->o.host_frames, &run->grids, err)) return false;
    bench_print_grids(&run->grids);
    run->report.grids = &run->grids;
    return true;
}

static bool (*const part_runs[PARTS])(bench_run *run, hs_error *err) = {
    [PART_PLUGIN] = run_plugin_part, [PART_WORST] = run_worst_part, [PART_FRAME] = run_frame_part,
    [PART_GROWTH] = run_growth_part, [PART_GUARD] = run_guard_part, [PART_CONVERT] = run_convert_part,
    [PART_LOOP] = run_host_part,     [PART_GRIDS] = run_grids_part};

static bool measure(bench_run *run, hs_error *err) {
    if (!hs_output_try(run->o.csv, err) || !hs_output_try(run->o.json, err)) return false;
    for (uint32_t i = 0; i < run->o.value_count; i++)
        if (!hs_plugin_parse_param(&run->plugin, run->o.value_texts[i], &run->values[i], err)) return false;
    bench_machine_ask(&run->report.machine, &run->cl, &run->plugin);
    bench_machine_print(&run->report.machine);
    run->team = bench_team_create(err);
    run->report.plugin = run->results;
    if (!run->team) return false;
    for (int i = 0; i < PARTS; i++)
        if (run->o.part[i] && !part_runs[i](run, err)) return false;
    if (!run->o.part[PART_WORST]) bench_print_targets(&run->report);
    return (!run->o.csv || bench_write_csv(&run->report, run->o.csv, err)) &&
           (!run->o.json || bench_write_json(&run->report, run->o.json, err));
}

/* Opens what a run needs, measures, and closes it. Returns the exit code. */
static int open_and_measure(void *context) {
    bench_run *run = context;
    hs_error err = {HS_OK, ""};
    const bool device = hs_cl_open(&run->cl, &err);
    const bool plugin =
        device && hs_plugin_open(&run->plugin, run->o.plugin, run->o.id, SV_LOG_WARNING, &err);
    const bool ok = plugin && measure(run, &err);
    bench_team_destroy(run->team);
    if (plugin) hs_plugin_close(&run->plugin);
    if (device) hs_cl_close(&run->cl);
    return ok ? HS_OK : bench_fail("sv_bench", &err);
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
    if (!run) {
        (void)hs_fail(&err, HS_ERR_MEMORY, "no memory for the results");
        return bench_fail("sv_bench", &err);
    }
    const bool ok = parse_options(argc, argv, &run->o, &wants_help, &err);
    if (wants_help)
        print_help();
    else if (ok && run->o.version)
        printf("sv_bench " HS_VERSION ", plugin ABI %u.%u\n", SV_ABI_MAJOR, SV_ABI_MINOR);
    else if (ok)
        code = hs_work_in_child(&run->o.guard, run->o.plugin, "it was timed", measure_and_finish, run, &err);
    free(run);
    return err.code == HS_OK ? hs_cli_finish("sv_bench", code) : bench_fail("sv_bench", &err);
}
