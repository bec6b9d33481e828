/* SPDX-License-Identifier: MIT */
#include "loop/confidence_map.h"

#include "loop/map_check.h"
#include "plugin/capabilities.h"
#include "render/host_kernels.h"

#include <stdlib.h>

struct hs_confidence_map {
    const hs_cl *cl;
    const hs_plugin *plugin;
    const sv_ext_confidence *ext; /* NULL: the plugin gives none */
    bool own_queue, asked;
    uint32_t width, height;
    size_t pixels;
    cl_mem values;      /* device, float32: for the renderer */
    float *host_values; /* own queue: where the plugin writes */
    hs_map_check check; /* of values that are no confidence */
    hs_error error;
};

static const sv_ext_confidence *find_extension(const hs_plugin *plugin) {
    if (!plugin) return NULL;
    const sv_ext_confidence *ext = hs_plugin_confidence(plugin->instance);
    return ext && ext->offered(plugin->instance) ? ext : NULL;
}

static bool create_memory(hs_confidence_map *map, hs_error *err) {
    if (!hs_cl_take_buffer(map->cl, map->pixels * sizeof(float), "confidence", &map->values, err) ||
        !hs_map_check_create(&map->check, map->cl, map->width, map->height, err))
        return false;
    map->host_values = calloc(map->pixels, sizeof(float));
    return map->host_values ||
           hs_fail(err, HS_ERR_MEMORY, "confidence: no memory for %zu pixels", map->pixels);
}

hs_confidence_map *hs_confidence_map_create(const hs_cl *cl, const hs_plugin *plugin, uint32_t width,
                                            uint32_t height, bool own_queue, hs_error *err) {
    hs_confidence_map *map = hs_memory(1, sizeof *map, "confidence", err);
    if (!map) return NULL;
    map->cl = cl;
    map->plugin = plugin;
    map->ext = find_extension(plugin);
    map->own_queue = own_queue;
    map->width = width;
    map->height = height;
    map->pixels = (size_t)width * height;
    if (!map->ext || create_memory(map, err)) return map;
    hs_confidence_map_destroy(map);
    return NULL;
}

void hs_confidence_map_destroy(hs_confidence_map *map) {
    if (!map) return;
    hs_map_check_destroy(&map->check);
    if (map->values) clReleaseMemObject(map->values);
    free(map->host_values);
    free(map);
}

bool hs_confidence_map_ask(hs_confidence_map *map, bool wanted, hs_error *err) {
    map->asked = false;
    if (!wanted || !map->ext) return true;
    const sv_plugin *instance = map->plugin->instance;
    const sv_status status = map->ext->write(instance, map->own_queue ? map->host_values : NULL,
                                             map->own_queue ? NULL : map->values, 0);
    if (status != SV_OK) {
        const char *reason = instance->last_error(instance);
        (void)hs_fail(&map->error, HS_ERR_PLUGIN, "%s: confidence: %s (%d): %s", map->plugin->path,
                      hs_status_name(status), status,
                      reason && reason[0] ? reason : "the plugin gave no reason");
        return true;
    }
    if (map->own_queue) {
        const cl_int code =
            clEnqueueWriteBuffer(map->cl->queue, map->values, CL_FALSE, 0, map->pixels * sizeof(float),
                                 map->host_values, 0, NULL, NULL);
        if (!hs_cl_check(code, "clEnqueueWriteBuffer (confidence)", err)) return false;
    }
    map->asked = hs_map_check_enqueue(&map->check, map->values, 0.0f, 1.0f, err);
    return map->asked;
}

bool hs_confidence_map_settle(hs_confidence_map *map) {
    if (!map->asked || map->check.count == 0) return map->asked;
    return hs_fail(&map->error, HS_ERR_PLUGIN, "%s: confidence: %d of %zu values are not in 0 .. 1",
                   map->plugin->path, (int)map->check.count, map->pixels);
}

cl_mem hs_confidence_map_values(const hs_confidence_map *map) {
    return map->values;
}

const hs_error *hs_confidence_map_error(const hs_confidence_map *map) {
    return &map->error;
}
