/* SPDX-License-Identifier: MIT */
#include "plugin/capabilities.h"

#include <stdio.h>

bool hs_plugin_takes(const sv_descriptor *d, hs_handover how) {
    const uint32_t queue = how.own_queue ? SV_QUEUE_OWN : SV_QUEUE_HOST;
    const bool known = how.carrier >= SV_CARRIER_HOST && how.carrier <= SV_CARRIER_IMAGE;
    return known && (d->voxel_types & SV_BIT(SV_VOXEL_U8)) && (d->carriers & SV_BIT(how.carrier)) &&
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

hs_fan hs_plugin_fan(const sv_descriptor *d) {
    return d->features & SV_FEATURE_SCANNED   ? HS_FAN_RANGES
           : d->features & SV_FEATURE_PADDING ? HS_FAN_PADDING
                                              : HS_FAN_NOTHING;
}

const char *hs_fan_name(hs_fan fan) {
    static const char *const names[] = {"ranges", "padding", "nothing"};
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

const sv_ext_needs *hs_plugin_needs(const sv_plugin *instance) {
    const sv_ext_needs *ext = instance->get_extension(instance, SV_EXT_NEEDS);
    return ext && SV_HAS(ext, of) && ext->of ? ext : NULL;
}

void hs_plugin_points(const sv_plugin *instance, sv_points_report *out) {
    const sv_ext_points *ext = instance->get_extension(instance, SV_EXT_POINTS);
    *out = (sv_points_report){.size = sizeof *out};
    if (!ext || !SV_HAS(ext, write) || !ext->write || ext->write(instance, out) != SV_OK) out->size = 0;
}

hs_doubt hs_plugin_doubt(const sv_plugin *instance) {
    const sv_ext_confidence *ext = hs_plugin_confidence(instance);
    sv_confidence_report r = {.size = sizeof r};
    const bool told = ext && ext->offered(instance) && ext->read(instance, NULL, &r) == SV_OK;
    return told && r.reason != SV_REASON_NONE ? (hs_doubt){r.found, r.wanted} : (hs_doubt){0};
}

bool hs_doubt_words(hs_doubt doubt, char *words, size_t bytes) {
    if (!(doubt.wanted > 0.0f)) return false;
    (void)snprintf(words, bytes,
                   "Clipped although doubtful (%.0f %%, sure from %.0f %%): the fetus may be cut.",
                   100.0 * (double)doubt.found, 100.0 * (double)doubt.wanted);
    return true;
}

bool hs_plugin_reason(const sv_plugin *instance, sv_confidence_report *out, char words[HS_REASON_BYTES]) {
    const sv_ext_confidence *ext = hs_plugin_confidence(instance);
    *out = (sv_confidence_report){.size = sizeof *out};
    return ext && ext->offered(instance) && ext->read(instance, NULL, out) == SV_OK &&
           hs_reason_words(out, words);
}
