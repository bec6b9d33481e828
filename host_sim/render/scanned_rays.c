/* SPDX-License-Identifier: MIT */
#include "render/scanned_rays.h"

#include "render/host_launch.h"

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
