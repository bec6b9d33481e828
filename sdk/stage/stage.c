/* SPDX-License-Identifier: MIT */
#include "stage/stage.h"

#include "core/system.h"
#include "smartvis/author_checks.h"

#include <stdlib.h>
#include <string.h>

enum { GUARD = 256, OBJECT_OFFSET = 64, RANGES_OFFSET = 12 };

static void need(const stage *st, cl_int code, const char *what) {
    if (code != CL_SUCCESS) st->failed(st->data, what, code);
}

static void *memory_for(const stage *st, size_t bytes, const char *what) {
    void *memory = calloc(1, bytes + 1);
    if (!memory) st->failed(st->data, what, CL_SUCCESS);
    return memory;
}

/* ---- the format */
static void split(stage *st) {
    const stage_way *w = &st->way;
    for (uint32_t first = 0; first < w->slices; st->slab_count++) {
        if (st->slab_count == STAGE_MAX_SLABS) st->failed(st->data, "fewer slabs", CL_SUCCESS);
        uint32_t length = w->lengths ? w->lengths[st->slab_count] : w->longest;
        if (length > w->slices - first || length == 0) length = w->slices - first;
        st->first[st->slab_count] = first;
        st->length[st->slab_count] = length;
        if (length > st->format.max_slab_slices) st->format.max_slab_slices = length;
        first += length;
    }
}

static void describe(stage *st) {
    const stage_way *w = &st->way;
    const uint32_t row = w->tiles_x * (w->width + w->extra_w);
    st->format = (sv_format){.size = sizeof st->format,
                             .width = w->width,
                             .height = w->height,
                             .slices = w->slices,
                             .voxel_type = SV_VOXEL_U8,
                             .carrier = w->carrier,
                             .padding_value = w->padding,
                             .tiles_x = w->tiles_x,
                             .tile_w = w->width + w->extra_w,
                             .tile_h = w->height + w->extra_h,
                             .row_pitch = row + w->extra_pitch,
                             .flags = w->ranges ? SV_FORMAT_SCANNED : 0,
                             .spacing_mm = {w->spacing_mm[0], w->spacing_mm[1], w->spacing_mm[2]},
                             .values = w->fixed_count ? st->way.fixed : NULL,
                             .value_count = w->fixed_count};
    st->format.context = st->device.context;
    st->format.device = st->device.device;
    st->format.queue = st->device.queue;
}

/* ---- memory and objects */
static size_t whole_pages(size_t bytes) {
    const size_t page = 65536; /* the largest that a system has */
    return (bytes + page - 1) / page * page;
}

/* Slabs one behind the other, each in pages of its own; behind the exact ones a page that cannot be read. */
static void place_slabs(stage *st) {
    const sv_format *f = &st->format;
    const size_t rows = ((size_t)f->max_slab_slices + f->tiles_x - 1) / f->tiles_x * f->tile_h;
    const size_t each = whole_pages(rows * f->row_pitch + 64), page = whole_pages(1);
    st->page_bytes = (each + page) * st->slab_count;
    void *pages = sys_pages(st->page_bytes);
    if (!pages) st->failed(st->data, "memory for slabs", CL_SUCCESS);
    st->pages = pages;
    for (uint32_t n = 0; n < st->slab_count; n++) {
        uint8_t *start = st->pages + n * (each + page);
        const size_t own = ((size_t)st->length[n] + f->tiles_x - 1) / f->tiles_x * f->tile_h;
        st->bytes[n] = st->way.exact ? sva_slab_bytes(f, st->length[n]) : own * f->row_pitch;
        st->memory[n] = st->way.exact ? start + each - st->bytes[n] : start;
        if (st->way.exact) sys_pages_forbid(start + each, page);
    }
    if (!st->way.registered) return;
    st->format.host_memory = st->pages;
    st->format.host_memory_bytes = st->page_bytes;
}

static void place_results(stage *st) {
    const size_t rays = (size_t)st->format.width * st->format.height;
    st->row_bytes = (st->format.width + st->way.pitch) * sizeof(float);
    st->depth_at = GUARD;
    st->status_at = st->depth_at + st->row_bytes * st->format.height + GUARD;
    st->stats_at = (st->status_at + rays + GUARD + 15) / 16 * 16;
    st->result_bytes = st->stats_at + sizeof(sv_stats) + GUARD;
    st->results = memory_for(st, st->result_bytes, "memory for results");
}

static void make_objects(stage *st) {
    const sv_format *f = &st->format;
    const size_t rays = (size_t)f->width * f->height;
    cl_context context = st->device.context;
    cl_int code = CL_SUCCESS;
    for (uint32_t n = 0; n < st->slab_count && f->carrier != SV_CARRIER_HOST; n++) {
        const cl_image_format format = {CL_R, n % 2 ? CL_UNORM_INT8 : CL_UNSIGNED_INT8};
        const cl_image_desc desc = {.image_type = CL_MEM_OBJECT_IMAGE2D,
                                    .image_width = (size_t)f->tiles_x * f->tile_w,
                                    .image_height = st->bytes[n] / f->row_pitch};
        st->objects[n] =
            f->carrier == SV_CARRIER_BUFFER
                ? clCreateBuffer(context, CL_MEM_READ_ONLY, st->bytes[n] + OBJECT_OFFSET, NULL, &code)
                : clCreateImage(context, CL_MEM_READ_ONLY, &format, &desc, NULL, &code);
        need(st, code, f->carrier == SV_CARRIER_BUFFER ? "a buffer" : "an image of CL_R");
    }
    if (st->way.ranges_in_buffer)
        st->ranges_object =
            clCreateBuffer(context, CL_MEM_READ_ONLY, rays * sizeof(sv_scanned) + RANGES_OFFSET, NULL, &code);
    need(st, code, "a buffer");
    if (st->way.depth_object)
        st->depth_object = clCreateBuffer(context, CL_MEM_READ_WRITE,
                                          rays * sizeof(float) + (size_t)2 * OBJECT_OFFSET, NULL, &code);
    need(st, code, "a buffer");
}

void stage_make(stage *st, const stage_way *way, const stage_device *device, stage_failure failed,
                void *data) {
    *st = (stage){.failed = failed, .data = data, .way = *way, .frame_flags = SV_FRAME_DISCONTINUITY};
    if (!way->own_queue) st->device = *device;
    describe(st);
    split(st);
    place_slabs(st);
    place_results(st);
    if (way->ranges)
        st->ranges = memory_for(st, sizeof(sv_scanned) * way->width * way->height, "memory for ranges");
    if (st->device.context) make_objects(st);
}

void stage_free(stage *st) {
    for (uint32_t n = 0; n < st->slab_count; n++)
        if (st->objects[n]) (void)clReleaseMemObject(st->objects[n]);
    if (st->ranges_object) (void)clReleaseMemObject(st->ranges_object);
    if (st->depth_object) (void)clReleaseMemObject(st->depth_object);
    sys_pages_free(st->pages, st->page_bytes);
    free(st->results);
    free(st->ranges);
    memset(st, 0, sizeof *st);
}

/* ---- volumes */
static void copy_slab(stage *st, const uint8_t *voxels, uint32_t n) {
    const sv_format *f = &st->format;
    memset(st->memory[n], st->way.hatch, st->bytes[n]);
    for (uint32_t s = 0; s < st->length[n]; s++)
        for (uint32_t y = 0; y < f->height; y++)
            memcpy(st->memory[n] + sva_byte(f, 0, y, s),
                   voxels + ((size_t)(st->first[n] + s) * f->height + y) * f->width, f->width);
}

static void upload_slab(stage *st, uint32_t n) {
    const sv_format *f = &st->format;
    const size_t zero[3] = {0, 0, 0};
    const size_t region[3] = {(size_t)f->tiles_x * f->tile_w, st->bytes[n] / f->row_pitch, 1};
    cl_command_queue q = st->device.queue;
    const cl_int code = f->carrier == SV_CARRIER_BUFFER
                            ? clEnqueueWriteBuffer(q, st->objects[n], CL_TRUE, OBJECT_OFFSET, st->bytes[n],
                                                   st->memory[n], 0, NULL, NULL)
                            : clEnqueueWriteImage(q, st->objects[n], CL_TRUE, zero, region, f->row_pitch, 0,
                                                  st->memory[n], 0, NULL, NULL);
    need(st, code, "an upload");
}

void stage_fill(stage *st, const uint8_t *voxels, const sv_scanned *ranges) {
    const size_t bytes = sizeof(sv_scanned) * st->format.width * st->format.height;
    for (uint32_t n = 0; n < st->slab_count; n++) {
        copy_slab(st, voxels, n);
        if (st->objects[n]) upload_slab(st, n);
    }
    if (st->ranges) memcpy(st->ranges, ranges, bytes);
    if (st->ranges_object)
        need(st,
             clEnqueueWriteBuffer(st->device.queue, st->ranges_object, CL_TRUE, RANGES_OFFSET, bytes, ranges,
                                  0, NULL, NULL),
             "an upload");
}

/* ---- what a call is given */
sv_slab stage_slab(const stage *st, uint32_t n) {
    const bool host = st->format.carrier == SV_CARRIER_HOST;
    return (sv_slab){.size = sizeof(sv_slab),
                     .first_slice = st->first[n],
                     .slice_count = st->length[n],
                     .memory = host ? st->memory[n] : NULL,
                     .object = st->objects[n],
                     .offset = st->format.carrier == SV_CARRIER_BUFFER ? OBJECT_OFFSET : 0,
                     .bytes = st->format.carrier == SV_CARRIER_IMAGE ? 0 : st->bytes[n]};
}

sv_frame stage_frame(const stage *st, const sv_param_value *values, uint32_t count) {
    sv_frame frame = st->told;
    frame.size = st->frame_size ? st->frame_size : sizeof frame;
    frame.flags = st->frame_flags;
    frame.index = 1;
    frame.values = values;
    frame.value_count = count;
    frame.scanned = st->ranges_object ? NULL : st->ranges;
    frame.scanned_object = st->ranges_object;
    frame.scanned_offset = st->ranges_object ? RANGES_OFFSET : 0;
    return frame;
}

sv_result stage_result(stage *st) {
    return (sv_result){.size = sizeof(sv_result),
                       .depth_pitch = st->way.pitch && !st->depth_object ? (uint32_t)st->row_bytes : 0,
                       .depth = st->depth_object ? NULL : (float *)(void *)(st->results + st->depth_at),
                       .depth_object = st->depth_object,
                       .depth_offset = st->depth_object ? OBJECT_OFFSET : 0,
                       .status = st->results + st->status_at,
                       .stats = (sv_stats *)(void *)(st->results + st->stats_at)};
}

void stage_poison(stage *st, uint8_t byte) {
    memset(st->results, byte, st->result_bytes);
    ((sv_stats *)(void *)(st->results + st->stats_at))->size = sizeof(sv_stats);
    if (!st->depth_object) return;
    const size_t bytes =
        (size_t)st->format.width * st->format.height * sizeof(float) + (size_t)2 * OBJECT_OFFSET;
    need(st, clEnqueueFillBuffer(st->device.queue, st->depth_object, &byte, 1, 0, bytes, 0, NULL, NULL),
         "to fill a buffer");
}

/* ---- what must not have changed */
/* All bytes of an object, to be freed. */
static uint8_t *read_object(const stage *st, cl_mem object, size_t *bytes) {
    cl_mem_object_type type = CL_MEM_OBJECT_BUFFER;
    size_t side[3] = {1, 1, 1};
    const size_t zero[3] = {0, 0, 0};
    cl_command_queue q = st->device.queue;
    need(st, clGetMemObjectInfo(object, CL_MEM_TYPE, sizeof type, &type, NULL), "to tell an object's type");
    const bool image = type != CL_MEM_OBJECT_BUFFER;
    if (image) {
        (void)clGetImageInfo(object, CL_IMAGE_WIDTH, sizeof side[0], &side[0], NULL);
        (void)clGetImageInfo(object, CL_IMAGE_HEIGHT, sizeof side[1], &side[1], NULL);
    } else {
        (void)clGetMemObjectInfo(object, CL_MEM_SIZE, sizeof side[0], &side[0], NULL);
    }
    *bytes = side[0] * side[1];
    uint8_t *out = memory_for(st, *bytes, "memory for a copy");
    need(st,
         image ? clEnqueueReadImage(q, object, CL_TRUE, zero, side, 0, 0, out, 0, NULL, NULL)
               : clEnqueueReadBuffer(q, object, CL_TRUE, 0, *bytes, out, 0, NULL, NULL),
         "to read an object");
    return out;
}

static bool is_touched(const stage *st, size_t from, size_t to, uint8_t byte) {
    for (size_t i = from; i < to; i++)
        if (st->results[i] != byte) return true;
    return false;
}

/* True if a byte around the map's buffer is another one. */
static bool is_object_touched(const stage *st, uint8_t byte) {
    size_t bytes = 0, touched = 0;
    uint8_t *all = read_object(st, st->depth_object, &bytes);
    for (size_t i = 0; i < OBJECT_OFFSET; i++) touched += all[i] != byte || all[bytes - 1 - i] != byte;
    free(all);
    return touched > 0;
}

const char *stage_trespass(const stage *st, uint8_t byte) {
    const size_t rays = (size_t)st->format.width * st->format.height, row = st->format.width * sizeof(float);
    if (st->depth_object && is_object_touched(st, byte)) return "beside the map, in its buffer";
    if (is_touched(st, 0, st->depth_at, byte)) return "before the map";
    for (uint32_t y = 0; y + 1 < st->format.height; y++)
        if (is_touched(st, st->depth_at + y * st->row_bytes + row, st->depth_at + (y + 1) * st->row_bytes,
                       byte))
            return "between two rows of the map (depth_pitch)";
    const size_t last = st->depth_at + (st->format.height - 1) * st->row_bytes + row;
    if (is_touched(st, last, last + GUARD / 2, byte)) return "behind the map";
    if (is_touched(st, last + GUARD / 2, st->status_at, byte)) return "before the status map";
    if (is_touched(st, st->status_at + rays, st->status_at + rays + GUARD / 2, byte))
        return "behind the status map";
    if (is_touched(st, st->status_at + rays + GUARD / 2, st->stats_at, byte)) return "before the statistics";
    if (is_touched(st, st->stats_at + sizeof(sv_stats), st->result_bytes, byte))
        return "behind the statistics";
    return NULL;
}

static uint64_t sum(uint64_t h, const void *data, size_t bytes) {
    const uint8_t *b = data;
    for (size_t i = 0; i < bytes; i++) h = (h ^ b[i]) * 0x100000001b3u;
    return h;
}

static uint64_t sum_object(const stage *st, uint64_t h, cl_mem object) {
    size_t bytes = 0;
    if (!object) return h;
    uint8_t *all = read_object(st, object, &bytes);
    h = sum(h, all, bytes);
    free(all);
    return h;
}

uint64_t stage_inputs(const stage *st) {
    uint64_t h = 0xcbf29ce484222325u;
    for (uint32_t n = 0; n < st->slab_count; n++) {
        h = sum(h, st->memory[n], st->bytes[n]);
        h = sum_object(st, h, st->objects[n]);
    }
    h = sum_object(st, h, st->ranges_object);
    if (st->ranges) h = sum(h, st->ranges, sizeof(sv_scanned) * st->format.width * st->format.height);
    return sum(h, &st->format, sizeof st->format);
}

/* ---- frames */
sv_status stage_run(const stage *st, const sv_plugin *p, const sv_param_value *values, uint32_t count,
                    const sv_result *result) {
    const sv_frame frame = stage_frame(st, values, count);
    sv_status status = p->begin(p, &frame);
    for (uint32_t n = 0; status == SV_OK && n < st->slab_count; n++) {
        const sv_slab slab = stage_slab(st, n);
        status = p->slab(p, &slab);
    }
    if (status == SV_OK) status = p->end(p, result);
    /* After an error, too: slabs may still be on their way. */
    if (st->device.queue) need(st, clFinish(st->device.queue), "clFinish after a frame");
    return status;
}

/* ---- what a device can */
bool stage_has_images(const stage_device *device) {
    cl_image_format formats[256];
    cl_uint count = 0;
    bool floats = false, integers = false;
    if (clGetSupportedImageFormats(device->context, CL_MEM_READ_ONLY, CL_MEM_OBJECT_IMAGE2D, 256, formats,
                                   &count) != CL_SUCCESS)
        return false;
    for (cl_uint i = 0; i < count && i < 256; i++) {
        const bool one = formats[i].image_channel_order == CL_R;
        floats |= one && formats[i].image_channel_data_type == CL_UNORM_INT8;
        integers |= one && formats[i].image_channel_data_type == CL_UNSIGNED_INT8;
    }
    return floats && integers;
}

sv_needs_device stage_facts(cl_device_id device) {
    sv_needs_device facts = {.size = sizeof facts, .compute_units = 1};
    cl_device_type type = 0;
    cl_bool unified = CL_FALSE;
    char extensions[8192] = "";
    (void)clGetDeviceInfo(device, CL_DEVICE_TYPE, sizeof type, &type, NULL);
    (void)clGetDeviceInfo(device, CL_DEVICE_HOST_UNIFIED_MEMORY, sizeof unified, &unified, NULL);
    (void)clGetDeviceInfo(device, CL_DEVICE_EXTENSIONS, sizeof extensions - 1, extensions, NULL);
    (void)clGetDeviceInfo(device, CL_DEVICE_MAX_COMPUTE_UNITS, sizeof facts.compute_units,
                          &facts.compute_units, NULL);
    facts.flags = (type & CL_DEVICE_TYPE_CPU ? SV_NEEDS_CPU : 0u) | (unified ? SV_NEEDS_UNIFIED : 0u) |
                  (strstr(extensions, "cl_khr_fp64") ? SV_NEEDS_DOUBLES : 0u);
    return facts;
}
