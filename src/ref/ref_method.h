/* SPDX-License-Identifier: MIT */
/* The scalar definition of a method behind one signature. */
#pragma once

#include "method_list.h"
#include "ref/ref_map.h"
#include "ref/ref_volume.h"

/* The plugin's parameters of these names; lengths in pixels of the frame. */
typedef struct {
    uint32_t kernel;    /* odd */
    double fill_weight; /* 0..1 */
    uint32_t passes;    /* of the minimum filter, at most; 0: until no pixel is empty */
    double lambda;
    uint32_t merge_grid, spline_grid;
    uint32_t prefilter_passes, prefilter_kernel; /* passes 0: no pre-filter */
} sv_ref_settings;

/* What a method works on. `map`: the points, with depths S(q). `volume` and its spacing: for a method that
 * takes the volume; else they may be left out. */
typedef struct {
    sv_ref_map map;
    const sv_ref_volume *volume;
    double spacing_mm[3]; /* between the volume's voxels; 0: not known */
    double q;
    const sv_ref_settings *settings;
} sv_ref_task;

/* What a device computes with. */
typedef struct {
    uint32_t slices, substeps; /* the largest depth, and samples of a slice */
    bool doubles;              /* the spline's solver has float64 */
} sv_ref_device;

typedef struct {
    bool takes_volume; /* the volume, not the points: no pre-filter */

    /* Largest difference in slices that a device's surface may have from this one (docs/numerics.md has the
     * reasons); sv_ref_bound is what self-test and tests ask. */
    double (*bound)(const sv_ref_task *task, const sv_ref_device *device);

    /* The surface at every pixel of task->map, in slices. False if memory runs out. */
    bool (*surface)(const sv_ref_task *task, double *surface);
} sv_ref_method;

/* The tables of the definitions. */
#define SV_REF_METHOD_TABLE(NAME, value, key) extern const sv_ref_method sv_ref_method_##key;
SV_METHODS(SV_REF_METHOD_TABLE)
#undef SV_REF_METHOD_TABLE
