/* SPDX-License-Identifier: MIT */
/* The extensions of a guarded instance: those of the host's list that the plugin in the child has. */
#ifndef HS_GUARDED_EXT_H
#define HS_GUARDED_EXT_H

#include "smartvis_plugin.h"

/* sv_plugin.get_extension of a guarded instance. */
const void *hs_guarded_extension(const sv_plugin *plugin, const char *id);

#endif
