/* SPDX-License-Identifier: MIT */
/* Checks of values as a person reads them. */
#ifndef CHECK_PARAM_TEXT_H
#define CHECK_PARAM_TEXT_H

#include "validate/drive/drive_run.h"

void check_param_text(v_run *run);
void check_param_round_trip(v_run *run);
void check_param_enum_names(v_run *run);

#endif
