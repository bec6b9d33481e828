/* SPDX-License-Identifier: MIT */
/* host_sim demo: the scan loop on a few scenes and real volumes, and one page that shows what came of it. */
#include "report/report.h"

#include "commands/look_line.h"
#include "commands/run.h"
#include "core/cli.h"
#include "core/options.h"
#include "core/paths.h"
#include "core/progress.h"
#include "core/system.h"
#include "core/text.h"
#include "guarded/guard_options.h"
#include "loop/clipper.h"
#include "loop/view.h"
#include "show/loop_pictures.h"

#include <ctype.h>
#include <dirent.h>
#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#define MAX_REAL 4

typedef struct {
    const char *out, *data, *plugin;
    bool quick, help;
    uint32_t picture;        /* its sides; 0: the default */
    hs_loop_options drawing; /* its renderer's look and lamp are the demo's */
    hs_guard_options guard;
    hs_demo_case cases[HS_DEMO_CASES];
    uint32_t case_count;
    FILE *log;             /* OUT/log.txt: the tables of times */
    hs_error plugin_error; /* the first one */
} demo;

static void add_scenes(demo *d) {
    static const char *const scenes[][2] = {{"example", "A whole fetus of twelve weeks, of our own making"},
                                            {"D01", "A wide gap of fluid"},
                                            {"E01", "Placenta at the arm, forehead near the wall"},
                                            {"E02", "Cord before the face"}};
    for (size_t i = 0; i < sizeof scenes / sizeof *scenes; i++) {
        hs_demo_case *c = &d->cases[d->case_count++];
        c->scene = scenes[i][0];
        (void)snprintf(c->folder, sizeof c->folder, "%s", c->scene);
        (void)snprintf(c->name, sizeof c->name, "%s", scenes[i][1]);
    }
}

static int is_volume(const struct dirent *entry) {
    const char *dot = strrchr(entry->d_name, '.');
    return (dot && (strcmp(dot, ".mha") == 0 || strcmp(dot, ".mhd") == 0)) || hs_kretz_is_name(entry->d_name);
}

/* The real fetus in fluid, if --data has it. */
static bool add_fetus(demo *d, hs_error *err) {
    char file[SYS_PATH];
    if (!d->data) return true;
    if (!hs_path_join(d->data, "real/fetus_12w.mha", file, sizeof file, err)) return false;
    if (access(file, R_OK) != 0) return true;
    hs_demo_case *c = &d->cases[d->case_count++];
    c->real = true;
    (void)snprintf(c->file, sizeof c->file, "%s", file);
    (void)snprintf(c->folder, sizeof c->folder, "fetus_12w_mha");
    (void)snprintf(c->name, sizeof c->name, "A real fetus of twelve weeks");
    return true;
}

/* The same volume once more, behind the occluders of the scene "real". */
static void add_hidden(demo *d, hs_demo_case plain) {
    hs_demo_case *c = &d->cases[d->case_count++];
    *c = plain;
    c->scene = "real";
    (void)snprintf(c->folder, sizeof c->folder, "hidden_%.200s", plain.folder);
    (void)snprintf(c->name, sizeof c->name, "%.60s, behind a synthetic placenta", plain.name);
}

/* A volume of --data: "fetal_head_21w.mha" is "Fetal head 21w". */
static bool add_volume(demo *d, const char *name, hs_error *err) {
    hs_demo_case *c = &d->cases[d->case_count++];
    const char *dot = strrchr(name, '.');
    (void)snprintf(c->folder, sizeof c->folder, "%s", name);
    (void)snprintf(c->name, sizeof c->name, "%.*s", dot ? (int)(dot - name) : 70, name);
    for (char *p = c->folder; (p = strchr(p, '.')) != NULL;) *p = '_';
    for (char *p = c->name; (p = strchr(p, '_')) != NULL;) *p = ' ';
    c->name[0] = (char)toupper((unsigned char)c->name[0]);
    if (!hs_path_join(d->data, name, c->file, sizeof c->file, err)) return false;
    add_hidden(d, *c);
    return true;
}

/* The volumes of --data, by name. */
static bool add_volumes(demo *d, hs_error *err) {
    struct dirent **entries = NULL;
    if (!d->data) return true;
    const int count = scandir(d->data, &entries, is_volume, alphasort);
    if (count < 0) return hs_fail(err, HS_ERR_INPUT, "%s: cannot list the folder", d->data);
    bool ok = true;
    for (int i = 0; i < count; i++) {
        if (ok && i < MAX_REAL) ok = add_volume(d, entries[i]->d_name, err);
        free(entries[i]);
    }
    free(entries);
    return ok;
}

/* The run's table as printed; NULL if memory runs out. */
static char *printed(const hs_run *run) {
    char *text = NULL;
    size_t bytes = 0;
    FILE *stream = open_memstream(&text, &bytes);
    if (!stream) return NULL;
    hs_run_print(run, stream);
    (void)fclose(stream);
    return text;
}

/* Whose volume it is, and what lies before it. */
static const char *about(const hs_demo_case *c, const hs_run *run) {
    if (c->file[0] && c->scene)
        return "The same volume, moved back, behind a synthetic wall of placenta with a fold, a cord and a "
               "cloud of particles. The volume itself is the ground truth.";
    if (c->file[0])
        return "A volume from a file, without a ground truth. Where no fluid lies before a structure there "
               "is nothing to remove, and a good result cuts nothing away there.";
    return run->source.title;
}

/* What the page says of the case in figures and words, but for its measures. */
static void keep_results(hs_demo_case *c, const hs_run *run) {
    const hs_loop_result *r = &run->results[HS_SETTING_SMARTVIS];
    const hs_frame frame = {
        .clipped = hs_outcome_clips(r->outcome), .doubt = r->doubt, .outcome = r->outcome, .stats = r->stats};
    c->clipped = frame.clipped;
    c->plugin_ms = r->stage[HS_STAGE_PLUGIN].median;
    if (!hs_frame_note(&frame, hs_run_plugin_error(run)->text, c->note, sizeof c->note)) c->note[0] = '\0';
    for (int s = 0; s < HS_SETTING_COUNT; s++)
        (void)snprintf(c->row[1 + s], HS_DEMO_CELL, "%.1f", run->results[s].volumes_per_second);
    (void)snprintf(c->row[4], HS_DEMO_CELL, "%.2f", c->plugin_ms);
    (void)snprintf(c->row[5], HS_DEMO_CELL, "%.1f %%", 100 * r->plugin_share);
    if (r->stats.points > 0)
        (void)snprintf(c->row[6], HS_DEMO_CELL, "%.1f %%", 100.0 * r->stats.points / r->stats.rays);
    (void)snprintf(c->row[7], HS_DEMO_CELL, "%s",
                   c->clipped            ? "clipped"
                   : r->outcome >= SV_OK ? "nothing removed"
                                         : hs_status_name(r->outcome));
    (void)snprintf(c->what, sizeof c->what, "%.290s", about(c, run));
    c->truth_cut = hs_truth_shows_cut(run->loop, run->request.loop.dvr.look, 0);
    c->printed = printed(run);
}

/* Measures frame 0 of a loop whose picture is as large as its map. */
static bool measure_map(hs_demo_case *c, hs_run *run, uint32_t side, hs_error *err) {
    hs_eval_table table = {0};
    hs_measures measures;
    hs_frame frame;
    float *map = calloc((size_t)side * side, sizeof *map);
    if (!map) return hs_fail(err, HS_ERR_MEMORY, "demo: no memory for a map");
    const bool ok = hs_eval_table_build(&table, run->loop, hs_source_volume(&run->source, 0),
                                        hs_source_truth(&run->source, 0),
                                        hs_source_scene_data(&run->source, 0)->label, err) &&
                    hs_loop_convert(run->loop, 0, err) && hs_loop_clip(run->loop, 0, &frame, map, err);
    if (ok) {
        hs_eval_measure_map(&table, map, &measures);
        c->cut = (double)measures.of[HS_MEASURE_FETUS_CUT];
        c->left = (double)measures.of[HS_MEASURE_OCCLUDER_LEFT];
        c->has_truth = true;
    }
    hs_eval_table_free(&table);
    free(map);
    return ok;
}

/* By the measures of the report, where the ground truth is known. The run's loop is another one then. */
static bool measure(hs_demo_case *c, hs_run *run, hs_error *err) {
    const uint32_t side = hs_loop_layout(run->loop)->width;
    hs_loop_options options;
    c->cut = c->left = (double)NAN;
    if (!hs_source_scene_data(&run->source, 0)) return true;
    hs_loop_defaults(&options);
    options.frames = 1;
    options.lowres = options.dvr.width = options.dvr.height = side;
    options.values = run->request.loop.values;
    options.value_count = run->request.loop.value_count;
    return hs_run_replace_loop(run, &options, err) && measure_map(c, run, side, err);
}

/* Takes times, draws, measures. */
static bool run_opened(hs_demo_case *c, hs_run *run, const char *folder, hs_error *err) {
    if (!hs_run_measure(run, err) || !hs_run_pictures(run, folder, err)) return false;
    keep_results(c, run);
    return measure(c, run, err);
}

/* A line a case, when it is through; its tables go to the log. */
static void tell(const demo *d, const hs_demo_case *c, double seconds) {
    char found[80] = "";
    if (c->has_truth && c->clipped)
        (void)snprintf(found, sizeof found, ", cut %.1f %%, left %.1f %%", 100 * c->cut, 100 * c->left);
    hs_print(stdout, "demo %u of %u: %s: %s%s, %.1f ms in the plugin (%.0f s)\n",
             (unsigned)(c - d->cases) + 1, d->case_count, c->name, c->row[7], found, c->plugin_ms, seconds);
    (void)fflush(stdout);
    (void)fprintf(d->log, "%s\n%s\n", c->name, c->printed ? c->printed : "");
}

static bool run_case(demo *d, hs_demo_case *c, hs_error *err) {
    const double start = hs_now();
    char folder[SYS_PATH];
    const char *const volumes[1] = {c->file};
    hs_run_request request;
    hs_run run;
    hs_run_defaults(&request);
    request.loop.dvr = d->drawing.dvr;
    request.plugin_path = d->plugin;
    request.guard = d->guard;
    request.scene.name = c->scene;
    request.scene.real = c->scene && c->file[0] ? c->file : NULL;
    request.scene.size = d->quick ? 128 : 256;
    request.volumes = volumes;
    request.volume_count = c->scene ? 0 : 1;
    request.loop.frames = d->quick ? 10 : 30;
    if (d->picture) request.loop.dvr.width = request.loop.dvr.height = request.panel_cell = d->picture;
    if (!hs_path_join(d->out, c->folder, folder, sizeof folder, err) || !hs_path_make_folder(folder, err))
        return false;
    if (!hs_run_open(&run, &request, err)) return false;
    const bool ok = run_opened(c, &run, folder, err);
    const hs_error *failure = hs_run_plugin_error(&run);
    if (failure->code != HS_OK) {
        hs_print(stderr, "host_sim demo: %s\nhost_sim demo: rendering unclipped\n", failure->text);
        (void)hs_fail(&d->plugin_error, failure->code, "%s", failure->text);
    }
    (void)hs_run_close(&run, &d->plugin_error); /* the first failure counts */
    if (ok) tell(d, c, hs_now() - start);
    return ok;
}

static bool run_demo(demo *d, hs_error *err) {
    char path[SYS_PATH], log[SYS_PATH];
    hs_page page;
    if (!hs_path_make_folder(d->out, err) || !hs_path_join(d->out, "index.html", path, sizeof path, err) ||
        !hs_path_join(d->out, "log.txt", log, sizeof log, err) || !add_fetus(d, err))
        return false;
    add_scenes(d);
    if (!add_volumes(d, err)) return false;
    d->log = fopen(log, "w");
    if (!d->log) return hs_fail(err, HS_ERR_OUTPUT, "%s: %s", log, strerror(errno));
    hs_page_open(&page, path, "SmartVis: what hides the fetus is removed");
    hs_print(stderr,
             "host_sim demo: OpenCL compiles its kernels for this machine; the first time that can take a "
             "minute, later they come from a cache ...\n");
    bool ok = true;
    for (uint32_t i = 0; ok && i < d->case_count; i++) ok = run_case(d, &d->cases[i], err);
    if (ok) hs_demo_page(&page, d->out, d->cases, d->case_count);
    if (d->plugin_error.code != HS_OK) hs_page_text(&page, d->plugin_error.text);
    /* A page that misses a case would look complete. */
    if (!ok) (void)hs_fail(&page.error, err->code, "%s", err->text);
    const bool logged = fclose(d->log) == 0;
    if (!hs_page_close(&page, ok ? err : &page.error) || !ok) return false;
    if (!logged) return hs_fail(err, HS_ERR_OUTPUT, "%s: cannot be written", log);
    hs_print(stdout, "Times and statistics are in %s\n", log);
    hs_print(stdout, "Pictures are in %s, the page is %s\n", d->out, path);
    return true;
}

static bool take_look(void *drawing, const char *text, hs_error *err) {
    hs_look look;
    if (!hs_look_line_look(&look, text, err)) return false;
    hs_loop_for_pictures(drawing, look);
    return true;
}

#define AT(field) offsetof(demo, field)
static const hs_option options[] = {
    HS_TEXT("out", "DIR", AT(out), "folder for the pictures and the page [out/demo]"),
    HS_TEXT("data", "DIR", AT(data),
            "also runs the volumes of this folder (.mha, .mhd, .vol), four at most, and\n"
            "first real/fetus_12w.mha in it"),
    HS_TEXT("plugin", "PATH", AT(plugin), "library to load, a path or a name [smartvis]"),
    HS_FLAG("quick", AT(quick), "smaller scenes and fewer frames"),
    HS_IN(COUNT, "picture", "N", AT(picture), 64, 1024, "every picture is N x N pixels, 64 .. 1024 [512]"),
    HS_TAKEN("look", "NAME", AT(drawing), take_look, "how pictures are drawn: thesis or lit [lit]"),
    HS_TAKEN("light", "AZ,EL", AT(drawing.dvr.light), hs_look_line_light,
             "where the lamp of the lit look is, degrees: right, up [-35,40]"),
    HS_GUARD_ROWS(AT(guard)),
    HS_OPTIONS_END,
};

static bool parse(int argc, char **argv, demo *d, hs_error *err) {
    int next = argc;
    hs_loop_defaults(&d->drawing);
    hs_loop_for_pictures(&d->drawing, HS_LOOK_LIT);
    return hs_options_read(argc, argv, options, d, &next, &d->help, err) &&
           (d->help || hs_cli_no_more(argc, argv, next, err));
}

static const char usage[] =
    "Usage: host_sim demo [options]\n"
    "Runs the scan loop in its three settings on a few scenes, and writes pictures and one "
    "page, index.html. For research, not a medical device.\n\n";

int hs_cmd_demo(int argc, char **argv) {
    hs_error err = {0};
    demo *d = calloc(1, sizeof *d);
    if (!d) {
        (void)hs_fail(&err, HS_ERR_MEMORY, "no memory");
        return hs_cli_fail("demo", &err);
    }
    d->out = "out/demo";
    hs_guard_defaults(&d->guard);
    int code = HS_OK;
    if (!parse(argc, argv, d, &err))
        code = hs_cli_fail("demo", &err);
    else if (d->help)
        (void)hs_options_help(usage, options, "");
    else if (!run_demo(d, &err))
        code = hs_cli_fail("demo", &err);
    else
        code = (int)d->plugin_error.code;
    for (uint32_t i = 0; i < d->case_count; i++) free(d->cases[i].printed);
    free(d);
    return code;
}
