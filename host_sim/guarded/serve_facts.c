/* SPDX-License-Identifier: MIT */
#include "guarded/serve_facts.h"

#include <stdio.h>
#include <string.h>

/* As much of a text as there is room for. NULL and a text without an end are the plugin's faults: the first
 * leaves an empty one, the second may crash, which is what this process is for. */
static void keep(char *out, size_t bytes, const char *text) {
    (void)snprintf(out, bytes, "%s", text ? text : "");
}

static void describe(hs_guard_descriptor *out, const sv_descriptor *d) {
    out->numbers = *d;
    keep(out->id, sizeof out->id, d->id);
    keep(out->name, sizeof out->name, d->name);
    keep(out->vendor, sizeof out->vendor, d->vendor);
    keep(out->version, sizeof out->version, d->version);
    keep(out->summary, sizeof out->summary, d->summary);
    out->extension_count = 0;
    for (uint32_t i = 0; d->extensions && d->extensions[i] && i < HS_GUARD_EXTENSIONS; i++)
        keep(out->extension[out->extension_count++], sizeof out->extension[0], d->extensions[i]);
}

static void describe_param(hs_guard_param *out, const sv_plugin *instance, uint32_t index) {
    sv_param_info info = {.size = sizeof info};
    out->status = instance->param_info(instance, index, &info);
    out->numbers = info;
    out->texts = 0;
    if (out->status != SV_OK) return;
    const char *const texts[] = {info.key, info.label, info.unit, info.help, info.group};
    for (uint32_t i = 0; i < 5; i++) out->texts |= (texts[i] ? 1u : 0u) << i;
    keep(out->key, sizeof out->key, info.key);
    keep(out->label, sizeof out->label, info.label);
    keep(out->unit, sizeof out->unit, info.unit);
    keep(out->help, sizeof out->help, info.help);
    keep(out->group, sizeof out->group, info.group);
}

static uint32_t find_extensions(const sv_plugin *instance) {
    const sv_ext_points *points = instance->get_extension(instance, SV_EXT_POINTS);
    return (hs_plugin_timing(instance) ? HS_GUARD_HAS_TIMING : 0u) |
           (hs_plugin_confidence(instance) ? HS_GUARD_HAS_CONFIDENCE : 0u) |
           (hs_plugin_spline(instance) ? HS_GUARD_HAS_SPLINE : 0u) |
           (points && SV_HAS(points, write) && points->write ? HS_GUARD_HAS_POINTS : 0u);
}

void hs_server_facts(hs_server *server) {
    const hs_plugin *plugin = &server->plugin;
    hs_guard_facts *facts = &server->block->facts;
    facts->abi_major = plugin->abi_major;
    facts->abi_minor = plugin->abi_minor;
    facts->plugin_count = plugin->count;
    facts->chosen = 0;
    hs_server_enter(server, "descriptor", 0, 0);
    for (uint32_t i = 0; i < plugin->count; i++) {
        describe(&facts->plugin[i], plugin->descriptor[i]);
        if (strcmp(plugin->descriptor[i]->id, plugin->instance->descriptor->id) == 0) facts->chosen = i;
    }
    hs_server_enter(server, "param_count", 0, 0);
    facts->param_count = plugin->instance->param_count(plugin->instance);
    for (uint32_t i = 0; i < facts->param_count && i < HS_MAX_PARAMS; i++) {
        hs_server_enter(server, "param_info", i + 1u, facts->param_count);
        describe_param(&facts->param[i], plugin->instance, i);
    }
    hs_server_enter(server, "get_extension", 0, 0);
    facts->extensions = find_extensions(plugin->instance);
}
