/* SPDX-License-Identifier: MIT */
#include "validate/drive/drive_params.h"

#include <math.h>

static bool is_usable(const sv_param_info *i) {
    return i->id != 0 && i->key && i->label && i->unit && i->help && i->type <= SV_PARAM_ENUM &&
           isfinite(i->min_value) && isfinite(i->max_value) && isfinite(i->default_value) &&
           i->min_value <= i->default_value && i->default_value <= i->max_value &&
           (i->type == SV_PARAM_FLOAT || i->step > 0.0);
}

void v_params_read(v_subject *s, v_params *params) {
    v_where(s->run, "param_count");
    const uint32_t count = s->plugin->param_count(s->plugin);
    params->count = 0;
    for (uint32_t i = 0; i < count && i < V_MAX_PARAMS; i++) {
        sv_param_info info = {.size = sizeof info};
        v_where(s->run, "param_info(%u)", i);
        if (s->plugin->param_info(s->plugin, i, &info) != SV_OK || !is_usable(&info)) continue;
        params->info[params->count++] = info;
    }
}

double v_param_step(const sv_param_info *info) {
    return info->type == SV_PARAM_FLOAT ? 0.0 : info->step;
}

uint32_t v_param_values(const sv_param_info *info) {
    if (info->type == SV_PARAM_FLOAT) return 0;
    const double count = floor((info->max_value - info->min_value) / info->step + 0.5) + 1.0;
    return count >= 1.0 && count <= 1e6 ? (uint32_t)count : 0;
}

double v_param_random(v_run *run, const sv_param_info *info) {
    const uint32_t values = v_param_values(info), turn = v_random(run, 8);
    if (turn == 0) return info->min_value;
    if (values > 0) return info->min_value + info->step * v_random(run, values);
    if (turn == 1) return info->max_value;
    return info->min_value + (info->max_value - info->min_value) * v_random_unit(run);
}

double v_param_other(const sv_param_info *info) {
    const uint32_t values = v_param_values(info);
    const double last = values > 0 ? info->min_value + info->step * (values - 1) : info->max_value;
    return info->default_value == info->min_value ? last : info->min_value;
}
