/* SPDX-License-Identifier: MIT */
/* What the report is made of: its commands, the results on the disk, tables, pictures and pages. */
#pragma once

#include "core/error.h"
#include "core/progress.h"
#include "core/system.h"
#include "eval/eval_case.h"
#include "eval/eval_compare.h"
#include "eval/eval_study.h"
#include "loop/view.h"
#include "page/page_html.h"
#include "picture/picture.h"

#include <stdint.h>
#include <stdio.h>

/* ---------------------------------------------------------------------------------------------- report -- */
/* host_sim report: quality and speed of a plugin over all cases and its parameter space, with a page. */

/* argv[0] is the command's own name. Returns the exit code (hs_code, base/error.h). */
int hs_cmd_report(int argc, char **argv);

/* --------------------------------------------------------------------------------------------- measure -- */
/* host_sim measure: the quality of depthmaps that were made elsewhere. */

int hs_cmd_measure(int argc, char **argv);

/* ------------------------------------------------------------------------------------------------ demo -- */
/* host_sim demo: the scan loop on a few scenes and real volumes, and one page that shows what came of it. */

/* argv[0] is the command's own name. Returns the exit code (hs_code, base/error.h). */
int hs_cmd_demo(int argc, char **argv);

/* --------------------------------------------------------------------------------------------- options -- */
/* The command line of `host_sim report`. */

/* Reads the options, which point into argv. HS_ERR_USAGE names option, value and what is allowed. With
 * --help, *help is true and the rest is not read. */
bool hs_report_line_parse(int argc, char **argv, hs_eval_options *options, bool *help, hs_error *err);

/* --------------------------------------------------------------------------------- results on the disk -- */
/* Writes the results of a parameter space, which is whole, to "space_<case>.csv" in `folder`, one row per
 * setting (docs/evaluation.md lists the columns). HS_ERR_OUTPUT names the file that cannot be written. */
bool hs_eval_csv_write(const hs_eval_space *space, const char *folder, hs_error *err);

/* ---------------------------------------------------------------------------------------------- tables -- */
/* The plugin as it is, and Tables 5.2 and 5.3, as cells of text, for the terminal, the CSV files and the page
 * alike. */

#define HS_EVAL_CELLS 13u /* columns */
#define HS_EVAL_CELL  32u /* bytes of a cell */

typedef struct {
    char cell[HS_EVAL_CELLS][HS_EVAL_CELL];
} hs_eval_row;

typedef enum {
    HS_TABLE_PLAIN,
    HS_TABLE_BEST,  /* Table 5.2: each case's best setting */
    HS_TABLE_COMMON /* Table 5.3: the common threshold and kernel, each case's best knob */
} hs_eval_table_kind;

typedef struct {
    char caption[300]; /* one sentence: what the table shows */
    uint32_t rows, columns;
    bool has[HS_EVAL_CELLS];                /* false: no case has anything in the column, as T_B of a plugin
                                             * without a threshold; terminal and page leave it out */
    hs_eval_row row[HS_EVAL_MAX_CASES + 2]; /* the columns' names, of which those that begin with "thesis"
                                             * come from it; a row a case; the means */
} hs_eval_rows;

void hs_eval_rows_make(const hs_eval_study *study, hs_eval_table_kind kind, hs_eval_rows *out);

/* The plugin as it is, and both tables, to a terminal. */
void hs_eval_study_print(const hs_eval_study *study, FILE *out);

/* The same as "plain.csv", "best.csv" and "common.csv" in the study's folder. HS_ERR_OUTPUT names the file.
 */
bool hs_eval_study_tables(const hs_eval_study *study, hs_error *err);

/* ------------------------------------------------------------------------------------ plugin as it is -- */
enum {
    HS_PLAIN_ABS,
    HS_PLAIN_CUT,  /* percent */
    HS_PLAIN_LEFT, /* percent */
    HS_PLAIN_MS,
    HS_PLAIN_UNCLIPPED,
    HS_PLAIN_FLOOR,
    HS_PLAIN_COUNT
};

/* The numbers of a case; index == study->count: the means over the cases that have them. NAN: not known. */
void hs_eval_plain_row(const hs_eval_study *study, uint32_t index, double out[HS_PLAIN_COUNT]);

/* The case whose number is largest, or study->count if none is known. */
uint32_t hs_eval_plain_worst(const hs_eval_study *study, int column, double *out);

/* --------------------------------------------------------------------------------------------- ranking -- */
/* The ranking of a comparison, for the terminal and the CSV file. */

/* To a terminal, a line a method in the order of the ranks. */
void hs_eval_compare_print(const hs_eval_comparison *x, FILE *out);

/* "compare.csv" in the comparison's folder, a row a method, case and seed; the last column, of the depthmap's
 * bits, is `map_crc32` of `host_sim measure`, too. HS_ERR_OUTPUT names the path. */
bool hs_eval_compare_table(const hs_eval_comparison *x, hs_error *err);

/* -------------------------------------------------------------------------------------------- pictures -- */
/* Pictures and speeds of one case at the common setting (thesis, section 5.3 and Figure 5.21). */

/* Pictures, speeds and the direct measures of case `index` into "<out>/<case>/". The study must be concluded.
 * HS_ERR_OUTPUT names the path; HS_ERR_MEMORY, HS_ERR_PLUGIN or HS_ERR_DEVICE. */
bool hs_eval_study_pictures(hs_eval_study *study, uint32_t index, hs_error *err);

/* ---------------------------------------------------------------------------- pictures of a comparison -- */
/* A comparison's renderings: every case at its first seed, by every method. */

/* Renderings of an open case by all methods, with the full volume and the ground truth, into the case's
 * folder, which is made. The case's loop is gone afterwards. HS_ERR_OUTPUT names the path. */
bool hs_eval_compare_pictures(hs_eval_comparison *x, uint32_t index, hs_eval_case *c, hs_error *err);

/* The folder of a case's pictures (HS_ERR_OUTPUT if its path is longer than `bytes`), and the name of a
 * method's picture in it. */
bool hs_eval_compare_folder(const hs_eval_comparison *x, uint32_t index, char *out, size_t bytes,
                            hs_error *err);
void hs_eval_compare_file(uint32_t method, char *out, size_t bytes);

/* ------------------------------------------------------------------------------------- parts of a page -- */
/* What the sections of the evaluation's page are made of: pictures of a case. */

/* A picture of the case's folder; renderings as photos. `alt` is said for the picture after the case's name.
 * Errors are kept in the page. */
void hs_eval_page_show(hs_page *report, const hs_eval_study *study, uint32_t index, const char *name,
                       const char *alt, const char *caption);

/* ------------------------------------------------------------------------------------- parameter space -- */
/* Figures 5.7 and 5.8 of the thesis, for our cases. */

/* Figure 5.7: e_abs of a case over threshold and kernel, its lowest over the knob. Nothing where the plugin
 * has neither. */
void hs_eval_figure_space(hs_page *report, const hs_eval_study *study, uint32_t index);

/* Figure 5.8: the same averaged over the cases, for the values of Delta_MI that all have. */
void hs_eval_figure_mean(hs_page *report, const hs_eval_study *study);

/* ----------------------------------------------------------------------------------------------- speed -- */
/* Table 5.4 and Figure 5.21 of the thesis, for our cases on this machine. */

/* Nothing if no speed was measured. */
void hs_eval_figure_speed(hs_page *report, const hs_eval_study *study);

/* ------------------------------------------------------------------------------------- page of a study -- */
/* The page of a study: tables, figures and every case in pictures. */

/* Writes "<out>/index.html" of a concluded study whose pictures are made. HS_ERR_OUTPUT, or HS_ERR_INPUT if a
 * picture cannot be read; then there is no page. */
bool hs_eval_study_page(const hs_eval_study *study, hs_error *err);

/* -------------------------------------------------------------------------------- page of a comparison -- */
/* The page of a comparison. */

/* Writes "<out>/index.html" of a ranked comparison whose pictures are made. HS_ERR_OUTPUT, or HS_ERR_INPUT if
 * a picture cannot be read; then there is no page. */
bool hs_eval_compare_page(const hs_eval_comparison *x, hs_error *err);

/* --------------------------------------------------------------------------------------- page of the demo --
 */
/* The page of the demo: its cases, and what came of each. */

#define HS_DEMO_CASES 16
#define HS_DEMO_CELLS 8  /* of a row of the table of speeds */
#define HS_DEMO_CELL  64 /* bytes of a cell */

/* One source of the demo. */
typedef struct {
    const char *scene;   /* a scene's name, or NULL: ... */
    char file[SYS_PATH]; /* ... a volume's path */
    char folder[256];    /* of its pictures, inside the demo's */
    char name[96];       /* for a person: "Cord before the face" */
    bool real;           /* the real fetus in fluid, which the page names the source of */

    /* What came of it. */
    char what[300]; /* a sentence on the source */
    char note[400]; /* why it is not clipped, or not all of it; empty: it is */
    bool clipped, has_truth;
    bool truth_cut;   /* its picture of the truth shows a cut (hs_truth_shows_cut) */
    double cut, left; /* shares, 0 .. 1; NAN: not known */
    double plugin_ms;
    char row[HS_DEMO_CELLS][HS_DEMO_CELL]; /* in the table of speeds, without the first cell */
    char *printed;                         /* the table of `host_sim run`; owned, may be NULL */
} hs_demo_case;

/* Fills the open page. `out` is the folder that holds those of the cases. Errors are kept in the page. */
void hs_demo_page(hs_page *page, const char *out, const hs_demo_case *cases, uint32_t count);
