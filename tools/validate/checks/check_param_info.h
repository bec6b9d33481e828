/* SPDX-License-Identifier: MIT */
/* Checks of how parameters describe themselves. */
#ifndef CHECK_PARAM_INFO_H
#define CHECK_PARAM_INFO_H

#include "validate/drive/drive_run.h"

void check_param_ids(v_run *run);
void check_param_strings(v_run *run);
void check_param_ranges(v_run *run);
void check_param_dependencies(v_run *run);
void check_param_flags(v_run *run);
void check_param_info_calls(v_run *run);

#endif
