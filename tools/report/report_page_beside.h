/* SPDX-License-Identifier: MIT */
/* The page's section of two methods beside each other: table, legends, and every case in pictures. */
#ifndef HS_REPORT_PAGE_BESIDE_H
#define HS_REPORT_PAGE_BESIDE_H

#include "eval/eval_study.h"
#include "picture/page_html.h"

/* Nothing if there is no other method. Errors are kept in the page. */
void hs_eval_page_beside(hs_page *report, const hs_eval_study *study);

#endif
