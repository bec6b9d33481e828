/* SPDX-License-Identifier: MIT */
#include "commands/look_line.h"

#include "core/cli.h"

#include <math.h>

bool hs_look_line_look(void *look, const char *text, hs_error *err) {
    const char *names[HS_LOOK_COUNT];
    uint32_t index;
    for (int i = 0; i < HS_LOOK_COUNT; i++) names[i] = hs_look_key((hs_look)i);
    if (!hs_cli_select("--look", text, names, HS_LOOK_COUNT, &index, err)) return false;
    *(hs_look *)look = (hs_look)index;
    return true;
}

bool hs_look_line_light(void *target, const char *text, hs_error *err) {
    float *const light = target;
    double angle[2];
    if (!hs_cli_numbers("--light", text, "AZ,EL", -180, 180, 2, 2, angle, err)) return false;
    if (fabs(angle[1]) > 90)
        return hs_fail(err, HS_ERR_USAGE, "--light: '%s', expected an elevation of -90 .. 90", text);
    light[0] = (float)angle[0];
    light[1] = (float)angle[1];
    return true;
}
