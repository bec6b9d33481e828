/* SPDX-License-Identifier: MIT */
#include "validate/drive/drive.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <unistd.h>

/* ---------------------------------------------------------------------------------------------- device -- */

enum { MAX_PLATFORMS = 16 };

static cl_device_id first_of(cl_device_type type) {
    cl_platform_id platforms[MAX_PLATFORMS];
    cl_uint count = 0;
    cl_device_id device = NULL;
    if (clGetPlatformIDs(MAX_PLATFORMS, platforms, &count) != CL_SUCCESS) return NULL;
    for (cl_uint i = 0; i < count && i < MAX_PLATFORMS && !device; i++)
        if (clGetDeviceIDs(platforms[i], type, 1, &device, NULL) != CL_SUCCESS) device = NULL;
    return device;
}

void v_device_open(v_run *run, v_device *d) {
    const char *wanted = getenv("SMARTVIS_DEVICE");
    cl_int code = CL_SUCCESS;
    memset(d, 0, sizeof *d);
    v_where(run, "the validator's own OpenCL calls");
    if (!wanted || strcmp(wanted, "cpu") != 0) d->device = first_of(CL_DEVICE_TYPE_GPU);
    if (!d->device && wanted && strcmp(wanted, "cpu") == 0) d->device = first_of(CL_DEVICE_TYPE_CPU);
    if (!d->device && !wanted) d->device = first_of(CL_DEVICE_TYPE_ALL);
    if (!d->device) v_skip(run, "there is no OpenCL device");
    d->context = clCreateContext(NULL, 1, &d->device, NULL, NULL, &code);
    if (code == CL_SUCCESS) d->queue = clCreateCommandQueue(d->context, d->device, 0, &code);
    if (code != CL_SUCCESS) v_skip(run, "the OpenCL device cannot be opened: %d", (int)code);
}

void v_device_close(v_device *d) {
    if (d->queue) (void)clReleaseCommandQueue(d->queue);
    if (d->context) (void)clReleaseContext(d->context);
    memset(d, 0, sizeof *d);
}

/* --------------------------------------------------------------------------------------------- volumes -- */

static uint8_t voxel(v_run *run, v_kind kind, uint32_t x, uint32_t y, uint32_t z, uint32_t slices) {
    const uint32_t shift = kind == V_OTHER ? slices / 5 : 0;
    const uint32_t wall = slices / 6 + (x + y) / 9 % 3 + shift,
                   fetus = slices / 2 + (x * 2 + y) / 11 % 4 + shift;
    switch (kind) {
    case V_LAYERS:
    case V_OTHER:
        if (z < wall) return (uint8_t)(90 + v_random(run, 60));
        return z < fetus ? (uint8_t)(5 + v_random(run, 20)) : (uint8_t)(140 + v_random(run, 100));
    case V_WHITE:
        return 255;
    case V_GREY:
        return 128;
    case V_NOISE:
        return (uint8_t)v_random(run, 256);
    case V_STRIPES:
        return z % 2 ? 255 : 0;
    default:
        return 0;
    }
}

const char *v_kind_name(v_kind kind) {
    static const char *const names[V_KINDS] = {"layered", "other layered", "black",  "white",
                                               "grey",    "noisy",         "striped"};
    return names[kind];
}

void v_volume_make(v_run *run, v_volume *v, v_kind kind, uint32_t width, uint32_t height, uint32_t slices) {
    const size_t rays = (size_t)width * height;
    *v = (v_volume){width, height, slices, v_memory(run, rays * slices),
                    v_memory(run, rays * sizeof(sv_scanned))};
    for (uint32_t z = 0; z < slices; z++)
        for (uint32_t y = 0; y < height; y++)
            for (uint32_t x = 0; x < width; x++)
                v->voxels[z * rays + (size_t)y * width + x] = voxel(run, kind, x, y, z, slices);
    for (size_t i = 0; i < rays; i++) v->ranges[i] = (sv_scanned){0, (uint16_t)slices};
}

void v_volume_free(v_volume *v) {
    free(v->voxels);
    free(v->ranges);
    *v = (v_volume){0};
}

void v_volume_narrow(v_volume *v) {
    for (uint32_t i = 0; i < v->width * v->height; i++) {
        const uint32_t first = i % 3, last = 1 + i % 2;
        if (v->slices > first + last)
            v->ranges[i] = (sv_scanned){(uint16_t)first, (uint16_t)(v->slices - last)};
    }
}

void v_volume_outside(v_run *run, v_volume *v, int value) {
    const size_t rays = (size_t)v->width * v->height;
    for (size_t i = 0; i < rays; i++)
        for (uint32_t z = 0; z < v->slices; z++)
            if (z < v->ranges[i].first || z >= v->ranges[i].end)
                v->voxels[z * rays + i] = value < 0 ? (uint8_t)v_random(run, 256) : (uint8_t)value;
}

/* ----------------------------------------------------------------------------------------------- stage -- */

enum { GUARD = 256, OBJECT_OFFSET = 64, RANGES_OFFSET = 12 };

v_way v_standard_way(const v_subject *s) {
    const sv_descriptor *d = s->descriptor;
    return (v_way){.width = 31,
                   .height = 26,
                   .slices = 28,
                   .longest = 11,
                   .tiles_x = 3,
                   .extra_w = 2,
                   .extra_h = 1,
                   .extra_pitch = 5,
                   .carrier = SV_CARRIER_HOST,
                   .own_queue = (d->queues & SV_QUEUE_HOST) == 0,
                   .ranges = (d->features & SV_FEATURE_SCANNED) != 0,
                   .padding = SV_NO_PADDING};
}

v_way v_sized(v_way way, uint32_t width, uint32_t height, uint32_t slices) {
    way.longest = (uint32_t)(((uint64_t)way.longest * slices + way.slices - 1) / way.slices);
    way.width = width;
    way.height = height;
    way.slices = slices;
    return way;
}

/* ---- the format */
static void split(v_stage *st) {
    const v_way *w = &st->way;
    for (uint32_t first = 0; first < w->slices; st->slab_count++) {
        V_EXPECT(st->run, st->slab_count < V_MAX_SLABS, "the validator cuts %u slices into too many slabs",
                 w->slices);
        uint32_t length = w->lengths ? w->lengths[st->slab_count] : w->longest;
        if (length > w->slices - first || length == 0) length = w->slices - first;
        st->first[st->slab_count] = first;
        st->length[st->slab_count] = length;
        if (length > st->format.max_slab_slices) st->format.max_slab_slices = length;
        first += length;
    }
}

static void describe(v_stage *st) {
    const v_way *w = &st->way;
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
                             .values = w->fixed_count ? st->way.fixed : NULL,
                             .value_count = w->fixed_count};
    if (!st->device) return;
    st->format.context = st->device->context;
    st->format.device = st->device->device;
    st->format.queue = st->device->queue;
}

/* The least bytes of a slab of n slices, as the header gives them at sv_slab. */
static uint64_t min_bytes(const sv_format *f, uint32_t n) {
    const uint64_t r = (n - 1) / f->tiles_x;
    const uint64_t last = (r * f->tile_h + f->height - 1) * f->row_pitch +
                          (uint64_t)((n - 1) % f->tiles_x) * f->tile_w + f->width;
    if (r == 0) return last;
    const uint64_t before = ((r - 1) * f->tile_h + f->height - 1) * f->row_pitch +
                            (uint64_t)(f->tiles_x - 1) * f->tile_w + f->width;
    return before > last ? before : last;
}

/* ---- memory and objects */
static size_t whole_pages(size_t bytes) {
    const size_t page = (size_t)sysconf(_SC_PAGESIZE);
    return (bytes + page - 1) / page * page;
}

/* Slabs one behind the other, each in pages of its own; behind the exact ones a page that cannot be read. */
static void place_slabs(v_stage *st) {
    const sv_format *f = &st->format;
    const size_t rows = (f->max_slab_slices + f->tiles_x - 1) / f->tiles_x * f->tile_h;
    const size_t each = whole_pages(rows * f->row_pitch + 64), page = whole_pages(1);
    st->page_bytes = (each + page) * st->slab_count;
    void *pages = mmap(NULL, st->page_bytes, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
    V_EXPECT(st->run, pages != MAP_FAILED, "no memory for slabs: the check could not be made");
    st->pages = pages;
    for (uint32_t n = 0; n < st->slab_count; n++) {
        uint8_t *start = st->pages + n * (each + page);
        st->bytes[n] = st->way.exact ? min_bytes(f, st->length[n]) : rows * f->row_pitch;
        st->memory[n] = st->way.exact ? start + each - st->bytes[n] : start;
        if (st->way.exact) (void)mprotect(start + each, page, PROT_NONE);
    }
    if (!st->way.registered) return;
    st->format.host_memory = st->pages;
    st->format.host_memory_bytes = st->page_bytes;
}

static void place_results(v_stage *st) {
    const size_t rays = (size_t)st->format.width * st->format.height;
    st->row_bytes = (st->format.width + st->way.pitch) * sizeof(float);
    st->depth_at = GUARD;
    st->status_at = st->depth_at + st->row_bytes * st->format.height + GUARD;
    st->stats_at = (st->status_at + rays + GUARD + 15) / 16 * 16;
    st->result_bytes = st->stats_at + sizeof(sv_stats) + GUARD;
    st->results = v_memory(st->run, st->result_bytes);
}

static void need(const v_stage *st, cl_int code, const char *what) {
    if (code != CL_SUCCESS) v_skip(st->run, "the OpenCL device refuses %s: %d", what, (int)code);
}

static void make_objects(v_stage *st) {
    const sv_format *f = &st->format;
    const size_t rays = (size_t)f->width * f->height;
    cl_context context = st->device->context;
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
        st->depth_object =
            clCreateBuffer(context, CL_MEM_READ_WRITE, rays * sizeof(float) + 2 * OBJECT_OFFSET, NULL, &code);
    need(st, code, "a buffer");
}

void v_stage_make(v_run *run, v_stage *st, const v_way *way, const v_device *device) {
    memset(st, 0, sizeof *st);
    st->run = run;
    st->way = *way;
    st->device = way->own_queue ? NULL : device;
    describe(st);
    split(st);
    place_slabs(st);
    place_results(st);
    if (way->ranges) st->ranges = v_memory(run, sizeof(sv_scanned) * way->width * way->height);
    if (st->device) make_objects(st);
}

void v_stage_free(v_stage *st) {
    for (uint32_t n = 0; n < st->slab_count; n++)
        if (st->objects[n]) (void)clReleaseMemObject(st->objects[n]);
    if (st->ranges_object) (void)clReleaseMemObject(st->ranges_object);
    if (st->depth_object) (void)clReleaseMemObject(st->depth_object);
    if (st->pages) (void)munmap(st->pages, st->page_bytes);
    free(st->results);
    free(st->ranges);
    memset(st, 0, sizeof *st);
}

/* ---- volumes */
static void copy_slab(v_stage *st, const v_volume *v, uint32_t n) {
    const sv_format *f = &st->format;
    memset(st->memory[n], st->way.hatch, st->bytes[n]);
    for (uint32_t s = 0; s < st->length[n]; s++)
        for (uint32_t y = 0; y < f->height; y++) {
            const size_t row = (size_t)(s / f->tiles_x) * f->tile_h + y;
            memcpy(st->memory[n] + row * f->row_pitch + (size_t)(s % f->tiles_x) * f->tile_w,
                   v->voxels + ((size_t)(st->first[n] + s) * v->height + y) * v->width, v->width);
        }
}

static void upload_slab(v_stage *st, uint32_t n) {
    const sv_format *f = &st->format;
    const size_t zero[3] = {0, 0, 0};
    const size_t region[3] = {(size_t)f->tiles_x * f->tile_w, st->bytes[n] / f->row_pitch, 1};
    cl_command_queue q = st->device->queue;
    const cl_int code = f->carrier == SV_CARRIER_BUFFER
                            ? clEnqueueWriteBuffer(q, st->objects[n], CL_TRUE, OBJECT_OFFSET, st->bytes[n],
                                                   st->memory[n], 0, NULL, NULL)
                            : clEnqueueWriteImage(q, st->objects[n], CL_TRUE, zero, region, f->row_pitch, 0,
                                                  st->memory[n], 0, NULL, NULL);
    need(st, code, "an upload");
}

void v_stage_fill(v_stage *st, const v_volume *v) {
    const size_t bytes = sizeof(sv_scanned) * v->width * v->height;
    for (uint32_t n = 0; n < st->slab_count; n++) {
        copy_slab(st, v, n);
        if (st->objects[n]) upload_slab(st, n);
    }
    if (st->ranges) memcpy(st->ranges, v->ranges, bytes);
    if (st->ranges_object)
        need(st,
             clEnqueueWriteBuffer(st->device->queue, st->ranges_object, CL_TRUE, RANGES_OFFSET, bytes,
                                  v->ranges, 0, NULL, NULL),
             "an upload");
}

/* ---- what a call is given */
sv_slab v_stage_slab(const v_stage *st, uint32_t n) {
    const bool host = st->format.carrier == SV_CARRIER_HOST;
    return (sv_slab){.size = sizeof(sv_slab),
                     .first_slice = st->first[n],
                     .slice_count = st->length[n],
                     .memory = host ? st->memory[n] : NULL,
                     .object = st->objects[n],
                     .offset = st->format.carrier == SV_CARRIER_BUFFER ? OBJECT_OFFSET : 0,
                     .bytes = st->format.carrier == SV_CARRIER_IMAGE ? 0 : st->bytes[n]};
}

sv_frame v_stage_frame(const v_stage *st, const sv_param_value *values, uint32_t count) {
    sv_frame frame = {.size = st->frame_size ? st->frame_size : sizeof frame,
                      .flags = SV_FRAME_DISCONTINUITY,
                      .index = 1,
                      .values = values,
                      .value_count = count,
                      .scanned = st->ranges_object ? NULL : st->ranges,
                      .scanned_object = st->ranges_object,
                      .scanned_offset = st->ranges_object ? RANGES_OFFSET : 0};
    memcpy(frame.probe_rotation, st->probe_rotation, sizeof frame.probe_rotation);
    memcpy(frame.probe_side, st->probe_side, sizeof frame.probe_side);
    return frame;
}

sv_result v_stage_result(v_stage *st) {
    return (sv_result){.size = sizeof(sv_result),
                       .depth_pitch = st->way.pitch && !st->depth_object ? (uint32_t)st->row_bytes : 0,
                       .depth = st->depth_object ? NULL : (float *)(void *)(st->results + st->depth_at),
                       .depth_object = st->depth_object,
                       .depth_offset = st->depth_object ? OBJECT_OFFSET : 0,
                       .status = st->results + st->status_at,
                       .stats = (sv_stats *)(void *)(st->results + st->stats_at)};
}

void v_stage_poison(v_stage *st, uint8_t byte) {
    memset(st->results, byte, st->result_bytes);
    ((sv_stats *)(void *)(st->results + st->stats_at))->size = sizeof(sv_stats);
    if (!st->depth_object) return;
    const size_t bytes = (size_t)st->format.width * st->format.height * sizeof(float) + 2 * OBJECT_OFFSET;
    need(st, clEnqueueFillBuffer(st->device->queue, st->depth_object, &byte, 1, 0, bytes, 0, NULL, NULL),
         "to fill a buffer");
}

/* ---- what must not have changed */
/* All bytes of an object, to be freed. */
static uint8_t *read_object(const v_stage *st, cl_mem object, size_t *bytes) {
    cl_mem_object_type type = CL_MEM_OBJECT_BUFFER;
    size_t side[3] = {1, 1, 1};
    const size_t zero[3] = {0, 0, 0};
    cl_command_queue q = st->device->queue;
    need(st, clGetMemObjectInfo(object, CL_MEM_TYPE, sizeof type, &type, NULL), "to tell an object's type");
    const bool image = type != CL_MEM_OBJECT_BUFFER;
    if (image) {
        (void)clGetImageInfo(object, CL_IMAGE_WIDTH, sizeof side[0], &side[0], NULL);
        (void)clGetImageInfo(object, CL_IMAGE_HEIGHT, sizeof side[1], &side[1], NULL);
    } else {
        (void)clGetMemObjectInfo(object, CL_MEM_SIZE, sizeof side[0], &side[0], NULL);
    }
    *bytes = side[0] * side[1];
    uint8_t *out = v_memory(st->run, *bytes);
    need(st,
         image ? clEnqueueReadImage(q, object, CL_TRUE, zero, side, 0, 0, out, 0, NULL, NULL)
               : clEnqueueReadBuffer(q, object, CL_TRUE, 0, *bytes, out, 0, NULL, NULL),
         "to read an object");
    return out;
}

static bool is_touched(const v_stage *st, size_t from, size_t to, uint8_t byte) {
    for (size_t i = from; i < to; i++)
        if (st->results[i] != byte) return true;
    return false;
}

/* True if a byte around the map's buffer is another one. */
static bool is_object_touched(const v_stage *st, uint8_t byte) {
    size_t bytes = 0, touched = 0;
    uint8_t *all = read_object(st, st->depth_object, &bytes);
    for (size_t i = 0; i < OBJECT_OFFSET; i++) touched += all[i] != byte || all[bytes - 1 - i] != byte;
    free(all);
    return touched > 0;
}

const char *v_stage_trespass(const v_stage *st, uint8_t byte) {
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

static uint64_t sum_object(const v_stage *st, uint64_t h, cl_mem object) {
    size_t bytes = 0;
    if (!object) return h;
    uint8_t *all = read_object(st, object, &bytes);
    h = sum(h, all, bytes);
    free(all);
    return h;
}

uint64_t v_stage_inputs(const v_stage *st) {
    uint64_t h = 0xcbf29ce484222325u;
    for (uint32_t n = 0; n < st->slab_count; n++) {
        h = sum(h, st->memory[n], st->bytes[n]);
        h = sum_object(st, h, st->objects[n]);
    }
    h = sum_object(st, h, st->ranges_object);
    if (st->ranges) h = sum(h, st->ranges, sizeof(sv_scanned) * st->format.width * st->format.height);
    return sum(h, &st->format, sizeof st->format);
}
