/* SPDX-License-Identifier: MIT */
/*
 * For tests/sdk/contract/test_layer_threads.sh, which builds it twice under ThreadSanitizer. With PLUGIN it
 * is a plugin without any state, so that only the layer can race. Else it is a host: layer_threads LAYER.so.
 * Two instances run frames on threads of their own, while a third thread asks both, and a fourth breaks the
 * rule and calls the first instance beside its own thread. It prints how often the layer told of that.
 */
#include "../sdk/support/plain_format.h"

#include <dlfcn.h>
#include <pthread.h>
#include <stdatomic.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

enum { SIDE = 32, RAYS = SIDE * SIDE, SLICES = 8, FRAMES = 300 };

#ifdef PLUGIN
static const char *const extensions[] = {NULL};
static const sv_descriptor about = {.size = sizeof about,
                                    .carriers = SV_BIT(SV_CARRIER_HOST),
                                    .id = "org.smartvis.test.stateless",
                                    .name = "Stateless",
                                    .vendor = "SmartVis tests",
                                    .version = "1",
                                    .summary = "A map of zeros.",
                                    .voxel_types = SV_BIT(SV_VOXEL_U8),
                                    .queues = SV_QUEUE_OWN,
                                    .extensions = extensions};

static void nothing(const sv_plugin *p) {}
static sv_status activate(const sv_plugin *p, const sv_format *f) {
    return p && f ? SV_OK : SV_ERR_ARGUMENT;
}
static sv_status begin(const sv_plugin *p, const sv_frame *f) {
    return p && f ? SV_OK : SV_ERR_ARGUMENT;
}
static sv_status slab(const sv_plugin *p, const sv_slab *s) {
    (void)usleep(20);
    return p && s ? SV_OK : SV_ERR_ARGUMENT;
}
static sv_status end(const sv_plugin *p, const sv_result *r) {
    if (!p || !r) return SV_ERR_ARGUMENT;
    memset(r->depth, 0, RAYS * sizeof *r->depth);
    return SV_OK;
}
static sv_status adjust(const sv_plugin *p, const sv_param_value *v, uint32_t n, const sv_result *r) {
    return p && r ? SV_OK : SV_ERR_ARGUMENT;
}
static uint32_t count(const sv_plugin *p) {
    return 0;
}
static sv_status info(const sv_plugin *p, uint32_t index, sv_param_info *out) {
    return p && index == 0 && out ? SV_ERR_ARGUMENT : SV_ERR_ARGUMENT;
}
static sv_status text(const sv_plugin *p, uint32_t id, double value, char *out, uint32_t bytes) {
    return snprintf(out, bytes, "%g", value) > 0 ? SV_OK : SV_ERR_ARGUMENT;
}
static const char *last_error(const sv_plugin *p) {
    return "";
}
static const void *extension(const sv_plugin *p, const char *id) {
    return NULL;
}
static const sv_plugin instance = {sizeof instance, 0,        &about, NULL,   nothing, activate, nothing,
                                   begin,           slab,     end,    adjust, count,   info,     text,
                                   last_error,      extension};
static sv_status create(const sv_host *host, const char *id, const sv_plugin **out) {
    *out = host && id ? &instance : NULL;
    return *out ? SV_OK : SV_ERR_ARGUMENT;
}
static const sv_descriptor *descriptor(uint32_t index) {
    return index ? NULL : &about;
}
SV_EXPORT const sv_entry smartvis_plugin_entry = {SV_ABI_MAJOR, SV_ABI_MINOR, sizeof(sv_entry), 1,
                                                  descriptor,   create};
#else

static atomic_uint told, frames_done;

static void count_lines(const sv_host *host, int32_t severity, const char *line) {
    if (severity == SV_LOG_HOST_MISBEHAVING && strstr(line, "host-threads")) atomic_fetch_add(&told, 1);
}

static const uint8_t volume[SLICES * RAYS];

/* NOLINTNEXTLINE(readability-non-const-parameter) */
static void frames(const sv_plugin *p, float *depth, uint32_t count) {
    const sv_format format = plain_format(SIDE, SIDE, SLICES, 1);
    const sv_slab slab = {
        .size = sizeof slab, .slice_count = SLICES, .memory = volume, .bytes = sizeof volume};
    const sv_result result = {.size = sizeof result, .depth = depth};
    (void)p->activate(p, &format);
    for (uint32_t n = 0; n < count; n++) {
        const sv_frame frame = {.size = sizeof frame, .index = n};
        if (p->begin(p, &frame) == SV_OK && p->slab(p, &slab) == SV_OK && p->end(p, &result) == SV_OK)
            atomic_fetch_add(&frames_done, 1);
    }
    p->deactivate(p);
}

static void *run(void *context) {
    static float depth[2][RAYS];
    static atomic_uint turn;
    frames(context, depth[atomic_fetch_add(&turn, 1) % 2], FRAMES);
    return NULL;
}

static void *ask(void *context) {
    const sv_plugin *const *both = context;
    char text[32];
    for (int n = 0; n < 4 * FRAMES; n++) {
        const sv_plugin *p = both[n % 2];
        (void)p->param_count(p);
        (void)p->param_text(p, 1, n, text, sizeof text);
        (void)p->get_extension(p, "smartvis.confidence/1");
    }
    return NULL;
}

static void *disturb(void *context) {
    const sv_plugin *p = context;
    const sv_frame frame = {.size = sizeof frame};
    for (int n = 0; n < 4 * FRAMES; n++) {
        (void)p->begin(p, &frame);
        (void)usleep(10);
    }
    return NULL;
}

int main(int argc, char **argv) {
    void *library = argc == 2 ? dlopen(argv[1], RTLD_NOW | RTLD_LOCAL) : NULL;
    const sv_entry *entry = library ? dlsym(library, SV_ENTRY_SYMBOL) : NULL;
    const sv_host host = {sizeof host, SV_ABI_MINOR, NULL, "layer_threads", "1", count_lines, NULL};
    const sv_plugin *p[2] = {NULL, NULL};
    if (!entry) return fprintf(stderr, "%s\n", argc == 2 ? dlerror() : "usage: layer_threads LAYER.so"), 2;
    for (int n = 0; n < 2; n++)
        if (entry->create(&host, entry->descriptor(0)->id, &p[n]) != SV_OK) return 4;
    pthread_t thread[4];
    const struct {
        void *(*work)(void *);
        const void *context;
    } jobs[4] = {{run, p[0]}, {run, p[1]}, {ask, (const void *)p}, {disturb, p[0]}};
    for (int n = 0; n < 4; n++)
        (void)pthread_create(&thread[n], NULL, jobs[n].work, (void *)(uintptr_t)jobs[n].context);
    for (int n = 0; n < 4; n++) (void)pthread_join(thread[n], NULL);
    for (int n = 0; n < 2; n++) p[n]->destroy(p[n]);
    printf("%u frames, told %u times\n", atomic_load(&frames_done), atomic_load(&told));
    return atomic_load(&told) > 0 && atomic_load(&frames_done) > FRAMES ? 0 : 1;
}
#endif
