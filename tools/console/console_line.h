/* SPDX-License-Identifier: MIT */
/* The command line that reproduces what a stage shows. */
#ifndef HS_CONSOLE_LINE_H
#define HS_CONSOLE_LINE_H

#include "console/console_stage.h"

/* "host_sim run --scene D01 ...", for a shell; the caller frees it. NULL without memory. Its result.png has
 * the pixels of the view "result" of lane `lane` at rest. */
char *hs_console_line(const hs_console_stage *stage, uint32_t lane);

#endif
