/* SPDX-License-Identifier: MIT */
/* A plugin of the host's own that gives out a map which was made elsewhere, whatever the volume is. */
#include "plugin/loader.h"
#include "smartvis/author.h"

#include <stdio.h>

static sv_status check_size(sva *a) {
    const hs_given_map *map = a->host->host_data;
    if (a->format.width == map->width && a->format.height == map->height) return SV_OK;
    return sva_error(a, SV_ERR_FORMAT, "the map has %u x %u pixels, the frame %u x %u", map->width,
                     map->height, a->format.width, a->format.height);
}

/* The front of the volume is half a slice before the middle of the first one, where depths are 0. */
static sv_status give(sva *a, float *depth) {
    const hs_given_map *map = a->host->host_data;
    for (size_t i = 0; i < sva_rays(a); i++)
        depth[i] = map->mm[i] > 0.0f ? map->mm[i] / a->format.spacing_mm[2] - 0.5f : 0.0f;
    return SV_OK;
}

static const sv_descriptor descriptor = SVA_DESCRIPTOR("org.smartvis.map", "A given map", "SmartVis", "1.0.0",
                                                       "Gives out a map that was made elsewhere.", 0);
static const sva_method method = {.descriptor = &descriptor, .activate = check_size, .finish = give};

bool hs_plugin_open_map(hs_plugin *plugin, const hs_given_map *map, hs_error *err) {
    *plugin = (hs_plugin){
        .abi_major = SV_ABI_MAJOR,
        .abi_minor = SV_ABI_MINOR,
        .descriptor = {&descriptor},
        .count = 1,
        .host = {.size = sizeof(sv_host), .abi_minor = SV_ABI_MINOR, .host_data = (void *)(uintptr_t)map}};
    (void)snprintf(plugin->path, sizeof plugin->path, "a given map");
    if (sva_create(&method, &plugin->host, descriptor.id, &plugin->instance) == SV_OK) return true;
    *plugin = (hs_plugin){0};
    return hs_fail(err, HS_ERR_MEMORY, "a given map: no memory");
}
