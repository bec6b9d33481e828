/* SPDX-License-Identifier: MIT */
/* What a plugin under test should give: frames by the scalar definition, and volumes to try it on. */
#ifndef SV_RIG_EXPECT_H
#define SV_RIG_EXPECT_H

#include "ref/ref_mean.h"
#include "ref/ref_points.h"
#include "smartvis_plugin.h"

typedef struct {
    double fluid_threshold, omega;
    sv_ref_bone bone;
    uint32_t k, substeps;
    bool half; /* precision int16; also a parameter of activate */
    float q;
    double evidence, min_gap; /* the default here is 0: a surface however little speaks for a gap */
} rig_settings;
rig_settings rig_default_settings(void);

typedef struct {
    uint8_t *status;
    float *depth;         /* fixed point: what the kernels must give to the bit */
    double *depth_double; /* float64 definition */
    uint32_t points, empty_points, sure_points, level, maximum;
    sv_ref_fill fill;
    sv_status outcome;
    sv_fixed format;
} rig_expected;
/* The same frame by the scalar definition: fixed point, and float64 if `with_double` is true.
 * Arrays of width * height; rig_expected_free them. */
rig_expected rig_expect(const sv_ref_volume *volume, const rig_settings *settings, bool with_double);
void rig_expected_free(rig_expected *e);

/* A seeded volume of the given kind. */
typedef enum {
    RIG_NOISE,    /* any value anywhere */
    RIG_EXTREMES, /* values at 0, 255 and within one level of T_L */
    RIG_LAYERS,   /* tissue, fluid, bone: like a scan */
    RIG_SPARSE,   /* mostly fluid, few bones: the filter needs many passes */
    RIG_KIND_COUNT
} rig_kind;
uint8_t *rig_volume(rig_kind kind, uint32_t width, uint32_t height, uint32_t slices, uint32_t seed);

/* A volume whose rays have the given fluid intervals, so that a test can state a map and not a volume: ray i
 * is tissue up to slice near_end[i], fluid up to far_end[i] and bone (255) there; far_end 0: bone at slice 0,
 * an empty interval; far_end < 0: fluid all along, no initial point. */
uint8_t *rig_map_volume(const int32_t *near_end, const int32_t *far_end, uint32_t width, uint32_t height,
                        uint32_t slices);

#endif
