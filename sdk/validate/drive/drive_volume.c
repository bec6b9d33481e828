/* SPDX-License-Identifier: MIT */
/* The device, volumes to try a plugin on, and the ways of handing them over. */
#include "validate/drive/drive.h"

#include "smartvis/device.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* ---------------------------------------------------------------------------------------------- device -- */

void v_device_open(v_run *run, stage_device *d) {
    sv_devices devices;
    v_where(run, "the validator's own OpenCL calls");
    if (!sv_devices_open(&devices, 0, &d->device, &d->context, &d->queue)) v_no_device(run, devices.why);
    run->report->on_device = true;
}

void v_device_close(stage_device *d) {
    if (d->queue) (void)clReleaseCommandQueue(d->queue);
    if (d->context) (void)clReleaseContext(d->context);
    memset(d, 0, sizeof *d);
}

/* --------------------------------------------------------------------------------------------- volumes -- */

static uint8_t voxel(v_run *run, v_kind kind, uint32_t x, uint32_t y, uint32_t z, uint32_t slices) {
    const uint32_t shift = kind == V_OTHER ? slices / 5 : 0;
    const uint32_t wall = slices / 6 + (x + y) / 9 % 3 + shift,
                   fetus = slices / 2 + (x * 2 + y) / 11 % 4 + shift;
    switch (kind) {
    case V_LAYERS:
    case V_OTHER:
        if (z < wall) return (uint8_t)(90 + v_random(run, 60));
        return z < fetus ? (uint8_t)(5 + v_random(run, 20)) : (uint8_t)(140 + v_random(run, 100));
    case V_WHITE:
        return 255;
    case V_GREY:
        return 128;
    case V_NOISE:
        return (uint8_t)v_random(run, 256);
    case V_STRIPES:
        return z % 2 ? 255 : 0;
    default:
        return 0;
    }
}

const char *v_kind_name(v_kind kind) {
    static const char *const names[V_KINDS] = {"layered", "other layered", "black",  "white",
                                               "grey",    "noisy",         "striped"};
    return names[kind];
}

void v_volume_make(v_run *run, v_volume *v, v_kind kind, uint32_t width, uint32_t height, uint32_t slices) {
    const size_t rays = (size_t)width * height;
    *v = (v_volume){width, height, slices, v_memory(run, rays * slices),
                    v_memory(run, rays * sizeof(sv_scanned))};
    for (uint32_t z = 0; z < slices; z++)
        for (uint32_t y = 0; y < height; y++)
            for (uint32_t x = 0; x < width; x++)
                v->voxels[z * rays + (size_t)y * width + x] = voxel(run, kind, x, y, z, slices);
    for (size_t i = 0; i < rays; i++) v->ranges[i] = (sv_scanned){0, (uint16_t)slices};
}

void v_volume_narrow(v_volume *v) {
    for (uint32_t i = 0; i < v->width * v->height; i++) {
        const uint32_t first = i % 3, last = 1 + i % 2;
        if (v->slices > first + last)
            v->ranges[i] = (sv_scanned){(uint16_t)first, (uint16_t)(v->slices - last)};
    }
}

void v_volume_outside(v_run *run, v_volume *v, int value) {
    const size_t rays = (size_t)v->width * v->height;
    for (size_t i = 0; i < rays; i++)
        for (uint32_t z = 0; z < v->slices; z++)
            if (z < v->ranges[i].first || z >= v->ranges[i].end)
                v->voxels[z * rays + i] = value < 0 ? (uint8_t)v_random(run, 256) : (uint8_t)value;
}

stage_way v_standard_way(const v_subject *s) {
    const sv_descriptor *d = s->descriptor;
    return (stage_way){.width = 31,
                       .height = 26,
                       .slices = 28,
                       .longest = 11,
                       .tiles_x = 3,
                       .extra_w = 2,
                       .extra_h = 1,
                       .extra_pitch = 5,
                       .carrier = SV_CARRIER_HOST,
                       .own_queue = (d->queues & SV_QUEUE_HOST) == 0,
                       .ranges = (d->features & SV_FEATURE_SCANNED) != 0,
                       .padding = SV_NO_PADDING};
}

stage_way v_sized(stage_way way, uint32_t width, uint32_t height, uint32_t slices) {
    way.longest = (uint32_t)(((uint64_t)way.longest * slices + way.slices - 1) / way.slices);
    way.width = width;
    way.height = height;
    way.slices = slices;
    return way;
}

/* ---- the stage: what it cannot have ends the check */
static void refused(void *data, const char *what, cl_int code) {
    if (code != CL_SUCCESS) v_skip(data, "the OpenCL device refuses %s: %d", what, (int)code);
    v_fail(data, "no %s: the check could not be made", what);
}

void v_stage_make(v_run *run, stage *st, const stage_way *way, const stage_device *device) {
    stage_make(st, way, device, refused, run);
}

void v_stage_fill(stage *st, const v_volume *v) {
    stage_fill(st, v->voxels, v->ranges);
}
