/* SPDX-License-Identifier: MIT */
/* The geometry of a Kretz file on a command line. */
#ifndef HS_VOL_LINE_H
#define HS_VOL_LINE_H

#include "scene/scene_export.h"

/* What a spec is before any key: all is left open. */
hs_vol_spec hs_vol_line_defaults(void);

/* "KEY=VALUE,KEY=VALUE,...". HS_ERR_USAGE names the key and its value, or the keys there are. */
bool hs_vol_line_parse(const char *text, hs_vol_spec *spec, hs_error *err);

/* The keys, for a help text. */
extern const char hs_vol_line_help[];

#endif
