/* SPDX-License-Identifier: MIT */
#include "plugin/loader_param.h"

#include "smartvis/lookup.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* An enum's values are few; a plugin that claims more than this is not asked for all their names. */
#define MAX_ENUM_VALUES 256

uint32_t hs_plugin_param_count(const hs_plugin *plugin) {
    const uint32_t count = plugin->instance->param_count(plugin->instance);
    return count < HS_MAX_PARAMS ? count : HS_MAX_PARAMS;
}

static bool param_at(const hs_plugin *plugin, uint32_t index, sv_param_info *info) {
    *info = (sv_param_info){.size = sizeof *info};
    return plugin->instance->param_info(plugin->instance, index, info) == SV_OK && info->key && info->label &&
           info->unit && info->help;
}

bool hs_plugin_find_param(const hs_plugin *plugin, const char *key, sv_param_info *info) {
    uint32_t count = hs_plugin_param_count(plugin);
    for (uint32_t i = 0; i < count; i++)
        if (param_at(plugin, i, info) && strcmp(info->key, key) == 0) return true;
    return false;
}

bool hs_plugin_is_fixed(const sv_plugin *plugin, uint32_t id) {
    sv_param_info info;
    return sv_lookup_id(plugin, id, &info) && (info.flags & SV_PARAM_REACTIVATE);
}

bool hs_plugin_find_primary(const hs_plugin *plugin, sv_param_info *info) {
    uint32_t count = hs_plugin_param_count(plugin);
    for (uint32_t i = 0; i < count; i++)
        if (param_at(plugin, i, info) && (info->flags & SV_PARAM_PRIMARY)) return true;
    return false;
}

/* Fails with the keys there are. */
static bool unknown_key(const hs_plugin *plugin, const char *key, hs_error *err) {
    char known[512] = "";
    size_t used = 0;
    sv_param_info info;
    uint32_t count = hs_plugin_param_count(plugin);
    for (uint32_t i = 0; i < count && used < sizeof known; i++)
        if (param_at(plugin, i, &info))
            used += (size_t)snprintf(known + used, sizeof known - used, "%s%s", used ? ", " : "", info.key);
    return hs_fail(err, HS_ERR_USAGE, "%s: no parameter '%s' (there are: %s)", plugin->path, key, known);
}

/* The plugin's text of a value; false if it has none. The plugin is told of one byte less than there are: a
 * NUL stands there, whatever it writes. */
static bool read_text(const hs_plugin *plugin, const sv_param_info *info, double value, char *out,
                      uint32_t bytes) {
    if (bytes < 2) return false;
    out[0] = out[bytes - 1] = '\0';
    if (plugin->instance->param_text(plugin->instance, info->id, value, out, bytes - 1) != SV_OK)
        return false;
    for (char *c = out; *c; c++)
        if ((unsigned char)*c < 0x20 || *c == 0x7f) *c = '?';
    return true;
}

void hs_plugin_value_text(const hs_plugin *plugin, const sv_param_info *info, double value, char *out,
                          uint32_t bytes) {
    if (!read_text(plugin, info, value, out, bytes)) (void)snprintf(out, bytes, "%g", value);
}

uint32_t hs_plugin_enum_count(const sv_param_info *info) {
    const double step = info->step > 0 ? info->step : 1.0;
    const double count = floor((info->max_value - info->min_value) / step + 0.5) + 1.0;
    return info->type == SV_PARAM_ENUM && count >= 1 && count <= MAX_ENUM_VALUES ? (uint32_t)count : 0;
}

bool hs_plugin_enum_at(const hs_plugin *plugin, const sv_param_info *info, uint32_t index, double *value,
                       char *name, uint32_t bytes) {
    *value = info->min_value + index * (info->step > 0 ? info->step : 1.0);
    return read_text(plugin, info, *value, name, bytes);
}

bool hs_plugin_find_enum(const hs_plugin *plugin, const sv_param_info *info, const char *name,
                         double *value) {
    char known[HS_ENUM_NAME];
    for (uint32_t i = 0; i < hs_plugin_enum_count(info); i++)
        if (hs_plugin_enum_at(plugin, info, i, value, known, sizeof known) && strcmp(known, name) == 0)
            return true;
    return false;
}

/* Fails with the names there are. */
static bool unknown_enum(const hs_plugin *plugin, const sv_param_info *info, const char *name,
                         hs_error *err) {
    char known[512] = "", one[HS_ENUM_NAME];
    double value;
    size_t used = 0;
    for (uint32_t i = 0; i < hs_plugin_enum_count(info) && used < sizeof known; i++)
        if (hs_plugin_enum_at(plugin, info, i, &value, one, sizeof one))
            used += (size_t)snprintf(known + used, sizeof known - used, "%s%s", used ? ", " : "", one);
    return hs_fail(err, HS_ERR_USAGE, "parameter %s: '%s' is not one of %s", info->key, name, known);
}

static bool parse_number(const sv_param_info *info, const char *text, double *out, hs_error *err) {
    char *end = NULL;
    double value = strtod(text, &end);
    if (end == text || *end != '\0' || !isfinite(value))
        return hs_fail(err, HS_ERR_USAGE, "parameter %s: '%s' is not a number", info->key, text);
    if (value < info->min_value || value > info->max_value)
        return hs_fail(err, HS_ERR_USAGE, "parameter %s: %g is outside %g .. %g", info->key, value,
                       info->min_value, info->max_value);
    if (info->type == SV_PARAM_INT && info->step > 0) {
        double n = (value - info->min_value) / info->step;
        if (n != floor(n))
            return hs_fail(err, HS_ERR_USAGE, "parameter %s: %g is not %g plus a multiple of %g", info->key,
                           value, info->min_value, info->step);
    }
    *out = value;
    return true;
}

bool hs_plugin_parse_param(const hs_plugin *plugin, const char *text, sv_param_value *out, hs_error *err) {
    const char *equals = strchr(text, '=');
    char key[64];
    if (!equals || equals == text || (size_t)(equals - text) >= sizeof key)
        return hs_fail(err, HS_ERR_USAGE, "'%s': expected key=value", text);
    memcpy(key, text, (size_t)(equals - text));
    key[equals - text] = '\0';
    sv_param_info info;
    if (!hs_plugin_find_param(plugin, key, &info)) return unknown_key(plugin, key, err);
    const char *value = equals + 1;
    *out = (sv_param_value){.id = info.id};
    if (info.type == SV_PARAM_ENUM)
        return hs_plugin_find_enum(plugin, &info, value, &out->value) ||
               unknown_enum(plugin, &info, value, err);
    if (info.type == SV_PARAM_BOOL && (strcmp(value, "true") == 0 || strcmp(value, "false") == 0)) {
        out->value = strcmp(value, "true") == 0;
        return true;
    }
    return parse_number(&info, value, &out->value, err);
}
