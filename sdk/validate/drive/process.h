/* SPDX-License-Identifier: MIT */
/* What the system tells of this process; with v_watch_... of drive.h in process_posix.c and
 * process_windows.c. */
#ifndef V_PROCESS_H
#define V_PROCESS_H

#include "validate/spy/library.h"

/* What handles signals or exceptions in the library: "SIGSEGV"; NULL: nothing. */
const char *v_process_handler(library_range library);

/* Open files (of Windows all handles), and threads. */
uint32_t v_process_files(void);
uint32_t v_process_threads(void);

/* How many files it may have open. */
uint64_t v_process_most_files(void);

#endif
