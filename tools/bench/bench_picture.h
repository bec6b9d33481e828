/* SPDX-License-Identifier: MIT */
/* What the benchmarks of the renderer draw: four views, each with a picture and a
 * depthmap that is a plane. */
#ifndef BENCH_PICTURE_H
#define BENCH_PICTURE_H

#include "render/dvr.h"

enum { BENCH_VIEWS = 4 };

/* A camera in degrees, and whether the picture is clipped. */
typedef struct {
    const char *label;
    double yaw, pitch;
    bool clipped;
} bench_view;

extern const bench_view bench_views[BENCH_VIEWS];

/* Where the plane lies, of the box' depth: in the fluid of the benchmark's volume. */
#define BENCH_PICTURE_PLANE 0.28

typedef struct {
    const hs_cl *cl;
    cl_mem pixels;         /* RGBA of the settings' width x height */
    hs_start_depths start; /* of the plane */
} bench_picture;

/* HS_ERR_DEVICE; call bench_picture_destroy in every case. */
bool bench_picture_create(bench_picture *p, const hs_cl *cl, const hs_dvr_settings *settings, hs_error *err);

/* Safe on a zeroed struct. */
void bench_picture_destroy(bench_picture *p);

/* Draws into `pixels` without waiting; clips at the plane or not. */
bool bench_picture_draw(const bench_picture *p, hs_dvr *dvr, const hs_device_volume *volume,
                        const hs_camera *camera, bool clipped, hs_error *err);

/* Waits for the queue. */
bool bench_picture_wait(const bench_picture *p, hs_error *err);

#endif
