/* SPDX-License-Identifier: MIT */
/* Checks of what a frame gives. */
#ifndef CHECK_FRAME_H
#define CHECK_FRAME_H

#include "validate/drive/drive_run.h"

void check_first_frame(v_run *run);
void check_depth_values(v_run *run);
void check_frame_outcome(v_run *run);
void check_frame_statistics(v_run *run);
void check_guard_bands(v_run *run);
void check_frame_shapes(v_run *run);
void check_frame_contents(v_run *run);
void check_confidence(v_run *run);

#endif
