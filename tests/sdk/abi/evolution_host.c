/* SPDX-License-Identifier: MIT */
/*
 * For test_evolution.sh: a host that uses every struct that grew in the next minor's header, if it was
 * compiled against it (GROWN). Each struct lies in an allocation of exactly its size, so that
 * AddressSanitizer sees one byte read or written too far. evolution_host PLUGIN [STRUCT]: prints what it got;
 * with STRUCT it shortens that struct below its first version and prints the status.
 */
#include "smartvis_plugin.h"

#include <dlfcn.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const char *shortened = "";

/* A zeroed struct of `bytes` bytes with its size field set. A shortened one lacks its
 * last four bytes of version 1.0. */
static void *make(const char *name, size_t bytes, size_t first_version) {
    if (strcmp(shortened, name) == 0) bytes = first_version - 4;
    uint32_t *object = calloc(1, bytes);
    if (!object) exit(2);
    *object = (uint32_t)bytes;
    return object;
}

#ifdef GROWN
#define MAKE(type, first_added) make(#type, sizeof(type), offsetof(type, first_added))
static uint32_t added_service(const sv_host *host) {
    (void)host;
    return 17;
}
#else
#define MAKE(type, first_added) make(#type, sizeof(type), sizeof(type))
#endif

static void use(const sv_entry *entry) {
    sv_host *host = MAKE(sv_host, added_service);
    sv_frame *frame = make("sv_frame", sizeof *frame, SV_FRAME_SIZE_1_0);
    sv_stats *stats = MAKE(sv_stats, added_count);
    sv_param_info *info = MAKE(sv_param_info, added_group);
    const sv_plugin *plugin = NULL;
#ifdef GROWN
    if (SV_HAS(host, added_service)) host->added_service = added_service;
    if (SV_HAS(frame, added_gain)) frame->added_gain = 3.0f;
#endif
    const sv_status created = entry->create(host, "", &plugin);
    if (created != SV_OK) {
        printf("create %d\n", (int)created);
    } else {
        const sv_result result = {.size = sizeof(result), .stats = stats};
        const sv_status begun = plugin->begin(plugin, frame);
        const sv_status ended = plugin->end(plugin, &result);
        const sv_status described = plugin->param_info(plugin, 0, info);
        printf("status %d %d %d", (int)begun, (int)ended, (int)described);
        if (begun == SV_OK && ended == SV_OK && described == SV_OK) {
            printf(" gain %u rays %u id %u service %.0f", stats->points, stats->rays, info->id, info->step);
#ifdef GROWN
            printf(" count %u group %s call %u", stats->added_count,
                   info->added_group ? info->added_group : "none",
                   SV_HAS(plugin, added_call) ? plugin->added_call(plugin) : 0);
#endif
        }
        puts("");
        plugin->destroy(plugin);
    }
    free(host);
    free(frame);
    free(stats);
    free(info);
}

int main(int argc, char **argv) {
    if (argc < 2) return 2;
    if (argc > 2) shortened = argv[2];
    void *library = dlopen(argv[1], RTLD_NOW | RTLD_LOCAL);
    const sv_entry *entry = library ? dlsym(library, SV_ENTRY_SYMBOL) : NULL;
    if (!entry || entry->abi_major != SV_ABI_MAJOR) {
        fprintf(stderr, "%s: %s\n", argv[1], library ? "another ABI" : dlerror());
        return 2;
    }
    use(entry);
    dlclose(library);
    return 0;
}
