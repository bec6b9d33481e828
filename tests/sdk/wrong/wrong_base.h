/* SPDX-License-Identifier: MIT */
/*
 * What the wrong plugins are made of: a plugin on the CPU that is right, and WRONG_IS, by which a source asks
 * for which entry of wrong_list.h its library is linked. A source replaces functions of the instance where
 * its entry asks for it, and exports the entry.
 *
 * On every ray the base takes the first edge from fluid to tissue. It takes ranges and padding, can adjust,
 * and has a parameter of every type.
 */
#pragma once

#include "smartvis/author.h"
#include "smartvis/confidence.h"
#include "wrong_list.h"

#include <unistd.h>

#define WRONG_NAME(id, source, check, what) WRONG_##id,
enum { WRONG_nothing, WRONG_LIST(WRONG_NAME) WRONG_COUNT };
/* A source is compiled once. The linker says which of the numbers a library's fault is (CMakeLists.txt). */
#define WRONG_HERE __attribute__((visibility("hidden"))) extern const unsigned char
WRONG_HERE wrong_fault, wrong_faults[WRONG_COUNT];
const unsigned char wrong_faults[WRONG_COUNT] = {WRONG_nothing, WRONG_LIST(WRONG_NAME)};
#define WRONG_IS(id) (wrong_fault == WRONG_##id)

enum { Q = 1, LEVEL, GAP, SIDE, DROP, PARAMS = 5 };

typedef struct {
    uint16_t near, far; /* the fluid's slices are near .. far - 1; far is 0 if the ray has no such edge */
} wrong_edge;

static const char *const wrong_sides[] = {"far", "middle", "near"};

static const sva_param wrong_params[PARAMS] = {
    SVA_PARAM(Q, SV_PARAM_FLOAT, SV_PARAM_PRIMARY | SV_PARAM_ADJUST, "q", "Surface position", "",
              "0: at the fetus; 1: at the tissue before it.", 0.0, 1.0, 0.25, 0.01),
    SVA_PARAM(LEVEL, SV_PARAM_FLOAT, 0, "level", "Fluid level", "", "Darker voxels are fluid.", 0.0, 1.0, 0.2,
              0.01),
    SVA_PARAM(GAP, SV_PARAM_INT, 0, "gap", "Shortest gap", "slices", "Less fluid does not count.", 1.0, 9.0,
              1.0, 1.0),
    {SIDE, SV_PARAM_ENUM, SV_PARAM_REACTIVATE, "side", "Side", "", "The end of the fluid that counts.", 0.0,
     2.0, 0.0, 1.0, 0.0, 0.0, "Surface", wrong_sides, 0, 0},
    {DROP, SV_PARAM_BOOL, SV_PARAM_REACTIVATE, "drop", "Drop the rim", "",
     "Rays of the first column have no surface.", 0.0, 1.0, 0.0, 1.0, 0.0, 0.0, "Surface", NULL, SIDE, 1}};

static inline sv_status wrong_place(sva *a, float *depth) {
    const wrong_edge *edges = (const wrong_edge *)a->rays;
    const float q = (float)sva_value(a, Q), side = 0.5f * (float)sva_value(a, SIDE);
    const int drop = sva_value(a, DROP) != 0.0;
    for (uint32_t i = 0; i < sva_rays(a); i++) {
        const wrong_edge e = edges[i];
        const int none = e.far == 0 || (drop && i % a->format.width == 0);
        depth[i] = none ? SVA_NO_DEPTH : (float)e.far - 0.5f - (q + side) * 0.5f * (float)(e.far - e.near);
        a->points[i] = none ? SV_POINT_NONE : SV_POINT_INITIAL;
    }
    return SV_OK;
}

static inline int wrong_is_scanned(const sva *a, uint32_t x, uint32_t y, uint32_t z, uint8_t voxel) {
    if (WRONG_IS(ignores_ranges)) return voxel != a->padding;
    if (WRONG_IS(ignores_padding_value) && voxel == a->padding) return 1;
    return sva_scanned(a, x, y, z, voxel);
}

static inline sv_status wrong_find(sva *a, float *depth) {
    const float level = (float)(255.0 * sva_value(a, LEVEL));
    const uint32_t gap = (uint32_t)sva_value(a, GAP);
    for (uint32_t i = 0; i < sva_rays(a); i++) {
        const uint32_t x = i % a->format.width, y = i / a->format.width;
        wrong_edge *e = (wrong_edge *)a->rays + i;
        uint32_t fluid = 0;
        for (uint32_t z = 0; z < a->format.slices && e->far == 0; z++) {
            const uint8_t voxel = sva_voxel(a, x, y, z);
            if (!wrong_is_scanned(a, x, y, z, voxel)) continue;
            if ((float)voxel < level) {
                fluid++;
            } else if (fluid >= gap) {
                e->far = (uint16_t)z;
            } else {
                e->near = (uint16_t)(z + 1);
                fluid = 0;
            }
        }
    }
    return wrong_place(a, depth);
}

#define WRONG_FEATURES (SV_FEATURE_SCANNED | SV_FEATURE_PADDING | SV_FEATURE_ADJUST | SV_FEATURE_PROBE)
static const sv_descriptor wrong_descriptor =
    SVA_DESCRIPTOR("org.smartvis.test.wrong", "Wrong", "SmartVis tests", "1.0.0",
                   "A plugin for tests that is wrong in one way at most.", WRONG_FEATURES);
static const sva_method wrong_method = {.descriptor = &wrong_descriptor,
                                        .params = wrong_params,
                                        .param_count = PARAMS,
                                        .ray_bytes = sizeof(wrong_edge),
                                        .finish = wrong_find,
                                        .adjust = wrong_place};

static inline sva *wrong_self(const sv_plugin *plugin) {
    return (sva *)plugin->plugin_data;
}

/* Does what the optimiser must not see through. */
static inline void wrong_crash(void) {
    volatile int *volatile nowhere = NULL;
    *nowhere = 1;
}
static inline void wrong_hang(void) {
    for (volatile int i = 0; i == 0;) (void)usleep(1000);
}

/* The entry of a library whose instances `misbehave` changes after create: void misbehave(sv_plugin *). */
#define WRONG_ENTRY(method, misbehave)                                                                       \
    static const sv_descriptor *wrong_entry_descriptor(uint32_t index) {                                     \
        return index == 0 ? (method).descriptor : NULL;                                                      \
    }                                                                                                        \
    static sv_status wrong_entry_create(const sv_host *host, const char *id, const sv_plugin **out) {        \
        const sv_status status = sva_create(&(method), host, id, out);                                       \
        if (status == SV_OK) misbehave(&wrong_self(*out)->api);                                              \
        return status;                                                                                       \
    }                                                                                                        \
    SV_EXPORT const sv_entry                                                                                 \
        smartvis_plugin_entry = {SV_ABI_MAJOR,           SV_ABI_MINOR,      (uint32_t)sizeof(sv_entry), 1,   \
                                 wrong_entry_descriptor, wrong_entry_create}
