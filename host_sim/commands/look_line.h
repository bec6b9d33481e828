/* SPDX-License-Identifier: MIT */
/* The options that say how pictures look: --look and --light. */
#ifndef HS_LOOK_LINE_H
#define HS_LOOK_LINE_H

#include "render/dvr_settings.h"

/* "thesis" or "lit". HS_ERR_USAGE. */
bool hs_look_line_look(const char *text, hs_look *look, hs_error *err);

/* "AZ,EL" in degrees, -180 .. 180 and -90 .. 90. HS_ERR_USAGE. */
bool hs_look_line_light(const char *text, float light[2], hs_error *err);

#endif
