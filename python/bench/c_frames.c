/* SPDX-License-Identifier: MIT */
/* The calls of a frame in C, as smartvis.Clipper makes them: c_frames PLUGIN SIDE FRAMES prints the least
 * milliseconds of a frame. The volume is a skin, fluid and a fetus; all parameters keep their defaults. */
#include "smartvis/confidence.h"
#include "smartvis/points.h"
#include "smartvis_plugin.h"

#include <dlfcn.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

typedef struct {
    const sv_plugin *plugin;
    const sv_ext_points *points;
    const sv_ext_confidence *confidence;
    uint32_t side;
    unsigned char *volume, *status;
    float *depth, *confidence_map;
} host;

static double now_ms(void) {
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return 1e3 * (double)t.tv_sec + 1e-6 * (double)t.tv_nsec;
}

static int frame(host *h, uint64_t index) {
    const sv_plugin *p = h->plugin;
    const size_t bytes = (size_t)h->side * h->side * h->side;
    sv_stats stats = {.size = sizeof stats};
    const sv_frame begin = {.size = sizeof begin, .index = index};
    const sv_slab slab = {.size = sizeof slab, .slice_count = h->side, .memory = h->volume, .bytes = bytes};
    const sv_result result = {.size = sizeof result, .depth = h->depth, .status = h->status, .stats = &stats};
    if (p->begin(p, &begin) != SV_OK || p->slab(p, &slab) != SV_OK || p->end(p, &result) < SV_OK) return 0;
    if (h->confidence) {
        sv_confidence_report report = {.size = sizeof report};
        return h->confidence->read(p, h->confidence_map, &report) == SV_OK;
    }
    sv_points_report report = {.size = sizeof report};
    return !h->points || h->points->write(p, &report) == SV_OK;
}

static int activate(host *h) {
    const sv_format format = {.size = sizeof format,
                              .width = h->side,
                              .height = h->side,
                              .slices = h->side,
                              .max_slab_slices = h->side,
                              .voxel_type = SV_VOXEL_U8,
                              .carrier = SV_CARRIER_HOST,
                              .padding_value = SV_NO_PADDING,
                              .tiles_x = 1,
                              .tile_w = h->side,
                              .tile_h = h->side,
                              .row_pitch = h->side,
                              .spacing_mm = {1, 1, 1}};
    if (h->plugin->activate(h->plugin, &format) != SV_OK) return 0;
    h->points = h->plugin->get_extension(h->plugin, SV_EXT_POINTS);
    h->confidence = h->plugin->get_extension(h->plugin, SV_EXT_CONFIDENCE);
    if (h->confidence && !h->confidence->offered(h->plugin)) h->confidence = NULL;
    return 1;
}

int main(int argc, char **argv) {
    if (argc != 4) return fprintf(stderr, "usage: c_frames PLUGIN SIDE FRAMES\n"), 2;
    void *library = dlopen(argv[1], RTLD_NOW | RTLD_LOCAL);
    const sv_entry *entry = library ? dlsym(library, SV_ENTRY_SYMBOL) : NULL;
    host h = {.side = (uint32_t)atoi(argv[2])};
    const size_t rays = (size_t)h.side * h.side;
    const sv_host offered = {sizeof offered, SV_ABI_MINOR, NULL, "c_frames", "1", NULL, NULL};
    h.volume = malloc(rays * h.side);
    h.status = malloc(rays);
    h.depth = malloc(rays * sizeof *h.depth);
    h.confidence_map = malloc(rays * sizeof *h.confidence_map);
    if (!entry || !h.volume || !h.status || !h.depth || !h.confidence_map) return 3;
    for (uint32_t z = 0; z < h.side; z++)
        memset(h.volume + z * rays, z < h.side / 5 ? 100 : z < 3 * h.side / 5 ? 10 : 200, rays);
    if (entry->create(&offered, entry->descriptor(0)->id, &h.plugin) != SV_OK || !activate(&h)) return 4;
    double fastest = 1e9;
    for (int i = 0; i < atoi(argv[3]); i++) {
        const double start = now_ms();
        if (!frame(&h, (uint64_t)i)) return 4;
        const double passed = now_ms() - start;
        if (i > 2 && passed < fastest) fastest = passed;
    }
    printf("%.4f\n", fastest);
    h.plugin->deactivate(h.plugin);
    h.plugin->destroy(h.plugin);
    return 0;
}
