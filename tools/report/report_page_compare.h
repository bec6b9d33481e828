/* SPDX-License-Identifier: MIT */
/* The page of a comparison. */
#ifndef HS_REPORT_PAGE_COMPARE_H
#define HS_REPORT_PAGE_COMPARE_H

#include "eval/eval_compare.h"

/* Writes "<out>/index.html" of a ranked comparison whose pictures are made. HS_ERR_OUTPUT, or HS_ERR_INPUT if
 * a picture cannot be read; then there is no page. */
bool hs_eval_compare_page(const hs_eval_comparison *x, hs_error *err);

#endif
