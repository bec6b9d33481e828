/* SPDX-License-Identifier: MIT */
#include "render/dvr.h"

#include "render/host_launch.h"

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
} ray_view;

/* Where the rays start, as render_volume takes it (cl/dvr.cl). */
typedef struct {
    cl_mem map, confidence; /* NULL: none */
    cl_int4 map_dims;
    cl_float4 to_steps;
} ray_start;

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

static double source_slices(const hs_volume *shape, const hs_camera *camera) {
    double finest = fmin(shape->spacing[0], fmin(shape->spacing[1], shape->spacing[2]));
    return fmax(1.0, round(camera->depth_extent / finest));
}

static uint32_t count_steps(const hs_dvr_settings *settings, const hs_volume *shape,
                            const hs_camera *camera) {
    double steps = ceil(source_slices(shape, camera) / (double)settings->step - 0.5);
    return (uint32_t)fmin(fmax(steps, 1.0), UINT32_MAX);
}

uint32_t hs_dvr_steps(const hs_dvr_settings *settings, const hs_device_volume *source,
                      const hs_camera *camera) {
    const hs_device_view view = hs_device_volume_view(source);
    return count_steps(settings, &view.shape, camera);
}

static cl_float4 scaled(const double v[3], double factor) {
    cl_float4 out = {{(cl_float)(v[0] * factor), (cl_float)(v[1] * factor), (cl_float)(v[2] * factor), 0.0f}};
    return out;
}

/* Bricks up to this value are transparent; -1: none is. A brick of zeros always
 * is: its samples are exactly 0. */
static cl_int transparent_level(const hs_dvr_settings *s) {
    if (!s->skip_empty) return -1;
    return (cl_int)fmax(ceil((double)s->threshold_low * 255.0 - SKIP_MARGIN) - 1.0, 0.0);
}

static bool plan_view(const hs_dvr_settings *s, const hs_device_view *source, const hs_camera *camera,
                      ray_view *out, hs_error *err) {
    const uint32_t steps = count_steps(s, &source->shape, camera);
    if (steps > MAX_STEPS) {
        return hs_fail(err, HS_ERR_USAGE,
                       "renderer: step %g makes %u steps of this volume, expected at most %u",
                       (double)s->step, steps, MAX_STEPS);
    }
    hs_box_map map;
    hs_camera_box_map(camera, &source->shape, &map);
    ray_view v = {.slices = source_slices(&source->shape, camera)};
    const uint32_t n[3] = {source->shape.nx, source->shape.ny, source->shape.nz};
    const double step = (double)s->step / v.slices; /* in box depths */
    double first[3];
    for (int k = 0; k < 3; k++) {
        first[k] =
            map.origin[k] + map.du[k] * 0.5 / s->width + map.dv[k] * 0.5 / s->height + map.dw[k] * 0.5 * step;
        v.dims.s[k] = (cl_int)n[k];
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

/* The view: the first arguments of both kernels. */
static hs_launch begin_launch(const hs_dvr *dvr, cl_kernel kernel, const char *name,
                              const hs_device_view *source, const ray_view *v) {
    hs_launch launch = hs_launch_begin(dvr->cl, kernel, name);
    hs_launch_buffer(&launch, source->voxels);
    hs_launch_arg(&launch, sizeof v->dims, &v->dims);
    hs_launch_buffer(&launch, source->brick_maxima);
    hs_launch_arg(&launch, sizeof v->bricks, &v->bricks);
    hs_launch_arg(&launch, sizeof v->origin, &v->origin);
    hs_launch_arg(&launch, sizeof v->dx, &v->dx);
    hs_launch_arg(&launch, sizeof v->dy, &v->dy);
    hs_launch_arg(&launch, sizeof v->dn, &v->dn);
    return launch;
}

/*
 * CPU: a work item renders 4 x 4 pixels (PACKET_W, PACKET_H in cl/base.cl), a work group a stripe of them:
 * long enough to cost nothing, short enough that no core waits for another. GPU: a square of pixels, whose
 * rays stay close.
 */
static bool enqueue(const hs_dvr *dvr, const hs_launch *launch, cl_event *event, hs_error *err) {
    const bool packets = dvr->cl->lanes > 1;
    const size_t edge = packets ? 4 : 1;
    const size_t local[2] = {packets ? 32 : 8, packets ? 1 : 8};
    const size_t picture[2] = {dvr->settings.width, dvr->settings.height};
    size_t global[2];
    for (int k = 0; k < 2; k++) {
        size_t items = (picture[k] + edge - 1) / edge;
        global[k] = (items + local[k] - 1) / local[k] * local[k];
    }
    return hs_launch_run(launch, 2, global, local, event, err);
}

/* Where the rays start, as the kernel takes it. */
static ray_start plan_start(const hs_dvr_settings *s, const ray_view *v, const hs_start_depths *depths) {
    ray_start out = {.map_dims = {{0, 0, (cl_int)s->width, (cl_int)s->height}},
                     .to_steps = {{0.0f, s->ghost_offset, 0.0f, 0.0f}}};
    if (!depths || !depths->depth) return out;
    out.map = depths->depth;
    out.map_dims.s[0] = (cl_int)depths->width;
    out.map_dims.s[1] = (cl_int)depths->height;
    out.to_steps.s[0] = (cl_float)(v->slices / ((double)depths->slices * (double)s->step));
    out.to_steps.s[2] = s->ghost_width > HARD_CUT_WIDTH ? 1.0f / s->ghost_width : 0.0f;
    if (depths->confidence && out.to_steps.s[2] > 0.0f) {
        out.confidence = depths->confidence;
        out.to_steps.s[3] = s->ghost_width * s->ghost_doubt;
    }
    return out;
}

static void set_transfer(hs_launch *launch, const hs_dvr_settings *s) {
    const double low = (double)s->threshold_low * 255.0, high = (double)s->threshold_high * 255.0;
    const cl_float4 window = {{(cl_float)low, (cl_float)(1.0 / (high - low)), s->termination, s->step}};
    const float gain = s->exposure;
    const cl_float4 skin = {{gain * s->skin[0], gain * s->skin[1], gain * s->skin[2], 0.0f}};
    hs_launch_arg(launch, sizeof window, &window);
    hs_launch_arg(launch, sizeof skin, &skin);
}

/* A buffer that may be NULL, and whether it is wanted. */
static void set_output(hs_launch *launch, cl_mem buffer) {
    const cl_int wanted = buffer != NULL;
    hs_launch_buffer(launch, buffer);
    hs_launch_arg(launch, sizeof wanted, &wanted);
}

static bool check_start(const hs_start_depths *depths, hs_error *err) {
    if (!depths || !depths->depth) return true;
    if (depths->width == 0 || depths->height == 0 || depths->slices == 0 || depths->width > MAX_PICTURE ||
        depths->height > MAX_PICTURE) {
        return hs_fail(err, HS_ERR_USAGE,
                       "renderer: depthmap of %u x %u pixels for %u slices, expected 1 .. %u", depths->width,
                       depths->height, depths->slices, (unsigned)MAX_PICTURE);
    }
    const uint64_t bytes = (uint64_t)depths->width * depths->height * sizeof(float);
    return hs_cl_check_size(depths->depth, bytes, "start depths", err) &&
           (!depths->confidence || hs_cl_check_size(depths->confidence, bytes, "the confidence", err));
}

bool hs_dvr_render(hs_dvr *dvr, const hs_device_volume *source, const hs_camera *camera,
                   const hs_start_depths *depths, cl_mem rgba, cl_mem termination, cl_event *event,
                   hs_error *err) {
    if (!check_start(depths, err)) return false;
    const uint64_t pixels = (uint64_t)dvr->settings.width * dvr->settings.height;
    if (rgba && !hs_cl_check_size(rgba, pixels * 4, "the picture", err)) return false;
    if (termination && !hs_cl_check_size(termination, pixels * sizeof(float), "termination depths", err))
        return false;
    ray_view v;
    const hs_device_view view = hs_device_volume_view(source);
    if (!plan_view(&dvr->settings, &view, camera, &v, err)) return false;
    const ray_start rays = plan_start(&dvr->settings, &v, depths);
    hs_launch launch = begin_launch(dvr, dvr->render, "render_volume", &view, &v);
    hs_launch_buffer(&launch, rays.map);
    hs_launch_arg(&launch, sizeof rays.map_dims, &rays.map_dims);
    hs_launch_arg(&launch, sizeof rays.to_steps, &rays.to_steps);
    set_transfer(&launch, &dvr->settings);
    set_output(&launch, rgba);
    set_output(&launch, termination);
    hs_launch_buffer(&launch, rays.confidence);
    return enqueue(dvr, &launch, event, err);
}

bool hs_dvr_mip(hs_dvr *dvr, const hs_device_volume *source, const hs_camera *camera, cl_mem gray,
                cl_event *event, hs_error *err) {
    const uint64_t pixels = (uint64_t)dvr->settings.width * dvr->settings.height;
    if (!hs_cl_check_size(gray, pixels, "the projection", err)) return false;
    ray_view v;
    const hs_device_view view = hs_device_volume_view(source);
    if (!plan_view(&dvr->settings, &view, camera, &v, err)) return false;
    const cl_int4 picture = {{(cl_int)dvr->settings.width, (cl_int)dvr->settings.height, 0, 0}};
    hs_launch launch = begin_launch(dvr, dvr->mip, "project_maximum", &view, &v);
    hs_launch_arg(&launch, sizeof picture, &picture);
    hs_launch_buffer(&launch, gray);
    return enqueue(dvr, &launch, event, err);
}
