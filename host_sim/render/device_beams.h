/* SPDX-License-Identifier: MIT */
/* A volume in probe geometry on the device, ready to be sampled by scan conversion. */
#ifndef HS_DEVICE_BEAMS_H
#define HS_DEVICE_BEAMS_H

#include "render/device_bytes.h"
#include "render/host_launch.h"
#include "volume/beams.h"

/* The geometry as the kernel reads it: radius i = x * inverse pitch ... (cl/scan_convert_beams.cl). */
typedef struct {
    uint32_t samples, lines, planes;
    float start, per_mm;    /* mm; samples a mm */
    float axis, side;       /* mm; -1 or +1 */
    float theta[2], phi[2]; /* an even table's first angle, and its steps a radian; 0 steps: uneven */
    double corner[3];       /* hs_beams */
} hs_beams_shape;

typedef struct hs_device_beams hs_device_beams;

/* Uploads samples and tables; does not wait: see hs_device_bytes_bring for how long they must stay. NULL with
 * HS_ERR_DEVICE or HS_ERR_MEMORY. */
hs_device_beams *hs_device_beams_create(const hs_cl *cl, const hs_beams *beams, hs_error *err);

/* Takes another volume with as many samples, lines and planes (HS_ERR_INPUT); its geometry may differ. */
bool hs_device_beams_replace(hs_device_beams *db, const hs_beams *beams, hs_error *err);

/* NULL is allowed. The queue must have run. */
void hs_device_beams_destroy(hs_device_beams *db);

/* What the kernel samples. Buffers are borrowed, and may be others after hs_device_beams_replace. */
typedef struct {
    hs_beams_shape shape;
    cl_mem voxels, theta, phi; /* bytes, and float32 tables */
} hs_beams_view;
hs_beams_view hs_device_beams_view(const hs_device_beams *db);

/* The next six arguments of a kernel: what it samples, as convert_beams has them
 * (cl/scan_convert_beams.cl). */
void hs_launch_beams(hs_launch *launch, const hs_beams_view *view);

#endif
