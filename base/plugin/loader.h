/* SPDX-License-Identifier: MIT */
/* Loads any SmartVis plugin by path. The host knows it by smartvis_plugin.h only. */
#pragma once

#include "core/error.h"
#include "smartvis_plugin.h"

#include <stdbool.h>
#include <stddef.h>

/* The file that `name` means. What has a '/' in it, or is a file here, is taken as it is. Else it is looked
 * for in the folders, with and without ".so"; if it is nowhere, out is `name` itself, so that a message names
 * what was asked for. */
void hs_plugin_find(const char *name, char *out, size_t bytes);

/* The plugin that is taken if none is named: smartvis.so beside the program, as in a build folder, else in
 * the folders. */
void hs_plugin_default_path(char *out, size_t bytes);

#define HS_MAX_PLUGINS 64u /* of a library; one that claims more is refused */

/* A loaded library with one instance. Owned by the caller; must not move in memory while open. */
typedef struct {
    void *library; /* NULL while closed, and if the library lives in another process */
    uint32_t abi_major, abi_minor;
    const sv_descriptor *descriptor[HS_MAX_PLUGINS]; /* of all its plugins */
    uint32_t count;
    const sv_plugin *instance;
    sv_host host;
    int32_t log_level; /* lines of lower severity are not printed (SV_LOG_*) */
    void (*hears)(void *ear, int32_t severity, const char *text); /* every line behind create; or NULL */
    void *ear;
    char line[256];      /* the last one of create: a plugin without an instance has no last_error */
    char complaint[256]; /* the first line of SV_LOG_PLUGIN_MISBEHAVING: a plugin that caught itself, or one
                            that checks another, like smartvis_check.so; "" if there was none */
    char path[1024];
} hs_plugin;

/* dlopen, symbol, ABI major, descriptor, create. `path` as hs_plugin_find takes it. `id` NULL takes the
 * library's first plugin. Every failure names the path and what was found (HS_ERR_PLUGIN): no such file, not
 * a library, no entry symbol, ABI major 2 where this host speaks 1, no plugin of that id (and which there
 * are). */
bool hs_plugin_open(hs_plugin *plugin, const char *path, const char *id, int32_t log_level, hs_error *err);

/* Is told of every call before it is made: "dlopen" (constructors run), "descriptor", "create". */
typedef struct {
    void (*enter)(void *context, const char *call);
    void *context;
} hs_call_watch;

/* Opens a plugin as hs_plugin_open does and tells `watch` of every call before it is made. */
bool hs_plugin_open_watched(hs_plugin *plugin, const char *path, const char *id, int32_t log_level,
                            const hs_call_watch *watch, hs_error *err);

/* destroy and dlclose. Of *plugin the complaint stays, all else is zeroed. */
void hs_plugin_close(hs_plugin *plugin);

/* Depths that were made elsewhere: mm from the front of the low-resolution volume's box, row by row; 0 or
 * less clips nothing. Borrowed. */
typedef struct {
    const float *mm;
    uint32_t width, height;
} hs_given_map;

/* Instead of a library, a plugin that gives out this map, which must outlive it. It refuses frames of another
 * size. HS_ERR_MEMORY. */
bool hs_plugin_open_map(hs_plugin *plugin, const hs_given_map *map, hs_error *err);

/* True for a status that the header names. */
bool hs_status_is_known(sv_status status);

/* True for SV_OK and the positive notes that the header names. */
bool hs_status_is_success(sv_status status);

/* True on SV_OK and on the header's positive notes; else records HS_ERR_PLUGIN: "<path>: <call>: <status
 * name> (<number>): <last_error>". */
bool hs_plugin_check(const hs_plugin *plugin, sv_status status, const char *call, hs_error *err);

/* A status's name, e.g. "SV_ERR_SLAB_ORDER"; "unknown status" for others. */
const char *hs_status_name(sv_status status);
