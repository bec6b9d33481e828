/* SPDX-License-Identifier: MIT */
/* What a check is. */
#ifndef V_CHECK_H
#define V_CHECK_H

#include "validate/drive/drive_run.h"

typedef struct {
    const char *id;    /* kebab-case, stable */
    const char *needs; /* skipped unless this check passed; NULL: none */
    const char *what;  /* one sentence: what holds */
    const char *mend;  /* one sentence: what to do if it does not */
    void (*run)(v_run *run);
} v_check;

#endif
