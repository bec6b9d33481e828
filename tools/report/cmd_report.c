/* SPDX-License-Identifier: MIT */
#include "report/cmd_report.h"

#include "base/cli.h"
#include "base/paths.h"
#include "base/text.h"
#include "eval/eval_compare.h"
#include "eval/eval_study.h"
#include "report/report_line.h"
#include "report/report_page.h"
#include "report/report_page_compare.h"
#include "report/report_pictures.h"
#include "report/report_pictures_compare.h"
#include "report/report_rows.h"
#include "report/report_rows_compare.h"
#include "report/space_csv.h"

#include <stdio.h>
#include <stdlib.h>

#define CHECK_TOLERANCE 1e-3 /* steps */

/* ------------------------------------------------------------------------------ the parameter space -- */

/* --merge computes nothing, so all results must be there. */
static bool load_whole(hs_eval_space *space, const char *folder, hs_error *err) {
    if (!hs_eval_csv_load(space, folder, err)) return false;
    return space->done_count == space->items ||
           hs_fail(err, HS_ERR_INPUT, "%s: %u of %u settings of %s are there: a shard is missing", folder,
                   space->done_count, space->items, space->name);
}

/* The space of an open case, from the folder's files and what they lack. */
static bool fill_space(hs_eval_study *study, uint32_t index, hs_eval_case *c, hs_error *err) {
    const hs_eval_options *o = study->options;
    hs_eval_space *space = &study->space[index];
    hs_progress progress;
    if (o->merge && !load_whole(space, o->out, err)) return false;
    hs_progress_begin(&progress, space->name, space->items);
    const bool ok = hs_eval_csv_run(space, c, o->out, o->shard, &progress, err);
    hs_progress_end(&progress);
    return ok;
}

/* The spaces of all cases (of this shard), with a line on stderr per case. */
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
        (void)fprintf(
            stderr,
            "host_sim report: %s: %u of %u settings x %u (%u of %u cases, %.0f s, about %.0f s left)\n",
            space->name, space->done_count, space->items, study->plan.knob.count, i + 1, cases, so_far,
            so_far / (i + 1) * (cases - i - 1));
    }
    return true;
}

static void print_check(const hs_eval_study *study) {
    (void)printf("%u settings measured the direct way, too: e_abs, e_pos and e_neg differ by %.6f, %.6f and "
                 "%.6f steps at most\n",
                 study->checked, study->check_worst[0], study->check_worst[1], study->check_worst[2]);
}

static bool check_held(const hs_eval_study *study, hs_error *err) {
    for (int m = 0; m < 3; m++)
        if (!(study->check_worst[m] <= CHECK_TOLERANCE))
            return hs_fail(err, HS_ERR_FAILED,
                           "the direct way gives another %s: off by %g steps, allowed are %g",
                           hs_measure_key((hs_measure)m), study->check_worst[m], CHECK_TOLERANCE);
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
        if (ok && o->check) {
            print_check(study);
            ok = check_held(study, err);
        }
        if (ok && hs_eval_study_whole(study))
            ok = finish(study, err);
        else if (ok)
            hs_print(stdout,
                     "Results of shard %u of %u are in %s; when all are there, 'host_sim report --merge' "
                     "with the same options makes the page\n",
                     o->shard.index + 1, o->shard.count, o->out);
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
    if (help) {
        hs_report_line_help();
        return HS_OK;
    }
    const bool ok = hs_path_make_folder(o.out, &err) &&
                    (o.compare_count ? run_comparison(&o, &err) : run_study(&o, &err));
    return ok ? HS_OK : hs_cli_fail("report", &err);
}
