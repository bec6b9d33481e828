/* SPDX-License-Identifier: MIT */
/* Checks of instances and of how a plugin treats its host and its process. */
#ifndef CHECK_CREATE_H
#define CHECK_CREATE_H

#include "validate/drive/drive_run.h"

void check_instance_whole(v_run *run);
void check_create_refusals(v_run *run);
void check_create_without_opencl(v_run *run);
void check_extensions(v_run *run);
void check_bare_host(v_run *run);
void check_host_callbacks(v_run *run);
void check_process_untouched(v_run *run);

#endif
