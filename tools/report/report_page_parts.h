/* SPDX-License-Identifier: MIT */
/* What the sections of the evaluation's page are made of: pictures of a case, and figures. */
#ifndef HS_REPORT_PAGE_PARTS_H
#define HS_REPORT_PAGE_PARTS_H

#include "eval/eval_study.h"
#include "picture/page_html.h"

/* A picture of the case's folder; renderings as photos. `alt` is said for the picture after the case's name.
 * Errors are kept in the page. */
void hs_eval_page_show(hs_page *report, const hs_eval_study *study, uint32_t index, const char *name,
                       const char *alt, const char *caption);

/* Writes a figure (host_sim/picture/plot.h) into the page. */
typedef void (*hs_eval_figure_fn)(FILE *out, const void *plot);
void hs_eval_figure_put(hs_page *report, hs_eval_figure_fn write, const void *plot);

#endif
