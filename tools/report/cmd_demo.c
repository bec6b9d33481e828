/* SPDX-License-Identifier: MIT */
/* host_sim demo: the scan loop on a few scenes and real volumes, and one page that shows what came of it. */
#include "report/report.h"

#include "base/cli.h"
#include "base/options.h"
#include "base/paths.h"
#include "base/text.h"
#include "commands/look_line.h"
#include "commands/run_print.h"
#include "guarded/guard_options.h"
#include "loop/clipper.h"
#include "plugin/loader_param.h"
#include "show/loop_pictures.h"

#include <dirent.h>
#include <limits.h>
#include <stdlib.h>
#include <string.h>

#define MAX_CASES   12
#define MAX_REAL    4
#define COLUMNS     8    /* of the table at the end of the page */
#define CELL        48   /* bytes of a cell */
#define ORBIT_TOTAL 60.0 /* degrees */

/* One source of the demo. */
typedef struct {
    const char *scene;         /* a scene's name, or NULL: ... */
    char file[PATH_MAX];       /* ... a volume's path */
    char folder[NAME_MAX + 1]; /* of its pictures, inside the demo's */
} demo_case;

typedef struct {
    const char *out, *data, *plugin;
    bool quick, help;
    uint32_t picture;        /* its sides; 0: the default */
    hs_loop_options drawing; /* its renderer's look and lamp are the demo's */
    hs_guard_options guard;
    demo_case cases[MAX_CASES];
    uint32_t case_count;
    hs_page report;
    char rows[MAX_CASES][COLUMNS][CELL]; /* the table at the end of the page */
    uint32_t row_count;
    hs_error plugin_error; /* the first one */
} demo;

static void add_scenes(demo *d) {
    static const char *const names[] = {"D01", "E01", "D02"};
    for (size_t i = 0; i < sizeof names / sizeof names[0]; i++) {
        demo_case *c = &d->cases[d->case_count++];
        *c = (demo_case){.scene = names[i]};
        (void)snprintf(c->folder, sizeof c->folder, "%s", names[i]);
    }
}

static int is_volume(const struct dirent *entry) {
    const char *dot = strrchr(entry->d_name, '.');
    return (dot && (strcmp(dot, ".mha") == 0 || strcmp(dot, ".mhd") == 0)) || hs_kretz_is_name(entry->d_name);
}

/* The same volume once more, behind the occluders of the scene "real". */
static void add_hidden(demo *d, demo_case plain) {
    demo_case *c = &d->cases[d->case_count++];
    *c = plain;
    c->scene = "real";
    (void)snprintf(c->folder, sizeof c->folder, "hidden_%.200s", plain.folder);
}

/* The volumes of --data, by name. */
static bool add_volumes(demo *d, hs_error *err) {
    struct dirent **entries = NULL;
    if (!d->data) return true;
    const int count = scandir(d->data, &entries, is_volume, alphasort);
    if (count < 0) return hs_fail(err, HS_ERR_INPUT, "%s: cannot list the folder", d->data);
    bool ok = true;
    for (int i = 0; i < count; i++) {
        if (ok && i < MAX_REAL) {
            demo_case *c = &d->cases[d->case_count++];
            (void)snprintf(c->folder, sizeof c->folder, "%s", entries[i]->d_name);
            for (char *dot = c->folder; (dot = strchr(dot, '.')) != NULL;) *dot = '_';
            ok = hs_path_join(d->data, entries[i]->d_name, c->file, sizeof c->file, err);
            if (ok) add_hidden(d, *c);
        }
        free(entries[i]);
    }
    free(entries);
    return ok;
}

/* A picture of the case on the page, if it was made (a real volume has no ground truth). */
static void show(demo *d, const char *folder, const char *name, const char *alt, const char *caption) {
    char path[PATH_MAX];
    if (!hs_path_join(folder, name, path, sizeof path, &d->report.error)) return;
    /* Renderings, and what is drawn over one, are photos; a map in false colour is small as it is. */
    (strcmp(name, "depthmap.png") == 0 ? hs_page_picture : hs_page_photo)(&d->report, path, alt, caption);
}

static void show_pictures(demo *d, const hs_run *run, const char *folder, bool clipped) {
    hs_page_row_begin(&d->report);
    show(d, folder, "full.png", "Rendering of the full volume", "Full volume: what the probe delivers");
    show(d, folder, "result.png",
         clipped ? "Rendering that starts at the clipping depthmap" : "Rendering, not clipped",
         clipped ? "Result: rays start at the plugin's clipping surface; grey is tissue that it cuts"
                 : "Result: nothing hides the fetus here, as far as fluid tells; not clipped");
    if (hs_source_truth(&run->source, 0))
        show(d, folder, "truth.png", "Rendering of the ground truth",
             "Ground truth: the scene without what hides the fetus");
    hs_page_row_end(&d->report);
    hs_page_row_begin(&d->report);
    show(d, folder, "depthmap.png", "The clipping depthmap in false colour",
         "Clipping depthmap: where the rays start, in mm; hatched clips nothing");
    show(d, folder, "points.png", "Initial points over the maximum intensity projection",
         "Initial points over the maximum intensity projection");
    hs_page_row_end(&d->report);
    hs_page_row_begin(&d->report);
    show(d, folder, "slices.png", "The result beside three slices with the clipping surface",
         "The result beside three slices: the yellow line is the clipping surface, what lies before it is "
         "dimmed");
    hs_page_row_end(&d->report);
    hs_page_row_begin(&d->report);
    sv_param_info knob;
    if (run->has_plugin && hs_plugin_find_primary(&run->plugin, &knob))
        show(d, folder, "knob.png", "The result for six positions of the knob",
             "The knob: the result for six positions of the plugin's primary parameter");
    hs_page_row_end(&d->report);
    hs_page_row_begin(&d->report);
    show(d, folder, "orbit.png", "Six views of an orbit, the full volume above and the result below",
         "Six views of an orbit: full volume above, result below");
    hs_page_row_end(&d->report);
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

/* As much of the text as a cell holds. */
static void put_cell(char *cell, const char *text) {
    const size_t length = strnlen(text, CELL - 1);
    memcpy(cell, text, length);
    cell[length] = '\0';
}

/* The case's row in the table at the end of the page. */
static void keep_row(demo *d, const demo_case *c, const hs_run *run) {
    const hs_loop_result *r = &run->results[HS_SETTING_SMARTVIS];
    char(*row)[CELL] = d->rows[d->row_count++];
    put_cell(row[0], c->folder);
    for (int s = 0; s < HS_SETTING_COUNT; s++)
        (void)snprintf(row[1 + s], CELL, "%.1f", run->results[s].volumes_per_second);
    (void)snprintf(row[4], CELL, "%.2f", r->stage[HS_STAGE_PLUGIN].median);
    (void)snprintf(row[5], CELL, "%.1f %%", 100 * r->plugin_share);
    (void)snprintf(row[6], CELL, "%.1f %%", r->stats.rays ? 100.0 * r->stats.points / r->stats.rays : 0.0);
    put_cell(row[7], hs_status_name(r->outcome));
}

/* The scene's own sentence; files have none. */
static const char *what_it_is(const hs_run *run) {
    return run->source.title[0]
               ? run->source.title
               : "A volume from a file, without a ground truth. Where no fluid lies before a structure "
                 "there is nothing to remove, and a good result cuts nothing away there.";
}

/* Measures, draws, then turns the camera for the strip of views. */
static bool run_opened(demo *d, const demo_case *c, hs_run *run, const char *folder, hs_error *err) {
    if (!hs_run_measure(run, err) || !hs_run_pictures(run, folder, err)) return false;
    hs_run_print(run, stdout);
    (void)printf("\n");
    (void)fflush(stdout);
    keep_row(d, c, run);
    char *numbers = printed(run);
    hs_loop_options orbit = run->request.loop;
    orbit.frames = HS_ORBIT_VIEWS;
    orbit.orbit = ORBIT_TOTAL;
    const bool ok = hs_run_replace_loop(run, &orbit, err) && hs_run_orbit_picture(run, folder, err);
    if (ok) {
        hs_page_heading(&d->report, 2, hs_source_shape(&run->source)->name);
        hs_page_text(&d->report, what_it_is(run));
        show_pictures(d, run, folder, hs_outcome_clips(run->results[HS_SETTING_SMARTVIS].outcome));
        hs_page_folded(&d->report, "Times and statistics", numbers ? numbers : "");
    }
    free(numbers);
    return ok;
}

static bool run_case(demo *d, const demo_case *c, hs_error *err) {
    char folder[PATH_MAX];
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
    hs_print(stderr, "host_sim demo: %s ...\n", c->folder);
    if (!hs_path_join(d->out, c->folder, folder, sizeof folder, err) || !hs_path_make_folder(folder, err))
        return false;
    if (!hs_run_open(&run, &request, err)) return false;
    const bool ok = run_opened(d, c, &run, folder, err);
    const hs_error *failure = hs_run_plugin_error(&run);
    if (failure->code != HS_OK) {
        hs_print(stderr, "host_sim demo: %s\nhost_sim demo: rendering unclipped\n", failure->text);
        (void)hs_fail(&d->plugin_error, failure->code, "%s", failure->text);
    }
    (void)hs_run_close(&run, &d->plugin_error); /* the first failure counts */
    return ok;
}

static void write_intro(demo *d) {
    hs_page_text(&d->report,
                 "In 3D ultrasound tissue, cord and particles often hide the fetus. For every viewing ray "
                 "the plugin finds a depth in the amniotic fluid between them and the fetus; the renderer "
                 "starts its rays there. Each case below shows the full volume, the result, and for "
                 "synthetic scenes the ground truth.");
}

static void write_table(demo *d) {
    static const char *const names[COLUMNS] = {"Case",           "DVR [1/s]",   "+ scan conversion [1/s]",
                                               "+ plugin [1/s]", "plugin [ms]", "plugin's share",
                                               "initial points", "outcome"};
    hs_page_heading(&d->report, 2, "Speed");
    hs_page_text(
        &d->report,
        "Volumes a second from the median of the whole loop, in the three settings of the thesis' Figure "
        "5.21: DVR alone and DVR with scan conversion render the full volume, unclipped; with the plugin the "
        "rays start at its depthmap. The plugin's share is that of a whole frame.");
    hs_page_table_begin(&d->report);
    hs_page_table_row(&d->report, names, COLUMNS);
    for (uint32_t i = 0; i < d->row_count; i++) {
        const char *cells[COLUMNS];
        for (uint32_t c = 0; c < COLUMNS; c++) cells[c] = d->rows[i][c];
        hs_page_table_row(&d->report, cells, COLUMNS);
    }
    hs_page_table_end(&d->report);
}

static bool run_demo(demo *d, hs_error *err) {
    char page[PATH_MAX];
    if (!hs_path_make_folder(d->out, err) || !hs_path_join(d->out, "index.html", page, sizeof page, err))
        return false;
    add_scenes(d);
    if (!add_volumes(d, err)) return false;
    hs_page_open(&d->report, page, "SmartVis: the scan loop");
    write_intro(d);
    hs_print(stderr,
             "host_sim demo: OpenCL compiles its kernels for this machine; the first time that can take a "
             "minute, later they come from a cache ...\n");
    bool ok = true;
    for (uint32_t i = 0; ok && i < d->case_count; i++) ok = run_case(d, &d->cases[i], err);
    write_table(d);
    if (d->plugin_error.code != HS_OK) hs_page_text(&d->report, d->plugin_error.text);
    /* A page that misses a case would look complete. */
    if (!ok) (void)hs_fail(&d->report.error, err->code, "%s", err->text);
    if (!hs_page_close(&d->report, ok ? err : &d->report.error) || !ok) return false;
    hs_print(stdout, "Pictures are in %s, the page is %s\n", d->out, page);
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
    {"out", "DIR", "folder for the pictures and the page [out/demo]\n", HS_OPTION_TEXT, AT(out), 0, 0, NULL},
    {"data", "DIR", "also runs the volumes of this folder (.mha, .mhd, .vol), four at most\n", HS_OPTION_TEXT,
     AT(data), 0, 0, NULL},
    {"plugin", "PATH", "library to load, a path or a name [smartvis]\n", HS_OPTION_TEXT, AT(plugin), 0, 0,
     NULL},
    {"quick", NULL, "smaller scenes and fewer frames\n", HS_OPTION_FLAG, AT(quick), 0, 0, NULL},
    {"picture", "N", "every picture is N x N pixels, 64 .. 1024 [512]\n", HS_OPTION_COUNT, AT(picture), 64,
     1024, NULL},
    {"look", "NAME", "how pictures are drawn: thesis or lit [lit]\n", HS_OPTION_TAKEN, AT(drawing), 0, 0,
     take_look},
    {"light", "AZ,EL", "where the lamp of the lit look is, degrees: right, up [-35,40]\n", HS_OPTION_TAKEN,
     AT(drawing.dvr.light), 0, 0, hs_look_line_light},
    HS_GUARD_ROWS(AT(guard)),
    {NULL, NULL, NULL, HS_OPTION_FLAG, 0, 0, 0, NULL},
};

static bool parse(int argc, char **argv, demo *d, hs_error *err) {
    int next = argc;
    hs_loop_defaults(&d->drawing);
    hs_loop_for_pictures(&d->drawing, HS_LOOK_LIT);
    return hs_options_read(argc, argv, options, d, &next, &d->help, err) &&
           (d->help || hs_cli_no_more(argc, argv, next, err));
}

static void print_help(void) {
    (void)printf("Usage: host_sim demo [options]\n"
                 "Runs the scan loop in its three settings on a few scenes, and writes pictures and one "
                 "page, index.html.\n"
                 "\n");
    hs_options_print(options);
    (void)printf("\n%s", hs_exit_codes_help);
}

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
        print_help();
    else if (!run_demo(d, &err))
        code = hs_cli_fail("demo", &err);
    else
        code = (int)d->plugin_error.code;
    free(d);
    return code;
}
