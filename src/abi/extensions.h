/* SPDX-License-Identifier: MIT */
/* The extensions that the plugin offers. */
#ifndef SV_EXTENSIONS_H
#define SV_EXTENSIONS_H

/* Their ids, ended by NULL, for the descriptor. */
extern const char *const sv_extension_ids[];

/* The const table of an extension, or NULL for an unknown id. */
const void *sv_extension(const char *id);

#endif
