/* SPDX-License-Identifier: MIT */
/* Building the scan loop, and one frame of it. */
#include "loop/loop_parts.h"

#include <math.h>
#include <stdlib.h>

#define SOURCE_VOXELS_PER_LOWRES 3.0    /* per axis: "about a third" (thesis 5.4) */
#define MAX_LOWRES_AXIS          8192.0 /* sv_format allows no more */

const char *hs_setting_key(hs_setting setting) {
    static const char *const keys[HS_SETTING_COUNT] = {"dvr", "convert", "smartvis"};
    return keys[setting];
}

const char *hs_setting_label(hs_setting setting) {
    static const char *const labels[HS_SETTING_COUNT] = {"DVR", "DVR + scan conversion",
                                                         "DVR + scan conversion + plugin"};
    return labels[setting];
}

const char *hs_stage_label(hs_stage stage) {
    static const char *const labels[HS_STAGE_COUNT] = {"upload", "scan conversion", "plugin", "DVR",
                                                       "whole loop"};
    return labels[stage];
}

void hs_loop_defaults(hs_loop_options *options) {
    *options = (hs_loop_options){.frames = 100, .slab_slices = 16, .carrier = SV_CARRIER_BUFFER};
    hs_dvr_defaults(&options->dvr);
}

double hs_loop_yaw(const hs_loop_options *options, uint32_t index) {
    if (options->frames < 2) return options->yaw;
    return options->yaw + options->orbit * ((double)index / (options->frames - 1) - 0.5);
}

void hs_loop_camera(const hs_loop *loop, uint32_t index, hs_camera *camera) {
    hs_camera_look(camera, hs_source_volume(loop->source, 0), hs_loop_yaw(&loop->options, index),
                   loop->options.pitch);
    hs_camera_merge_box(camera, &loop->box);
}

/* One box that holds the volume in every view of the run. */
static void find_box(hs_loop *loop) {
    const hs_volume *volume = hs_source_volume(loop->source, 0);
    hs_camera_look(&loop->box, volume, hs_loop_yaw(&loop->options, 0), loop->options.pitch);
    for (uint32_t i = 1; i < loop->options.frames && loop->options.orbit != 0; i++) {
        hs_camera view;
        hs_camera_look(&view, volume, hs_loop_yaw(&loop->options, i), loop->options.pitch);
        hs_camera_merge_box(&loop->box, &view);
    }
}

static uint32_t axis_count(double count) {
    return (uint32_t)fmin(fmax(floor(count + 0.5), 1.0), MAX_LOWRES_AXIS);
}

/* The low-resolution grid has cubic voxels over the loop's box; its slabs are textures of about as many tiles
 * in x as in y, with rows that start at multiples of 64 bytes (an image has no pitch of its own). */
static bool make_layout(const hs_loop *loop, hs_slab_layout *layout, hs_error *err) {
    const hs_loop_options *o = &loop->options;
    const hs_volume *volume = hs_source_volume(loop->source, 0);
    const double spacing = fmin(volume->spacing[0], fmin(volume->spacing[1], volume->spacing[2]));
    if (o->lowres > MAX_LOWRES_AXIS)
        return hs_fail(err, HS_ERR_USAGE, "low resolution: %u pixels, allowed are 1 .. %g (0: a third)",
                       o->lowres, MAX_LOWRES_AXIS);
    const double voxel = o->lowres ? loop->box.extent / o->lowres : SOURCE_VOXELS_PER_LOWRES * spacing;
    layout->width = layout->height = axis_count(loop->box.extent / voxel);
    layout->slices = axis_count(loop->box.depth_extent / voxel);
    layout->slab_slices = o->slab_slices < layout->slices ? o->slab_slices : layout->slices;
    layout->tiles_x = axis_count(ceil(sqrt(layout->slab_slices)));
    layout->tile_w = layout->width;
    layout->tile_h = layout->height;
    const uint32_t row = layout->tiles_x * layout->tile_w;
    layout->row_pitch = o->carrier == SV_CARRIER_IMAGE ? row : (row + 63u) / 64u * 64u;
    return true;
}

static bool check_options(const hs_loop_options *o, hs_error *err) {
    if (o->frames < 1) return hs_fail(err, HS_ERR_USAGE, "frames: 0, expected 1 or more");
    if (o->slab_slices < 1) return hs_fail(err, HS_ERR_USAGE, "slab: 0 slices, expected 1 or more");
    if (o->carrier < SV_CARRIER_HOST || o->carrier > SV_CARRIER_IMAGE)
        return hs_fail(err, HS_ERR_USAGE, "carrier: %u is none of 1 (host), 2 (buffer), 3 (image)",
                       o->carrier);
    if (o->own_queue && o->carrier != SV_CARRIER_HOST)
        return hs_fail(err, HS_ERR_USAGE, "own queue: needs carrier host, got %s",
                       o->carrier == SV_CARRIER_BUFFER ? "buffer" : "image");
    if (!isfinite(o->yaw) || !isfinite(o->pitch) || !isfinite(o->orbit))
        return hs_fail(err, HS_ERR_USAGE, "camera: yaw %g, pitch %g, orbit %g must be finite", o->yaw,
                       o->pitch, o->orbit);
    return true;
}

static bool create_pictures(hs_loop *loop, hs_error *err) {
    const size_t pixels = (size_t)loop->options.dvr.width * loop->options.dvr.height;
    cl_int code;
    loop->rgba = clCreateBuffer(loop->cl->context, CL_MEM_READ_WRITE, pixels * 4, NULL, &code);
    if (!hs_cl_check(code, "clCreateBuffer (picture)", err)) return false;
    loop->termination =
        clCreateBuffer(loop->cl->context, CL_MEM_READ_WRITE, pixels * sizeof(float), NULL, &code);
    return hs_cl_check(code, "clCreateBuffer (termination depths)", err);
}

static bool create_parts(hs_loop *loop, const hs_plugin *plugin, hs_error *err) {
    hs_slab_layout layout;
    find_box(loop);
    loop->times = calloc((size_t)HS_STAGE_COUNT * loop->options.frames, sizeof(double));
    if (!loop->times)
        return hs_fail(err, HS_ERR_MEMORY, "times: no memory for %u frames", loop->options.frames);
    if (!make_layout(loop, &layout, err)) return false;
    loop->dvr = hs_dvr_create(loop->cl, &loop->options.dvr, err);
    if (!loop->dvr || !create_pictures(loop, err)) return false;
    loop->volume = hs_device_volume_create(loop->cl, hs_source_volume(loop->source, 0), err);
    if (!loop->volume) return false;
    loop->converter = hs_scan_converter_create(loop->cl, &layout, err);
    if (!loop->converter || !hs_slabs_create(&loop->slabs, loop->cl, &layout, loop->options.carrier, err))
        return false;
    return hs_clipper_create(&loop->clipper, loop->cl, &loop->slabs, plugin, &loop->options, err);
}

hs_loop *hs_loop_create(const hs_cl *cl, const hs_source *source, const hs_plugin *plugin,
                        const hs_loop_options *options, hs_error *err) {
    if (!check_options(options, err)) return NULL;
    hs_loop *loop = calloc(1, sizeof *loop);
    if (!loop) {
        (void)hs_fail(err, HS_ERR_MEMORY, "scan loop: no memory");
        return NULL;
    }
    loop->cl = cl;
    loop->source = source;
    loop->options = *options;
    if (create_parts(loop, plugin, err)) return loop;
    hs_loop_destroy(loop);
    return NULL;
}

void hs_loop_destroy(hs_loop *loop) {
    if (!loop) return;
    (void)clFinish(loop->cl->queue); /* nothing may run on what goes now */
    hs_clipper_destroy(&loop->clipper);
    hs_slabs_destroy(&loop->slabs);
    hs_scan_converter_destroy(loop->converter);
    hs_device_volume_destroy(loop->volume);
    hs_dvr_destroy(loop->dvr);
    if (loop->rgba) clReleaseMemObject(loop->rgba);
    if (loop->termination) clReleaseMemObject(loop->termination);
    free(loop->times);
    free(loop);
}

const hs_slab_layout *hs_loop_layout(const hs_loop *loop) {
    return &loop->slabs.layout;
}

void hs_loop_set_values(hs_loop *loop, const sv_param_value *values, uint32_t count) {
    loop->clipper.values = values;
    loop->clipper.value_count = count;
}

const hs_error *hs_loop_plugin_error(const hs_loop *loop) {
    return &loop->clipper.error;
}

const hs_error *hs_loop_confidence_error(const hs_loop *loop) {
    return &loop->clipper.sure_error;
}

bool hs_loop_render(hs_loop *loop, const hs_device_volume *volume, const hs_camera *camera,
                    const hs_frame *frame, bool with_termination, hs_error *err) {
    const hs_slab_layout *layout = &loop->slabs.layout;
    const bool clipped = frame && frame->clipped;
    const hs_start_depths start = {.depth = clipped ? loop->clipper.depth : NULL,
                                   .confidence = clipped && frame->sure ? loop->clipper.sure : NULL,
                                   .width = layout->width,
                                   .height = layout->height,
                                   .slices = layout->slices};
    return hs_dvr_render(loop->dvr, volume, camera, clipped ? &start : NULL, loop->rgba,
                         with_termination ? loop->termination : NULL, NULL, err);
}

/* The volume of frame `index` on the device: a sequence's or a live scan's arrives anew. */
static bool bring_volume(hs_loop *loop, uint32_t index, hs_error *err) {
    const uint32_t wanted = index % loop->source->count;
    if (wanted == loop->resident && !loop->options.live) return true;
    loop->resident = wanted;
    return hs_device_volume_replace(loop->volume, hs_source_volume(loop->source, wanted), err);
}

static bool wait_for(const hs_loop *loop, const char *stage, hs_error *err) {
    return hs_cl_check(clFinish(loop->cl->queue), stage, err);
}

bool hs_loop_frame(hs_loop *loop, hs_setting setting, uint32_t index, hs_frame *frame, hs_error *err) {
    *frame = (hs_frame){.outcome = SV_OK};
    hs_camera camera;
    const double start = hs_now();
    hs_loop_camera(loop, index, &camera);
    if (!bring_volume(loop, index, err) || !wait_for(loop, "clFinish (upload)", err)) return false;
    const double uploaded = hs_now();
    if (setting != HS_SETTING_DVR &&
        (!hs_slabs_convert(&loop->slabs, loop->cl, loop->converter, loop->volume, &camera, err) ||
         !wait_for(loop, "clFinish (scan conversion)", err)))
        return false;
    const double converted = hs_now();
    if (setting == HS_SETTING_SMARTVIS && !hs_clipper_frame(&loop->clipper, index, frame, err)) return false;
    const double clipped = hs_now();
    if (!hs_loop_render(loop, loop->volume, &camera, frame, false, err) ||
        !wait_for(loop, "clFinish (DVR)", err))
        return false;
    const double end = hs_now();
    frame->ms[HS_STAGE_UPLOAD] = (uploaded - start) * 1e3;
    frame->ms[HS_STAGE_CONVERT] = (converted - uploaded) * 1e3;
    frame->ms[HS_STAGE_PLUGIN] = (clipped - converted) * 1e3;
    frame->ms[HS_STAGE_DVR] = (end - clipped) * 1e3;
    frame->ms[HS_STAGE_LOOP] = (end - start) * 1e3;
    return true;
}
