/* SPDX-License-Identifier: MIT */
/* Checks of the values that a plugin takes and refuses. */
#ifndef CHECK_PARAM_VALUES_H
#define CHECK_PARAM_VALUES_H

#include "validate/drive/drive_run.h"

void check_param_in_range(v_run *run);
void check_param_out_of_range(v_run *run);
void check_param_fixed(v_run *run);
void check_param_repeated(v_run *run);
void check_adjust_equals_frame(v_run *run);
void check_param_fuzz(v_run *run);

#endif
