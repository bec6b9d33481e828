/* SPDX-License-Identifier: MIT */
/* Table 5.4 and Figures 5.19, 5.20 and 5.21 of the thesis, for our cases on this machine. */
#ifndef HS_REPORT_PAGE_SPEED_H
#define HS_REPORT_PAGE_SPEED_H

#include "eval/eval_study.h"
#include "picture/page_html.h"

/* Nothing if no speed was measured. */
void hs_eval_figure_speed(hs_page *report, const hs_eval_study *study);

#endif
