/* SPDX-License-Identifier: MIT */
/* Checks that a map depends on its frame and on nothing else. */
#ifndef CHECK_REPEAT_H
#define CHECK_REPEAT_H

#include "validate/drive/drive_run.h"

void check_same_frame_same_bits(v_run *run);
void check_frames_independent(v_run *run);
void check_slab_splits(v_run *run);
void check_instances_interleaved(v_run *run);
void check_instances_parallel(v_run *run);
void check_any_calls(v_run *run);

#endif
