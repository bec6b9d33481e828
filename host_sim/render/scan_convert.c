/* SPDX-License-Identifier: MIT */
#include "render/scan_convert.h"

#include "render/host_kernels.h"

#include <math.h>
#include <stdlib.h>

#define MAX_ROW_PITCH        (1u << 28) /* bytes; a slab's size then fits 64 bits */
#define SAMPLE_SPACING       1.5        /* finest source voxels from one sample to the next, about */
#define MIN_SHARED_SPAN      1.5        /* a box edge from here on has at least two samples */
#define MAX_SAMPLES_PER_AXIS 8
#define MAX_HALVED_SAMPLES   6   /* the same in the halved volume, each worth two of the source's */
#define NEAREST_MIN_SPAN     1.5 /* source voxels a box spans each way for a mean of nearest ones */
#define HALVED_MIN_SPAN      2.7 /* the same for samples of the halved volume */
#define FIXED_MIN_BITS       12  /* fraction bits a fixed-point position must have */
#define BLOCK                16  /* voxels each way of a work item of convert_halved on a CPU (its cl file) */
#define TOLERANCE            1e-6 /* of a span: 2 voxels computed as 1.999.. are 2 */

/* How a voxel's samples are taken. */
typedef enum { NEAREST, TRILINEAR, HALVED, BEAMS, WAYS } sampling_way;
static const char *const kernel_names[WAYS] = {"convert_nearest", "convert_trilinear", "convert_halved",
                                               "convert_beams"};

struct hs_scan_converter {
    const hs_cl *cl;
    hs_slab_layout layout;
    cl_kernel kernel[WAYS];
};

/* How the samples of a volume lie: sample (i, j, k) of width * grid[0] x ... stands at voxel index
 * origin + i * step[0] + j * step[1] + k * step[2]. */
typedef struct {
    uint32_t grid[3]; /* samples per low-resolution voxel */
    sampling_way way;
    int bits;                     /* fraction bits of fixed-point positions */
    double origin[3], step[3][3]; /* voxels, or halved voxels; BEAMS: millimetres (in_probe) */
} sampling;

uint32_t hs_slab_count(const hs_slab_layout *layout) {
    return (layout->slices + layout->slab_slices - 1) / layout->slab_slices;
}

uint32_t hs_slab_length(const hs_slab_layout *layout, uint32_t index) {
    uint32_t rest = layout->slices - index * layout->slab_slices;
    return rest < layout->slab_slices ? rest : layout->slab_slices;
}

size_t hs_slab_bytes(const hs_slab_layout *layout, uint32_t slices) {
    uint32_t tile_rows = (slices + layout->tiles_x - 1) / layout->tiles_x;
    return (size_t)tile_rows * layout->tile_h * layout->row_pitch;
}

static bool check_layout(const hs_slab_layout *l, hs_error *err) {
    const struct {
        const char *name;
        uint64_t value, low, high;
    } fields[] = {
        {"width", l->width, 1, 8192},
        {"height", l->height, 1, 8192},
        {"slices", l->slices, 1, 8192},
        {"slab_slices", l->slab_slices, 1, l->slices},
        {"tiles_x", l->tiles_x, 1, 8192},
        {"tile_w", l->tile_w, l->width, 1u << 20},
        {"tile_h", l->tile_h, l->height, 1u << 20},
        {"row_pitch", l->row_pitch, (uint64_t)l->tiles_x * l->tile_w, MAX_ROW_PITCH},
    };
    for (size_t i = 0; i < sizeof fields / sizeof fields[0]; i++) {
        if (fields[i].value >= fields[i].low && fields[i].value <= fields[i].high) continue;
        return hs_fail(err, HS_ERR_USAGE, "slab layout: %s is %llu, expected %llu .. %llu", fields[i].name,
                       (unsigned long long)fields[i].value, (unsigned long long)fields[i].low,
                       (unsigned long long)fields[i].high);
    }
    return true;
}

static bool init(hs_scan_converter *converter, const hs_slab_layout *layout, hs_error *err) {
    if (!check_layout(layout, err)) return false;
    converter->layout = *layout;
    for (int i = 0; i < WAYS; i++)
        if (!hs_cl_take_kernel(converter->cl, kernel_names[i], &converter->kernel[i], err)) return false;
    return true;
}

hs_scan_converter *hs_scan_converter_create(const hs_cl *cl, const hs_slab_layout *layout, hs_error *err) {
    hs_scan_converter *converter = hs_memory(1, sizeof *converter, "scan conversion", err);
    if (!converter) return NULL;
    converter->cl = cl;
    if (init(converter, layout, err)) return converter;
    hs_scan_converter_destroy(converter);
    return NULL;
}

void hs_scan_converter_destroy(hs_scan_converter *converter) {
    if (!converter) return;
    for (int i = 0; i < WAYS; i++)
        if (converter->kernel[i]) (void)clReleaseKernel(converter->kernel[i]);
    free(converter);
}

/* The most fraction bits with which every position a packet may meet fits an int, the parts of its sum and
 * the volume's own faces too. */
static int position_bits(const sampling *s, const hs_slab_layout *layout, const hs_volume *shape) {
    /* Packets may overhang the picture. */
    const uint32_t size[3] = {layout->width + 4, layout->height + 4, layout->slices};
    const uint32_t n[3] = {shape->nx, shape->ny, shape->nz};
    double reach = 0.0;
    for (int k = 0; k < 3; k++) {
        double along = fabs(s->origin[k]) + 1.0;
        for (int a = 0; a < 3; a++) along += fabs(s->step[a][k]) * s->grid[a] * size[a];
        /* Where the halved volume has an edge, the source's own voxels are sampled. */
        reach = fmax(fmax(reach, s->way == HALVED ? 2.0 * along : along), n[k]);
    }
    int bits = 0;
    while (bits < 30 && ldexp(reach, bits + 1) < 0x1p31) bits++;
    return bits;
}

/* Samples along an edge that spans so many source voxels. */
static uint32_t samples_along(sampling_way way, double span) {
    if (way == HALVED)
        return (uint32_t)fmin(fmax(round(0.5 * span / SAMPLE_SPACING), 1.0), MAX_HALVED_SAMPLES);
    const double fewest = span >= MIN_SHARED_SPAN * (1.0 - TOLERANCE) ? 2.0 : 1.0;
    return (uint32_t)fmin(fmax(round(span / SAMPLE_SPACING), fewest), MAX_SAMPLES_PER_AXIS);
}

/* Makes the places those among the halved volume's voxels. */
static void halve_places(sampling *s) {
    for (int k = 0; k < 3; k++) {
        s->origin[k] = 0.5 * (s->origin[k] - 0.5);
        for (int a = 0; a < 3; a++) s->step[a][k] *= 0.5;
    }
}

static sampling lay_samples(const hs_slab_layout *layout, const hs_volume *shape, const hs_camera *camera,
                            const double edge[3], sampling_way way) {
    hs_box_map map;
    hs_camera_box_map(camera, shape, &map);
    const double *const axis[3] = {map.du, map.dv, map.dw};
    const uint32_t size[3] = {layout->width, layout->height, layout->slices};
    const double finest = fmin(shape->spacing[0], fmin(shape->spacing[1], shape->spacing[2]));
    sampling s = {.way = way, .origin = {map.origin[0], map.origin[1], map.origin[2]}};
    for (int a = 0; a < 3; a++) {
        s.grid[a] = samples_along(way, edge[a] / finest);
        for (int k = 0; k < 3; k++) {
            s.step[a][k] = axis[a][k] / ((double)size[a] * s.grid[a]);
            s.origin[k] += 0.5 * s.step[a][k];
        }
    }
    if (way == HALVED) halve_places(&s);
    s.bits = position_bits(&s, layout, shape);
    return s;
}

/* Every sample is a voxel's centre: the nearest voxel is what a blend would give, to the bit. */
static bool meets_voxels(const sampling *s) {
    bool meets = s->bits >= FIXED_MIN_BITS;
    for (int k = 0; k < 3; k++) {
        meets &= s->grid[k] == 1 && fabs(s->origin[k] - rint(s->origin[k])) < TOLERANCE / 2048;
        for (int a = 0; a < 3; a++) meets &= fabs(s->step[a][k] - rint(s->step[a][k])) < TOLERANCE / 2048;
    }
    return meets;
}

static sampling plan_sampling(const hs_slab_layout *layout, const hs_device_view *source,
                              const hs_camera *camera) {
    const double *spacing = source->shape.spacing;
    const double edge[3] = {camera->extent / layout->width, camera->extent / layout->height,
                            camera->depth_extent / layout->slices};
    const double coarsest = fmax(spacing[0], fmax(spacing[1], spacing[2]));
    const double span = fmin(edge[0], fmin(edge[1], edge[2])) / coarsest * (1.0 + TOLERANCE);
    sampling_way way = TRILINEAR;
    if (span >= NEAREST_MIN_SPAN) way = NEAREST;
    if (span >= HALVED_MIN_SPAN && !source->beams) way = HALVED;
    sampling s = lay_samples(layout, &source->shape, camera, edge, way);
    if (way == TRILINEAR && !source->beams && meets_voxels(&s)) s.way = NEAREST;
    return s.bits >= FIXED_MIN_BITS ? s : lay_samples(layout, &source->shape, camera, edge, TRILINEAR);
}

static cl_int4 fixed4(const double v[3], double offset, int bits) {
    cl_int4 out = {{(cl_int)lrint(ldexp(v[0] + offset, bits)), (cl_int)lrint(ldexp(v[1] + offset, bits)),
                    (cl_int)lrint(ldexp(v[2] + offset, bits)), 0}};
    return out;
}

static cl_float4 float4_of(const double v[3]) {
    cl_float4 out = {{(cl_float)v[0], (cl_float)v[1], (cl_float)v[2], 0.0f}};
    return out;
}

/* The four arguments that say where the samples lie. Half a voxel makes the nearest one a floor. */
static void set_positions(hs_launch *launch, const sampling *s) {
    for (cl_uint i = 0; i < 4; i++) {
        const double *v = i == 0 ? s->origin : s->step[i - 1];
        if (s->way == NEAREST || s->way == HALVED) {
            cl_int4 fixed = fixed4(v, i == 0 && s->way == NEAREST ? 0.5 : 0.0, s->bits);
            hs_launch_arg(launch, sizeof fixed, &fixed);
        } else {
            cl_float4 plain = float4_of(v);
            hs_launch_arg(launch, sizeof plain, &plain);
        }
    }
}

/* On a CPU a work item makes a packet of 4 x 4 voxels of a slice (PACKET_W, PACKET_H in cl/base.cl); from the
 * halved volume a block: what it reads fits the first-level cache, and its pages the address cache, however
 * the camera is turned. */
static bool enqueue(const hs_scan_converter *converter, const hs_launch *launch, sampling_way way,
                    uint32_t slices, cl_event *event, hs_error *err) {
    const hs_slab_layout *l = &converter->layout;
    const bool packets = converter->cl->lanes > 1;
    const size_t edge = !packets ? 1 : way == HALVED ? BLOCK : 4, deep = way == HALVED ? edge : 1;
    const size_t global[3] = {(l->width + edge - 1) / edge, (slices + deep - 1) / deep,
                              (l->height + edge - 1) / edge};
    return hs_launch_items(launch, 3, global, event, err);
}

/* Converts the sampling to millimetres from the array's centre of curvature. */
static sampling in_probe(sampling s, const hs_volume *shape, const double corner[3]) {
    s.way = BEAMS;
    for (int k = 0; k < 3; k++) {
        s.origin[k] = corner[k] + (s.origin[k] + 0.5) * shape->spacing[k];
        for (int a = 0; a < 3; a++) s.step[a][k] *= shape->spacing[k];
    }
    return s;
}

static hs_launch begin(const hs_scan_converter *converter, sampling_way way) {
    return hs_launch_begin(converter->cl, converter->kernel[way], kernel_names[way]);
}

/* The arguments that say what is sampled. */
static hs_launch begin_beams(const hs_scan_converter *converter, const hs_beams_view *view) {
    hs_launch launch = begin(converter, BEAMS);
    hs_launch_beams(&launch, view);
    return launch;
}

static void set_voxels(hs_launch *launch, const hs_device_view *view) {
    const hs_volume *v = &view->shape;
    const cl_int4 dims = {{(cl_int)v->nx, (cl_int)v->ny, (cl_int)v->nz, 0}};
    hs_launch_buffer(launch, view->voxels);
    hs_launch_arg(launch, sizeof dims, &dims);
}

/* The kernel with the arguments that say what is sampled. The halved volume is made where it is missing. */
static bool begin_source(const hs_scan_converter *converter, const hs_device_volume *source,
                         const hs_device_view *view, sampling *s, hs_launch *launch, hs_error *err) {
    hs_halved_view half;
    if (view->beams) {
        const hs_beams_view beams = hs_device_beams_view(view->beams);
        *s = in_probe(*s, &view->shape, beams.shape.corner);
        *launch = begin_beams(converter, &beams);
        return true;
    }
    *launch = begin(converter, s->way);
    if (s->way == HALVED) {
        if (!hs_device_volume_halved(source, &half, err)) return false;
        hs_launch_buffer(launch, half.marked);
        hs_launch_arg(launch, sizeof half.dims, &half.dims);
    }
    set_voxels(launch, view);
    return true;
}

bool hs_scan_convert_prepare(const hs_scan_converter *converter, const hs_device_volume *source,
                             const hs_camera *camera, hs_error *err) {
    const hs_device_view view = hs_device_volume_view(source);
    hs_halved_view half;
    return plan_sampling(&converter->layout, &view, camera).way != HALVED ||
           hs_device_volume_halved(source, &half, err);
}

/* True if the grid's voxels are voxels of the volume in their order, and a slab holds one slice below the
 * other: it is a box of the volume then. */
static bool is_box(const sampling *s, const hs_slab_layout *l, const hs_volume *shape) {
    const double n[3] = {shape->nx, shape->ny, shape->nz}, size[3] = {l->width, l->height, l->slices};
    bool same = s->way == NEAREST && meets_voxels(s) && l->tiles_x == 1;
    for (int k = 0; k < 3; k++) {
        same &= s->origin[k] > -0.5 && s->origin[k] + size[k] < n[k] + 0.5;
        for (int a = 0; a < 3; a++) same &= fabs(s->step[a][k] - (a == k ? 1.0 : 0.0)) < 0.5;
    }
    return same;
}

static bool copy_box(const hs_scan_converter *converter, const hs_device_view *view, const sampling *s,
                     uint32_t first, uint32_t slices, cl_mem slab, size_t offset, cl_event *event,
                     hs_error *err) {
    const hs_slab_layout *l = &converter->layout;
    const size_t row = view->shape.nx, slice = row * view->shape.ny;
    const size_t from[3] = {(size_t)lrint(s->origin[0]), (size_t)lrint(s->origin[1]),
                            (size_t)lrint(s->origin[2]) + first};
    const size_t to[3] = {offset, 0, 0}, region[3] = {l->width, l->height, slices};
    const cl_int code =
        clEnqueueCopyBufferRect(converter->cl->queue, view->voxels, slab, from, to, region, row, slice,
                                l->row_pitch, (size_t)l->tile_h * l->row_pitch, 0, NULL, event);
    return hs_cl_check(code, "clEnqueueCopyBufferRect (slab)", err);
}

bool hs_scan_convert_slab(hs_scan_converter *converter, const hs_device_volume *source,
                          const hs_camera *camera, uint32_t index, cl_mem slab, size_t offset,
                          cl_event *event, hs_error *err) {
    const hs_slab_layout *l = &converter->layout;
    if (index >= hs_slab_count(l)) {
        return hs_fail(err, HS_ERR_USAGE, "scan conversion: slab %u of %u", index, hs_slab_count(l));
    }
    const uint32_t slices = hs_slab_length(l, index);
    const uint64_t bytes = hs_slab_bytes(l, slices), end = bytes + offset;
    if (!hs_cl_check_size(slab, end < bytes ? UINT64_MAX : end, "a slab", err)) return false;
    const hs_device_view view = hs_device_volume_view(source);
    sampling s = plan_sampling(l, &view, camera);
    hs_launch launch;
    if (is_box(&s, l, &view.shape))
        return copy_box(converter, &view, &s, index * l->slab_slices, slices, slab, offset, event, err);
    if (!begin_source(converter, source, &view, &s, &launch, err)) return false;
    const cl_int4 grid = {{(cl_int)s.grid[0], (cl_int)s.grid[1], (cl_int)s.grid[2], 0}};
    const cl_int4 size = {{(cl_int)l->width, (cl_int)l->height, (cl_int)(index * l->slab_slices), s.bits}};
    const cl_int4 layout = {{(cl_int)l->tiles_x, (cl_int)l->tile_w, (cl_int)l->tile_h, (cl_int)l->row_pitch}};
    const cl_ulong start = offset;
    const cl_int length = (cl_int)slices;
    hs_launch_arg(&launch, sizeof grid, &grid);
    set_positions(&launch, &s);
    hs_launch_arg(&launch, sizeof size, &size);
    if (s.way == HALVED) hs_launch_arg(&launch, sizeof length, &length);
    hs_launch_arg(&launch, sizeof layout, &layout);
    hs_launch_buffer(&launch, slab);
    hs_launch_arg(&launch, sizeof start, &start);
    return enqueue(converter, &launch, s.way, slices, event, err);
}

bool hs_scanned_rays_create(hs_scanned_rays *rays, const hs_cl *cl, const hs_slab_layout *layout,
                            hs_error *err) {
    const size_t bytes = (size_t)layout->width * layout->height * sizeof(cl_ushort2);
    *rays = (hs_scanned_rays){.cl = cl};
    return hs_cl_take_buffer(cl, bytes, "scanned ranges", &rays->ranges, err) &&
           hs_cl_take_kernel(cl, "scanned_rays", &rays->kernel, err);
}

void hs_scanned_rays_destroy(hs_scanned_rays *rays) {
    if (rays->kernel) clReleaseKernel(rays->kernel);
    if (rays->ranges) clReleaseMemObject(rays->ranges);
    *rays = (hs_scanned_rays){0};
}

static cl_float4 steps_of(const double v[3], uint32_t count) {
    return (cl_float4){{(cl_float)(v[0] / count), (cl_float)(v[1] / count), (cl_float)(v[2] / count), 0.0f}};
}

/* Where the voxels lie among the source's. What was scanned in probe geometry is not held to the box of its
 * Cartesian copy. */
static void set_places(hs_launch *launch, const hs_slab_layout *layout, const hs_device_view *view,
                       const hs_camera *camera) {
    const hs_volume *shape = &view->shape;
    hs_box_map map = {{0}, {0}, {0}, {0}};
    if (!view->beams) hs_camera_box_map(camera, shape, &map);
    const cl_int4 dims = {{(cl_int)shape->nx, (cl_int)shape->ny, (cl_int)shape->nz, 0}};
    const cl_float4 places[4] = {steps_of(map.origin, 1), steps_of(map.du, layout->width),
                                 steps_of(map.dv, layout->height), steps_of(map.dw, layout->slices)};
    hs_launch_arg(launch, sizeof dims, &dims);
    for (int i = 0; i < 4; i++) hs_launch_arg(launch, sizeof places[i], &places[i]);
}

bool hs_scanned_rays_find(const hs_scanned_rays *rays, const hs_slab_layout *layout,
                          const hs_device_volume *source, const hs_camera *camera, cl_mem slabs,
                          size_t stride, hs_error *err) {
    const cl_int4 texture = {
        {(cl_int)layout->tiles_x, (cl_int)layout->tile_w, (cl_int)layout->tile_h, (cl_int)layout->row_pitch}};
    const cl_int4 size = {{(cl_int)layout->width, (cl_int)layout->slices, (cl_int)layout->slab_slices, 0}};
    const cl_ulong bytes = stride;
    const hs_device_view view = hs_device_volume_view(source);
    const size_t lanes = rays->cl->lanes;
    const size_t global[2] = {(layout->width + lanes - 1) / lanes, layout->height};
    hs_launch l = hs_launch_begin(rays->cl, rays->kernel, "scanned_rays");
    hs_launch_buffer(&l, slabs);
    hs_launch_arg(&l, sizeof texture, &texture);
    hs_launch_arg(&l, sizeof size, &size);
    hs_launch_arg(&l, sizeof bytes, &bytes);
    set_places(&l, layout, &view, camera);
    hs_launch_buffer(&l, rays->ranges);
    return hs_launch_items(&l, 2, global, NULL, err);
}
