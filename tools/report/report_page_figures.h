/* SPDX-License-Identifier: MIT */
/* Figures 5.7 and 5.8 of the thesis, for our cases. */
#ifndef HS_REPORT_PAGE_FIGURES_H
#define HS_REPORT_PAGE_FIGURES_H

#include "eval/eval_study.h"
#include "picture/page_html.h"

/* Figure 5.7: e_abs of a case over threshold and kernel, its lowest over the knob. Nothing where the plugin
 * has neither. */
void hs_eval_figure_space(hs_page *report, const hs_eval_study *study, uint32_t index);

/* Figure 5.8: the same averaged over the cases, for the values of Delta_MI that all have. */
void hs_eval_figure_mean(hs_page *report, const hs_eval_study *study);

#endif
