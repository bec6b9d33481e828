/* SPDX-License-Identifier: MIT */
/* Checks of what a plugin must refuse, and that it says why. */
#ifndef CHECK_REFUSAL_H
#define CHECK_REFUSAL_H

#include "validate/drive/drive_run.h"

void check_slab_refusals(v_run *run);
void check_format_refusals(v_run *run);
void check_null_arguments(v_run *run);
void check_struct_sizes(v_run *run);
void check_reasons(v_run *run);

#endif
