/* SPDX-License-Identifier: MIT */
#include "bench/bench_picture.h"

#define SIDE   2u    /* pixels of the depthmap */
#define SLICES 1000u /* of the low-resolution volume that it is said to be of */

const bench_view bench_views[BENCH_VIEWS] = {{"still camera clipped", 0, 0, true},
                                             {"rotated camera clipped", 30, 20, true},
                                             {"still camera full volume", 0, 0, false},
                                             {"rotated camera full volume", 30, 20, false}};

bool bench_picture_create(bench_picture *p, const hs_cl *cl, const hs_dvr_settings *settings, hs_error *err) {
    const cl_float depth = (cl_float)(BENCH_PICTURE_PLANE * SLICES);
    const size_t bytes = (size_t)settings->width * settings->height * 4;
    *p = (bench_picture){.cl = cl, .start = {.width = SIDE, .height = SIDE, .slices = SLICES}};
    if (!hs_cl_take_buffer(cl, bytes, "picture", &p->pixels, err) ||
        !hs_cl_take_buffer(cl, SIDE * SIDE * sizeof depth, "start depths", &p->start.depth, err))
        return false;
    const cl_int code = clEnqueueFillBuffer(cl->queue, p->start.depth, &depth, sizeof depth, 0,
                                            SIDE * SIDE * sizeof depth, 0, NULL, NULL);
    return hs_cl_check(code, "clEnqueueFillBuffer (benchmark)", err) && bench_picture_wait(p, err);
}

void bench_picture_destroy(bench_picture *p) {
    if (p->pixels) (void)clReleaseMemObject(p->pixels);
    if (p->start.depth) (void)clReleaseMemObject(p->start.depth);
    *p = (bench_picture){0};
}

bool bench_picture_draw(const bench_picture *p, hs_dvr *dvr, const hs_device_volume *volume,
                        const hs_camera *camera, bool clipped, hs_error *err) {
    return hs_dvr_render(dvr, volume, camera, clipped ? &p->start : NULL, p->pixels, NULL, NULL, err);
}

bool bench_picture_wait(const bench_picture *p, hs_error *err) {
    return hs_cl_check(clFinish(p->cl->queue), "clFinish (benchmark)", err);
}
