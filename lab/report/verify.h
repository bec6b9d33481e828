/* SPDX-License-Identifier: MIT */
/* host_sim verify: what is looked at on the machine where a plugin shall run, a row each. */
#pragma once

#include "core/error.h"

#include <stdint.h>

typedef enum { HS_VERIFY_HELD, HS_VERIFY_FAILED, HS_VERIFY_UNASKED, HS_VERIFY_FACT } hs_verify_held;

typedef struct {
    const char *name;
    hs_verify_held held;
    char said[1400];
} hs_verify_row;

/* Fills the row about the files: all lists PREFIX/share/smartvis/sums/NAME.sha256, as sha256sum writes them.
 */
void hs_verify_sums(hs_verify_row *row);

/* The command. argv[0] is its own name. Returns the exit code (hs_code, base/error.h). */
int hs_cmd_verify(int argc, char **argv);
