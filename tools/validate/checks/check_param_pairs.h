/* SPDX-License-Identifier: MIT */
/* The check of values that only activate reads, two at a time. */
#ifndef CHECK_PARAM_PAIRS_H
#define CHECK_PARAM_PAIRS_H

#include "validate/drive/drive_run.h"

void check_param_pairs(v_run *run);

#endif
