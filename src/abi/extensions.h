/* SPDX-License-Identifier: MIT */
/* The plugin's extensions: statistics, spline report, confidence (include/smartvis_plugin.h has the
 * contract). */
#ifndef SV_EXTENSIONS_H
#define SV_EXTENSIONS_H

/* The table of the extension `id` (not NULL), static, or NULL if the plugin has none by that name. */
const void *sv_extension_find(const char *id);

#endif
