/* SPDX-License-Identifier: MIT */
/*
 * A helper for hosts, header-only and optional: parameters by key, values by name, which parameters matter
 * now, and the names of statuses. It calls the plugin's [any] functions only and keeps nothing.
 */
#ifndef SMARTVIS_LOOKUP_H
#define SMARTVIS_LOOKUP_H

#include "smartvis_plugin.h"

#include <string.h>

SMARTVIS_BEGIN_C

/* Longest text of a value that the helper compares, its NUL included. */
#define SV_LOOKUP_TEXT_BYTES 128

/* Parameters that the helper looks at, at most: more than any plugin has, and an end to what a wrong one
 * claims. */
#define SV_LOOKUP_MAX_PARAMS 4096u

static inline uint32_t sv_lookup_count(const sv_plugin *plugin) {
    const uint32_t count = plugin->param_count(plugin);
    return count < SV_LOOKUP_MAX_PARAMS ? count : SV_LOOKUP_MAX_PARAMS;
}

/* Reads parameter `index` into *out. 1 on success, 0 if there is no such parameter. */
static inline int sv_lookup_index(const sv_plugin *plugin, uint32_t index, sv_param_info *out) {
    memset(out, 0, sizeof *out);
    out->size = (uint32_t)sizeof *out;
    return index < sv_lookup_count(plugin) && plugin->param_info(plugin, index, out) == SV_OK;
}

/* The parameter with this key. 1 on success, 0 if there is none. */
static inline int sv_lookup_key(const sv_plugin *plugin, const char *key, sv_param_info *out) {
    for (uint32_t i = 0; i < sv_lookup_count(plugin); i++)
        if (sv_lookup_index(plugin, i, out) && strcmp(out->key, key) == 0) return 1;
    return 0;
}

/* The parameter with this id. 1 on success, 0 if there is none. */
static inline int sv_lookup_id(const sv_plugin *plugin, uint32_t id, sv_param_info *out) {
    for (uint32_t i = 0; i < sv_lookup_count(plugin); i++)
        if (sv_lookup_index(plugin, i, out) && out->id == id) return 1;
    return 0;
}

/* The value of an enum whose text (param_text) is `name`. 1 on success, 0 if the parameter is no enum or none
 * of its values has that name; *value is then as it was. */
static inline int sv_lookup_value(const sv_plugin *plugin, const sv_param_info *info, const char *name,
                                  double *value) {
    char text[SV_LOOKUP_TEXT_BYTES];
    if (info->type != SV_PARAM_ENUM) return 0;
    for (double v = info->min_value; v <= info->max_value; v += info->step > 0.0 ? info->step : 1.0) {
        text[0] = text[sizeof text - 1] = '\0';
        if (plugin->param_text(plugin, info->id, v, text, (uint32_t)sizeof text - 1) != SV_OK) continue;
        if (strcmp(text, name) != 0) continue;
        *value = v;
        return 1;
    }
    return 0;
}

/* The value that parameter `id` has in a list; its default if it is not there. Of a repeated id the last
 * counts. */
static inline double sv_lookup_current(const sv_param_info *info, const sv_param_value *values,
                                       uint32_t count) {
    double value = info->default_value;
    for (uint32_t i = 0; i < count; i++)
        if (values[i].id == info->id) value = values[i].value;
    return value;
}

/* 1 if the parameter matters with these values (see sv_param_info.depends_on), else 0. A parameter that
 * depends on one the plugin does not have matters. */
static inline int sv_lookup_matters(const sv_plugin *plugin, const sv_param_info *info,
                                    const sv_param_value *values, uint32_t count) {
    sv_param_info on = *info;
    uint32_t id = info->depends_on;
    uint64_t wanted = info->depends_values;
    /* No longer chain than there are parameters: a plugin's circle must not hold the host. */
    for (uint32_t n = sv_lookup_count(plugin); id != 0 && n > 0; n--) {
        if (!sv_lookup_id(plugin, id, &on) || on.step <= 0.0) return 1;
        const double step = (sv_lookup_current(&on, values, count) - on.min_value) / on.step + 0.5;
        if (!(step >= 0.0 && step < 64.0) || !(wanted >> (uint32_t)step & 1u)) return 0;
        id = on.depends_on;
        wanted = on.depends_values;
    }
    return 1;
}

/* The name of a status of the header, "SV_ERR_STATE", or NULL. */
static inline const char *sv_lookup_status(sv_status status) {
#define SV_LOOKUP_NAME(code)                                                                                 \
    case code:                                                                                               \
        return #code
    switch (status) {
        SV_LOOKUP_NAME(SV_OK);
        SV_LOOKUP_NAME(SV_NO_SURFACE);
        SV_LOOKUP_NAME(SV_PARTIAL);
        SV_LOOKUP_NAME(SV_ERR_INTERNAL);
        SV_LOOKUP_NAME(SV_ERR_ARGUMENT);
        SV_LOOKUP_NAME(SV_ERR_SIZE);
        SV_LOOKUP_NAME(SV_ERR_FORMAT);
        SV_LOOKUP_NAME(SV_ERR_PARAM_ID);
        SV_LOOKUP_NAME(SV_ERR_PARAM_RANGE);
        SV_LOOKUP_NAME(SV_ERR_PARAM_FIXED);
        SV_LOOKUP_NAME(SV_ERR_UNKNOWN_ID);
        SV_LOOKUP_NAME(SV_ERR_STATE);
        SV_LOOKUP_NAME(SV_ERR_SLAB_ORDER);
        SV_LOOKUP_NAME(SV_ERR_SLAB_MISSING);
        SV_LOOKUP_NAME(SV_ERR_SLAB_SHAPE);
        SV_LOOKUP_NAME(SV_ERR_NO_DEVICE);
        SV_LOOKUP_NAME(SV_ERR_BUILD);
        SV_LOOKUP_NAME(SV_ERR_OPENCL);
        SV_LOOKUP_NAME(SV_ERR_SELF_TEST);
        SV_LOOKUP_NAME(SV_ERR_NO_MEMORY);
    default:
        return NULL;
    }
#undef SV_LOOKUP_NAME
}

SMARTVIS_END_C

#endif
