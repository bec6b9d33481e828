/* SPDX-License-Identifier: MIT */
#include "render/dvr.h"

#include "render/device_volume.h"

#include <math.h>
#include <stdlib.h>

#define MAX_PICTURE 8192
#define MAX_STEPS   (1u << 22) /* kernels count steps in float */
/* Grey levels below T_L from which on a brick counts as transparent: more than any rounding of a sample. */
#define SKIP_MARGIN    1e-3
#define HARD_CUT_WIDTH 1e-6f /* steps: a ghost no wider than this is a hard cut */

struct hs_dvr {
    const hs_cl *cl;
    hs_dvr_settings settings;
    cl_kernel render, mip;
};

/* The view as the kernels take it (cl/base_rays.cl). */
typedef struct {
    cl_int4 dims, bricks;
    cl_float4 origin, dx, dy, dn;
    double slices; /* source slices along the box' depth */
} view;

void hs_dvr_defaults(hs_dvr_settings *settings) {
    const hs_dvr_settings defaults = {
        .width = 512,
        .height = 512,
        .threshold_low = 40.5f / 255.0f,
        .threshold_high = 0.45f,
        .step = 1.0f,
        .termination = 0.95f,
        .ghost_offset = 0.0f,
        .ghost_width = 0.0f,
        .ghost_doubt = 2.0f,
        .skin = {1.0f, 0.85f, 0.72f},
        .exposure = 1.0f,
        .skip_empty = true,
    };
    *settings = defaults;
}

static bool check_settings(const hs_dvr_settings *s, hs_error *err) {
    const struct {
        const char *name;
        double value, low, high;
    } fields[] = {
        {"width", s->width, 1, MAX_PICTURE},
        {"height", s->height, 1, MAX_PICTURE},
        {"threshold_low", s->threshold_low, 0, 1},
        {"threshold_high", s->threshold_high, (double)s->threshold_low + 1e-6, 2},
        {"step", s->step, 0.01, 100},
        {"termination", s->termination, 1e-3, INFINITY},
        {"ghost_offset", s->ghost_offset, -(double)MAX_STEPS, MAX_STEPS},
        {"ghost_width", s->ghost_width, 0, MAX_STEPS},
        {"ghost_doubt", s->ghost_doubt, 0, HS_DVR_MAX_DOUBT},
        {"skin[0]", s->skin[0], 0, 1},
        {"skin[1]", s->skin[1], 0, 1},
        {"skin[2]", s->skin[2], 0, 1},
        {"exposure", s->exposure, 0.1, 10},
    };
    for (size_t i = 0; i < sizeof fields / sizeof fields[0]; i++) {
        if (fields[i].value >= fields[i].low && fields[i].value <= fields[i].high) continue;
        return hs_fail(err, HS_ERR_USAGE, "renderer: %s is %g, expected %g .. %g", fields[i].name,
                       fields[i].value, fields[i].low, fields[i].high);
    }
    return true;
}

static bool init(hs_dvr *dvr, const hs_dvr_settings *settings, hs_error *err) {
    if (!check_settings(settings, err)) return false;
    dvr->settings = *settings;
    cl_int code = CL_SUCCESS;
    dvr->render = clCreateKernel(dvr->cl->program, "render_volume", &code);
    if (!hs_cl_check(code, "clCreateKernel(render_volume)", err)) return false;
    dvr->mip = clCreateKernel(dvr->cl->program, "project_maximum", &code);
    return hs_cl_check(code, "clCreateKernel(project_maximum)", err);
}

hs_dvr *hs_dvr_create(const hs_cl *cl, const hs_dvr_settings *settings, hs_error *err) {
    hs_dvr *dvr = calloc(1, sizeof *dvr);
    if (!dvr) {
        hs_fail(err, HS_ERR_MEMORY, "renderer: no memory");
        return NULL;
    }
    dvr->cl = cl;
    if (init(dvr, settings, err)) return dvr;
    hs_dvr_destroy(dvr);
    return NULL;
}

void hs_dvr_destroy(hs_dvr *dvr) {
    if (!dvr) return;
    if (dvr->render) (void)clReleaseKernel(dvr->render);
    if (dvr->mip) (void)clReleaseKernel(dvr->mip);
    free(dvr);
}

static double source_slices(const hs_device_volume *source, const hs_camera *camera) {
    double finest = fmin(source->spacing[0], fmin(source->spacing[1], source->spacing[2]));
    return fmax(1.0, round(camera->depth_extent / finest));
}

uint32_t hs_dvr_steps(const hs_dvr_settings *settings, const hs_device_volume *source,
                      const hs_camera *camera) {
    double steps = ceil(source_slices(source, camera) / (double)settings->step - 0.5);
    return (uint32_t)fmin(fmax(steps, 1.0), UINT32_MAX);
}

static cl_float4 scaled(const double v[3], double factor) {
    cl_float4 out = {{(cl_float)(v[0] * factor), (cl_float)(v[1] * factor), (cl_float)(v[2] * factor), 0.0f}};
    return out;
}

/* Bricks up to this value are transparent; -1: none is. A brick of zeros always is: its samples are exactly
 * 0. */
static cl_int transparent_level(const hs_dvr_settings *s) {
    if (!s->skip_empty) return -1;
    return (cl_int)fmax(ceil((double)s->threshold_low * 255.0 - SKIP_MARGIN) - 1.0, 0.0);
}

static bool plan_view(const hs_dvr_settings *s, const hs_device_volume *source, const hs_camera *camera,
                      view *out, hs_error *err) {
    const uint32_t steps = hs_dvr_steps(s, source, camera);
    if (steps > MAX_STEPS) {
        return hs_fail(err, HS_ERR_USAGE,
                       "renderer: step %g makes %u steps of this volume, expected at most %u",
                       (double)s->step, steps, MAX_STEPS);
    }
    const hs_volume shape = {.nx = source->n[0],
                             .ny = source->n[1],
                             .nz = source->n[2],
                             .spacing = {source->spacing[0], source->spacing[1], source->spacing[2]}};
    hs_box_map map;
    hs_camera_box_map(camera, &shape, &map);
    view v = {.slices = source_slices(source, camera)};
    const double step = (double)s->step / v.slices; /* in box depths */
    double first[3];
    for (int k = 0; k < 3; k++) {
        first[k] =
            map.origin[k] + map.du[k] * 0.5 / s->width + map.dv[k] * 0.5 / s->height + map.dw[k] * 0.5 * step;
        v.dims.s[k] = (cl_int)source->n[k];
        v.bricks.s[k] = (cl_int)source->bricks[k];
    }
    v.dims.s[3] = (cl_int)steps;
    v.bricks.s[3] = transparent_level(s);
    v.origin = scaled(first, 1.0);
    v.dx = scaled(map.du, 1.0 / s->width);
    v.dy = scaled(map.dv, 1.0 / s->height);
    v.dn = scaled(map.dw, step);
    *out = v;
    return true;
}

/* Arguments 0 to 7, which both kernels share. */
static cl_int set_view(cl_kernel kernel, const hs_device_volume *source, const view *v) {
    cl_int code = clSetKernelArg(kernel, 0, sizeof(cl_mem), &source->voxels);
    code |= clSetKernelArg(kernel, 1, sizeof v->dims, &v->dims);
    code |= clSetKernelArg(kernel, 2, sizeof(cl_mem), &source->grid);
    code |= clSetKernelArg(kernel, 3, sizeof v->bricks, &v->bricks);
    code |= clSetKernelArg(kernel, 4, sizeof v->origin, &v->origin);
    code |= clSetKernelArg(kernel, 5, sizeof v->dx, &v->dx);
    code |= clSetKernelArg(kernel, 6, sizeof v->dy, &v->dy);
    code |= clSetKernelArg(kernel, 7, sizeof v->dn, &v->dn);
    return code;
}

/*
 * CPU: a work item renders 4 x 4 pixels (PACKET_W, PACKET_H in cl/base.cl), a work group a stripe of them:
 * long enough to cost nothing, short enough that no core waits for another. GPU: a square of pixels, whose
 * rays stay close.
 */
static bool enqueue(hs_dvr *dvr, cl_kernel kernel, cl_event *event, const char *call, hs_error *err) {
    const bool packets = dvr->cl->lanes > 1;
    const size_t edge = packets ? 4 : 1;
    const size_t local[2] = {packets ? 32 : 8, packets ? 1 : 8};
    const size_t picture[2] = {dvr->settings.width, dvr->settings.height};
    size_t global[2];
    for (int k = 0; k < 2; k++) {
        size_t items = (picture[k] + edge - 1) / edge;
        global[k] = (items + local[k] - 1) / local[k] * local[k];
    }
    cl_int code = clEnqueueNDRangeKernel(dvr->cl->queue, kernel, 2, NULL, global, local, 0, NULL, event);
    return hs_cl_check(code, call, err);
}

/* Arguments 8 to 12 and 17: start depths, transfer function, confidence. */
static cl_int set_transfer(hs_dvr *dvr, const view *v, const hs_start_depths *start) {
    const hs_dvr_settings *s = &dvr->settings;
    const bool clipped = start && start->depth;
    cl_mem map = clipped ? start->depth : NULL, sure = NULL;
    cl_int4 map_dims = {{0, 0, (cl_int)s->width, (cl_int)s->height}};
    cl_float4 to_steps = {{0.0f, s->ghost_offset, 0.0f, 0.0f}};
    if (clipped) {
        map_dims.s[0] = (cl_int)start->width;
        map_dims.s[1] = (cl_int)start->height;
        to_steps.s[0] = (cl_float)(v->slices / ((double)start->slices * (double)s->step));
        to_steps.s[2] = s->ghost_width > HARD_CUT_WIDTH ? 1.0f / s->ghost_width : 0.0f;
        if (start->confidence && to_steps.s[2] > 0.0f) {
            sure = start->confidence;
            to_steps.s[3] = s->ghost_width * s->ghost_doubt;
        }
    }
    const double low = (double)s->threshold_low * 255.0, high = (double)s->threshold_high * 255.0;
    const cl_float4 window = {{(cl_float)low, (cl_float)(1.0 / (high - low)), s->termination, s->step}};
    const float gain = s->exposure;
    const cl_float4 skin = {{gain * s->skin[0], gain * s->skin[1], gain * s->skin[2], 0.0f}};
    cl_int code = clSetKernelArg(dvr->render, 8, sizeof(cl_mem), map ? &map : NULL);
    code |= clSetKernelArg(dvr->render, 9, sizeof map_dims, &map_dims);
    code |= clSetKernelArg(dvr->render, 10, sizeof to_steps, &to_steps);
    code |= clSetKernelArg(dvr->render, 11, sizeof window, &window);
    code |= clSetKernelArg(dvr->render, 12, sizeof skin, &skin);
    code |= clSetKernelArg(dvr->render, 17, sizeof(cl_mem), sure ? &sure : NULL);
    return code;
}

static cl_int set_output(cl_kernel kernel, cl_uint index, cl_mem buffer) {
    const cl_int wanted = buffer != NULL;
    cl_int code = clSetKernelArg(kernel, index, sizeof(cl_mem), buffer ? &buffer : NULL);
    code |= clSetKernelArg(kernel, index + 1, sizeof wanted, &wanted);
    return code;
}

static bool check_start(const hs_start_depths *start, hs_error *err) {
    if (!start || !start->depth) return true;
    if (start->width == 0 || start->height == 0 || start->slices == 0 || start->width > MAX_PICTURE ||
        start->height > MAX_PICTURE) {
        return hs_fail(err, HS_ERR_USAGE,
                       "renderer: depthmap of %u x %u pixels for %u slices, expected 1 .. %u", start->width,
                       start->height, start->slices, (unsigned)MAX_PICTURE);
    }
    const uint64_t bytes = (uint64_t)start->width * start->height * sizeof(float);
    return hs_cl_check_size(start->depth, bytes, "start depths", err) &&
           (!start->confidence || hs_cl_check_size(start->confidence, bytes, "the confidence", err));
}

bool hs_dvr_render(hs_dvr *dvr, const hs_device_volume *source, const hs_camera *camera,
                   const hs_start_depths *start, cl_mem rgba, cl_mem termination, cl_event *event,
                   hs_error *err) {
    if (!check_start(start, err)) return false;
    const uint64_t pixels = (uint64_t)dvr->settings.width * dvr->settings.height;
    if (rgba && !hs_cl_check_size(rgba, pixels * 4, "the picture", err)) return false;
    if (termination && !hs_cl_check_size(termination, pixels * sizeof(float), "termination depths", err))
        return false;
    view v;
    if (!plan_view(&dvr->settings, source, camera, &v, err)) return false;
    cl_int code = set_view(dvr->render, source, &v);
    code |= set_transfer(dvr, &v, start);
    code |= set_output(dvr->render, 13, rgba);
    code |= set_output(dvr->render, 15, termination);
    if (!hs_cl_check(code, "clSetKernelArg(render_volume)", err)) return false;
    return enqueue(dvr, dvr->render, event, "clEnqueueNDRangeKernel(render_volume)", err);
}

bool hs_dvr_mip(hs_dvr *dvr, const hs_device_volume *source, const hs_camera *camera, cl_mem gray,
                cl_event *event, hs_error *err) {
    const uint64_t pixels = (uint64_t)dvr->settings.width * dvr->settings.height;
    if (!hs_cl_check_size(gray, pixels, "the projection", err)) return false;
    view v;
    if (!plan_view(&dvr->settings, source, camera, &v, err)) return false;
    const cl_int4 picture = {{(cl_int)dvr->settings.width, (cl_int)dvr->settings.height, 0, 0}};
    cl_int code = set_view(dvr->mip, source, &v);
    code |= clSetKernelArg(dvr->mip, 8, sizeof picture, &picture);
    code |= clSetKernelArg(dvr->mip, 9, sizeof(cl_mem), &gray);
    if (!hs_cl_check(code, "clSetKernelArg(project_maximum)", err)) return false;
    return enqueue(dvr, dvr->mip, event, "clEnqueueNDRangeKernel(project_maximum)", err);
}
