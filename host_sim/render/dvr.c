/* SPDX-License-Identifier: MIT */
/* The two looks of the renderer: what they share, and the arguments of their kernels. docs/rendering.md
 * defines them. */
#include "render/dvr.h"

#include "render/derived_volume.h"

#include <math.h>
#include <stdlib.h>

#define HARD_CUT      1e-6f /* steps: a ghost no wider than this is a hard cut */
#define THESIS_KERNEL "render_volume"
#define LIT_KERNEL    "render_lit"

struct hs_dvr {
    const hs_cl *cl;
    hs_dvr_settings settings;
    cl_kernel render;
    cl_kernel lit; /* NULL: the look is the thesis' */
};

/* The view as the kernels take it (cl/base_rays.cl, cl/dvr.cl). */
typedef struct {
    cl_mem voxels, maxima;
    cl_int4 dims, bricks;
    cl_float4 origin, dx, dy, dn;
    double slices; /* source slices along the box' depth */
} ray_view;

/* What the lit look draws, and how. Pointers are borrowed. */
typedef struct {
    hs_lit_view volume;
    const hs_volume *shape; /* the source's size and spacing */
    const hs_camera *camera;
    const hs_dvr_settings *settings;
} lit_scene;

/* Grey levels below T_L from which on a brick counts as transparent: more than any rounding of a sample. */
#define SKIP_MARGIN 1e-3

/* Source slices along the box' depth: round(depth_extent / finest spacing), 1 at least. */
static double source_slices(const hs_volume *shape, const hs_camera *camera) {
    double finest = fmin(shape->spacing[0], fmin(shape->spacing[1], shape->spacing[2]));
    return fmax(1.0, round(camera->depth_extent / finest));
}

static uint32_t count_steps(const hs_dvr_settings *settings, const hs_volume *shape,
                            const hs_camera *camera) {
    double steps = ceil(source_slices(shape, camera) / (double)settings->step - 0.5);
    return (uint32_t)fmin(fmax(steps, 1.0), UINT32_MAX);
}

static bool check_steps(const hs_dvr_settings *s, uint32_t steps, hs_error *err) {
    return steps <= HS_DVR_MAX_STEPS ||
           hs_fail(err, HS_ERR_INPUT, "renderer: step %g makes %u steps of this volume, expected at most %u",
                   (double)s->step, steps, HS_DVR_MAX_STEPS);
}

/* factor * v, as kernels take it. */
static cl_float4 float4_of(const double v[3], double factor) {
    cl_float4 out = {{(cl_float)(v[0] * factor), (cl_float)(v[1] * factor), (cl_float)(v[2] * factor), 0.0f}};
    return out;
}

/* How pixels of the picture lie in the map, as kernels take it: to_map of cl/dvr.cl. */
static cl_float4 pixel_to_map(const hs_dvr_settings *settings, const hs_start_depths *depths) {
    const double share = depths->share > 0.0f ? (double)depths->share : 1.0;
    cl_float4 out = {{(cl_float)(share * depths->width / settings->width),
                      (cl_float)(share * depths->height / settings->height),
                      (cl_float)(0.5 * (1.0 - share) * depths->width),
                      (cl_float)(0.5 * (1.0 - share) * depths->height)}};
    return out;
}

/* Bricks up to this value are transparent; -1: none is. A brick of zeros always is: its samples are exactly
 * 0. */
static cl_int transparent_limit(const hs_dvr_settings *s) {
    if (!s->skip_empty) return -1;
    return (cl_int)fmax(ceil((double)s->threshold_low * 255.0 - SKIP_MARGIN) - 1.0, 0.0);
}

/* Enqueues the volume's brick maxima if they are not there. */
static bool view_of(const hs_dvr_settings *s, const hs_device_volume *source, const hs_camera *camera,
                    ray_view *out, hs_error *err) {
    const hs_device_view view = hs_device_volume_view(source);
    const hs_volume *shape = &view.shape;
    const uint32_t steps = count_steps(s, shape, camera);
    hs_brick_view bricks;
    if (!hs_device_volume_bricks(source, &bricks, err) || !check_steps(s, steps, err)) return false;
    hs_box_map map;
    hs_camera_box_map(camera, shape, &map);
    ray_view v = {.voxels = view.voxels,
                  .maxima = bricks.maxima,
                  .bricks = bricks.count,
                  .slices = source_slices(shape, camera)};
    const uint32_t n[3] = {shape->nx, shape->ny, shape->nz};
    const double step = (double)s->step / v.slices; /* in box depths */
    double first[3];
    for (int k = 0; k < 3; k++) {
        first[k] =
            map.origin[k] + map.du[k] * 0.5 / s->width + map.dv[k] * 0.5 / s->height + map.dw[k] * 0.5 * step;
        v.dims.s[k] = (cl_int)n[k];
    }
    v.dims.s[3] = (cl_int)steps;
    v.bricks.s[3] = transparent_limit(s);
    v.origin = float4_of(first, 1.0);
    v.dx = float4_of(map.du, 1.0 / s->width);
    v.dy = float4_of(map.dv, 1.0 / s->height);
    v.dn = float4_of(map.dw, step);
    *out = v;
    return true;
}

/* The next seven arguments of a kernel, as render_volume has them (cl/dvr.cl): the view but for what is
 * sampled. */
static void launch_view(hs_launch *launch, const ray_view *v) {
    hs_launch_arg(launch, sizeof v->dims, &v->dims);
    hs_launch_buffer(launch, v->maxima);
    hs_launch_arg(launch, sizeof v->bricks, &v->bricks);
    hs_launch_arg(launch, sizeof v->origin, &v->origin);
    hs_launch_arg(launch, sizeof v->dx, &v->dx);
    hs_launch_arg(launch, sizeof v->dy, &v->dy);
    hs_launch_arg(launch, sizeof v->dn, &v->dn);
}

/*
 * Runs a kernel over the picture, a work item a packet of pixels (cl/base.cl); does not wait.
 * CPU: a work item renders 4 x 4 pixels (PACKET_W, PACKET_H in cl/base.cl) and is a group of its own: PoCL
 * keeps the variables of a whole group on a thread's stack, 26 KB an item of render_lit. GPU: a square of
 * pixels, whose rays stay close.
 */
static bool launch_picture(const hs_launch *launch, const hs_dvr_settings *settings, cl_event *event,
                           hs_error *err) {
    const bool packets = launch->cl->lanes > 1;
    const size_t edge = packets ? 4 : 1, group = packets ? 1 : 8;
    const size_t local[2] = {group, group}, picture[2] = {settings->width, settings->height};
    size_t global[2];
    for (int k = 0; k < 2; k++) {
        size_t items = (picture[k] + edge - 1) / edge;
        global[k] = (items + group - 1) / group * group;
    }
    return hs_launch_run(launch, 2, global, local, event, err);
}

/* Where the rays start, as render_volume takes it (cl/dvr.cl). */
typedef struct {
    cl_mem map, confidence; /* NULL: none */
    cl_int4 map_dims;
    cl_float4 to_map, to_steps;
} ray_start;

static ray_start plan_start(const hs_dvr_settings *s, const ray_view *v, const hs_start_depths *depths) {
    ray_start out = {.map_dims = {{0, 0, (cl_int)s->width, (cl_int)s->height}},
                     .to_steps = {{0.0f, s->ghost_offset, 0.0f, 0.0f}}};
    if (!depths || !depths->depth) return out;
    out.map = depths->depth;
    out.map_dims.s[0] = (cl_int)depths->width;
    out.map_dims.s[1] = (cl_int)depths->height;
    out.to_map = pixel_to_map(s, depths);
    out.to_steps.s[0] = (cl_float)(v->slices / ((double)depths->slices * (double)s->step));
    out.to_steps.s[2] = s->ghost_width > HARD_CUT ? 1.0f / s->ghost_width : 0.0f;
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

/* The thesis' look, and the ends of rays in either. */
static bool render_thesis(hs_dvr *dvr, const hs_device_volume *source, const hs_camera *camera,
                          const hs_start_depths *depths, cl_mem rgba, cl_mem termination, cl_event *event,
                          hs_error *err) {
    const hs_dvr_settings *s = &dvr->settings;
    ray_view view;
    if (!view_of(s, source, camera, &view, err)) return false;
    const ray_start rays = plan_start(s, &view, depths);
    hs_launch launch = hs_launch_begin(dvr->cl, dvr->render, THESIS_KERNEL);
    hs_launch_buffer(&launch, view.voxels);
    launch_view(&launch, &view);
    hs_launch_buffer(&launch, rays.map);
    hs_launch_arg(&launch, sizeof rays.map_dims, &rays.map_dims);
    hs_launch_arg(&launch, sizeof rays.to_map, &rays.to_map);
    hs_launch_arg(&launch, sizeof rays.to_steps, &rays.to_steps);
    set_transfer(&launch, s);
    set_output(&launch, rgba);
    set_output(&launch, termination);
    hs_launch_buffer(&launch, rays.confidence);
    return launch_picture(&launch, s, event, err);
}

#define UNITS         256.0 /* of thickness along the volume's mean edge ... */
#define THICKNESS     1.5   /* ... each with this optical depth at opacity 1 */
#define LIGHT_UNITS   64.0  /* of light along the same edge: distances of occlusion and shadow */
#define FLAT_GRADIENT 0.5   /* grey levels a smoothed voxel: below, a normal turns to the viewer */
#define DEGREE        0.017453292519943295

/* The geometry as render_lit takes it (cl/lit_render.cl). */
typedef struct {
    cl_int4 dims, bricks;
    cl_float4 origin, dx, dy, dn, mx, my, mz, per_mm;
    double slices, edge_mm; /* source slices along the box' depth; edge of a cube of the volume's size */
    double sample_steps, sample_mm; /* from sample to sample, a smoothed voxel */
} lit_plan;

static lit_plan plan_geometry(const lit_scene *scene) {
    const hs_dvr_settings *s = scene->settings;
    const hs_volume *shape = scene->shape;
    const uint32_t n[3] = {shape->nx, shape->ny, shape->nz};
    hs_box_map map;
    hs_camera_box_map(scene->camera, shape, &map);
    lit_plan p = {.dims = scene->volume.dims, .bricks = scene->volume.bricks.count};
    p.slices = source_slices(shape, scene->camera);
    const double factor = scene->volume.factor;
    double first[3], du[3], dv[3], dw[3], size = 1.0, finest = shape->spacing[0];
    cl_float4 *const rows[3] = {&p.mx, &p.my, &p.mz};
    for (int k = 0; k < 3; k++) {
        /* Index i of the source, here: hs_lit_view. */
        first[k] = map.origin[k] + map.du[k] * 0.5 / s->width + map.dv[k] * 0.5 / s->height;
        first[k] = (first[k] - 0.5 * (factor - 1.0)) / factor + HS_LIT_BORDER;
        du[k] = map.du[k] / (factor * s->width);
        dv[k] = map.dv[k] / (factor * s->height);
        dw[k] = map.dw[k] * (double)s->step / p.slices;
        *rows[k] = float4_of(scene->camera->rotation + (size_t)k * 3, 1.0 / (factor * shape->spacing[k]));
        size *= n[k] * shape->spacing[k];
        finest = fmin(finest, shape->spacing[k]);
    }
    p.edge_mm = cbrt(size);
    p.mx.s[3] = (cl_float)(FLAT_GRADIENT / (factor * finest));
    p.origin = float4_of(first, 1.0);
    p.dx = float4_of(du, 1.0);
    p.dy = float4_of(dv, 1.0);
    p.dn = float4_of(dw, 1.0);
    p.sample_steps = factor;
    p.sample_mm = factor * (double)s->step * scene->camera->depth_extent / p.slices;
    p.dims.s[3] = (cl_int)ceil(scene->camera->depth_extent / p.sample_mm) + 1;
    p.bricks.s[3] = transparent_limit(s);
    p.per_mm = (cl_float4){{(cl_float)(s->width / scene->camera->extent),
                            (cl_float)(s->height / scene->camera->extent), (cl_float)(1.0 / p.sample_mm),
                            (cl_float)(p.edge_mm / LIGHT_UNITS)}};
    return p;
}

/* Depth d of the map is box depth (d + 0.5) / M; ghosting is over w - s steps behind it. */
static void set_start(hs_launch *launch, const lit_scene *scene, const lit_plan *p,
                      const hs_start_depths *depths) {
    const hs_dvr_settings *s = scene->settings;
    cl_int4 map_dims = {{0, 0, (cl_int)s->width, (cl_int)s->height}};
    cl_float4 to_map = {{0}}, to_samples = {{0}};
    cl_mem map = NULL, confidence = NULL;
    if (depths && depths->depth) {
        const double slice = p->slices / (depths->slices * (double)s->step * p->sample_steps);
        const double width = s->ghost_width > HARD_CUT ? (double)s->ghost_width : 0.0;
        map = depths->depth;
        map_dims.s[0] = (cl_int)depths->width;
        map_dims.s[1] = (cl_int)depths->height;
        to_map = pixel_to_map(s, depths);
        to_samples.s[0] = (cl_float)slice;
        to_samples.s[1] = (cl_float)(0.5 * slice + (width - (double)s->ghost_offset) / p->sample_steps);
        if (width > 0.0) to_samples.s[2] = (cl_float)(p->sample_steps / width);
        if (width > 0.0 && depths->confidence) {
            confidence = depths->confidence;
            to_samples.s[3] = (cl_float)(width * (double)s->ghost_doubt / p->sample_steps);
        }
    }
    hs_launch_buffer(launch, map);
    hs_launch_buffer(launch, confidence);
    hs_launch_arg(launch, sizeof map_dims, &map_dims);
    hs_launch_arg(launch, sizeof to_map, &to_map);
    hs_launch_arg(launch, sizeof to_samples, &to_samples);
}

static void set_window(hs_launch *launch, const lit_scene *scene, const lit_plan *p) {
    const hs_dvr_settings *s = scene->settings;
    const double low = (double)s->threshold_low * 255.0, high = (double)s->threshold_high * 255.0;
    const cl_float4 window = {{(cl_float)low, (cl_float)(1.0 / (high - low)),
                               (cl_float)(THICKNESS * p->sample_mm * UNITS / p->edge_mm), s->exposure}};
    hs_launch_arg(launch, sizeof window, &window);
}

static void set_light(hs_launch *launch, const hs_dvr_settings *s, const lit_plan *p) {
    const double azimuth = (double)s->light[0] * DEGREE, elevation = (double)s->light[1] * DEGREE;
    const double lamp[3] = {sin(azimuth) * cos(elevation), -sin(elevation), -cos(azimuth) * cos(elevation)};
    double between[3] = {lamp[0], lamp[1], lamp[2] - 1.0}, length = 0.0;
    for (int k = 0; k < 3; k++) length += between[k] * between[k];
    const cl_float4 lamp4 = float4_of(lamp, 1.0);
    const cl_float4 between4 = float4_of(between, length > 0.0 ? 1.0 / sqrt(length) : 0.0);
    const cl_float4 skin = {
        {s->skin[0], s->skin[1], s->skin[2], (cl_float)(p->sample_steps * (double)s->step / p->slices)}};
    hs_launch_arg(launch, sizeof lamp4, &lamp4);
    hs_launch_arg(launch, sizeof between4, &between4);
    hs_launch_arg(launch, sizeof skin, &skin);
}

static bool render_lit(hs_dvr *dvr, const hs_device_volume *source, const hs_camera *camera,
                       const hs_start_depths *depths, cl_mem rgba, cl_event *event, hs_error *err) {
    const hs_dvr_settings *s = &dvr->settings;
    const hs_device_view view = hs_device_volume_view(source);
    lit_scene scene = {.shape = &view.shape, .camera = camera, .settings = s};
    if (!hs_device_volume_lit(source, s->threshold_low, s->threshold_high, &scene.volume, err) ||
        !check_steps(s, count_steps(s, &view.shape, camera), err))
        return false;
    const lit_plan p = plan_geometry(&scene);
    const hs_lit_view *v = &scene.volume;
    hs_launch launch = hs_launch_begin(dvr->cl, dvr->lit, LIT_KERNEL);
    hs_launch_buffer(&launch, v->smooth);
    hs_launch_arg(&launch, sizeof p.dims, &p.dims);
    hs_launch_buffer(&launch, v->bricks.maxima);
    hs_launch_arg(&launch, sizeof p.bricks, &p.bricks);
    hs_launch_buffer(&launch, v->opacity);
    hs_launch_arg(&launch, sizeof v->cells, &v->cells);
    hs_launch_buffer(&launch, v->share.scanned);
    hs_launch_arg(&launch, sizeof v->share.dims, &v->share.dims);
    const cl_float4 *const rays[4] = {&p.origin, &p.dx, &p.dy, &p.dn};
    for (int i = 0; i < 4; i++) hs_launch_arg(&launch, sizeof *rays[i], rays[i]);
    set_start(&launch, &scene, &p, depths);
    set_window(&launch, &scene, &p);
    const cl_float4 *const axes[4] = {&p.mx, &p.my, &p.mz, &p.per_mm};
    for (int i = 0; i < 4; i++) hs_launch_arg(&launch, sizeof *axes[i], axes[i]);
    set_light(&launch, s, &p);
    hs_launch_buffer(&launch, rgba);
    return launch_picture(&launch, s, event, err);
}

static bool init(hs_dvr *dvr, const hs_dvr_settings *settings, hs_error *err) {
    if (!hs_dvr_check_settings(settings, err)) return false;
    dvr->settings = *settings;
    return hs_cl_take_kernel(dvr->cl, THESIS_KERNEL, &dvr->render, err) &&
           (settings->look != HS_LOOK_LIT || hs_cl_take_kernel(dvr->cl, LIT_KERNEL, &dvr->lit, err));
}

hs_dvr *hs_dvr_create(const hs_cl *cl, const hs_dvr_settings *settings, hs_error *err) {
    hs_dvr *dvr = hs_memory(1, sizeof *dvr, "renderer", err);
    if (!dvr) return NULL;
    dvr->cl = cl;
    if (init(dvr, settings, err)) return dvr;
    hs_dvr_destroy(dvr);
    return NULL;
}

void hs_dvr_destroy(hs_dvr *dvr) {
    if (!dvr) return;
    if (dvr->render) (void)clReleaseKernel(dvr->render);
    if (dvr->lit) (void)clReleaseKernel(dvr->lit);
    free(dvr);
}

uint32_t hs_dvr_steps(const hs_dvr_settings *settings, const hs_device_volume *source,
                      const hs_camera *camera) {
    const hs_device_view view = hs_device_volume_view(source);
    return count_steps(settings, &view.shape, camera);
}

bool hs_dvr_prepare(hs_dvr *dvr, const hs_device_volume *source, hs_error *err) {
    const hs_dvr_settings *s = &dvr->settings;
    hs_lit_view lit;
    hs_brick_view bricks;
    return s->look == HS_LOOK_LIT
               ? hs_device_volume_lit(source, s->threshold_low, s->threshold_high, &lit, err)
               : hs_device_volume_bricks(source, &bricks, err);
}

bool hs_dvr_render(hs_dvr *dvr, const hs_device_volume *source, const hs_camera *camera,
                   const hs_start_depths *depths, cl_mem rgba, cl_mem termination, cl_event *event,
                   hs_error *err) {
    if (!hs_dvr_check_start(depths, err)) return false;
    const uint64_t pixels = (uint64_t)dvr->settings.width * dvr->settings.height;
    if (rgba && !hs_cl_check_size(rgba, pixels * 4, "the picture", err)) return false;
    if (termination && !hs_cl_check_size(termination, pixels * sizeof(float), "termination depths", err))
        return false;
    if (!dvr->lit) return render_thesis(dvr, source, camera, depths, rgba, termination, event, err);
    if (termination &&
        !render_thesis(dvr, source, camera, depths, NULL, termination, rgba ? NULL : event, err))
        return false;
    return !rgba || render_lit(dvr, source, camera, depths, rgba, event, err);
}
