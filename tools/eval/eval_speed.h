/* SPDX-License-Identifier: MIT */
/* How fast a plugin is on the cases of a study, by the wall clock (thesis 5.4, Figures 5.19 to 5.21). */
#ifndef HS_EVAL_SPEED_H
#define HS_EVAL_SPEED_H

#include "eval/eval_study.h"

/* Figure 5.20, into study->curve_...: the plugin alone over kernel, for some thresholds. On the open case
 * `index` if that is E04, or the last one of a study without E04. Nothing if options->frames is 0, or if the
 * plugin has no threshold or no kernel. */
bool hs_eval_speed_curves(hs_eval_study *study, uint32_t index, hs_eval_case *c, hs_error *err);

/* Figures 5.19 and 5.21, into the case's result: options->frames frames (0: nothing) of the three settings
 * with `values`, pictures of 512 x 512. The case must be released (hs_eval_case_release). */
bool hs_eval_speed_settings(hs_eval_study *study, uint32_t index, const hs_eval_case *c,
                            const hs_eval_values *values, hs_error *err);

#endif
