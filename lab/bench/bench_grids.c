/* SPDX-License-Identifier: MIT */
/* Times the renderer of a probe's volume in turns in both grids that it could sample: the Cartesian copy, as
 * the host does, and the probe's own (lab/bench/cl/probe_grid.cl). */
#include "bench/bench_results.h"

#include "kernels_bench_grids.h"
#include "render/dvr.h"
#include "render/dvr_looks.h"
#include "scene/scene.h"
#include "scene/scene_export.h"
#include "volume/volume.h"

#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#define ALIKE  8.0 /* of 255: pictures of one volume differ by less */
#define MAKING 3u  /* times that the copy is made */

enum { COPY, PROBE, COPY_WALKS, PROBE_WALKS, WAYS };

typedef struct {
    const hs_cl *cl;
    hs_dvr_settings settings[2]; /* leaping, walking */
    hs_dvr *dvr[2];
    hs_volume copy;
    hs_device_volume *volume;
    cl_program program;
    cl_kernel kernel;
    bench_picture picture;
} bench;

/* ----------------------------------------------------------------------------------------- the volume -- */

static bool scan(bench *b, const char *name, uint32_t size, hs_error *err) {
    const hs_vol_spec spec = {.start = NAN, .axis = NAN, .samples = 400, .lines = 400, .planes = 400};
    hs_scene_data data;
    if (!hs_scene_generate(name, size, 0, &data, err)) return false;
    hs_beams *beams = hs_vol_geometry(&spec, &data.full, err);
    if (beams) hs_vol_fill(beams, &data.full);
    hs_scene_free(&data);
    if (!beams) return false;
    if (hs_beams_cartesian_init(&b->copy, beams, 0.0, err)) return true;
    hs_beams_free(beams);
    return false;
}

static bool time_making(bench *b, bench_times *out, hs_error *err) {
    bench_samples samples = {0};
    if (!bench_samples_create(&samples, MAKING, err)) return false;
    for (uint32_t i = 0; i <= MAKING; i++) { /* the first touches the memory */
        const double begin = hs_now();
        hs_beams_cartesian_fill(&b->copy);
        if (i > 0) bench_samples_add(&samples, (hs_now() - begin) * 1e3);
    }
    *out = bench_samples_times(&samples);
    bench_samples_destroy(&samples);
    return true;
}

/* ----------------------------------------------------------------------------------------- the device -- */

static bool open_device(bench *b, hs_error *err) {
    cl_int code = CL_SUCCESS;
    for (int walks = 0; walks < 2; walks++) {
        hs_dvr_settings *s = &b->settings[walks];
        hs_dvr_defaults(s);
        s->skip_empty = !walks;
        if (!(b->dvr[walks] = hs_dvr_create(b->cl, s, err))) return false;
    }
    if (!hs_cl_build(b->cl, bench_grids_source, bench_grids_source_size, &b->program, err) ||
        !(b->volume = hs_device_volume_create(b->cl, &b->copy, err)))
        return false;
    b->kernel = clCreateKernel(b->program, HS_DVR_THESIS_KERNEL, &code);
    return hs_cl_check(code, "clCreateKernel(" HS_DVR_THESIS_KERNEL ")", err) &&
           bench_picture_create(&b->picture, b->cl, &b->settings[0], err);
}

static void close_bench(bench *b) {
    bench_picture_destroy(&b->picture);
    if (b->kernel) (void)clReleaseKernel(b->kernel);
    if (b->volume) hs_device_volume_destroy(b->volume);
    if (b->program) (void)clReleaseProgram(b->program);
    for (int walks = 0; walks < 2; walks++) hs_dvr_destroy(b->dvr[walks]);
    hs_volume_free(&b->copy);
}

/* Enqueues the picture from the probe's grid. */
static bool render_probe(const bench *b, const hs_dvr_settings *s, const hs_camera *camera, bool clipped,
                         hs_error *err) {
    const hs_beams_view beams = hs_device_beams_view(hs_device_volume_view(b->volume).beams);
    const double edge = b->copy.spacing[0];
    hs_ray_view v;
    cl_float4 to_mm = {{0.0f, 0.0f, 0.0f, (cl_float)edge}};
    if (!hs_ray_view_of(s, b->volume, camera, &v, err)) return false;
    for (int k = 0; k < 3; k++) to_mm.s[k] = (cl_float)(beams.shape.corner[k] + 0.5 * edge);
    hs_launch launch = hs_launch_begin(b->cl, b->kernel, HS_DVR_THESIS_KERNEL);
    hs_launch_beams(&launch, &beams);
    hs_launch_arg(&launch, sizeof to_mm, &to_mm);
    hs_dvr_thesis_arguments(&launch, s, &v, clipped ? &b->picture.start : NULL, b->picture.pixels, NULL);
    return hs_dvr_launch(&launch, s, NULL, err);
}

static bool time_picture(const bench *b, int way, const hs_camera *camera, bool clipped, double *ms,
                         hs_error *err) {
    const int walks = way == COPY_WALKS || way == PROBE_WALKS;
    const double begin = hs_now();
    const bool ok = way == PROBE || way == PROBE_WALKS
                        ? render_probe(b, &b->settings[walks], camera, clipped, err)
                        : bench_picture_draw(&b->picture, b->dvr[walks], b->volume, camera, clipped, err);
    const bool done = ok && bench_picture_wait(&b->picture, err);
    *ms = (hs_now() - begin) * 1e3;
    return done;
}

static bool read_picture(const bench *b, uint8_t *rgba, size_t bytes, hs_error *err) {
    return hs_cl_check(
        clEnqueueReadBuffer(b->cl->queue, b->picture.pixels, CL_TRUE, 0, bytes, rgba, 0, NULL, NULL),
        "clEnqueueReadBuffer (benchmark)", err);
}

/* How much the two pictures differ: they show one volume, so little. */
static bool compare(const bench *b, const hs_camera *camera, bool clipped, double *difference,
                    hs_error *err) {
    const size_t bytes = (size_t)b->settings->width * b->settings->height * 4;
    uint8_t *pictures = malloc(2 * bytes);
    double ms, sum = 0.0;
    bool ok = pictures != NULL || hs_fail(err, HS_ERR_MEMORY, "benchmark: no memory for two pictures");
    for (int way = COPY; ok && way <= PROBE; way++)
        ok = time_picture(b, way, camera, clipped, &ms, err) &&
             read_picture(b, pictures + (size_t)way * bytes, bytes, err);
    for (size_t i = 0; ok && i < bytes; i++)
        sum += i % 4 == 3 ? 0.0 : fabs((double)pictures[i] - (double)pictures[bytes + i]);
    *difference = sum / (0.75 * (double)bytes);
    free(pictures);
    return ok &&
           (*difference <= ALIKE || hs_fail(err, HS_ERR_FAILED,
                                            "benchmark: the pictures of the two grids differ by %.1f of 255, "
                                            "expected %.0f at most",
                                            *difference, ALIKE));
}

static bool run_view(const bench *b, uint32_t frames, const bench_view *view, bench_grid_view *out,
                     hs_error *err) {
    bench_samples samples[WAYS] = {{0}};
    bench_times *const times[WAYS] = {&out->copy, &out->probe, &out->copy_walks, &out->probe_walks};
    const bool clipped = view->clipped;
    hs_camera camera;
    hs_camera_look(&camera, &b->copy, view->yaw, view->pitch);
    bool ok = compare(b, &camera, clipped, &out->difference, err);
    for (int way = 0; way < WAYS; way++) ok = ok && bench_samples_create(&samples[way], frames, err);
    for (uint32_t i = 0; ok && i <= frames; i++) /* the first is not counted */
        for (int way = 0; ok && way < WAYS; way++) {
            double ms = 0.0;
            ok = time_picture(b, way, &camera, clipped, &ms, err);
            if (i > 0) bench_samples_add(&samples[way], ms);
        }
    out->label = view->label;
    for (int way = 0; way < WAYS; way++) {
        *times[way] = bench_samples_times(&samples[way]);
        bench_samples_destroy(&samples[way]);
    }
    return ok;
}

bool bench_grids_run(const hs_cl *cl, const char *scene, uint32_t size, uint32_t frames,
                     bench_grids_result *out, hs_error *err) {
    bench b = {.cl = cl};
    *out = (bench_grids_result){0};
    (void)snprintf(out->volume, sizeof out->volume, "%s", scene);
    bool ok = scan(&b, scene, size, err) && time_making(&b, &out->making, err) && open_device(&b, err);
    if (ok) {
        out->samples = b.copy.beams->samples;
        out->lines = b.copy.beams->lines;
        out->planes = b.copy.beams->planes;
        out->voxels[0] = b.copy.nx;
        out->voxels[1] = b.copy.ny;
        out->voxels[2] = b.copy.nz;
    }
    for (int i = 0; ok && i < BENCH_VIEWS; i++)
        ok = run_view(&b, frames, &bench_views[i], &out->view[i], err);
    close_bench(&b);
    return ok;
}

void bench_print_grids(const bench_grids_result *r) {
    printf("\nGrids of a probe's volume, in turns: %s, %" PRIu32 " x %" PRIu32 " x %" PRIu32
           " samples, Cartesian copy of %" PRIu32 " x %" PRIu32 " x %" PRIu32 " voxels\n",
           r->volume, r->samples, r->lines, r->planes, r->voxels[0], r->voxels[1], r->voxels[2]);
    printf("one picture, milliseconds; ratios of medians (of minima)\n");
    printf("%-28s | %8s %8s | %-14s | %8s %8s | %-14s | %s\n", "", "copy", "probe's", "probe's / copy",
           "copy", "probe's", "without leaps", "difference of 255");
    double more = INFINITY;
    for (int i = 0; i < BENCH_VIEWS; i++) {
        const bench_grid_view *v = &r->view[i];
        printf("%-28s | %8.2f %8.2f | %5.2f (%5.2f)  | %8.2f %8.2f | %5.2f (%5.2f)  | %.2f\n", v->label,
               v->copy.median, v->probe.median, v->probe.median / v->copy.median, v->probe.min / v->copy.min,
               v->copy_walks.median, v->probe_walks.median, v->probe_walks.median / v->copy_walks.median,
               v->probe_walks.min / v->copy_walks.min, v->difference);
        more = fmin(more, v->probe.median - v->copy.median);
    }
    printf("The copy is made in %.0f (min %.0f)", r->making.median, r->making.min);
    if (more > 0.0)
        printf(": it has paid after %.0f pictures at the latest\n", ceil(r->making.median / more));
    else
        printf(": it never pays in one of the views\n");
}
