/* SPDX-License-Identifier: MIT */
/* Checks of what a plugin does with the memory that it is given. */
#ifndef CHECK_INPUT_H
#define CHECK_INPUT_H

#include "validate/drive/drive_run.h"

void check_inputs_unchanged(v_run *run);
void check_reads_within_slab(v_run *run);
void check_padding_ignored(v_run *run);
void check_scanned_ranges(v_run *run);
void check_padding_value(v_run *run);
void check_carriers(v_run *run);

#endif
