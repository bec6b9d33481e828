/* SPDX-License-Identifier: MIT */
/* Where plugins are looked for. The folders, in this order:
 *   1. those of the environment variable SMARTVIS_PLUGIN_PATH, separated by ':'
 *   2. ../lib/smartvis beside the folder of the program, so that an installation can be moved
 *   3. /usr/local/lib/smartvis and /usr/lib/smartvis
 */
#ifndef HS_PLUGIN_PATH_H
#define HS_PLUGIN_PATH_H

#include <stdbool.h>
#include <stddef.h>

/* The folder of that number, 0 first; false behind the last one. Empty parts of the variable are left out. ""
 * stands for a folder that is not there, or that has its turn later. */
bool hs_plugin_folder(unsigned index, char *out, size_t bytes);

/* The file that `name` means. What has a '/' in it, or is a file here, is taken as it is. Else it is looked
 * for in the folders, with and without ".so"; if it is nowhere, out is `name` itself, so that a message names
 * what was asked for. */
void hs_plugin_find(const char *name, char *out, size_t bytes);

/* The plugin that is taken if none is named: smartvis.so beside the program, as in a build folder, else in
 * the folders. */
void hs_plugin_default_path(char *out, size_t bytes);

#endif
