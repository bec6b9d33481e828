/* SPDX-License-Identifier: MIT */
#include "render/device_beams.h"

#include <stdlib.h>

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

hs_device_beams *hs_device_beams_create(const hs_cl *cl, const hs_beams *beams, hs_error *err) {
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

bool hs_device_beams_replace(hs_device_beams *db, const hs_beams *beams, hs_error *err) {
    const hs_beams_shape *s = &db->shape;
    if (beams->samples != s->samples || beams->lines != s->lines || beams->planes != s->planes)
        return hs_fail(err, HS_ERR_INPUT, "%u x %u x %u samples in a sequence of %u x %u x %u",
                       beams->samples, beams->lines, beams->planes, s->samples, s->lines, s->planes);
    return take(db, beams, err);
}

void hs_device_beams_destroy(hs_device_beams *db) {
    if (!db) return;
    hs_device_bytes_free(&db->samples);
    if (db->theta) (void)clReleaseMemObject(db->theta);
    if (db->phi) (void)clReleaseMemObject(db->phi);
    free(db->tables);
    free(db);
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
