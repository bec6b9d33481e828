/* SPDX-License-Identifier: MIT */
/* Checks of a plugin's OpenCL calls and allocations, seen through the spies. */
#ifndef CHECK_OPENCL_H
#define CHECK_OPENCL_H

#include "validate/drive/drive_run.h"

void check_frame_path_opencl(v_run *run);
void check_frame_path_heap(v_run *run);
void check_first_launches(v_run *run);
void check_opencl_balance(v_run *run);
void check_opencl_faults(v_run *run);
void check_heap_faults(v_run *run);
void check_activations(v_run *run);

#endif
