/* SPDX-License-Identifier: MIT */
/* The options that say how pictures look, as tables of hs_option take them: --look and --light. */
#pragma once

#include "render/dvr_settings.h"

/* "thesis" or "lit", into an hs_look. HS_ERR_USAGE. */
bool hs_look_line_look(void *look, const char *text, hs_error *err);

/* "AZ,EL" in degrees, -180 .. 180 and -90 .. 90, into two floats. HS_ERR_USAGE. */
bool hs_look_line_light(void *light, const char *text, hs_error *err);
