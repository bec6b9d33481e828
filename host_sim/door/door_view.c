/* SPDX-License-Identifier: MIT */
/* How a camera sees a volume, and what a depthmap on its grid makes of the volume. */
#include "door/door.h"
#include "loop/lowres.h"
#include "loop/slabs.h"
#include "result/result_write.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define MAX_TURN 1e6 /* degrees */

static bool check_angles(const svh_view *view, hs_error *err) {
    if (view->turned)
        return hs_pose_is_right_angled(view->rotation, DOOR_SKEW) ||
               hs_fail(err, HS_ERR_USAGE,
                       "svh_view: rotation is (%g %g %g) and so on, expected three columns of length 1 at "
                       "right angles",
                       view->rotation[0], view->rotation[1], view->rotation[2]);
    return (fabs(view->yaw) <= MAX_TURN && fabs(view->pitch) <= MAX_TURN && fabs(view->roll) <= MAX_TURN) ||
           hs_fail(err, HS_ERR_USAGE, "svh_view: yaw, pitch and roll are %g, %g and %g, expected -%g .. %g",
                   view->yaw, view->pitch, view->roll, MAX_TURN, MAX_TURN);
}

bool door_camera(const svh_volume *volume, const svh_view *view, hs_camera *camera, hs_error *err) {
    const hs_volume *v = &volume->volume;
    if (!check_angles(view, err)) return false;
    if (view->from >= HS_FROM_COUNT)
        return hs_fail(err, HS_ERR_USAGE, "svh_view: from is %u, expected 0 .. %d", view->from,
                       (int)HS_FROM_COUNT - 1);
    if (!view->turned && view->from != HS_FROM_PROBE && !v->pose.stated)
        return hs_fail(err, HS_ERR_INPUT,
                       "%s: does not say how it lies in the patient, so there is no view %s", v->name,
                       hs_from_name((hs_from)view->from));
    if (view->turned) {
        hs_camera_look(camera, v, 0.0, 0.0);
        hs_camera_turn(camera, v, view->rotation);
    } else {
        hs_camera_look_from(camera, v, (hs_from)view->from, view->yaw, view->pitch);
        hs_camera_roll(camera, v, view->roll);
    }
    if (view->around) hs_camera_hold_all(camera, v);
    return true;
}

hs_told door_told(const svh_view *view) {
    hs_told told = {.beams = view->beams, .sweep_mm = view->beam_sweep_mm};
    memcpy(told.rotation, view->probe_rotation, sizeof told.rotation);
    memcpy(told.side, view->probe_side, sizeof told.side);
    memcpy(told.apex_mm, view->beam_apex_mm, sizeof told.apex_mm);
    return told;
}

hs_slab_layout door_layout(const svh_view *view) {
    return (hs_slab_layout){.width = view->n[0],
                            .height = view->n[1],
                            .slices = view->n[2],
                            .slab_slices = view->n[2],
                            .tiles_x = 1,
                            .tile_w = view->n[0],
                            .tile_h = view->n[1],
                            .row_pitch = view->n[0]};
}

bool door_check_planned(const svh_view *view, hs_error *err) {
    return (view->n[0] && view->n[1] && view->n[2]) ||
           hs_fail(err, HS_ERR_USAGE, "svh_view: has no grid: call svh_plan first");
}

int32_t svh_plan(const svh_volume *volume, svh_view *view, svh_error *error) {
    hs_error err = {0};
    hs_camera camera;
    hs_told told;
    svh_view own;
    if (!DOOR_GIVEN(&err, volume, view) || !DOOR_TAKE(svh_view, &own, view, &err) ||
        !door_camera(volume, &own, &camera, &err) ||
        !hs_lowres_size(&volume->volume, own.lowres, &camera, own.n, &err))
        return door_leave(NULL, &err, error);
    memcpy(own.rotation, camera.rotation, sizeof camera.rotation);
    own.box[0] = camera.extent;
    own.box[1] = camera.depth_extent;
    hs_camera_tell(&camera, &volume->volume, own.n, &told);
    memcpy(own.probe_rotation, told.rotation, sizeof told.rotation);
    memcpy(own.probe_side, told.side, sizeof told.side);
    memcpy(own.beam_apex_mm, told.apex_mm, sizeof told.apex_mm);
    own.beams = told.beams;
    own.beam_sweep_mm = told.sweep_mm;
    door_give(view, &own, sizeof own);
    return SVH_OK;
}

hs_device_volume *door_bring(svh_volume *volume, hs_error *err) {
    if (volume->on_device || !door_open_device(volume->host, err)) return volume->on_device;
    volume->on_device = hs_device_volume_create(&volume->host->cl, &volume->volume, err);
    volume->host->on_device += volume->on_device != NULL;
    return volume->on_device;
}

static bool convert(svh_volume *volume, const hs_camera *camera, const svh_view *view, uint8_t *voxels,
                    uint16_t *ranges, hs_error *err) {
    const hs_slab_layout layout = door_layout(view);
    const size_t pixels = (size_t)view->n[0] * view->n[1];
    const hs_cl *cl = &volume->host->cl;
    sv_slab slab;
    sv_frame frame = {0};
    hs_device_volume *source = door_bring(volume, err);
    hs_slabs *slabs = source ? hs_slabs_create(cl, &layout, SV_CARRIER_HOST, HS_FAN_RANGES,
                                               volume->volume.beams != NULL, NULL, err)
                             : NULL;
    const bool ok = slabs && hs_slabs_convert(slabs, source, camera, err) &&
                    hs_cl_check(clFinish(cl->queue), "clFinish (scan conversion)", err);
    if (ok) {
        hs_slabs_describe(slabs, 0, &slab);
        hs_slabs_describe_frame(slabs, true, &frame);
        memcpy(voxels, slab.memory, pixels * view->n[2]);
        memcpy(ranges, frame.scanned, pixels * sizeof *frame.scanned);
    }
    hs_slabs_destroy(slabs);
    return ok;
}

int32_t svh_convert(svh_volume *volume, const svh_view *view, uint8_t *voxels, uint16_t *ranges,
                    svh_error *error) {
    hs_error err = {0};
    hs_camera camera;
    svh_view own;
    if (!DOOR_GIVEN(&err, volume, view, voxels, ranges)) return door_leave(NULL, &err, error);
    (void)pthread_mutex_lock(&volume->host->lock);
    if (DOOR_TAKE(svh_view, &own, view, &err) && door_camera(volume, &own, &camera, &err) &&
        door_check_planned(&own, &err))
        (void)convert(volume, &camera, &own, voxels, ranges, &err);
    return door_leave(volume->host, &err, error);
}

/* ---------------------------------------------------------------------------------------- a depthmap -- */

hs_mark *door_marks(const svh_mark *marks, uint32_t count, hs_error *err) {
    if (count > HS_MARKS_MAX) {
        (void)hs_fail(err, HS_ERR_USAGE, "%u marks, expected at most %d", count, (int)HS_MARKS_MAX);
        return NULL;
    }
    if (count > 0 && !marks) {
        (void)hs_fail(err, HS_ERR_USAGE, "marks is NULL, expected %u", count);
        return NULL;
    }
    hs_mark *out = hs_memory(count + 1u, sizeof *out, "marks", err);
    for (uint32_t i = 0; out && i < count; i++) {
        memcpy(out[i].place, marks[i].place, sizeof out[i].place);
        out[i].radius = marks[i].radius;
        out[i].keep = marks[i].keep != 0;
    }
    return out;
}

int32_t svh_mark_depth(const svh_volume *volume, const svh_view *view, const svh_mark *marks, uint32_t count,
                       float *depth, svh_error *error) {
    hs_error err = {0};
    hs_camera camera;
    svh_view own;
    hs_mark *list = NULL;
    if (DOOR_GIVEN(&err, volume, view, depth) && DOOR_TAKE(svh_view, &own, view, &err) &&
        door_camera(volume, &own, &camera, &err) && door_check_planned(&own, &err) &&
        (list = door_marks(marks, count, &err)))
        (void)hs_marks_apply(list, count, &volume->volume, &camera, own.n, depth, &err);
    free(list);
    return door_leave(NULL, &err, error);
}

/* The depthmap with its camera, as the machine's results take it; it is only read. */
static bool maps_of(const svh_volume *volume, const svh_view *view, const float *depth, hs_maps *maps,
                    hs_error *err) {
    union {
        const float *in;
        float *out;
    } values = {depth};
    svh_view own;
    if (!DOOR_TAKE(svh_view, &own, view, err)) return false;
    *maps = (hs_maps){.width = own.n[0], .height = own.n[1], .slices = own.n[2], .depth = values.out};
    return door_camera(volume, &own, &maps->camera, err) && door_check_planned(&own, err);
}

int32_t svh_mask(const svh_volume *volume, const svh_view *view, const float *depth, uint8_t *mask,
                 svh_error *error) {
    hs_error err = {0};
    hs_maps maps;
    if (DOOR_GIVEN(&err, volume, view, depth, mask) && maps_of(volume, view, depth, &maps, &err))
        hs_result_mask(&maps, &volume->volume, mask);
    return door_leave(NULL, &err, error);
}

int32_t svh_clipped(const svh_volume *volume, const svh_view *view, const float *depth, uint8_t *levels,
                    svh_error *error) {
    const int32_t code = svh_mask(volume, view, depth, levels, error);
    const size_t count = code == SVH_OK ? hs_volume_count(&volume->volume) : 0;
    for (size_t i = 0; i < count; i++) levels[i] = levels[i] ? volume->volume.voxels[i] : 0;
    return code;
}

int32_t svh_surface(const svh_volume *volume, const svh_view *view, const float *depth, svh_mesh *out,
                    svh_error *error) {
    const hs_crop whole = {0};
    hs_error err = {0};
    hs_maps maps;
    hs_mesh mesh;
    if (!DOOR_GIVEN(&err, volume, view, depth, out) || !DOOR_FITS(svh_mesh, out, &err) ||
        !maps_of(volume, view, depth, &maps, &err) ||
        !hs_result_surface(&maps, &volume->volume, &whole, &mesh, &err))
        return door_leave(NULL, &err, error);
    const svh_mesh own = {.vertex_count = mesh.size.vertices,
                          .triangle_count = mesh.size.triangles,
                          .vertices = &mesh.vertices[0][0],
                          .triangles = &mesh.triangles[0][0]};
    door_give(out, &own, sizeof own);
    return SVH_OK;
}

void svh_mesh_free(svh_mesh *mesh) {
    if (!mesh) return;
    free(mesh->vertices);
    free(mesh->triangles);
    mesh->vertices = NULL;
    mesh->triangles = NULL;
    mesh->vertex_count = mesh->triangle_count = 0;
}
