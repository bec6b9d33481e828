/* SPDX-License-Identifier: MIT */
#include "render/dvr_lit.h"

#include <math.h>

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

static lit_plan plan_geometry(const hs_dvr_lit_scene *scene) {
    const hs_dvr_settings *s = scene->settings;
    const hs_volume *shape = scene->shape;
    const uint32_t n[3] = {shape->nx, shape->ny, shape->nz};
    hs_box_map map;
    hs_camera_box_map(scene->camera, shape, &map);
    lit_plan p = {.dims = scene->volume.dims, .bricks = scene->volume.bricks};
    p.slices = hs_dvr_slices(shape, scene->camera);
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
        *rows[k] = hs_dvr_float4(scene->camera->rotation + (size_t)k * 3, 1.0 / (factor * shape->spacing[k]));
        size *= n[k] * shape->spacing[k];
        finest = fmin(finest, shape->spacing[k]);
    }
    p.edge_mm = cbrt(size);
    p.mx.s[3] = (cl_float)(FLAT_GRADIENT / (factor * finest));
    p.origin = hs_dvr_float4(first, 1.0);
    p.dx = hs_dvr_float4(du, 1.0);
    p.dy = hs_dvr_float4(dv, 1.0);
    p.dn = hs_dvr_float4(dw, 1.0);
    p.sample_steps = factor;
    p.sample_mm = factor * (double)s->step * scene->camera->depth_extent / p.slices;
    p.dims.s[3] = (cl_int)ceil(scene->camera->depth_extent / p.sample_mm) + 1;
    p.bricks.s[3] = hs_dvr_transparent(s);
    p.per_mm = (cl_float4){{(cl_float)(s->width / scene->camera->extent),
                            (cl_float)(s->height / scene->camera->extent), (cl_float)(1.0 / p.sample_mm),
                            (cl_float)(p.edge_mm / LIGHT_UNITS)}};
    return p;
}

/* Depth d of the map is box depth (d + 0.5) / M; ghosting is over w - s steps behind it. */
static void set_start(hs_launch *launch, const hs_dvr_lit_scene *scene, const lit_plan *p,
                      const hs_start_depths *depths) {
    const hs_dvr_settings *s = scene->settings;
    cl_int4 map_dims = {{0, 0, (cl_int)s->width, (cl_int)s->height}};
    cl_float4 to_map = {{0}}, to_samples = {{0}};
    cl_mem map = NULL, confidence = NULL;
    if (depths && depths->depth) {
        const double slice = p->slices / (depths->slices * (double)s->step * p->sample_steps);
        const double width = s->ghost_width > HS_DVR_HARD_CUT ? (double)s->ghost_width : 0.0;
        map = depths->depth;
        map_dims.s[0] = (cl_int)depths->width;
        map_dims.s[1] = (cl_int)depths->height;
        to_map = hs_dvr_to_map(s, depths);
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

static void set_window(hs_launch *launch, const hs_dvr_lit_scene *scene, const lit_plan *p) {
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
    const cl_float4 lamp4 = hs_dvr_float4(lamp, 1.0);
    const cl_float4 between4 = hs_dvr_float4(between, length > 0.0 ? 1.0 / sqrt(length) : 0.0);
    const cl_float4 skin = {
        {s->skin[0], s->skin[1], s->skin[2], (cl_float)(p->sample_steps * (double)s->step / p->slices)}};
    hs_launch_arg(launch, sizeof lamp4, &lamp4);
    hs_launch_arg(launch, sizeof between4, &between4);
    hs_launch_arg(launch, sizeof skin, &skin);
}

bool hs_dvr_lit_render(const hs_cl *cl, cl_kernel kernel, const hs_dvr_lit_scene *scene,
                       const hs_start_depths *depths, cl_mem rgba, cl_event *event, hs_error *err) {
    if (scene->steps > HS_DVR_MAX_STEPS)
        return hs_fail(err, HS_ERR_USAGE,
                       "renderer: step %g makes %u steps of this volume, expected at most %u",
                       (double)scene->settings->step, scene->steps, HS_DVR_MAX_STEPS);
    const lit_plan p = plan_geometry(scene);
    const hs_lit_view *v = &scene->volume;
    hs_launch launch = hs_launch_begin(cl, kernel, HS_DVR_LIT_KERNEL);
    hs_launch_buffer(&launch, v->smooth);
    hs_launch_arg(&launch, sizeof p.dims, &p.dims);
    hs_launch_buffer(&launch, v->brick_maxima);
    hs_launch_arg(&launch, sizeof p.bricks, &p.bricks);
    hs_launch_buffer(&launch, v->opacity);
    hs_launch_arg(&launch, sizeof v->cells, &v->cells);
    hs_launch_buffer(&launch, v->share.scanned);
    hs_launch_arg(&launch, sizeof v->share.dims, &v->share.dims);
    const cl_float4 *const rays[4] = {&p.origin, &p.dx, &p.dy, &p.dn};
    for (int i = 0; i < 4; i++) hs_launch_arg(&launch, sizeof *rays[i], rays[i]);
    set_start(&launch, scene, &p, depths);
    set_window(&launch, scene, &p);
    const cl_float4 *const axes[4] = {&p.mx, &p.my, &p.mz, &p.per_mm};
    for (int i = 0; i < 4; i++) hs_launch_arg(&launch, sizeof *axes[i], axes[i]);
    set_light(&launch, scene->settings, &p);
    hs_launch_buffer(&launch, rgba);
    return hs_dvr_launch(&launch, scene->settings, event, err);
}
