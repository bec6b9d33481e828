/* SPDX-License-Identifier: MIT */
#include "commands/info_timing.h"

#include "base/progress.h"
#include "render/scan_convert.h"
#include "volume/metaimage_parts.h"
#include "volume/volume.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

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

/* Samples the middle of `volume`, which has beams, from an oblique camera at places about a voxel apart,
 * by the kernels of scan conversion: linearly in its Cartesian copy, and linearly in the probe's grid, at
 * the same places. Prints the shortest times of several turns and their ratio. Opens an OpenCL device.
 * HS_ERR_DEVICE or HS_ERR_MEMORY. */
static bool hs_info_sampling(const hs_volume *volume, hs_error *err) {
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

#define TURNS 5

/* What is read: a file's first volume. */
typedef struct {
    const char *path;
    const hs_kretz_options *kretz; /* options; of a MetaImage file not looked at */
    const char *data_path;         /* the file that holds the voxels */
    uint64_t first;                /* where compressed ones start there */
    size_t bytes;                  /* of the voxels there; of compressed ones, how many they become */
} target;

/* What is timed: false with an error. */
typedef bool (*reader)(const target *t, hs_error *err);

static bool read_bytes(const target *t, hs_error *err) {
    size_t bytes = t->bytes;
    uint8_t *memory = hs_plain_bytes(t->data_path, 0, &bytes, err);
    free(memory);
    return memory != NULL;
}

static bool inflate_bytes(const target *t, hs_error *err) {
    return hs_plain_inflate(t->data_path, t->first, t->bytes, err);
}

/* The samples of a Kretz file, its header checked, without their Cartesian copy. */
static bool read_samples(const target *t, hs_error *err) {
    hs_kretz *kretz = hs_kretz_open(t->path, t->kretz, err);
    uint8_t *memory = kretz ? malloc(t->bytes) : NULL;
    const bool ok =
        kretz && (memory ? hs_kretz_read_bytes(kretz, 0, memory, err)
                         : hs_fail(err, HS_ERR_MEMORY, "%s: no memory for %zu bytes", t->path, t->bytes));
    free(memory);
    hs_kretz_close(kretz);
    return ok;
}

static bool read_kretz(const target *t, hs_error *err) {
    hs_volume volume = {0};
    hs_kretz *kretz = hs_kretz_open(t->path, t->kretz, err);
    const bool ok = kretz && hs_kretz_read(kretz, 0, &volume, err);
    hs_volume_free(&volume);
    hs_kretz_close(kretz);
    return ok;
}

static bool read_metaimage(const target *t, hs_error *err) {
    hs_volume volume = {0};
    hs_metaimage *file = hs_metaimage_open(t->path, NULL, err);
    const bool ok = file && hs_metaimage_read_at(file, 0, &volume, err);
    hs_volume_free(&volume);
    hs_metaimage_close(file);
    return ok;
}

static bool shortest(reader read_it, const target *t, double *ms, hs_error *err) {
    *ms = INFINITY;
    for (int turn = 0; turn < TURNS; turn++) {
        const double start = hs_now();
        if (!read_it(t, err)) return false;
        *ms = fmin(*ms, (hs_now() - start) * 1e3);
    }
    return true;
}

static void print_base(const char *what, double ms, size_t bytes) {
    (void)printf("  reading it, the shortest of %d times:\n    %-26s %9.2f ms (%zu bytes)\n", TURNS, what, ms,
                 bytes);
}

static void print_line(const char *what, double ms, double base_ms) {
    (void)printf("    %-26s %9.2f ms, %.2f times that\n", what, ms, ms / base_ms);
}

/* Only a volume that was scanned by a probe has two grids to sample. */
static bool time_sampling(const target *t, hs_error *err) {
    hs_volume volume = {0};
    hs_kretz *kretz = hs_kretz_open(t->path, t->kretz, err);
    bool ok = kretz && hs_kretz_read(kretz, 0, &volume, err);
    hs_kretz_close(kretz);
    ok = ok && (!volume.beams || hs_info_sampling(&volume, err));
    hs_volume_free(&volume);
    return ok;
}

static bool time_kretz(target t, hs_error *err) {
    double bytes_ms, samples_ms, volume_ms;
    hs_kretz *kretz = hs_kretz_open(t.path, t.kretz, err);
    if (!kretz) return false;
    t.bytes = hs_kretz_bytes(kretz);
    hs_kretz_close(kretz);
    if (!shortest(read_samples, &t, &samples_ms, err) || !shortest(read_kretz, &t, &volume_ms, err) ||
        !shortest(read_bytes, &t, &bytes_ms, err))
        return false;
    print_base("its bytes alone", bytes_ms, t.bytes);
    print_line("samples", samples_ms, bytes_ms);
    print_line("with the Cartesian copy", volume_ms, bytes_ms);
    return time_sampling(&t, err);
}

/* zlib decides how long compressed bytes take, so they are compared with zlib alone. */
static bool time_metaimage(target t, hs_error *err) {
    hs_met_header header;
    double base_ms = 0, volume_ms = 0;
    bool ok = hs_met_header_read(t.path, &header, err);
    if (ok) {
        t.data_path = header.data_path;
        t.first = header.header_size;
        t.bytes = (size_t)header.size[0] * header.size[1] * header.size[2] * header.element_bytes;
        ok = shortest(read_metaimage, &t, &volume_ms, err) &&
             shortest(header.compressed ? inflate_bytes : read_bytes, &t, &base_ms, err);
    }
    if (ok) {
        print_base(header.compressed ? "inflating alone" : "its bytes alone", base_ms, t.bytes);
        print_line("volume", volume_ms, base_ms);
    }
    hs_met_header_free(&header);
    return ok;
}

bool hs_info_timing(const char *path, const hs_kretz_options *kretz, hs_error *err) {
    const target t = {.path = path, .kretz = kretz, .data_path = path};
    return hs_kretz_is_file(path) ? time_kretz(t, err) : time_metaimage(t, err);
}
