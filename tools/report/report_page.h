/* SPDX-License-Identifier: MIT */
/* The page of a study: tables, figures and every case in pictures. */
#ifndef HS_REPORT_PAGE_H
#define HS_REPORT_PAGE_H

#include "eval/eval_study.h"

/* Writes "<out>/index.html" of a concluded study whose pictures are made. HS_ERR_OUTPUT, or HS_ERR_INPUT if a
 * picture cannot be read; then there is no page. */
bool hs_eval_study_page(const hs_eval_study *study, hs_error *err);

#endif
