/* SPDX-License-Identifier: MIT */
/* The checking layer around a plugin, and a host that plays what a test tells it. */
#pragma once

#include "opencl/host_cl.h"
#include "smartvis_plugin.h"

#include <CL/cl.h>

enum { W = 24, H = 20, SLICES = 24, SLAB = 8, SLABS = 3, RAYS = W * H };

typedef struct {
    void *library;
    const sv_entry *entry;
    sv_host host;
    const sv_plugin *p; /* NULL if create failed */
    sv_status created;
    sv_format format;
    uint8_t volume[SLICES][RAYS];
    sv_scanned ranges[RAYS];
    float depth[RAYS];
    uint8_t status[RAYS];
    sv_stats stats;
    sv_frame frame; /* as begin is given it */
    hs_cl cl;       /* with the host's queue only */
    cl_mem objects[SLABS], map;
    void (*on_log)(void *subject); /* once */
    char log[1 << 16];
} layer_subject;

/* SV_BUILD_DIR. Fails the test if it is not set. */
const char *layer_build(void);

/* Loads FOLDER/smartvis_check.so, with a volume of skin, fluid and fetus, its format, and a host; without an
 * instance yet. */
layer_subject *layer_load(const char *folder);

/* The same of the build folder, around <build>/<plugin>.so. */
layer_subject *layer_open(const char *plugin);
void layer_create(layer_subject *s);
void layer_close(layer_subject *s);

/* Before create: slabs in buffers, and the host's queue. */
void layer_take_queue(layer_subject *s);

/* Single calls, and begin, all slabs and end. end waits for the host's queue. */
sv_status layer_activate(layer_subject *s);
sv_status layer_begin(layer_subject *s);
sv_status layer_slab(layer_subject *s, uint32_t n);
sv_status layer_end(layer_subject *s);
sv_status layer_frame(layer_subject *s);
sv_slab layer_slab_of(const layer_subject *s, uint32_t n);
sv_result layer_result_of(layer_subject *s);

/* Activates, begins, and gives `count` slabs. */
void layer_start(layer_subject *s, uint32_t count);

/* What a host does that is right: frames, an adjust, a confidence, parameters. */
void layer_use(layer_subject *s);
