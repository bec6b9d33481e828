/* SPDX-License-Identifier: MIT */
#include "commands/info_sampling.h"

#include "base/progress.h"
#include "render/scan_convert.h"

#include <math.h>
#include <stdio.h>

#define TURNS 5
#define SLABS 64u /* that are sampled, spread over the depth */
#define PART  0.4 /* of the box: its middle lies in the fan, where neither kernel has places to leave out */
#define YAW   30.0
#define PITCH 20.0 /* degrees: along no axis of either grid */

typedef struct {
    hs_cl cl;
    hs_camera camera;
    hs_slab_layout layout;
    hs_scan_converter *converter;
    hs_device_volume *beams, *copy;
    cl_mem slab;
} sampler;

static uint32_t places_along(double extent, double spacing) {
    return (uint32_t)fmax(ceil(extent / spacing), 1.0);
}

/* One sample a voxel: no edge is longer than that of the copy's voxels. */
static void lay_out(sampler *s, const hs_volume *volume) {
    hs_camera_look(&s->camera, volume, YAW, PITCH);
    s->camera.extent *= PART;
    s->camera.depth_extent *= PART;
    const uint32_t across = places_along(s->camera.extent, volume->spacing[0]);
    const uint32_t deep = places_along(s->camera.depth_extent, volume->spacing[0]);
    s->layout = (hs_slab_layout){.width = across,
                                 .height = across,
                                 .slices = deep,
                                 .slab_slices = 1,
                                 .tiles_x = 1,
                                 .tile_w = across,
                                 .tile_h = across,
                                 .row_pitch = across};
}

static bool begin(sampler *s, const hs_volume *volume, hs_error *err) {
    hs_volume copy = *volume;
    copy.beams = NULL;
    if (!hs_cl_open(&s->cl, err)) return false;
    lay_out(s, volume);
    return hs_cl_take_buffer(&s->cl, hs_slab_bytes(&s->layout, 1), "slab", &s->slab, err) &&
           (s->converter = hs_scan_converter_create(&s->cl, &s->layout, err)) &&
           (s->beams = hs_device_volume_create(&s->cl, volume, err)) &&
           (s->copy = hs_device_volume_create(&s->cl, &copy, err));
}

static void end(sampler *s) {
    if (s->beams) hs_device_volume_destroy(s->beams);
    if (s->copy) hs_device_volume_destroy(s->copy);
    hs_scan_converter_destroy(s->converter);
    if (s->slab) (void)clReleaseMemObject(s->slab);
    hs_cl_close(&s->cl);
}

static uint32_t slabs_of(const sampler *s) {
    return s->layout.slices < SLABS ? s->layout.slices : SLABS;
}

static bool time_once(const sampler *s, const hs_device_volume *from, double *ms, hs_error *err) {
    const uint32_t slabs = slabs_of(s);
    const double start = hs_now();
    for (uint32_t i = 0; i < slabs; i++) {
        const uint32_t slice = (uint32_t)((2 * (uint64_t)i + 1) * s->layout.slices / (2 * (uint64_t)slabs));
        if (!hs_scan_convert_slab(s->converter, from, &s->camera, slice, s->slab, 0, NULL, err)) return false;
    }
    if (!hs_cl_check(clFinish(s->cl.queue), "clFinish (sampling)", err)) return false;
    *ms = fmin(*ms, (hs_now() - start) * 1e3);
    return true;
}

bool hs_info_sampling(const hs_volume *volume, hs_error *err) {
    sampler s = {0};
    double beams_ms = INFINITY, copy_ms = INFINITY;
    bool ok = begin(&s, volume, err);
    for (int turn = 0; ok && turn < TURNS; turn++)
        ok = time_once(&s, s.copy, &copy_ms, err) && time_once(&s, s.beams, &beams_ms, err);
    const uint64_t places = (uint64_t)s.layout.width * s.layout.height * slabs_of(&s);
    if (ok)
        (void)printf("  sampling it linearly at %llu places, the shortest of %d times:\n"
                     "    %-26s %9.2f ms\n    %-26s %9.2f ms, %.2f times as long\n",
                     (unsigned long long)places, TURNS, "in the Cartesian copy", copy_ms,
                     "in the probe's grid", beams_ms, beams_ms / copy_ms);
    end(&s);
    return ok;
}
