/* SPDX-License-Identifier: MIT */
#include "render/device_volume.h"

#include "render/host_kernels.h"

#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>

#define HS_WRAP_COUNT 8 /* host buffers of a live sequence whose wrapping is remembered */

/* A zeroed struct has nothing to free. */
typedef struct {
    const hs_cl *cl;
    size_t bytes;
    cl_mem buffer; /* what kernels read after hs_device_bytes_bring; not owned: one of the following */
    cl_mem copy;   /* a device's own memory; NULL while host memory is wrapped */
    struct {
        const uint8_t *host;
        cl_mem buffer;
    } wrap[HS_WRAP_COUNT];
    uint32_t wrap_next; /* the oldest wrapping: the next to go */
} hs_device_bytes;

/* For arrays of `bytes` bytes. `wrapped`: a CPU reads them in place; else they are copied, to a buffer with
 * one byte behind them. HS_ERR_DEVICE. */
static bool hs_device_bytes_init(hs_device_bytes *bytes, const hs_cl *cl, size_t count, bool wrapped,
                                 hs_error *err) {
    *bytes = (hs_device_bytes){.cl = cl, .bytes = count};
    if (wrapped) return true;
    cl_int code = CL_SUCCESS;
    bytes->copy = clCreateBuffer(cl->context, CL_MEM_READ_ONLY, count + 1, NULL, &code);
    return hs_cl_check(code, "clCreateBuffer(volume)", err);
}

/* The buffer around this host memory: a known one, or a new one in the place of the oldest. */
static bool wrap(hs_device_bytes *b, const uint8_t *host, hs_error *err) {
    for (uint32_t i = 0; i < HS_WRAP_COUNT; i++) {
        if (b->wrap[i].host != host) continue;
        b->buffer = b->wrap[i].buffer;
        /* The contents may be new: OpenCL wants to be told before a command reads them. */
        cl_int code = CL_SUCCESS;
        void *mapped = clEnqueueMapBuffer(b->cl->queue, b->buffer, CL_FALSE, CL_MAP_WRITE_INVALIDATE_REGION,
                                          0, b->bytes, 0, NULL, NULL, &code);
        if (!hs_cl_check(code, "clEnqueueMapBuffer(volume)", err)) return false;
        code = clEnqueueUnmapMemObject(b->cl->queue, b->buffer, mapped, 0, NULL, NULL);
        return hs_cl_check(code, "clEnqueueUnmapMemObject(volume)", err);
    }
    union {
        const uint8_t *in;
        void *out;
    } pointer = {host}; /* read-only for the device, whatever the prototype says */
    cl_int code = CL_SUCCESS;
    cl_mem buffer =
        clCreateBuffer(b->cl->context, CL_MEM_READ_ONLY | CL_MEM_USE_HOST_PTR, b->bytes, pointer.out, &code);
    if (!hs_cl_check(code, "clCreateBuffer(volume in host memory)", err)) return false;
    uint32_t slot = b->wrap_next;
    if (b->wrap[slot].buffer) (void)clReleaseMemObject(b->wrap[slot].buffer);
    b->wrap[slot].host = host;
    b->wrap[slot].buffer = buffer;
    b->wrap_next = (slot + 1) % HS_WRAP_COUNT;
    b->buffer = buffer;
    return true;
}

/* Enqueues the way of `host` to the device; does not wait. It must stay, unchanged, until the commands that
 * read it have run; in place, allocated until hs_device_bytes_free. Host buffers that come again create no
 * OpenCL object. HS_ERR_DEVICE. */
static bool hs_device_bytes_bring(hs_device_bytes *b, const uint8_t *host, hs_error *err) {
    if (!b->copy) return wrap(b, host, err);
    b->buffer = b->copy;
    return hs_cl_check(
        clEnqueueWriteBuffer(b->cl->queue, b->copy, CL_FALSE, 0, b->bytes, host, 0, NULL, NULL),
        "clEnqueueWriteBuffer(volume)", err);
}

/* The queue must have run. */
static void hs_device_bytes_free(hs_device_bytes *b) {
    if (b->copy) (void)clReleaseMemObject(b->copy);
    for (uint32_t i = 0; i < HS_WRAP_COUNT; i++)
        if (b->wrap[i].buffer) (void)clReleaseMemObject(b->wrap[i].buffer);
    *b = (hs_device_bytes){0};
}

struct hs_device_beams {
    const hs_cl *cl;
    hs_beams_shape shape;
    hs_device_bytes samples;
    float *tables; /* theta, then phi: what the device has; behind them as many that are new */
    cl_mem theta, phi;
};

/* A table as the kernel reads it, and how it is looked up. */
static void take_table(const double *table, uint32_t count, float *out, float lookup[2]) {
    for (uint32_t i = 0; i < count; i++) out[i] = (float)table[i];
    lookup[0] = (float)table[0];
    lookup[1] = hs_beams_even(table, count) ? (float)((count - 1) / (table[count - 1] - table[0])) : 0.0f;
}

static bool send(hs_device_beams *db, cl_mem to, const float *table, uint32_t count, hs_error *err) {
    return hs_cl_check(
        clEnqueueWriteBuffer(db->cl->queue, to, CL_TRUE, 0, count * sizeof *table, table, 0, NULL, NULL),
        "clEnqueueWriteBuffer(angles)", err);
}

/* The tables of a sequence seldom change, and only then they are sent, and waited for. */
static bool take_tables(hs_device_beams *db, const hs_beams *beams, hs_error *err) {
    const uint32_t lines = beams->lines, planes = beams->planes;
    bool same = true;
    float *fresh = db->tables + lines + planes;
    take_table(beams->theta, lines, fresh, db->shape.theta);
    take_table(beams->phi, planes, fresh + lines, db->shape.phi);
    for (uint32_t i = 0; i < lines + planes; i++) {
        same = same && fresh[i] == db->tables[i];
        db->tables[i] = fresh[i];
    }
    if (same) return true;
    return send(db, db->theta, db->tables, lines, err) && send(db, db->phi, db->tables + lines, planes, err);
}

static bool take(hs_device_beams *db, const hs_beams *beams, hs_error *err) {
    db->shape = (hs_beams_shape){.samples = beams->samples,
                                 .lines = beams->lines,
                                 .planes = beams->planes,
                                 .start = (float)beams->start,
                                 .per_mm = (float)(1.0 / beams->pitch),
                                 .axis = (float)beams->axis,
                                 .side = (float)hs_beams_side(beams),
                                 .corner = {beams->corner[0], beams->corner[1], beams->corner[2]}};
    return take_tables(db, beams, err) && hs_device_bytes_bring(&db->samples, beams->voxels, err);
}

static bool create_table(const hs_cl *cl, uint32_t count, cl_mem *table, hs_error *err) {
    cl_int code = CL_SUCCESS;
    *table = clCreateBuffer(cl->context, CL_MEM_READ_ONLY, count * sizeof(float), NULL, &code);
    return hs_cl_check(code, "clCreateBuffer(angles)", err);
}

/* NULL is allowed. The queue must have run. */
static void hs_device_beams_destroy(hs_device_beams *db) {
    if (!db) return;
    hs_device_bytes_free(&db->samples);
    if (db->theta) (void)clReleaseMemObject(db->theta);
    if (db->phi) (void)clReleaseMemObject(db->phi);
    free(db->tables);
    free(db);
}

/* Uploads samples and tables; does not wait: see hs_device_bytes_bring for how long they must stay. NULL with
 * HS_ERR_DEVICE or HS_ERR_MEMORY. */
static hs_device_beams *hs_device_beams_create(const hs_cl *cl, const hs_beams *beams, hs_error *err) {
    hs_device_beams *db = calloc(1, sizeof *db);
    if (db) db->tables = calloc(2 * ((size_t)beams->lines + beams->planes), sizeof *db->tables);
    if (!db || !db->tables) {
        free(db);
        (void)hs_fail(err, HS_ERR_MEMORY, "probe geometry: no memory for its tables");
        return NULL;
    }
    db->cl = cl;
    if (hs_device_bytes_init(&db->samples, cl, hs_beams_count(beams), cl->is_cpu, err) &&
        create_table(cl, beams->lines, &db->theta, err) && create_table(cl, beams->planes, &db->phi, err) &&
        take(db, beams, err))
        return db;
    hs_device_beams_destroy(db);
    return NULL;
}

/* Takes another volume with as many samples, lines and planes (HS_ERR_INPUT); its geometry may differ. */
static bool hs_device_beams_replace(hs_device_beams *db, const hs_beams *beams, hs_error *err) {
    const hs_beams_shape *s = &db->shape;
    if (beams->samples != s->samples || beams->lines != s->lines || beams->planes != s->planes)
        return hs_fail(err, HS_ERR_INPUT, "%u x %u x %u samples in a sequence of %u x %u x %u",
                       beams->samples, beams->lines, beams->planes, s->samples, s->lines, s->planes);
    return take(db, beams, err);
}

hs_beams_view hs_device_beams_view(const hs_device_beams *db) {
    return (hs_beams_view){
        .shape = db->shape, .voxels = db->samples.buffer, .theta = db->theta, .phi = db->phi};
}

void hs_launch_beams(hs_launch *launch, const hs_beams_view *view) {
    const hs_beams_shape *b = &view->shape;
    const cl_int4 dims = {{(cl_int)b->samples, (cl_int)b->lines, (cl_int)b->planes, 0}};
    const cl_float4 reach = {{b->start, b->per_mm, b->axis, b->side}};
    const cl_float4 even = {{b->theta[0], b->theta[1], b->phi[0], b->phi[1]}};
    hs_launch_buffer(launch, view->voxels);
    hs_launch_arg(launch, sizeof dims, &dims);
    hs_launch_buffer(launch, view->theta);
    hs_launch_buffer(launch, view->phi);
    hs_launch_arg(launch, sizeof reach, &reach);
    hs_launch_arg(launch, sizeof even, &even);
}

struct hs_device_volume {
    const hs_cl *cl;
    uint32_t n[3];          /* voxels */
    double spacing[3];      /* mm */
    hs_device_bytes voxels; /* n[0] * n[1] * n[2] bytes, x fastest */
    hs_device_beams *beams; /* what the volume is the Cartesian copy of, or NULL */
    hs_derived *derived;    /* made of the voxels when somebody asks */
};

/* Trilinear lookups read two neighbours in x. A volume one voxel wide has no second one, so the kernels
 * (which give it weight 0) need a byte behind the last voxel: such a volume is copied, never wrapped. */
static bool wraps_host_memory(const hs_device_volume *dv) {
    return dv->cl->is_cpu && dv->n[0] > 1;
}

/* Volumes of a sequence are all in probe geometry, or none is. */
static bool bring_beams(hs_device_volume *dv, const hs_beams *beams, hs_error *err) {
    if (!beams) return true;
    if (dv->beams) return hs_device_beams_replace(dv->beams, beams, err);
    dv->beams = hs_device_beams_create(dv->cl, beams, err);
    return dv->beams != NULL;
}

static bool upload(hs_device_volume *dv, const hs_volume *volume, hs_error *err) {
    return bring_beams(dv, volume->beams, err) && hs_device_bytes_bring(&dv->voxels, volume->voxels, err);
}

static bool init(hs_device_volume *dv, const hs_volume *volume, hs_error *err) {
    const uint32_t n[3] = {volume->nx, volume->ny, volume->nz};
    uint64_t count = 1;
    for (int k = 0; k < 3; k++) {
        if (n[k] == 0 || n[k] > HS_VOLUME_MAX_AXIS) { /* the kernels' rows are as long as that (MAX_ROW) */
            return hs_fail(err, HS_ERR_INPUT, "%s: size %c is %u, expected 1 .. %u", volume->name, "xyz"[k],
                           n[k], HS_VOLUME_MAX_AXIS);
        }
        dv->n[k] = n[k];
        dv->spacing[k] = volume->spacing[k];
        count *= n[k];
    }
    if (count >= 1ull << 31) { /* the kernels index voxels with 31 bits */
        return hs_fail(err, HS_ERR_INPUT, "%s: %u x %u x %u voxels, expected at most 2^31 - 1 in all",
                       volume->name, n[0], n[1], n[2]);
    }
    return hs_device_bytes_init(&dv->voxels, dv->cl, (size_t)count, wraps_host_memory(dv), err) &&
           (dv->derived = hs_derived_create(dv->cl, n, err)) && upload(dv, volume, err);
}

hs_device_volume *hs_device_volume_create(const hs_cl *cl, const hs_volume *volume, hs_error *err) {
    hs_device_volume *dv = hs_memory(1, sizeof *dv, volume->name, err);
    if (!dv) return NULL;
    dv->cl = cl;
    if (init(dv, volume, err)) return dv;
    hs_device_volume_destroy(dv);
    return NULL;
}

bool hs_device_volume_replace(hs_device_volume *dv, const hs_volume *volume, hs_error *err) {
    if (volume->nx != dv->n[0] || volume->ny != dv->n[1] || volume->nz != dv->n[2]) {
        return hs_fail(err, HS_ERR_INPUT, "%s: %u x %u x %u voxels in a sequence of %u x %u x %u",
                       volume->name, volume->nx, volume->ny, volume->nz, dv->n[0], dv->n[1], dv->n[2]);
    }
    if ((dv->beams != NULL) != (volume->beams != NULL))
        return hs_fail(err, HS_ERR_INPUT, "%s: %s in a sequence that is not", volume->name,
                       volume->beams ? "in probe geometry" : "Cartesian");
    for (int k = 0; k < 3; k++) dv->spacing[k] = volume->spacing[k];
    hs_derived_expire(dv->derived);
    return upload(dv, volume, err);
}

void hs_device_volume_destroy(hs_device_volume *dv) {
    if (!dv) return;
    /* The host memory may go as soon as this returns, so nothing may be reading it any more. */
    (void)clFinish(dv->cl->queue);
    hs_derived_destroy(dv->derived);
    hs_device_beams_destroy(dv->beams);
    hs_device_bytes_free(&dv->voxels);
    free(dv);
}

hs_device_view hs_device_volume_view(const hs_device_volume *dv) {
    return (hs_device_view){.shape = {.nx = dv->n[0],
                                      .ny = dv->n[1],
                                      .nz = dv->n[2],
                                      .spacing = {dv->spacing[0], dv->spacing[1], dv->spacing[2]}},
                            .voxels = dv->voxels.buffer,
                            .beams = dv->beams};
}

bool hs_device_volume_bricks(const hs_device_volume *dv, hs_brick_view *view, hs_error *err) {
    return hs_derived_bricks(dv->derived, dv->voxels.buffer, view, err);
}

bool hs_device_volume_halved(const hs_device_volume *dv, hs_halved_view *view, hs_error *err) {
    return hs_derived_halved(dv->derived, dv->voxels.buffer, view, err);
}

bool hs_device_volume_lit(const hs_device_volume *dv, float threshold_low, float threshold_high,
                          hs_lit_view *view, hs_error *err) {
    return hs_derived_lit(dv->derived, dv->voxels.buffer, threshold_low, threshold_high, view, err);
}
