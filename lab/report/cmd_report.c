/* SPDX-License-Identifier: MIT */
#include "report/report.h"

#include "commands/look_line.h"
#include "core/cli.h"
#include "core/options.h"
#include "core/paths.h"
#include "core/text.h"
#include "guarded/guard_options.h"
#include "loop/source_options.h"
#include "scene/scene.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* --------------------------------------------------------------------------------------------- options -- */

static bool append_group(const char *option, hs_scene_group group, hs_eval_options *o, hs_error *err) {
    bool ok = true;
    for (uint32_t i = 0; ok && hs_scene_of_group(group, i); i++)
        ok = hs_cli_append(option, hs_scene_of_group(group, i), o->cases, &o->case_count, HS_EVAL_MAX_CASES,
                           err);
    return ok;
}

static bool take_case(void *target, const char *text, hs_error *err) {
    hs_eval_options *const o = target;
    return hs_cli_append("--case", text, o->cases, &o->case_count, HS_EVAL_MAX_CASES, err);
}

static bool take_set(void *target, const char *text, hs_error *err) {
    hs_eval_options *const o = target;
    return hs_cli_append("--set", text, o->sets, &o->set_count, HS_EVAL_MAX_CASES, err);
}

static bool take_compare(void *target, const char *text, hs_error *err) {
    hs_eval_options *const o = target;
    return hs_cli_append("--compare", text, o->compare, &o->compare_count, HS_EVAL_MAX_CASES, err);
}

static bool take_hard(void *o, const char *text, hs_error *err) {
    (void)text;
    return append_group("--hard", HS_SCENES_HARD, o, err);
}

static bool take_real(void *target, const char *text, hs_error *err) {
    hs_eval_options *const o = target;
    o->real = text;
    return hs_cli_append("--real", "real", o->cases, &o->case_count, HS_EVAL_MAX_CASES, err);
}

static bool take_quick(void *target, const char *text, hs_error *err) {
    hs_eval_options *const o = target;
    (void)text;
    (void)err;
    o->coarse = true;
    o->size = 96;
    o->frames = 3;
    return true;
}

#define AT(field) offsetof(hs_eval_options, field)
static const hs_option options[] = {
    HS_TEXT("out", "DIR", AT(out), "folder for everything [out/report]"),
    HS_TAKEN("case", "NAME", 0, take_case,
             "a built-in scene, a scene file, or files FULL,TRUTH,LABEL[,FIRST,END][,REFERENCE];\n"
             "FIRST and END are every ray's first scanned slice and the first one behind the scan;\n"
             "REFERENCE is the volume as an expert edited it, drawn beside the truth;\n"
             "repeatable [E01 .. E04, M01 .. M03, D01, D02]"),
    HS_TAKEN("hard", NULL, 0, take_hard,
             "the hard cases, H01 and on (docs/scenes.md); with --case those, too"),
    HS_TAKEN("real", "FILE", 0, take_real,
             "the scene 'real' as a case: synthetic occluders before the volume in FILE"),
    HS_IN(COUNT, "size", "N", AT(size), 32, 512, "voxels per axis of the scenes, 32 .. 512 [384]"),
    HS_SOURCE_ROWS(AT(read)),
    HS_IN(COUNT, "lowres", "N", AT(lowres), 1, 512,
          "pixels per axis of the depthmap [as in run: 128 of 384]"),
    HS_IN(WHOLE, "seed", "N", AT(seed), 0, 0, "seed of the scenes; 0 is their own [0]"),
    HS_TEXT("plugin", "PATH", AT(plugin), "library to measure, a path or a name [smartvis]"),
    HS_TAKEN("set", "KEY=VALUE", 0, take_set,
             "a plugin parameter; repeatable; see 'host_sim list'; a plugin that has the mean\n"
             "filter is studied with method=mean, as in the thesis, unless this names another"),
    HS_FLAG("coarse", AT(coarse), "every fifth position on every axis of the parameter space"),
    HS_TAKEN("quick", NULL, 0, take_quick,
             "small scenes (96), --coarse, few frames: to see what the page looks like"),
    HS_IN(COUNT, "frames", "N", AT(frames), 0, 10000,
          "frames of a measurement of speed; 0 measures none [20]"),
    HS_TAKEN("look", "NAME", AT(look), hs_look_line_look,
             "how pictures are drawn: thesis or lit [lit]; measures always use thesis"),
    HS_TAKEN("light", "AZ,EL", AT(light), hs_look_line_light,
             "where the lamp of the lit look is, degrees from the viewer: right, up [-35,40]"),
    HS_OPTIONS_GROUP("Comparison, instead of the parameter space:"),
    HS_TAKEN("compare", "'PATH [KEY=VALUE]...'", 0, take_compare,
             "a plugin with its settings; repeatable; '-' is the default plugin"),
    HS_IN(COUNT, "seeds", "N", AT(seeds), 1, 100,
          "seeds of every scene, for the spread of the differences [3]"),
    HS_GUARD_ROWS(AT(guard)),
    HS_OPTIONS_END,
};

bool hs_report_line_parse(int argc, char **argv, hs_eval_options *o, bool *help, hs_error *err) {
    *o = (hs_eval_options){.out = "out/report", .size = 384, .frames = 20};
    hs_guard_defaults(&o->guard);
    hs_dvr_settings drawing;
    hs_dvr_defaults(&drawing);
    o->look = HS_LOOK_LIT;
    memcpy(o->light, drawing.light, sizeof o->light);
    int next = argc;
    if (!hs_options_read(argc, argv, options, o, &next, help, err)) return false;
    if (*help) return true;
    if (o->seeds > 0 && o->compare_count == 0)
        return hs_fail(err, HS_ERR_USAGE, "--seeds %u: is for --compare", o->seeds);
    if (o->seeds == 0) o->seeds = 3;
    if (o->case_count == 0 && !append_group("the cases", HS_SCENES_THESIS, o, err)) return false;
    return hs_cli_no_more(argc, argv, next, err);
}

static const char usage[] =
    "Usage: host_sim report [options]\n"
    "Measures a plugin over the nine cases and its whole parameter space (thesis, chapter 5), and writes\n"
    "CSV files, pictures and one page, index.html.\n\n";

/* --------------------------------------------------------------------------------------------- command -- */

/* ------------------------------------------------------------------------------ the parameter space -- */

/* The space of an open case, and its file. */
static bool fill_space(hs_eval_study *study, uint32_t index, hs_eval_case *c, hs_error *err) {
    const hs_eval_options *o = study->options;
    hs_eval_space *space = &study->space[index];
    hs_progress progress;
    hs_progress_begin(&progress, space->name, space->items);
    const bool ok = hs_eval_space_run(space, c, &progress, err);
    hs_progress_end(&progress);
    return ok && hs_eval_csv_write(space, o->out, err);
}

/* The spaces of all cases, with a line on stderr per case. */
static bool run_cases(hs_eval_study *study, hs_error *err) {
    const uint32_t cases = study->options->case_count;
    const double start = hs_now();
    for (uint32_t i = 0; i < cases; i++) {
        hs_eval_case c;
        if (!hs_eval_study_begin(study, i, &c, err)) return false;
        const bool ok = fill_space(study, i, &c, err) && hs_eval_study_finish(study, i, &c, err);
        hs_eval_case_close(&c);
        if (!ok) return false;
        const double so_far = hs_now() - start;
        const hs_eval_space *space = &study->space[i];
        (void)fprintf(stderr,
                      "host_sim report: %s: %u settings x %u (%u of %u cases, %.0f s, about %.0f s left)\n",
                      space->name, space->items, study->plan.knob.count, i + 1, cases, so_far,
                      so_far / (i + 1) * (cases - i - 1));
    }
    return true;
}

static bool finish(hs_eval_study *study, hs_error *err) {
    if (!hs_eval_study_conclude(study, err) || !hs_eval_study_tables(study, err)) return false;
    hs_eval_study_print(study, stdout);
    (void)fflush(stdout);
    for (uint32_t i = 0; i < study->count; i++) {
        hs_print(stderr, "host_sim report: pictures of %s ...\n", study->space[i].name);
        if (!hs_eval_study_pictures(study, i, err)) return false;
    }
    if (!hs_eval_study_page(study, err)) return false;
    hs_print(stdout, "Results are in %s, the page is %s/index.html\n", study->options->out,
             study->options->out);
    return true;
}

static bool run_study(const hs_eval_options *o, hs_error *err) {
    hs_eval_study *study = calloc(1, sizeof *study);
    if (!study) return hs_fail(err, HS_ERR_MEMORY, "no memory");
    bool ok = hs_eval_study_open(study, o, err);
    if (ok) {
        ok = run_cases(study, err);
        ok = ok && finish(study, err);
        if (ok && study->plugin_error.code != HS_OK)
            ok = hs_fail(err, study->plugin_error.code, "%s", study->plugin_error.text);
        ok = hs_eval_study_close(study, err) && ok;
    }
    free(study);
    return ok;
}

/* ------------------------------------------------------------------------------------- the comparison -- */

/* Every case at every seed; the pictures are those of the first. */
static bool compare_case(hs_eval_comparison *x, uint32_t index, hs_error *err) {
    for (uint32_t seed = 0; seed < x->seeds; seed++) {
        hs_eval_case c;
        if (!hs_eval_compare_measure(x, index, seed, &c, err)) return false;
        const bool ok = seed > 0 || hs_eval_compare_pictures(x, index, &c, err);
        hs_eval_case_close(&c);
        if (!ok) return false;
    }
    hs_print(stderr, "host_sim report: %s: %u methods, %u seeds\n", x->name[index], x->count, x->seeds);
    return true;
}

static bool compare(hs_eval_comparison *x, hs_error *err) {
    const char *out = x->options->out;
    for (uint32_t i = 0; i < x->options->case_count; i++)
        if (!compare_case(x, i, err)) return false;
    hs_eval_compare_rank(x);
    hs_eval_compare_print(x, stdout);
    if (!hs_eval_compare_table(x, err) || !hs_eval_compare_page(x, err)) return false;
    hs_print(stdout, "Results are in %s, the page is %s/index.html\n", out, out);
    return true;
}

static bool run_comparison(const hs_eval_options *o, hs_error *err) {
    hs_eval_comparison *x = calloc(1, sizeof *x);
    if (!x) return hs_fail(err, HS_ERR_MEMORY, "comparison: no memory");
    bool ok = hs_eval_compare_open(x, o, err);
    if (ok) {
        ok = compare(x, err);
        ok = hs_eval_compare_close(x, err) && ok;
    }
    free(x);
    return ok;
}

int hs_cmd_report(int argc, char **argv) {
    hs_eval_options o;
    hs_error err = {0};
    bool help;
    if (!hs_report_line_parse(argc, argv, &o, &help, &err)) return hs_cli_fail("report", &err);
    if (help) return hs_options_help(usage, options, "");
    const bool ok = hs_path_make_folder(o.out, &err) &&
                    (o.compare_count ? run_comparison(&o, &err) : run_study(&o, &err));
    return ok ? HS_OK : hs_cli_fail("report", &err);
}
