/* SPDX-License-Identifier: MIT */
/* A source volume on the device, ready to be sampled by scan conversion and renderer. */
#pragma once

#include "render/derived_volume.h"
#include "render/host_kernels.h"
#include "volume/beams.h"
#include "volume/volume.h"

/* The geometry as the kernel reads it: radius i = x * inverse pitch ... (cl/scan_convert.cl). */
typedef struct {
    uint32_t samples, lines, planes;
    float start, per_mm;    /* mm; samples a mm */
    float axis, side;       /* mm; -1 or +1 */
    float theta[2], phi[2]; /* an even table's first angle, and its steps a radian; 0 steps: uneven */
    double corner[3];       /* hs_beams */
} hs_beams_shape;

typedef struct hs_device_beams hs_device_beams;

/* What the kernel samples. Buffers are borrowed, and may be others after hs_device_beams_replace. */
typedef struct {
    hs_beams_shape shape;
    cl_mem voxels, theta, phi; /* bytes, and float32 tables */
} hs_beams_view;
hs_beams_view hs_device_beams_view(const hs_device_beams *db);

/* The next six arguments of a kernel: what it samples, as convert_beams has them
 * (cl/scan_convert.cl). */
void hs_launch_beams(hs_launch *launch, const hs_beams_view *view);

typedef struct hs_device_volume hs_device_volume;

/*
 * Uploads the volume, and what it is the Cartesian copy of; does not wait: the voxels must stay, unchanged,
 * until the commands that read them have run. On a CPU device they are not copied but read where they are, so
 * they must stay allocated until hs_device_volume_destroy, which waits for the queue. (A volume one voxel
 * wide is copied.) NULL with HS_ERR_INPUT (2^31 voxels or more), HS_ERR_DEVICE or HS_ERR_MEMORY.
 */
hs_device_volume *hs_device_volume_create(const hs_cl *cl, const hs_volume *volume, hs_error *err);

/* Takes another volume of the same size (a live sequence); does not wait. No memory for voxels is
 * allocated; on a CPU device, host buffers that come again (up to 8 in turn) create no OpenCL object
 * either. The spacing may differ. */
bool hs_device_volume_replace(hs_device_volume *dv, const hs_volume *volume, hs_error *err);
void hs_device_volume_destroy(hs_device_volume *dv);

/* What the kernels sample it by. Buffers are borrowed, and may be others after hs_device_volume_replace. */
typedef struct {
    hs_volume shape;              /* size and spacing; no voxels, no name */
    cl_mem voxels;                /* one byte each, x fastest, then y, then z */
    const hs_device_beams *beams; /* what it is the Cartesian copy of, or NULL */
} hs_device_view;
hs_device_view hs_device_volume_view(const hs_device_volume *dv);

/* What is made of the voxels, each once per volume, when it is first asked for; it takes its memory at the
 * first time of all, and does not wait. For the thesis' look and projections; for scan conversion and the lit
 * look; for the lit look (hs_derived_lit). HS_ERR_DEVICE. */
bool hs_device_volume_bricks(const hs_device_volume *dv, hs_brick_view *view, hs_error *err);
bool hs_device_volume_halved(const hs_device_volume *dv, hs_halved_view *view, hs_error *err);
bool hs_device_volume_lit(const hs_device_volume *dv, float threshold_low, float threshold_high,
                          hs_lit_view *view, hs_error *err);
