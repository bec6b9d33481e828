/* SPDX-License-Identifier: MIT */
/* The figures of the evaluation's page; used by hs_eval_page*.c only. */
#ifndef HS_REPORT_PAGE_H
#define HS_REPORT_PAGE_H

#include "eval/eval_study.h"
#include "picture/page_html.h"

/* A picture of the case's folder; renderings as photos. */
void hs_eval_page_show(hs_report *report, const hs_eval_study *study, uint32_t index, const char *name,
                       const char *alt, const char *caption);

/* The section of two methods beside each other; nothing if there is no other. */
void hs_eval_page_beside(hs_report *report, const hs_eval_study *study);

/* Writes a figure (host_sim/picture/plot.h) into the page. */
typedef void (*hs_eval_figure_fn)(FILE *out, const void *plot);
void hs_eval_figure_put(hs_report *report, hs_eval_figure_fn write, const void *plot);

/* Figure 5.7: e_abs of a case over threshold and kernel, its lowest over the knob. Nothing where the plugin
 * has neither. */
void hs_eval_figure_space(hs_report *report, const hs_eval_study *study, uint32_t index);

/* Figure 5.8: the same averaged over the cases, for the values of Delta_MI that all have. */
void hs_eval_figure_mean(hs_report *report, const hs_eval_study *study);

/* Table 5.4 and Figures 5.19, 5.20 and 5.21; nothing if no speed was measured. */
void hs_eval_figure_speed(hs_report *report, const hs_eval_study *study);

#endif
