/* SPDX-License-Identifier: MIT */
/* A comparison's renderings: every case at its first seed, by every method. */
#ifndef HS_REPORT_PICTURES_COMPARE_H
#define HS_REPORT_PICTURES_COMPARE_H

#include "eval/eval_compare.h"

/* Renderings of an open case by all methods, with the full volume and the ground truth, into the case's
 * folder, which is made. The case's loop is gone afterwards. HS_ERR_OUTPUT names the path. */
bool hs_eval_compare_pictures(const hs_eval_comparison *x, uint32_t index, hs_eval_case *c, hs_error *err);

/* The folder of a case's pictures (HS_ERR_OUTPUT if its path is longer than `bytes`), and the name of a
 * method's picture in it. */
bool hs_eval_compare_folder(const hs_eval_comparison *x, uint32_t index, char *out, size_t bytes,
                            hs_error *err);
void hs_eval_compare_file(uint32_t method, char *out, size_t bytes);

#endif
