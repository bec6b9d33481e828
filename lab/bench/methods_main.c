/* SPDX-License-Identifier: MIT */
/* sv_surfaces_bench: what each reconstruction method costs, and how wrong it is. */
#include "bench/methods.h"

#include "base/cli.h"
#include "base/options.h"
#include "base/progress.h"
#include "ref/ref_chain.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const double default_q = 0.5;

typedef struct {
    char usual[1024]; /* where the plugin lies by default */
    const char *plugin, *id, *csv, *svg, *points;
    uint32_t frames;
    double seconds, budget; /* of a variant; of a definition, operations */
    bool size[BENCH_SIZES], method[SV_METHOD_END], quick, no_truth, no_fit;
} options;

static const char intro[] =
    "Usage: sv_surfaces_bench [options]\n"
    "Times the surface reconstruction of every method, precision and approximation, and measures its error:\n"
    "against the float64 definition on the same initial points, and against the ground truth of scenes. The\n"
    "map's initial points lie on 3 % of the rays, in patches; the volume is 64 slices deep, because only "
    "the\n"
    "reconstruction is timed. Ratios of medians are to the memory limit (two float32 maps read and one "
    "written,\n"
    "its least time) and to the mean filter in plain C (in brackets: ratio of minima), both on two threads "
    "and\n"
    "in turns with the plugin.\n\n";
static const char outro[] =
    "Variants: k, the mean and minimum filter's window; m, cells per side that a spline's points are merged\n"
    "on; grid or g, cells per side it is evaluated on (pixels: every pixel); f32, solver in float32; int16,\n"
    "16-bit planes; 1/2 and 1/4, reduced resolution. Errors are those against the full one.\n"
    "Exit codes as host_sim's; 1: the plugin finds other initial points, or no surface.\n";

static bool take_method(void *all, const char *text, hs_error *err) {
    options *const o = all;
    for (uint32_t m = 0; m < SV_METHOD_END; m++)
        if (methods_on_points(m) && strcmp(text, sv_ref_method_name(m)) == 0) return o->method[m] = true;
    return hs_fail(err, HS_ERR_USAGE, "--method: there is no '%s'; see --help", text);
}

static bool take_quick(void *all, const char *text, hs_error *err) {
    options *const o = all;
    (void)text;
    (void)err;
    o->frames = 10;
    o->seconds = 0.3;
    o->budget = 5.5e9;
    return o->quick = true;
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
    {"size", "N", "maps of N x N pixels only: 128, 171 or 512; may be repeated\n", HS_OPTION_TAKEN, 0, 0, 0,
     take_size},
    {"method", "NAME", "this method only, of those that start from initial points; may be repeated\n",
     HS_OPTION_TAKEN, 0, 0, 0, take_method},
    {"frames", "N", "timed frames of each variant at most (default 30)\n", HS_OPTION_COUNT, AT(frames), 3,
     100000, NULL},
    {"seconds", "S", "a variant that took longer ends early, after 3 frames at least (default 2)\n",
     HS_OPTION_NUMBER, AT(seconds), 0, 3600, NULL},
    {"operations", "N", "leave out a float64 definition that takes more scalar operations (default 2e10)\n",
     HS_OPTION_NUMBER, AT(budget), 0, 1e15, NULL},
    {"no-truth", NULL, "without the scenes\n", HS_OPTION_FLAG, AT(no_truth), 0, 0, NULL},
    {"no-fit", NULL, "without the exponents\n", HS_OPTION_FLAG, AT(no_fit), 0, 0, NULL},
    {"quick", NULL, "9 variants, 10 frames, 0.3 seconds, 5.5e9 operations: under a minute\n", HS_OPTION_TAKEN,
     0, 0, 0, take_quick},
    {"csv", "FILE", "all numbers as CSV\n", HS_OPTION_TEXT, AT(csv), 0, 0, NULL},
    {"svg", "FILE", "a plot of time against error, with the Pareto fronts\n", HS_OPTION_TEXT, AT(svg), 0, 0,
     NULL},
    {"points", "FILE", "write the initial points of the one --size as lines 'x y near far', and end\n",
     HS_OPTION_TEXT, AT(points), 0, 0, NULL},
    {NULL, NULL, NULL, HS_OPTION_FLAG, 0, 0, 0, NULL},
};

static void print_help(void) {
    printf("%s", intro);
    hs_options_print(known);
    printf("\n%s", outro);
}

static bool parse_options(int argc, char **argv, options *o, bool *wants_help, hs_error *err) {
    *o = (options){.frames = 30, .seconds = 2.0, .budget = 2e10};
    hs_plugin_default_path(o->usual, sizeof o->usual);
    o->plugin = o->usual;
    int next = argc;
    if (!hs_options_read(argc, argv, known, o, &next, wants_help, err) ||
        !hs_cli_no_more(argc, argv, next, err))
        return false;
    if (*wants_help) return true;
    const int sizes = bench_choose_all_if_none(o->size, BENCH_SIZES);
    (void)bench_choose_all_if_none(o->method, SV_METHOD_END);
    return !o->points || sizes == 1 ||
           hs_fail(err, HS_ERR_USAGE, "--points: needs one --size, got %d", sizes);
}

/* A run's own. `reference` is the last definition that was computed: variants
 * that share it stand together. */
typedef struct {
    options o;
    hs_cl cl;
    hs_plugin plugin;
    methods_setup setup;
    methods_report report;
    float *depth;
    double *reference;
    const methods_variant *reference_of;
} bench_run;

static bool wanted(const options *o, const methods_variant *v) {
    return v->label && o->method[v->method] && (v->quick || !o->quick);
}

/* Error against the definition, unless that takes too long. */
static bool find_error(bench_run *run, const methods_map *map, methods_row *row, hs_error *err) {
    const methods_variant *v = row->variant;
    if (methods_reference_cost(map, v) > run->o.budget) return true;
    if (!run->reference || !methods_reference_same(v, run->reference_of)) {
        free(run->reference);
        run->reference = methods_reference_make(map, v, run->setup.q, err);
        run->reference_of = v;
    }
    if (!run->reference) return false;
    row->error = methods_error_of(run->depth, run->reference, (size_t)map->n * map->n);
    return true;
}

static bool run_row(bench_run *run, const methods_map *map, const methods_variant *variant, methods_row *row,
                    hs_error *err) {
    *row = (methods_row){.variant = variant, .n = map->n, .points = map->points};
    if (!methods_time(&run->setup, map, variant, run->depth, &row->times, err) ||
        !find_error(run, map, row, err))
        return false;
    methods_print_row(row);
    return true;
}

static void new_map(bench_run *run, methods_map *map) {
    methods_map_free(map);
    free(run->reference);
    run->reference = NULL;
}

static bool run_size(bench_run *run, uint32_t n, hs_error *err) {
    methods_map map;
    if (!methods_map_bones(&map, n, err)) return false;
    char what[64];
    (void)snprintf(what, sizeof what, "%u x %u pixels, %u initial points", n, n, map.points);
    methods_print_head(what);
    bool ok = true;
    for (int v = 0; ok && v < METHODS_VARIANTS; v++)
        if (wanted(&run->o, &methods_variants[v])) {
            ok = run_row(run, &map, &methods_variants[v], &run->report.rows[run->report.row_count], err);
            if (ok) run->report.row_count++;
        }
    new_map(run, &map);
    return ok;
}

/* Splines through more and more points, for the fit. */
static bool run_splines(bench_run *run, hs_error *err) {
    static const methods_variant unmerged = {.label = "spline unmerged, pixels", .method = SV_METHOD_SPLINE};
    methods_print_head("Splines through scattered points, 128 x 128 pixels");
    for (int i = 0; i < METHODS_SPLINES; i++) {
        methods_map map;
        if (!methods_map_scattered(&map, bench_sizes[0], methods_spline_points[i], err)) return false;
        const bool ok = run_row(run, &map, &unmerged, &run->report.splines[i], err);
        if (ok) run->report.spline_count++;
        new_map(run, &map);
        if (!ok) return false;
    }
    return true;
}

static bool run_scene(bench_run *run, int s, hs_error *err) {
    methods_scene scene;
    if (!methods_scene_open(&scene, &run->cl, methods_scene_names[s], err)) return false;
    run->report.unclipped[s] = scene.unclipped;
    bool ok = true;
    hs_progress progress;
    hs_progress_begin(&progress, methods_scene_names[s], METHODS_VARIANTS);
    for (int v = 0; ok && v < METHODS_VARIANTS; v++) {
        methods_truth_row *row = &run->report.truth[v];
        if (!wanted(&run->o, &methods_variants[v])) continue;
        row->known = true;
        ok = methods_scene_difference(&scene, &run->cl, &run->plugin, &methods_variants[v], &row->slices[s],
                                      &row->clipped[s], err);
        hs_progress_step(&progress, (uint64_t)v + 1);
    }
    hs_progress_end(&progress);
    methods_scene_close(&scene);
    return ok;
}

static bool run_truth(bench_run *run, hs_error *err) {
    for (int s = 0; s < METHODS_SCENES; s++)
        if (!run_scene(run, s, err)) return false;
    methods_print_truth(&run->report);
    return true;
}

static bool measure(bench_run *run, hs_error *err) {
    const options *o = &run->o;
    const size_t largest = (size_t)bench_sizes[BENCH_SIZES - 1] * bench_sizes[BENCH_SIZES - 1];
    if (!hs_output_try(o->csv, err) || !hs_output_try(o->svg, err)) return false;
    run->depth = malloc(largest * sizeof *run->depth);
    if (!run->depth) return hs_fail(err, HS_ERR_MEMORY, "benchmark: no memory for %zu pixels", largest);
    bench_machine_ask(&run->report.machine, &run->cl, &run->plugin);
    bench_machine_print(&run->report.machine);
    for (int s = 0; s < BENCH_SIZES; s++)
        if (o->size[s] && !run_size(run, bench_sizes[s], err)) return false;
    if (!o->no_fit && o->method[SV_METHOD_SPLINE] && !run_splines(run, err)) return false;
    if (!o->no_truth && !run_truth(run, err)) return false;
    if (!o->no_fit) methods_print_fits(&run->report);
    if (o->csv && !methods_write_csv(&run->report, o->csv, err)) return false;
    if (o->svg && !methods_write_svg(&run->report, o->svg, err)) return false;
    if (o->csv) printf("\nnumbers: %s\n", o->csv);
    if (o->svg) printf("plot:    %s\n", o->svg);
    return true;
}

/* Opens what a run needs, and closes it. */
static bool open_and_measure(bench_run *run, hs_error *err) {
    const options *o = &run->o;
    if (!hs_cl_open(&run->cl, err)) return false;
    bool ok = hs_plugin_open(&run->plugin, o->plugin, o->id, SV_LOG_WARNING, err);
    bench_team *team = ok ? bench_team_create(err) : NULL;
    run->setup = (methods_setup){.plugin = &run->plugin,
                                 .team = team,
                                 .q = (float)default_q,
                                 .frames = o->frames,
                                 .seconds = o->seconds};
    if (ok) {
        ok = team && measure(run, err);
        bench_team_destroy(team);
        hs_plugin_close(&run->plugin);
    }
    free(run->depth);
    free(run->reference);
    hs_cl_close(&run->cl);
    return ok;
}

static bool write_points(const options *o, hs_error *err) {
    int size = 0;
    while (!o->size[size]) size++;
    methods_map map;
    if (!methods_map_bones(&map, bench_sizes[size], err)) return false;
    const bool ok = methods_map_write(&map, o->points, err);
    methods_map_free(&map);
    return ok;
}

int main(int argc, char **argv) {
    hs_error err = {HS_OK, ""};
    bool wants_help = false, ok = false;
    bench_run *run = calloc(1, sizeof *run);
    if (!run) (void)hs_fail(&err, HS_ERR_MEMORY, "no memory for the results");
    methods_variants_complete();
    if (run) ok = parse_options(argc, argv, &run->o, &wants_help, &err);
    if (wants_help) print_help();
    if (ok && !wants_help) ok = run->o.points ? write_points(&run->o, &err) : open_and_measure(run, &err);
    free(run);
    if (ok) return hs_cli_finish("sv_surfaces_bench", HS_OK);
    return bench_fail("sv_surfaces_bench", &err);
}
