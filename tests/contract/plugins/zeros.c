/* SPDX-License-Identifier: MIT */
/* A whole plugin whose depthmap is always zero: it clips nothing, so an evaluation must find exactly the
 * errors of the unclipped volume. It has no parameter at all. */
#include "smartvis_plugin.h"

#include <CL/cl.h>
#include <stdlib.h>
#include <string.h>

typedef struct {
    sv_plugin api;
    sv_format format;
} zeros;

static const sv_descriptor descriptor = {.size = sizeof(sv_descriptor),
                                         .id = "org.smartvis.test.zeros",
                                         .name = "Zeros",
                                         .vendor = "SmartVis tests",
                                         .version = "1.0.0",
                                         .summary = "A map of zeros, whatever the volume holds."};

static const float nothing = 0.0f;

static void zeros_destroy(const sv_plugin *plugin) {
    free(plugin->plugin_data);
}

static sv_status zeros_activate(const sv_plugin *plugin, const sv_format *format) {
    zeros *z = plugin->plugin_data;
    z->format = *format;
    return format->queue ? SV_OK : SV_ERR_FORMAT;
}

static void zeros_deactivate(const sv_plugin *plugin) {
    (void)plugin;
}

static sv_status zeros_begin(const sv_plugin *plugin, const sv_frame *frame) {
    (void)plugin;
    return frame->value_count == 0 ? SV_OK : SV_ERR_PARAM_ID;
}

static sv_status zeros_slab(const sv_plugin *plugin, const sv_slab *slab) {
    (void)plugin;
    (void)slab;
    return SV_OK;
}

static sv_status zeros_end(const sv_plugin *plugin, const sv_result *result) {
    zeros *z = plugin->plugin_data;
    const uint32_t rays = z->format.width * z->format.height;
    if (result->status) memset(result->status, SV_POINT_NONE, rays);
    if (result->stats) {
        const uint32_t size = result->stats->size;
        const sv_stats stats = {.size = size, .outcome = SV_OK, .rays = rays};
        memcpy(result->stats, &stats, size < sizeof stats ? size : sizeof stats);
    }
    if (!result->depth_object) return SV_ERR_ARGUMENT;
    return clEnqueueFillBuffer(z->format.queue, result->depth_object, &nothing, sizeof nothing,
                               result->depth_offset, rays * sizeof(float), 0, NULL, NULL) == CL_SUCCESS
               ? SV_OK
               : SV_ERR_OPENCL;
}

static sv_status zeros_adjust(const sv_plugin *plugin, const sv_param_value *values, uint32_t count,
                              const sv_result *result) {
    (void)values;
    return count == 0 ? zeros_end(plugin, result) : SV_ERR_PARAM_ID;
}

static uint32_t zeros_param_count(const sv_plugin *plugin) {
    (void)plugin;
    return 0;
}

static sv_status zeros_param_info(const sv_plugin *plugin, uint32_t index, sv_param_info *out) {
    (void)plugin;
    (void)index;
    (void)out;
    return SV_ERR_ARGUMENT;
}

static sv_status zeros_param_text(const sv_plugin *plugin, uint32_t id, double value, char *out,
                                  uint32_t bytes) {
    (void)plugin;
    (void)id;
    (void)value;
    if (bytes) out[0] = '\0';
    return SV_ERR_PARAM_ID;
}

static const char *zeros_last_error(const sv_plugin *plugin) {
    (void)plugin;
    return "";
}

static const void *zeros_get_extension(const sv_plugin *plugin, const char *id) {
    (void)plugin;
    (void)id;
    return NULL;
}

static const sv_descriptor *zeros_descriptor(uint32_t index) {
    return index == 0 ? &descriptor : NULL;
}

static sv_status zeros_create(const sv_host *host, const char *id, const sv_plugin **out) {
    (void)host;
    *out = NULL;
    if (strcmp(id, descriptor.id) != 0) return SV_ERR_UNKNOWN_ID;
    zeros *z = calloc(1, sizeof *z);
    if (!z) return SV_ERR_NO_MEMORY;
    z->api = (sv_plugin){.size = sizeof(sv_plugin),
                         .descriptor = &descriptor,
                         .plugin_data = z,
                         .destroy = zeros_destroy,
                         .activate = zeros_activate,
                         .deactivate = zeros_deactivate,
                         .begin = zeros_begin,
                         .slab = zeros_slab,
                         .end = zeros_end,
                         .adjust = zeros_adjust,
                         .param_count = zeros_param_count,
                         .param_info = zeros_param_info,
                         .param_text = zeros_param_text,
                         .last_error = zeros_last_error,
                         .get_extension = zeros_get_extension};
    *out = &z->api;
    return SV_OK;
}

SV_EXPORT const sv_entry smartvis_plugin_entry = {.abi_major = SV_ABI_MAJOR,
                                                  .abi_minor = SV_ABI_MINOR,
                                                  .size = sizeof(sv_entry),
                                                  .count = 1,
                                                  .descriptor = zeros_descriptor,
                                                  .create = zeros_create};
