/* SPDX-License-Identifier: MIT */
/* A plugin's parameters as a command line sees them: found by key, written as key=value. */
#pragma once

#include "plugin/loader.h"

/* Parameters of the plugin; of more than HS_MAX_PARAMS the rest are left out: no plugin means so many. */
#define HS_MAX_PARAMS 1024u
uint32_t hs_plugin_param_count(const hs_plugin *plugin);

/* A value as the plugin words it, or as a number where it does not. Always ended by a NUL and free of control
 * characters, whatever the plugin wrote. */
void hs_plugin_value_text(const hs_plugin *plugin, const sv_param_info *info, double value, char *out,
                          uint32_t bytes);

/* Finds a parameter by key. False if there is none. */
bool hs_plugin_find_param(const hs_plugin *plugin, const char *key, sv_param_info *info);

/* True for a parameter that only activate reads. */
bool hs_plugin_is_fixed(const sv_plugin *plugin, uint32_t id);

/* Finds the one parameter that every user sees (SV_PARAM_PRIMARY). False if the plugin has none. */
bool hs_plugin_find_primary(const hs_plugin *plugin, sv_param_info *info);

#define HS_ENUM_NAME 64u /* bytes that hold the name of an enum's value; a longer one is no name */

/* The values of an enum: how many there are (0 if it is no enum, or claims more than 256), and the value of
 * position `index` with its name. False if the plugin has no name for it, or none that fits. */
uint32_t hs_plugin_enum_count(const sv_param_info *info);
bool hs_plugin_enum_at(const hs_plugin *plugin, const sv_param_info *info, uint32_t index, double *value,
                       char *name, uint32_t bytes);

/* The value of an enum by its name. False if it has none of that name; *value means nothing then. */
bool hs_plugin_find_enum(const hs_plugin *plugin, const sv_param_info *info, const char *name, double *value);

/* Parses "key=value" (a number, true/false, or an enum's value text) into *out; errors name key, value and
 * the allowed range or names. */
bool hs_plugin_parse_param(const hs_plugin *plugin, const char *text, sv_param_value *out, hs_error *err);
