/* SPDX-License-Identifier: MIT */
/* Checks of the library as a file: loading, symbols, entry, descriptors. */
#ifndef CHECK_LIBRARY_H
#define CHECK_LIBRARY_H

#include "validate/drive/drive_run.h"

void check_library_loads(v_run *run);
void check_library_reloads(v_run *run);
void check_library_symbols(v_run *run);
void check_library_scan_time(v_run *run);
void check_entry_whole(v_run *run);
void check_descriptors(v_run *run);
void check_descriptor_constant(v_run *run);

#endif
