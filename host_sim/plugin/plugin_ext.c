/* SPDX-License-Identifier: MIT */
#include "plugin/plugin_ext.h"

const sv_ext_timing *hs_plugin_timing(const sv_plugin *instance) {
    const sv_ext_timing *ext = instance->get_extension(instance, SV_EXT_TIMING);
    return ext && SV_HAS(ext, stage_times) && ext->enable && ext->stage_times ? ext : NULL;
}

const sv_ext_confidence *hs_plugin_confidence(const sv_plugin *instance) {
    const sv_ext_confidence *ext = instance->get_extension(instance, SV_EXT_CONFIDENCE);
    return ext && SV_HAS(ext, write) && ext->read && ext->offered && ext->write ? ext : NULL;
}

const sv_ext_spline *hs_plugin_spline(const sv_plugin *instance) {
    const sv_ext_spline *ext = instance->get_extension(instance, SV_EXT_SPLINE);
    return ext && SV_HAS(ext, report) && ext->report ? ext : NULL;
}

void hs_plugin_points(const sv_plugin *instance, sv_points_report *out) {
    const sv_ext_points *ext = instance->get_extension(instance, SV_EXT_POINTS);
    *out = (sv_points_report){.size = sizeof *out};
    if (!ext || !SV_HAS(ext, write) || !ext->write || ext->write(instance, out) != SV_OK) out->size = 0;
}
