/* SPDX-License-Identifier: MIT */
/*
 * Plugins behind a guard. The library lives in a child process; what the host holds is an instance of its own
 * (an sv_plugin like any other) that hands every call over to the child. If the child crashes, leaves, hangs
 * or takes too much memory, the call returns SV_ERR_INTERNAL with the reason, and a new child is started for
 * the next frame.
 *
 * A guarded instance takes slabs in host memory from hs_guarded_memory, on a queue of its own. In the child
 * the plugin gets them as hs_guarded_route says. A frame is one message: begin and slab only note what they
 * are given.
 */
#pragma once

#include "guarded/guard_options.h"
#include "plugin/capabilities.h"
#include "plugin/loader.h"

/* hs_plugin_open, guarded or not as the options say. The errors are the same, and HS_ERR_PLUGIN also tells
 * how a child ended: "x.so: crashed: SIGSEGV in create". hs_guarded_close or hs_plugin_close ends it. */
bool hs_guarded_open(hs_plugin *plugin, const char *path, const char *id, int32_t log_level,
                     const hs_guard_options *options, hs_error *err);

/* Closes a plugin of either kind. False with HS_ERR_PLUGIN if its child ended at any time before it was to,
 * in destroy for example: the first time that happened; or with plugin->complaint if there is one. */
bool hs_guarded_close(hs_plugin *plugin, hs_error *err);

/* True if the plugin lives in a child. NULL: false. */
bool hs_is_guarded(const hs_plugin *plugin);

/* How the plugin gets its slabs in the child, from the next activate on. Does nothing if it is not
 * guarded. */
void hs_guarded_route(const hs_plugin *plugin, hs_handover way);

/* Memory for all slabs, aligned to a page, zeroed, owned by the guard until the plugin is closed. It is the
 * same memory at every call, so only one user of the plugin can have it at a time; what it held is gone. NULL
 * with HS_ERR_MEMORY. The plugin must be guarded and inactive. */
void *hs_guarded_memory(const hs_plugin *plugin, size_t bytes, hs_error *err);

/* The call that the last failure was found in ("slab", "end"), or `call` if the plugin is not guarded: a
 * guarded frame fails in its last call whatever the plugin failed in. Valid until the next call of the
 * instance. */
const char *hs_guarded_call(const hs_plugin *plugin, const char *call);

/* True if the plugin has a process now, or needs none of its own. */
bool hs_guarded_lives(const hs_plugin *plugin);

/* The first time that a child of the plugin ended before it was to; code HS_OK if none did. Owned by the
 * plugin. */
const hs_error *hs_guarded_ended(const hs_plugin *plugin);

/* How often a child was started anew; 0 if the plugin is not guarded. */
uint32_t hs_guarded_restarts(const hs_plugin *plugin);
