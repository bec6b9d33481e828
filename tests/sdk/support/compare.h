/* SPDX-License-Identifier: MIT */
/* One frame of the plugin held against the scalar definition: maps bit for bit,
 * statistics number for number. */
#pragma once

#include "support/rig.h"

/* What the comparisons since the last compare_print came to. */
typedef struct {
    uint32_t frames, max_passes;
    double worst;       /* slices: largest difference to the float64 definition */
    double worst_share; /* largest share of the bound for that many passes */
} compare_summary;

/* Promised of every frame, in slices (docs/numerics.md). */
#define COMPARE_PROMISE 1e-3

/* Runs one frame of an active instance and compares; fails the test with every argument and the first pixel
 * that differs. `volume` is what the stage was filled with; `where` says what is being tested. */
void compare_frame(rig *r, const stage *t, const uint8_t *volume, const rig_settings *settings,
                   const char *where);

/* Activates for `f`, compares one frame, deactivates. */
void compare_run(rig *r, const rig_format *f, const uint8_t *volume, const rig_settings *settings,
                 const char *where);

compare_summary compare_print(const char *what);
