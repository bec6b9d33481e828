/* SPDX-License-Identifier: MIT */
/* Checks of calls in every state. */
#ifndef CHECK_STATE_H
#define CHECK_STATE_H

#include "validate/drive/drive_run.h"

void check_call_states(v_run *run);
void check_state_walk(v_run *run);

#endif
