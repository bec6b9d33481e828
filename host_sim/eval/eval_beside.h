/* SPDX-License-Identifier: MIT */
/*
 * Another method of the same plugin beside the one whose space is studied: both on the same volumes, with the
 * true surface as the floor. What is compared is one setting for all cases.
 */
#ifndef HS_EVAL_BESIDE_H
#define HS_EVAL_BESIDE_H

#include "eval/eval_case.h"

#include <stdio.h>

#define HS_BESIDE_MAX_CASES 32u

/* The columns: one setting for all cases each. */
typedef enum {
    HS_BESIDE_DEFAULT, /* the studied method at its defaults */
    HS_BESIDE_KNOB,    /* the same, its knob where the mean e_abs over the cases is lowest */
    HS_BESIDE_TUNED,   /* the same, T_B by Delta_MI, k and knob where it is lowest (Table 5.3, one knob) */
    HS_BESIDE_OTHER,   /* the other method at its defaults */
    HS_BESIDE_TRUTH,   /* the scene's own clipping surface as a depthmap: no map of this size can be better */
    HS_BESIDE_COUNT
} hs_beside_way;

typedef struct {
    bool exists;
    char first_name[64], other_name[64];                     /* "mean", "cost" */
    hs_eval_values first, other;                             /* without the knob */
    hs_eval_knob knob;                                       /* of the studied method */
    uint32_t best;                                           /* HS_BESIDE_KNOB's position */
    hs_measures line[HS_BESIDE_MAX_CASES][HS_EVAL_MAX_LINE]; /* over the knob */
    hs_measures of[HS_BESIDE_MAX_CASES][HS_BESIDE_COUNT];    /* NAN: not known */
    bool has_confidence[HS_BESIDE_MAX_CASES]; /* the other method gave one, and its picture is there */
} hs_eval_beside;

struct hs_eval_study;

/* Decides whether there is another method: options->beside as "KEY=VALUE[ KEY=VALUE]...", or "none"; NULL:
 * "method=cost", if the plugin has it and --set names no method. HS_ERR_USAGE for settings the plugin does
 * not take. */
bool hs_eval_beside_open(struct hs_eval_study *study, hs_error *err);

/* Measures an open case, of which only hs_eval_case_close may follow. Nothing if there is no other method. */
bool hs_eval_beside_measure(struct hs_eval_study *study, uint32_t index, hs_eval_case *c, hs_error *err);

/* The best knob, when all cases are measured and the study's mean is there. */
void hs_eval_beside_conclude(struct hs_eval_study *study);

/* Mean over the cases; NAN if one is not known. */
double hs_eval_beside_mean(const struct hs_eval_study *study, hs_beside_way way, hs_measure measure);

/* "beside_knob.png", "beside_other.png" and their errors, "beside_confidence.png" in the case's folder
 * (host_sim/report/report_pictures_beside.c). The case's loop is replaced. */
bool hs_eval_beside_pictures(struct hs_eval_study *study, uint32_t index, hs_eval_case *c, const char *folder,
                             hs_error *err);

#define HS_BESIDE_CELLS 14u
#define HS_BESIDE_CELL  48u /* bytes */

/* The table as cells of text: row 0 is the head, 1 .. count the cases, count + 1 the means. */
void hs_eval_beside_row(const struct hs_eval_study *study, uint32_t row,
                        char cell[HS_BESIDE_CELLS][HS_BESIDE_CELL]);

/* To a terminal, and as "beside.csv". Nothing if there is no other method. */
void hs_eval_beside_print(const struct hs_eval_study *study, FILE *out);
bool hs_eval_beside_table(const struct hs_eval_study *study, hs_error *err);

#endif
