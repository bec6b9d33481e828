/* SPDX-License-Identifier: MIT */
#include "loop/screen.h"

#include <stdlib.h>

struct hs_screen {
    const hs_cl *cl;
    hs_dvr_settings settings;
    hs_dvr *dvr;
    size_t pixels;
    cl_mem rgba;        /* the picture */
    cl_mem termination; /* float32 steps */
    cl_mem start;       /* one float32: a depthmap of one pixel */
};

hs_screen *hs_screen_create(const hs_cl *cl, const hs_dvr_settings *settings, hs_error *err) {
    hs_screen *screen = hs_memory(1, sizeof *screen, "picture", err);
    if (!screen) return NULL;
    screen->cl = cl;
    screen->settings = *settings;
    screen->pixels = (size_t)settings->width * settings->height;
    screen->dvr = hs_dvr_create(cl, settings, err);
    if (screen->dvr && hs_cl_take_buffer(cl, screen->pixels * 4, "picture", &screen->rgba, err) &&
        hs_cl_take_buffer(cl, screen->pixels * sizeof(float), "termination depths", &screen->termination,
                          err) &&
        hs_cl_take_buffer(cl, sizeof(float), "start depth", &screen->start, err))
        return screen;
    hs_screen_destroy(screen);
    return NULL;
}

void hs_screen_destroy(hs_screen *screen) {
    if (!screen) return;
    hs_dvr_destroy(screen->dvr);
    if (screen->rgba) clReleaseMemObject(screen->rgba);
    if (screen->termination) clReleaseMemObject(screen->termination);
    if (screen->start) clReleaseMemObject(screen->start);
    free(screen);
}

bool hs_screen_prepare(hs_screen *screen, const hs_device_volume *volume, hs_error *err) {
    return hs_dvr_prepare(screen->dvr, volume, err);
}

bool hs_screen_render(hs_screen *screen, const hs_device_volume *volume, const hs_camera *camera,
                      const hs_start_depths *start, bool with_termination, hs_error *err) {
    return hs_dvr_render(screen->dvr, volume, camera, start, screen->rgba,
                         with_termination ? screen->termination : NULL, NULL, err);
}

bool hs_screen_render_from(hs_screen *screen, const hs_device_volume *volume, const hs_camera *camera,
                           uint32_t step, hs_error *err) {
    const float depth = (float)step;
    /* As many slices as steps: the map's depth then is the step (host_sim/render/dvr.h). */
    const hs_start_depths start = {
        .depth = screen->start, .width = 1, .height = 1, .slices = hs_screen_steps(screen, volume, camera)};
    return hs_cl_check(clEnqueueFillBuffer(screen->cl->queue, screen->start, &depth, sizeof depth, 0,
                                           sizeof depth, 0, NULL, NULL),
                       "clEnqueueFillBuffer (start depth)", err) &&
           hs_dvr_render(screen->dvr, volume, camera, &start, NULL, screen->termination, NULL, err);
}

static bool read_back(const hs_screen *screen, cl_mem from, size_t bytes, void *to, const char *call,
                      hs_error *err) {
    return hs_cl_check(clEnqueueReadBuffer(screen->cl->queue, from, CL_TRUE, 0, bytes, to, 0, NULL, NULL),
                       call, err);
}

bool hs_screen_read(const hs_screen *screen, uint8_t *rgba, hs_error *err) {
    return read_back(screen, screen->rgba, screen->pixels * 4, rgba, "clEnqueueReadBuffer (picture)", err);
}

bool hs_screen_read_termination(const hs_screen *screen, float *termination, hs_error *err) {
    return read_back(screen, screen->termination, screen->pixels * sizeof(float), termination,
                     "clEnqueueReadBuffer (termination depths)", err);
}

uint32_t hs_screen_steps(const hs_screen *screen, const hs_device_volume *volume, const hs_camera *camera) {
    return hs_dvr_steps(&screen->settings, volume, camera);
}
