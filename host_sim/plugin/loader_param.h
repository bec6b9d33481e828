/* SPDX-License-Identifier: MIT */
/* A plugin's parameters as a command line sees them: found by key, written as key=value. */
#ifndef HS_LOADER_PARAM_H
#define HS_LOADER_PARAM_H

#include "plugin/loader.h"

/* Finds a parameter by key. False if there is none. */
bool hs_plugin_find_param(const hs_plugin *plugin, const char *key, sv_param_info *info);

/* Finds the one knob a user sees (SV_PARAM_PRIMARY). False if the plugin has none. */
bool hs_plugin_find_primary(const hs_plugin *plugin, sv_param_info *info);

/* Parses "key=value" (a number, true/false, or an enum's value text) into *out; errors name key, value and
 * the allowed range or names. */
bool hs_plugin_parse_param(const hs_plugin *plugin, const char *text, sv_param_value *out, hs_error *err);

#endif
