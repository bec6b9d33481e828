/* SPDX-License-Identifier: MIT */
#include "plugin/capabilities.h"

bool hs_plugin_takes(const sv_descriptor *d, hs_handover how) {
    const uint32_t queue = how.own_queue ? SV_QUEUE_OWN : SV_QUEUE_HOST;
    return (d->voxel_types & SV_BIT(SV_VOXEL_U8)) && (d->carriers & SV_BIT(how.carrier)) &&
           (d->queues & queue);
}

bool hs_plugin_choose_handover(const sv_descriptor *d, const char *path, hs_handover wanted, bool insists,
                               hs_handover *out, hs_error *err) {
    const hs_handover ways[] = {wanted, {SV_CARRIER_HOST, false}, {SV_CARRIER_HOST, true}};
    for (size_t i = 0; i < (insists ? 1 : sizeof ways / sizeof *ways); i++) {
        if (!hs_plugin_takes(d, ways[i])) continue;
        *out = ways[i];
        return true;
    }
    return hs_fail(
        err, HS_ERR_PLUGIN,
        "%s: takes no %sslabs of 8 bits%s: its descriptor has carriers 0x%x, voxel_types 0x%x, queues 0x%x",
        path,
        !insists                              ? ""
        : wanted.carrier == SV_CARRIER_HOST   ? "host memory "
        : wanted.carrier == SV_CARRIER_BUFFER ? "OpenCL buffer "
                                              : "OpenCL image ",
        !insists           ? ""
        : wanted.own_queue ? " on a queue of its own"
                           : " on the host's queue",
        d->carriers, d->voxel_types, d->queues);
}

bool hs_plugin_choose_fan(const sv_descriptor *d, const char *path, hs_fan wanted, hs_fan *out,
                          hs_error *err) {
    const bool ranges = d->features & SV_FEATURE_SCANNED;
    if (wanted == HS_FAN_RANGES && !ranges)
        return hs_fail(
            err, HS_ERR_PLUGIN,
            "%s: takes no scanned ranges: its descriptor has features 0x%x, without SV_FEATURE_SCANNED", path,
            d->features);
    *out = wanted;
    if (wanted == HS_FAN_BEST)
        *out = ranges ? HS_FAN_RANGES : d->features & SV_FEATURE_PADDING ? HS_FAN_PADDING : HS_FAN_NOTHING;
    return true;
}

const char *hs_fan_name(hs_fan fan) {
    static const char *const names[] = {"best", "ranges", "padding", "nothing"};
    return names[fan];
}

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
