/* SPDX-License-Identifier: MIT */
/* Times scan conversion against reading the volume's bytes once, and holds it to exact means over boxes. */
#include "base/progress.h"
#include "bench/bench_results.h"
#include "bench/plain.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#define SOURCE_VOXELS 3.0 /* an edge of a low-resolution voxel, as in the scan loop */
#define SLAB_SLICES   16u
#define COMPARED      8000u /* voxels that are held to their exact means */

static const struct {
    const char *label;
    double yaw, pitch;
} cameras[BENCH_CONVERT_VIEWS] = {
    {"still", 0, 0},          {"30, 20 degrees", 30, 20},   {"45, 35 degrees", 45, 35},
    {"90, 0 degrees", 90, 0}, {"-20, 80 degrees", -20, 80},
};

typedef struct {
    const bench_convert_setup *setup;
    const hs_volume *volume;
    hs_device_volume *device;
    hs_camera camera;
    hs_slab_layout layout;
    hs_scan_converter *converter;
    cl_mem slabs;
    size_t slab_bytes;
} bench;

static size_t volume_bytes(const hs_volume *v) {
    return v->beams ? hs_beams_count(v->beams) : hs_volume_count(v);
}

static void lay_out(bench *b) {
    const double *s = b->volume->spacing, edge = SOURCE_VOXELS * fmin(s[0], fmin(s[1], s[2]));
    hs_slab_layout *l = &b->layout;
    *l = (hs_slab_layout){.tiles_x = 1};
    l->width = l->height = l->tile_w = l->tile_h = l->row_pitch =
        (uint32_t)fmax(floor(b->camera.extent / edge + 0.5), 1.0);
    l->slices = (uint32_t)fmax(floor(b->camera.depth_extent / edge + 0.5), 1.0);
    l->slab_slices = l->slices < SLAB_SLICES ? l->slices : SLAB_SLICES;
}

static bool finish(const bench *b, hs_error *err) {
    return hs_cl_check(clFinish(b->setup->cl->queue), "clFinish (benchmark)", err);
}

/* Wall clock, and processor time of all threads; milliseconds. */
typedef struct {
    double wall, processor;
} moment;

static moment now(void) {
    return (moment){hs_now() * 1e3, bench_processor_ms()};
}

static moment since(moment begin) {
    const moment end = now();
    return (moment){end.wall - begin.wall, end.processor - begin.processor};
}

static bool convert(const bench *b, moment *took, hs_error *err) {
    const moment begin = now();
    bool ok = true;
    for (uint32_t i = 0; ok && i < hs_slab_count(&b->layout); i++)
        ok = hs_scan_convert_slab(b->converter, b->device, &b->camera, i, b->slabs, i * b->slab_bytes, NULL,
                                  err);
    ok = ok && finish(b, err);
    *took = since(begin);
    return ok;
}

/* The volume's bytes, and then the conversion of a volume that is new and of one that is not. */
static bool take_turn(const bench *b, moment took[3], hs_error *err) {
    const hs_volume *v = b->volume;
    if (!hs_device_volume_replace(b->device, v, err) || !finish(b, err)) return false;
    bench_team_ready(b->setup->team);
    const moment begin = now();
    (void)plain_read(b->setup->team, v->beams ? v->beams->voxels : v->voxels, volume_bytes(v) / 16 * 16);
    took[0] = since(begin);
    bench_team_rest(b->setup->team);
    return convert(b, &took[1], err) && convert(b, &took[2], err);
}

static bool time_view(const bench *b, bench_samples samples[6], hs_error *err) {
    for (uint32_t i = 0; i <= b->setup->frames; i++) { /* the first is not counted */
        moment took[3];
        if (!take_turn(b, took, err)) return false;
        for (int k = 0; i > 0 && k < 3; k++) {
            bench_samples_add(&samples[k], took[k].wall);
            bench_samples_add(&samples[3 + k], took[k].processor);
        }
    }
    return true;
}

static bool compare(const bench *b, hs_box_error *out, hs_error *err) {
    const size_t total = (size_t)b->layout.width * b->layout.height * b->layout.slices;
    /* Odd, so that the voxels are not all of a few columns. */
    const uint32_t every = (uint32_t)(total / COMPARED) | 1u;
    uint8_t *voxels = malloc(total);
    if (!voxels) return hs_fail(err, HS_ERR_MEMORY, "benchmark: no memory for %zu voxels", total);
    const cl_int code =
        clEnqueueReadBuffer(b->setup->cl->queue, b->slabs, CL_TRUE, 0, total, voxels, 0, NULL, NULL);
    const bool ok = hs_cl_check(code, "clEnqueueReadBuffer (benchmark)", err) &&
                    hs_box_error_measure(b->volume, &b->camera, &b->layout, voxels, every, out, err);
    free(voxels);
    return ok;
}

static bool run_view(bench *b, int index, bench_convert_view *out, hs_error *err) {
    bench_samples samples[6] = {{0}};
    hs_camera_look(&b->camera, b->volume, cameras[index].yaw, cameras[index].pitch);
    lay_out(b);
    b->slab_bytes = hs_slab_bytes(&b->layout, b->layout.slab_slices);
    b->converter = hs_scan_converter_create(b->setup->cl, &b->layout, err);
    const size_t bytes = b->slab_bytes * hs_slab_count(&b->layout);
    bool ok = b->converter && hs_cl_take_buffer(b->setup->cl, bytes, "benchmark", &b->slabs, err);
    for (int k = 0; ok && k < 6; k++) ok = bench_samples_create(&samples[k], b->setup->frames, err);
    ok = ok && time_view(b, samples, err) && compare(b, &out->error, err);
    out->label = cameras[index].label;
    out->size[0] = b->layout.width;
    out->size[1] = b->layout.height;
    out->size[2] = b->layout.slices;
    bench_times *const times[6] = {&out->read.wall,      &out->fresh.wall,      &out->again.wall,
                                   &out->read.processor, &out->fresh.processor, &out->again.processor};
    for (int k = 0; k < 6; k++) {
        *times[k] = bench_samples_times(&samples[k]);
        bench_samples_destroy(&samples[k]);
    }
    if (b->slabs) (void)clReleaseMemObject(b->slabs);
    b->slabs = NULL;
    hs_scan_converter_destroy(b->converter);
    b->converter = NULL;
    return ok;
}

bool bench_convert_run(const bench_convert_setup *setup, const hs_volume *volume, bench_convert_result *out,
                       hs_error *err) {
    bench b = {.setup = setup, .volume = volume};
    if (!volume) return false; /* the source has said why */
    *out = (bench_convert_result){.bytes = volume_bytes(volume)};
    (void)snprintf(out->volume, sizeof out->volume, "%s", volume->name);
    bool ok = (b.device = hs_device_volume_create(setup->cl, volume, err)) != NULL;
    for (int i = 0; ok && i < BENCH_CONVERT_VIEWS; i++) ok = run_view(&b, i, &out->view[i], err);
    hs_device_volume_destroy(b.device);
    return ok;
}

static void print_ratio(const bench_convert_time *t, const bench_convert_time *read) {
    printf(" | %7.2f %5.1f %5.1f", t->wall.median, t->wall.median / read->wall.median,
           t->processor.median / read->processor.median);
}

void bench_print_convert(const bench_convert_result *r) {
    printf("\nScan conversion of %s, %.1f MB, in turns with reading them once by two threads; medians in "
           "milliseconds, as multiples of reading, and processor time as a multiple of reading's\n",
           r->volume, (double)r->bytes * 1e-6);
    printf("%-16s %-15s | %6s | %-19s | %-19s | %s\n", "camera", "voxels", "read", "    new /read  busy",
           "  again /read  busy", "off the exact mean: mean, 99 %, disputed");
    for (int i = 0; i < BENCH_CONVERT_VIEWS; i++) {
        const bench_convert_view *v = &r->view[i];
        char size[32];
        (void)snprintf(size, sizeof size, "%u x %u x %u", v->size[0], v->size[1], v->size[2]);
        printf("%-16s %-15s | %6.2f", v->label, size, v->read.wall.median);
        print_ratio(&v->fresh, &v->read);
        print_ratio(&v->again, &v->read);
        printf(" | %.2f, %.2f levels, %.2f %%\n", v->error.mean, v->error.p99,
               100.0 * (double)v->error.disputed / fmax((double)(v->error.voxels + v->error.disputed), 1.0));
    }
}
