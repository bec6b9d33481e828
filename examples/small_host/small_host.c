/* SPDX-License-Identifier: MIT */
/* A whole host: loads a plugin, asks it for the surface of a small volume, and prints where a renderer would
 * start its rays. The volume is a skin, a wavy gap of fluid and a fetus. Usage: small_host PLUGIN.so */
#include "smartvis/open.h"
#include "smartvis_plugin.h"

#include <stdio.h>

enum { SIDE = 64, SLICES = 64, SLAB = 16, RAYS = SIDE * SIDE, SKIN = 100, FLUID = 10, FETUS = 200 };

static uint8_t volume[SLICES][RAYS]; /* one tile a row: a slab is SLAB slices one after the other */
static sv_scanned scanned[RAYS];
static float depthmap[RAYS];

static void make_volume(void) {
    for (uint32_t i = 0; i < RAYS; i++) {
        const uint32_t x = i % SIDE, near = 8 + x / 16, far = near + 20 + (x / 8 + i / SIDE / 8) % 4;
        for (uint32_t z = 0; z < SLICES; z++) volume[z][i] = z < near ? SKIN : z < far ? FLUID : FETUS;
        scanned[i] = (sv_scanned){0, SLICES - 4}; /* the fan ends before the volume does */
    }
}

static void print_log(const sv_host *host, int32_t severity, const char *text) {
    (void)host;
    if (severity >= SV_LOG_WARNING) fprintf(stderr, "plugin: %s\n", text);
}

/* One volume, front to back, with every parameter at its default. */
static sv_status one_frame(const sv_plugin *p, int ranges) {
    sv_frame frame = {.size = sizeof frame, .index = 1, .scanned = ranges ? scanned : NULL};
    sv_status status = p->begin(p, &frame);
    for (uint32_t z = 0; z < SLICES && status >= SV_OK; z += SLAB) {
        const sv_slab slab = {.size = sizeof slab,
                              .first_slice = z,
                              .slice_count = SLAB,
                              .memory = volume[z],
                              .bytes = sizeof volume[0] * SLAB};
        status = p->slab(p, &slab);
    }
    const sv_result result = {.size = sizeof result, .depth = depthmap};
    return status >= SV_OK ? p->end(p, &result) : status;
}

static sv_status run(const sv_plugin *p) {
    make_volume();
    const int ranges = (p->descriptor->features & SV_FEATURE_SCANNED) != 0;
    const sv_format format = {.size = sizeof format,
                              .width = SIDE,
                              .height = SIDE,
                              .slices = SLICES,
                              .max_slab_slices = SLAB,
                              .voxel_type = SV_VOXEL_U8,
                              .carrier = SV_CARRIER_HOST,
                              .padding_value = SV_NO_PADDING,
                              .tiles_x = 1,
                              .tile_w = SIDE,
                              .tile_h = SIDE,
                              .row_pitch = SIDE,
                              .spacing_mm = {1, 1, 1},
                              .flags = ranges ? SV_FORMAT_SCANNED : 0};
    sv_status status = p->activate(p, &format);
    if (status < SV_OK) return status;
    status = one_frame(p, ranges);
    if (status != SV_OK) printf("%s\n", p->last_error(p));
    p->deactivate(p);
    return status;
}

int main(int argc, char **argv) {
    char why[256] = "usage: small_host FOLDER/PLUGIN.so";
    const sv_entry *entry = argc == 2 ? sv_open(argv[1], NULL, why, sizeof why) : NULL;
    if (!entry) return fprintf(stderr, "%s\n", why), 2;
    if (entry->abi_major != SV_ABI_MAJOR) return fprintf(stderr, "another ABI: %u\n", entry->abi_major), 4;
    const sv_descriptor *d = entry->descriptor(0); /* says before what activate would refuse */
    if (!(d->queues & SV_QUEUE_OWN) || !(d->voxel_types & SV_BIT(SV_VOXEL_U8)))
        return fprintf(stderr, "%s needs the host's queue or other voxels\n", d->id), 4;
    const sv_host host = {sizeof host, SV_ABI_MINOR, NULL, "small_host", "1", print_log, NULL};
    const sv_plugin *p = NULL;
    sv_status status = entry->create(&host, d->id, &p);
    if (status == SV_OK) {
        status = run(p);
        p->destroy(p);
    }
    const int clip = status == SV_OK || status == SV_PARTIAL; /* else unclipped, never with an old map */
    printf("%s: status %d, rendered %s\n", d->id, (int)status, clip ? "with the map" : "unclipped");
    for (uint32_t i = 0; i < RAYS; i++)
        if (i % 8 == 4 && i / SIDE % 8 == 4)
            printf("%5.1f%c", clip ? (double)depthmap[i] : 0.0, i % SIDE > SIDE - 8 ? '\n' : ' ');
    return status < 0 ? 4 : 0; /* the library stays loaded until the process ends */
}
