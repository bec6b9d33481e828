/* SPDX-License-Identifier: MIT */
/* The check of every value that only activate reads, one at a time. */
#ifndef CHECK_SETTINGS_H
#define CHECK_SETTINGS_H

#include "validate/drive/drive_run.h"

void check_every_setting(v_run *run);

#endif
