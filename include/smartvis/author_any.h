/* SPDX-License-Identifier: MIT */
/*
 * The functions of a plugin that any thread may call at any time: they read what stays, and only log. A part
 * of smartvis/author.h; a method does not call it.
 */
#ifndef SMARTVIS_AUTHOR_ANY_H
#define SMARTVIS_AUTHOR_ANY_H

#include "smartvis/author_checks.h"

SMARTVIS_BEGIN_C

static inline uint32_t SV_CALL sva_param_count(const sv_plugin *plugin) {
    return ((const sva *)plugin->plugin_data)->method->param_count;
}

static inline sv_status SV_CALL sva_param_info(const sv_plugin *plugin, uint32_t index, sv_param_info *out) {
    const sva *a = (const sva *)plugin->plugin_data;
    if (!out) return sva_tell(a, SV_ERR_ARGUMENT, "param_info: out is NULL");
    if (out->size < sizeof *out)
        return sva_tell(a, SV_ERR_SIZE, "param_info: out.size is %u, expected at least %u",
                        (unsigned)out->size, (unsigned)sizeof *out);
    if (index >= a->method->param_count)
        return sva_tell(a, SV_ERR_ARGUMENT, "param_info: index is %u, there are %u parameters",
                        (unsigned)index, (unsigned)a->method->param_count);
    const sva_param *p = &a->method->params[index];
    const int whole = p->display_min == 0.0 && p->display_max == 0.0;
    out->id = p->id;
    out->type = p->type;
    out->flags = p->flags;
    out->key = p->key;
    out->label = p->label;
    out->unit = p->unit;
    out->help = p->help;
    out->min_value = p->min_value;
    out->max_value = p->max_value;
    out->display_min = whole ? p->min_value : p->display_min;
    out->display_max = whole ? p->max_value : p->display_max;
    out->default_value = p->default_value;
    out->step = sva_step(p);
    out->group = p->group ? p->group : "";
    out->depends_on = p->depends_on;
    out->reserved = 0;
    out->depends_values = a->method->depends_values ? a->method->depends_values(p) : p->depends_values;
    return SV_OK;
}

static inline sv_status SV_CALL sva_param_text(const sv_plugin *plugin, uint32_t id, double value, char *out,
                                               uint32_t bytes) {
    const sva *a = (const sva *)plugin->plugin_data;
    const sva_param *p = sva_find(a, id);
    if (!out || bytes == 0) return sva_tell(a, SV_ERR_ARGUMENT, "param_text: no room for text");
    out[0] = '\0';
    if (!p) return sva_tell(a, SV_ERR_PARAM_ID, "param_text: no parameter has id %u", (unsigned)id);
    if (sva_left_out(p, value)) return SV_ERR_PARAM_RANGE; /* a host that asks which values there are */
    if (!sva_value_fits(p, value))
        return sva_tell(a, SV_ERR_PARAM_RANGE, "param_text: %s is %g, expected %g to %g", p->key, value,
                        p->min_value, p->max_value);
    sva_value_text(p, value, out, bytes);
    return SV_OK;
}

static inline const char *SV_CALL sva_last_error(const sv_plugin *plugin) {
    return ((const sva *)plugin->plugin_data)->reason;
}

static inline const void *SV_CALL sva_get_extension(const sv_plugin *plugin, const char *id) {
    const sva *a = (const sva *)plugin->plugin_data;
    return id && a->method->extension ? a->method->extension(a, id) : NULL;
}

SMARTVIS_END_C

#endif
