/* SPDX-License-Identifier: MIT */
/* Pictures and speeds of one case at the common setting (thesis, section 5.3 and Figures 5.19 - 5.21). */
#ifndef HS_REPORT_PICTURES_H
#define HS_REPORT_PICTURES_H

#include "eval/eval_study.h"

/* Pictures, speeds and the direct measures of case `index` into "<out>/<case>/". The study must be concluded.
 * HS_ERR_OUTPUT names the path; HS_ERR_MEMORY, HS_ERR_PLUGIN or HS_ERR_DEVICE. */
bool hs_eval_study_pictures(hs_eval_study *study, uint32_t index, hs_error *err);

#endif
