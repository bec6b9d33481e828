/* SPDX-License-Identifier: MIT */
#include "replay/replay.h"

#include "smartvis/author_checks.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* The tile rows of a slab, whole. */
static uint64_t texture_bytes(const sv_format *f, uint32_t slices) {
    return (uint64_t)((slices + f->tiles_x - 1) / f->tiles_x) * f->tile_h * f->row_pitch;
}

/* The ways of a plugin that has a process of its own are its guard's. */
static bool choose_way(rp_hand *h, const rp_options *o, const rec_item *item, hs_error *err) {
    const sv_descriptor *d = h->plugin->instance->descriptor;
    hs_handover wanted = {item->format.carrier, !item->host_queue};
    if (o->carrier) wanted.carrier = o->carrier;
    if (o->carrier > SV_CARRIER_HOST) wanted.own_queue = false;
    if (o->own_queue) wanted = (hs_handover){SV_CARRIER_HOST, true};
    if (!hs_plugin_choose_handover(d, h->plugin->path, wanted, o->carrier != 0 || o->own_queue, &h->way, err))
        return false;
    hs_guarded_route(h->plugin, h->way);
    if (hs_is_guarded(h->plugin) || h->way.own_queue) return true;
    if (!h->cl.queue && !hs_cl_open_bare(&h->cl, err)) return false;
    return h->way.carrier != SV_CARRIER_IMAGE || hs_cl_check_images(&h->cl, err);
}

static bool make_memory(rp_hand *h, const rp_options *o, hs_error *err) {
    const sv_format *f = &h->format;
    const size_t rays = (size_t)f->width * f->height;
    /* Slabs of a slice each need most. */
    const uint64_t bytes = (uint64_t)f->slices * f->tile_h * f->row_pitch;
    if (!rp_pays(o, h->plugin, f, bytes, err)) return false;
    h->bytes = (size_t)bytes;
    h->guards = hs_is_guarded(h->plugin);
    h->memory = h->guards ? hs_guarded_memory(h->plugin, h->bytes, err) : calloc(h->bytes, 1);
    h->ranges = calloc(rays, sizeof *h->ranges);
    h->status = calloc(rays, 1);
    h->objects = calloc((size_t)f->slices + 4, sizeof *h->objects);
    return (h->memory && h->ranges && h->status && h->objects) ||
           hs_fail(err, HS_ERR_MEMORY, "no memory for a frame of %zu bytes", h->bytes);
}

bool rp_hand_format(rp_hand *h, const rp_options *o, const rec_item *item, hs_error *err) {
    rp_hand_release(h);
    if (!choose_way(h, o, item, err)) return false;
    sv_format *f = &h->format;
    *f = item->format;
    f->size = sizeof *f;
    /* An image has no pitch; in memory its rows are as long as they must be. */
    if (f->row_pitch < f->tiles_x * f->tile_w) f->row_pitch = f->tiles_x * f->tile_w;
    if (!make_memory(h, o, err)) {
        rp_hand_release(h);
        return false;
    }
    const bool guarded = hs_is_guarded(h->plugin);
    f->carrier = guarded ? SV_CARRIER_HOST : h->way.carrier;
    if (!guarded && !h->way.own_queue) {
        f->context = h->cl.context;
        f->device = h->cl.device;
        f->queue = h->cl.queue;
    }
    if (item->registered && f->carrier == SV_CARRIER_HOST) {
        f->host_memory = h->memory;
        f->host_memory_bytes = h->bytes;
    }
    return true;
}

static void forget_objects(rp_hand *h) {
    if (h->cl.queue) (void)clFinish(h->cl.queue);
    while (h->object_count > 0) (void)clReleaseMemObject(h->objects[--h->object_count]);
}

/* Keeps an object until the next frame. NULL if it was not made. */
static cl_mem keep(rp_hand *h, cl_mem made, cl_int code, const char *call, hs_error *err) {
    if (!hs_cl_check(code, call, err)) return NULL;
    if (h->object_count <= h->format.slices) return h->objects[h->object_count++] = made;
    (void)clReleaseMemObject(made);
    (void)hs_fail(err, HS_ERR_INPUT, "a frame has more slabs than slices");
    return NULL;
}

/* A buffer with these bytes, until the next frame. */
static cl_mem buffer_of(rp_hand *h, const void *bytes, size_t count, hs_error *err) {
    cl_int code;
    const cl_mem made = clCreateBuffer(h->cl.context, CL_MEM_READ_ONLY | CL_MEM_COPY_HOST_PTR, count,
                                       (void *)(uintptr_t)bytes, &code);
    return keep(h, made, code, "clCreateBuffer (replay)", err);
}

bool rp_hand_frame(rp_hand *h, const rec_item *item, sv_frame *frame, hs_error *err) {
    *frame = item->frame;
    frame->size = sizeof *frame;
    h->used = 0;
    forget_objects(h);
    if (item->ranges == REC_ABSENT || !item->data) return true;
    memcpy(h->ranges, item->data, item->bytes);
    if (item->ranges == REC_MEMORY || !h->format.queue) {
        frame->scanned = h->ranges;
        return true;
    }
    return (frame->scanned_object = buffer_of(h, h->ranges, item->bytes, err)) != NULL;
}

/* The slab's texture, with 0 where no voxel of a slice is. */
static uint8_t *fill_texture(rp_hand *h, const rec_item *item) {
    const sv_format *f = &h->format;
    const size_t slice = (size_t)f->width * f->height;
    const uint64_t bytes = texture_bytes(f, item->slab.slice_count);
    uint8_t *texture = h->memory + h->used;
    h->used += (size_t)bytes;
    memset(texture, 0, (size_t)bytes);
    for (uint32_t s = 0; item->voxels && s < item->slab.slice_count; s++)
        for (uint32_t y = 0; y < f->height; y++)
            memcpy(texture + sva_byte(f, 0, y, s), item->data + s * slice + (size_t)y * f->width, f->width);
    return texture;
}

bool rp_hand_slab(rp_hand *h, const rec_item *item, sv_slab *slab, hs_error *err) {
    const sv_format *f = &h->format;
    if (texture_bytes(f, item->slab.slice_count) > h->bytes - h->used)
        return hs_fail(err, HS_ERR_INPUT, "a frame has more slabs than slices");
    *slab = (sv_slab){
        .size = sizeof *slab, .first_slice = item->slab.first_slice, .slice_count = item->slab.slice_count};
    uint8_t *texture = fill_texture(h, item);
    if (f->carrier != SV_CARRIER_IMAGE) slab->bytes = sva_slab_bytes(f, slab->slice_count);
    if (f->carrier == SV_CARRIER_HOST) slab->memory = texture;
    if (f->carrier == SV_CARRIER_BUFFER)
        return (slab->object = buffer_of(h, texture, (size_t)slab->bytes, err)) != NULL;
    if (f->carrier != SV_CARRIER_IMAGE) return true;
    const cl_image_format pixel = {CL_R, CL_UNORM_INT8};
    const cl_image_desc desc = {.image_type = CL_MEM_OBJECT_IMAGE2D,
                                .image_width = (size_t)f->tiles_x * f->tile_w,
                                .image_height = (size_t)(texture_bytes(f, slab->slice_count) / f->row_pitch),
                                .image_row_pitch = f->row_pitch};
    cl_int code;
    const cl_mem made =
        clCreateImage(f->context, CL_MEM_READ_ONLY | CL_MEM_COPY_HOST_PTR, &pixel, &desc, texture, &code);
    return (slab->object = keep(h, made, code, "clCreateImage (replay)", err)) != NULL;
}

/* An object for depths, NaN as the checking layer hands it over, which recorded this. */
static bool make_depth_object(rp_hand *h, size_t bytes, hs_error *err) {
    const float nothing = NAN;
    cl_int code = CL_SUCCESS;
    if (!h->depth_object)
        h->depth_object = clCreateBuffer(h->cl.context, CL_MEM_READ_WRITE, bytes, NULL, &code);
    if (code == CL_SUCCESS)
        code = clEnqueueFillBuffer(h->format.queue, h->depth_object, &nothing, sizeof nothing, 0, bytes, 0,
                                   NULL, NULL);
    return hs_cl_check(code, "clCreateBuffer (replay)", err);
}

bool rp_hand_result(rp_hand *h, const rec_item *item, sv_result *result, hs_error *err) {
    const sv_format *f = &h->format;
    const size_t tight = (size_t)f->width * sizeof(float);
    const bool guarded = hs_is_guarded(h->plugin);
    h->in_object = false;
    h->row =
        !guarded && item->depth_pitch >= tight && item->depth_pitch <= 4 * tight ? item->depth_pitch : tight;
    free(h->depth);
    h->depth = calloc(f->height + 1u, h->row + sizeof(float)); /* never none */
    if (!h->depth) return hs_fail(err, HS_ERR_MEMORY, "no memory for %u rows of depths", f->height);
    for (size_t i = 0; i < h->row / sizeof(float) * f->height; i++) h->depth[i] = NAN;
    if (!f->queue) memset(h->status, 0xff, (size_t)f->width * f->height);
    h->stats = (sv_stats){.size = sizeof h->stats};
    *result = (sv_result){.size = sizeof *result,
                          .depth_pitch = h->row == tight ? 0 : (uint32_t)h->row,
                          .depth = h->depth,
                          .status = item->status ? h->status : NULL,
                          .stats = item->stats ? &h->stats : NULL};
    if (item->depth != REC_OBJECT || !f->queue) return true;
    h->row = tight;
    result->depth = NULL;
    result->depth_pitch = 0;
    h->in_object = make_depth_object(h, tight * f->height, err);
    result->depth_object = h->depth_object;
    return h->in_object;
}

bool rp_hand_collect(rp_hand *h, hs_error *err) {
    if (!h->format.queue) return true;
    if (!hs_cl_check(clFinish(h->format.queue), "clFinish (replay)", err)) return false;
    return !h->in_object ||
           hs_cl_check(clEnqueueReadBuffer(h->format.queue, h->depth_object, CL_TRUE, 0,
                                           h->row * h->format.height, h->depth, 0, NULL, NULL),
                       "clEnqueueReadBuffer (replay)", err);
}

void rp_hand_release(rp_hand *h) {
    if (h->objects) forget_objects(h);
    if (h->depth_object) (void)clReleaseMemObject(h->depth_object);
    free(h->objects);
    if (!h->guards) free(h->memory);
    free(h->ranges);
    free(h->depth);
    free(h->status);
    h->objects = NULL;
    h->depth_object = NULL;
    h->in_object = false;
    h->bytes = h->used = 0;
    h->memory = NULL;
    h->ranges = NULL;
    h->depth = NULL;
    h->status = NULL;
    h->format = (sv_format){0};
}

void rp_hand_close(rp_hand *h) {
    rp_hand_release(h);
    hs_cl_close(&h->cl);
}
