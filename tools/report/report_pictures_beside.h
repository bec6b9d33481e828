/* SPDX-License-Identifier: MIT */
/* Pictures of both methods of one case, each at its one setting for all cases. */
#ifndef HS_REPORT_PICTURES_BESIDE_H
#define HS_REPORT_PICTURES_BESIDE_H

#include "eval/eval_study.h"

/* "beside_knob.png", "beside_other.png" and their errors, "beside_confidence.png" in the case's folder.
 * Nothing if there is no other method. The case's loop is replaced, and gone afterwards. */
bool hs_eval_beside_pictures(hs_eval_study *study, uint32_t index, hs_eval_case *c, const char *folder,
                             hs_error *err);

#endif
