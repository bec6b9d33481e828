/* SPDX-License-Identifier: MIT */
/*
 * For test_evolution.sh: a plugin that follows the header's rules on growing structs, and computes nothing.
 * Compiled against the header as it is and against one of the next minor with fields appended (GROWN). With
 * NAIVE it reads an appended field without asking SV_HAS: the mistake that the test must be able to see.
 */
#include "smartvis_plugin.h"

#include <string.h>

/* What a struct of version 1.0 must have at least: everything before the first field that came later. */
#ifdef GROWN
#define FIRST_VERSION(type, first_added) ((uint32_t)offsetof(type, first_added))
#else
#define FIRST_VERSION(type, first_added) ((uint32_t)sizeof(type))
#endif

static float gain; /* this plugin is a test's own: one instance, so a global will do */
static uint32_t service;

/* Copies `from`, whose own size is its sizeof, into the host's struct: no further than
 * the host's size, which stays. */
static void fill(void *to, uint32_t to_size, const void *from, uint32_t from_size) {
    const uint32_t bytes = to_size < from_size ? to_size : from_size;
    memcpy((char *)to + sizeof(uint32_t), (const char *)from + sizeof(uint32_t), bytes - sizeof(uint32_t));
}

static sv_status begin(const sv_plugin *plugin, const sv_frame *frame) {
    (void)plugin;
    if (frame->size < SV_FRAME_SIZE_1_0) return SV_ERR_SIZE;
    gain = 2.0f; /* the default of a host that does not know the field */
#ifdef GROWN
#ifdef NAIVE
    gain = frame->added_gain;
#else
    if (SV_HAS(frame, added_gain)) gain = frame->added_gain;
#endif
#endif
    return SV_OK;
}

static sv_status end(const sv_plugin *plugin, const sv_result *result) {
    (void)plugin;
    if (result->stats->size < FIRST_VERSION(sv_stats, added_count)) return SV_ERR_SIZE;
    sv_stats stats = {.size = sizeof(stats), .outcome = SV_OK, .rays = 7, .points = (uint32_t)gain};
#ifdef GROWN
    stats.added_count = 11;
#endif
    fill(result->stats, result->stats->size, &stats, sizeof(stats));
    return SV_OK;
}

static sv_status param_info(const sv_plugin *plugin, uint32_t index, sv_param_info *out) {
    (void)plugin;
    (void)index;
    if (out->size < FIRST_VERSION(sv_param_info, added_group)) return SV_ERR_SIZE;
    sv_param_info info = {
        .size = sizeof(info), .id = 5, .key = "key", .label = "", .unit = "", .help = "", .step = service};
#ifdef GROWN
    info.added_group = "group";
#endif
    fill(out, out->size, &info, sizeof(info));
    return SV_OK;
}

#ifdef GROWN
static uint32_t added_call(const sv_plugin *plugin) {
    (void)plugin;
    return 13;
}
#endif

static void destroy(const sv_plugin *plugin) {
    (void)plugin;
}

static const sv_plugin instance = {
    .size = sizeof(instance),
    .destroy = destroy,
    .begin = begin,
    .end = end,
    .param_info = param_info,
#ifdef GROWN
    .added_call = added_call,
#endif
};

static const sv_descriptor *descriptor(uint32_t index) {
    (void)index;
    return NULL;
}

static sv_status create(const sv_host *host, const char *id, const sv_plugin **out) {
    (void)id;
    *out = NULL;
    if (host->size < FIRST_VERSION(sv_host, added_service)) return SV_ERR_SIZE;
    service = 0;
#ifdef GROWN
    if (SV_HAS(host, added_service)) service = host->added_service(host);
#endif
    *out = &instance;
    return SV_OK;
}

SV_EXPORT const sv_entry smartvis_plugin_entry = {
    .abi_major = SV_ABI_MAJOR,
    .abi_minor = SV_ABI_MINOR,
    .size = sizeof(sv_entry),
    .count = 1,
    .descriptor = descriptor,
    .create = create,
};
