/* SPDX-License-Identifier: MIT */
/* A host with its own OpenCL queue: slabs and depthmap are buffers, the plugin enqueues behind the host's
 * commands, and the host waits once, when all is enqueued. The volume is a skin, a wavy gap of fluid and a
 * fetus. Usage: queue_host PLUGIN.so */
#define CL_TARGET_OPENCL_VERSION 120
#include <CL/cl.h>

#include "smartvis/device.h"
#include "smartvis/open.h"
#include "smartvis_plugin.h"

#include <stdio.h>

enum { SIDE = 64, SLICES = 64, SLAB = 16, RAYS = SIDE * SIDE, SKIN = 100, FLUID = 10, FETUS = 200 };

typedef struct {
    cl_device_id device;
    cl_context context;
    cl_command_queue queue;
    cl_mem voxels; /* all slabs of a volume: none may change before the frame's commands have run */
    cl_mem depth;  /* what a renderer on this queue reads in place */
    cl_mem ranges; /* which slices of every ray were scanned */
} device;

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

/* 1, or 0 if there is no device or no memory; close_device takes what came so far. */
static int open_device(device *d) {
    sv_devices devices;
    cl_int code = CL_SUCCESS;
    if (!sv_devices_open(&devices, 0, &d->device, &d->context, &d->queue)) { /* in order */
        fprintf(stderr, "queue_host: %s\n", devices.why);
        return 0;
    }
    d->voxels = clCreateBuffer(d->context, CL_MEM_READ_ONLY, sizeof volume, NULL, &code);
    if (code == CL_SUCCESS)
        d->depth = clCreateBuffer(d->context, CL_MEM_READ_WRITE, sizeof depthmap, NULL, &code);
    if (code == CL_SUCCESS)
        d->ranges = clCreateBuffer(d->context, CL_MEM_READ_ONLY | CL_MEM_COPY_HOST_PTR, sizeof scanned,
                                   scanned, &code);
    if (code != CL_SUCCESS) fprintf(stderr, "queue_host: OpenCL error %d\n", (int)code);
    return code == CL_SUCCESS;
}

static void close_device(device *d) {
    if (d->ranges) clReleaseMemObject(d->ranges);
    if (d->depth) clReleaseMemObject(d->depth);
    if (d->voxels) clReleaseMemObject(d->voxels);
    if (d->queue) clReleaseCommandQueue(d->queue);
    if (d->context) clReleaseContext(d->context);
}

/* Enqueues one volume, front to back: a slab goes to the device, and the plugin's commands follow it on the
 * same queue. */
static sv_status enqueue_frame(const sv_plugin *p, const device *d, int ranges, sv_stats *stats) {
    sv_frame frame = {.size = sizeof frame, .index = 1, .scanned_object = ranges ? d->ranges : NULL};
    sv_status status = p->begin(p, &frame);
    for (uint32_t z = 0; z < SLICES && status >= SV_OK; z += SLAB) {
        const size_t offset = sizeof volume[0] * z, bytes = sizeof volume[0] * SLAB;
        if (clEnqueueWriteBuffer(d->queue, d->voxels, CL_FALSE, offset, bytes, volume[z], 0, NULL, NULL) !=
            CL_SUCCESS)
            return SV_ERR_OPENCL; /* the frame stays unfinished: the next begin drops it */
        const sv_slab slab = {.size = sizeof slab,
                              .first_slice = z,
                              .slice_count = SLAB,
                              .object = d->voxels,
                              .offset = offset,
                              .bytes = bytes};
        status = p->slab(p, &slab);
    }
    const sv_result result = {.size = sizeof result, .depth_object = d->depth, .stats = stats};
    return status >= SV_OK ? p->end(p, &result) : status;
}

/* The frame's outcome: it is known when the queue has run. */
static sv_status run_frame(const sv_plugin *p, const device *d, int ranges) {
    const float zero = 0.0f; /* never an older map */
    sv_stats stats = {.size = sizeof stats, .outcome = SV_ERR_INTERNAL};
    if (clEnqueueFillBuffer(d->queue, d->depth, &zero, sizeof zero, 0, sizeof depthmap, 0, NULL, NULL) !=
        CL_SUCCESS)
        return SV_ERR_OPENCL;
    const sv_status status = enqueue_frame(p, d, ranges, &stats);
    /* A renderer would be enqueued here. This host reads the map instead, and so waits for everything. */
    const cl_int code =
        clEnqueueReadBuffer(d->queue, d->depth, CL_TRUE, 0, sizeof depthmap, depthmap, 0, NULL, NULL);
    if (status < SV_OK) return status;
    return code == CL_SUCCESS ? stats.outcome : SV_ERR_OPENCL;
}

static sv_status run(const sv_plugin *p, const device *d) {
    const int ranges = (p->descriptor->features & SV_FEATURE_SCANNED) != 0;
    const sv_format format = {.size = sizeof format,
                              .width = SIDE,
                              .height = SIDE,
                              .slices = SLICES,
                              .max_slab_slices = SLAB,
                              .voxel_type = SV_VOXEL_U8,
                              .carrier = SV_CARRIER_BUFFER,
                              .padding_value = SV_NO_PADDING,
                              .tiles_x = 1,
                              .tile_w = SIDE,
                              .tile_h = SIDE,
                              .row_pitch = SIDE,
                              .spacing_mm = {1, 1, 1},
                              .flags = ranges ? SV_FORMAT_SCANNED : 0,
                              .context = d->context,
                              .device = d->device,
                              .queue = d->queue};
    sv_status status = p->activate(p, &format);
    if (status >= SV_OK) {
        status = run_frame(p, d, ranges);
        if (status < SV_OK) fprintf(stderr, "queue_host: %s\n", p->last_error(p));
        p->deactivate(p);
    } else {
        fprintf(stderr, "queue_host: %s\n", p->last_error(p));
    }
    return status;
}

static sv_status run_plugin(const sv_entry *entry, const sv_descriptor *about) {
    const sv_host host = {sizeof host, SV_ABI_MINOR, NULL, "queue_host", "1", print_log, NULL};
    const sv_plugin *p = NULL;
    device d = {0};
    make_volume();
    sv_status status = open_device(&d) ? entry->create(&host, about->id, &p) : SV_ERR_NO_DEVICE;
    if (status == SV_OK) {
        status = run(p, &d);
        p->destroy(p);
    }
    close_device(&d);
    return status;
}

int main(int argc, char **argv) {
    char why[256] = "usage: queue_host FOLDER/PLUGIN.so";
    const sv_entry *entry = argc == 2 ? sv_open(argv[1], NULL, why, sizeof why) : NULL;
    if (!entry) return fprintf(stderr, "%s\n", why), 2;
    if (entry->abi_major != SV_ABI_MAJOR) return fprintf(stderr, "another ABI: %u\n", entry->abi_major), 4;
    const sv_descriptor *about = entry->descriptor(0); /* says before what activate would refuse */
    if (!(about->queues & SV_QUEUE_HOST) || !(about->carriers & SV_BIT(SV_CARRIER_BUFFER)))
        return fprintf(stderr, "%s takes no queue or no buffers of the host's\n", about->id), 4;
    const sv_status status = run_plugin(entry, about);
    const int clip = status == SV_OK || status == SV_PARTIAL; /* else unclipped, never with an old map */
    printf("%s: status %d, rendered %s\n", about->id, (int)status, clip ? "with the map" : "unclipped");
    for (uint32_t i = 0; i < RAYS; i++)
        if (i % 8 == 4 && i / SIDE % 8 == 4)
            printf("%5.1f%c", clip ? (double)depthmap[i] : 0.0, i % SIDE > SIDE - 8 ? '\n' : ' ');
    return status < 0 ? 4 : 0; /* the library stays loaded until the process ends */
}
