/* SPDX-License-Identifier: MIT */
#include "support/rig.h"

#include "programs/shared_programs.h"

#include "smartvis/lookup.h"
#include <dlfcn.h>

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static void fail(const char *what, const char *detail) {
    (void)fprintf(stderr, "rig: %s: %s\n", what, detail);
    exit(2);
}

static void keep_log(const sv_host *host, int32_t severity, const char *text) {
    rig *r = host->host_data;
    if (strchr(text, '\n')) fail("a line of the log has a newline", text);
    r->last_severity = severity;
    (void)snprintf(r->last_log, sizeof r->last_log, "%s", text);
    r->log_lines++;
    const size_t used = strlen(r->all_logs);
    (void)snprintf(r->all_logs + used, sizeof r->all_logs - used, "%s\n", text);
}

static void open_device(rig *r) {
    cl_platform_id platform = NULL;
    cl_int code = clGetPlatformIDs(1, &platform, NULL);
    if (code == CL_SUCCESS) code = clGetDeviceIDs(platform, CL_DEVICE_TYPE_ALL, 1, &r->device, NULL);
    if (code == CL_SUCCESS) r->context = clCreateContext(NULL, 1, &r->device, NULL, NULL, &code);
    if (code == CL_SUCCESS)
        r->queue = clCreateCommandQueue(r->context, r->device, CL_QUEUE_PROFILING_ENABLE, &code);
    if (code != CL_SUCCESS) fail("OpenCL", "no device");
    shared_programs_begin(r->context);
}

cl_mem rig_foreign_buffer(const rig *r, size_t bytes) {
    cl_int code = CL_SUCCESS;
    cl_mem buffer = NULL;
    cl_context other = clCreateContext(NULL, 1, &r->device, NULL, NULL, &code);
    if (code == CL_SUCCESS) buffer = clCreateBuffer(other, CL_MEM_READ_WRITE, bytes, NULL, &code);
    if (code != CL_SUCCESS) fail("OpenCL", "no buffer in another context");
    (void)clReleaseContext(other); /* the buffer keeps it */
    return buffer;
}

bool rig_is_cpu(const rig *r) {
    cl_device_type type = 0;
    if (clGetDeviceInfo(r->device, CL_DEVICE_TYPE, sizeof type, &type, NULL) != CL_SUCCESS)
        fail("OpenCL", "clGetDeviceInfo");
    return (type & CL_DEVICE_TYPE_CPU) != 0;
}

void rig_open_library(rig *r, const char *path) {
    char standard[1024];
    memset(r, 0, sizeof *r);
    const char *build = getenv("SV_BUILD_DIR");
    (void)snprintf(standard, sizeof standard, "%s/smartvis.so", build ? build : ".");
    r->library = dlopen(path ? path : standard, RTLD_NOW | RTLD_LOCAL);
    if (!r->library) fail("dlopen", dlerror());
    r->entry = dlsym(r->library, SV_ENTRY_SYMBOL);
    if (!r->entry) fail("dlsym", dlerror());
    r->host =
        (sv_host){.size = sizeof r->host, .host_data = r, .name = "rig", .version = "1", .log = keep_log};
    if (r->entry->create(&r->host, r->entry->descriptor(0)->id, &r->plugin) != SV_OK)
        fail("create", r->last_log);
}

void rig_close_library(rig *r) {
    r->plugin->destroy(r->plugin);
    (void)dlclose(r->library);
}

void rig_open(rig *r, const char *path) {
    rig_open_library(r, path);
    open_device(r);
}

void rig_close(rig *r) {
    r->plugin->destroy(r->plugin);
    shared_programs_end(r->context);
    (void)clReleaseCommandQueue(r->queue);
    (void)clReleaseContext(r->context);
    (void)dlclose(r->library);
}

int rig_setup(void **state) {
    rig *r = malloc(sizeof *r);
    if (!r) return -1;
    rig_open(r, NULL);
    *state = r;
    return 0;
}

int rig_teardown(void **state) {
    rig_close(*state);
    free(*state);
    return 0;
}

rig_result rig_result_make(uint32_t width, uint32_t height) {
    rig_result out = {.depth = calloc((size_t)width * height, sizeof(float)),
                      .status = calloc((size_t)width * height, 1),
                      .stats = {.size = sizeof(sv_stats)}};
    if (!out.depth || !out.status) fail("memory", "result");
    return out;
}

void rig_result_free(rig_result *out) {
    free(out->depth);
    free(out->status);
    memset(out, 0, sizeof *out);
}

static sv_param_info info_of(const rig *r, const char *key) {
    sv_param_info info = {.size = sizeof info};
    for (uint32_t i = 0; i < r->plugin->param_count(r->plugin); i++)
        if (r->plugin->param_info(r->plugin, i, &info) == SV_OK && strcmp(info.key, key) == 0) return info;
    fail("no parameter", key);
    return info;
}

uint32_t rig_param(const rig *r, const char *key) {
    return info_of(r, key).id;
}

double rig_param_default(const rig *r, const char *key) {
    return info_of(r, key).default_value;
}

double rig_enum(const rig *r, const char *key, const char *name) {
    const sv_param_info info = info_of(r, key);
    double value = 0.0;
    if (!sv_lookup_value(r->plugin, &info, name, &value)) fail("no value of an enum", name);
    return value;
}

uint32_t rig_values(const rig *r, const rig_settings *s, sv_param_value *values) {
    const struct {
        const char *key;
        double value;
    } list[] = {{"q", (double)s->q},
                {"fluid_threshold", s->fluid_threshold},
                {"bone_mode", s->bone.bone_mode},
                {"bone_offset", s->bone.bone_offset},
                {"bone_threshold", s->bone.bone_threshold},
                {"bone_fraction", s->bone.bone_fraction},
                {"kernel", s->k},
                {"fill_weight", s->omega},
                {"drop_empty", s->bone.drop_empty},
                {"evidence", s->evidence},
                {"min_gap", s->min_gap}};
    const uint32_t count = sizeof list / sizeof *list;
    for (uint32_t i = 0; i < count; i++)
        values[i] = (sv_param_value){.id = rig_param(r, list[i].key), .value = list[i].value};
    return count;
}

static void split(rig_textures *t, const rig_format *f) {
    const uint32_t longest = f->slab_slices ? f->slab_slices : f->slices;
    for (uint32_t first = 0; first < f->slices && t->slab_count < RIG_MAX_SLABS; t->slab_count++) {
        uint32_t length = f->lengths ? f->lengths[t->slab_count] : longest;
        if (length > f->slices - first) length = f->slices - first;
        t->first[t->slab_count] = first;
        t->length[t->slab_count] = length;
        if (length > t->format.max_slab_slices) t->format.max_slab_slices = length;
        first += length;
    }
}

/* Copies the volume into textures. */
static void fill_textures(rig_textures *t, const rig_format *f, const uint8_t *volume) {
    const sv_format *m = &t->format;
    const uint32_t tile_rows = (m->max_slab_slices + m->tiles_x - 1) / m->tiles_x;
    t->texture_bytes = (size_t)tile_rows * m->tile_h * m->row_pitch;
    t->memory = malloc(t->texture_bytes * t->slab_count);
    if (!t->memory) fail("memory", "textures");
    memset(t->memory, 255, t->texture_bytes * t->slab_count);
    for (uint32_t n = 0; n < t->slab_count; n++)
        for (uint32_t s = 0; s < t->length[n]; s++)
            for (uint32_t y = 0; y < f->height; y++) {
                const size_t row = (size_t)(s / m->tiles_x) * m->tile_h + y;
                memcpy(t->memory + n * t->texture_bytes + row * m->row_pitch +
                           (size_t)(s % m->tiles_x) * m->tile_w,
                       volume + ((size_t)(t->first[n] + s) * f->height + y) * f->width, f->width);
            }
}

static void make_objects(rig_textures *t, const rig *r) {
    const sv_format *m = &t->format;
    for (uint32_t n = 0; n < t->slab_count; n++) {
        uint8_t *texture = t->memory + n * t->texture_bytes;
        cl_int code = CL_SUCCESS;
        if (m->carrier == SV_CARRIER_BUFFER) {
            t->objects[n] = clCreateBuffer(r->context, CL_MEM_READ_ONLY, t->texture_bytes + 64, NULL, &code);
            if (code == CL_SUCCESS)
                code = clEnqueueWriteBuffer(r->queue, t->objects[n], CL_TRUE, 64, t->texture_bytes, texture,
                                            0, NULL, NULL);
        } else {
            const cl_image_format format = {CL_R, n % 2 ? CL_UNORM_INT8 : CL_UNSIGNED_INT8};
            const cl_image_desc desc = {.image_type = CL_MEM_OBJECT_IMAGE2D,
                                        .image_width = (size_t)m->tiles_x * m->tile_w,
                                        .image_height = t->texture_bytes / m->row_pitch,
                                        .image_row_pitch = m->row_pitch};
            t->objects[n] = clCreateImage(r->context, CL_MEM_READ_ONLY | CL_MEM_COPY_HOST_PTR, &format, &desc,
                                          texture, &code);
        }
        if (code != CL_SUCCESS) fail("OpenCL", "slab object");
    }
}

/* Ranges in a buffer begin SCANNED_OFFSET bytes behind its start. */
enum { SCANNED_OFFSET = 12 };
static void hand_over_ranges(rig_textures *t, const rig *r, const rig_format *f) {
    const size_t bytes = (size_t)f->width * f->height * sizeof *f->scanned;
    cl_int code = CL_SUCCESS;
    t->format.flags |= SV_FORMAT_SCANNED;
    if (!f->scanned_in_buffer) {
        t->scanned = f->scanned;
        return;
    }
    t->scanned_buffer = clCreateBuffer(r->context, CL_MEM_READ_ONLY, bytes + SCANNED_OFFSET, NULL, &code);
    if (code == CL_SUCCESS)
        code = clEnqueueWriteBuffer(r->queue, t->scanned_buffer, CL_TRUE, SCANNED_OFFSET, bytes, f->scanned,
                                    0, NULL, NULL);
    if (code != CL_SUCCESS) fail("OpenCL", "buffer of scanned ranges");
}

/* The format's parameters. Where they name no method, and the plugin has one to name, it is the mean filter:
 * rig_expect knows its map. */
static void hand_over_values(rig_textures *t, const rig *r, const rig_format *f) {
    sv_param_info info = {.size = sizeof info};
    double mean = 0.0;
    bool named =
        !sv_lookup_key(r->plugin, "method", &info) || !sv_lookup_value(r->plugin, &info, "mean", &mean);
    uint32_t count = f->fixed_count;
    for (uint32_t i = 0; i < count; i++) named = named || f->fixed[i].id == info.id;
    memcpy(t->fixed, f->fixed, sizeof f->fixed);
    if (!named) t->fixed[count++] = (sv_param_value){info.id, 0, mean};
    t->format.values = t->fixed;
    t->format.value_count = count;
}

rig_textures *rig_textures_make(const rig *r, const rig_format *f, const uint8_t *volume) {
    rig_textures *t = calloc(1, sizeof *t);
    if (!t) fail("memory", "textures");
    sv_format *m = &t->format;
    *m = (sv_format){.size = sizeof *m,
                     .width = f->width,
                     .height = f->height,
                     .slices = f->slices,
                     .voxel_type = SV_VOXEL_U8,
                     .carrier = f->carrier ? f->carrier : SV_CARRIER_HOST,
                     .padding_value = f->padding,
                     .tiles_x = f->tiles_x ? f->tiles_x : 4,
                     .tile_w = f->width + f->extra_w,
                     .tile_h = f->height + f->extra_h,
                     .spacing_mm = {f->voxel_mm, f->voxel_mm, f->voxel_mm}};
    m->row_pitch = m->tiles_x * m->tile_w + f->extra_pitch;
    if (!f->own_queue) {
        m->context = r->context;
        m->device = r->device;
        m->queue = r->queue;
    }
    hand_over_values(t, r, f);
    if (f->scanned) hand_over_ranges(t, r, f);
    split(t, f);
    fill_textures(t, f, volume);
    if (f->in_place) {
        m->host_memory = t->memory;
        m->host_memory_bytes = t->texture_bytes * t->slab_count;
    }
    if (m->carrier != SV_CARRIER_HOST) make_objects(t, r);
    return t;
}

void rig_textures_free(rig_textures *t) {
    for (uint32_t n = 0; n < t->slab_count; n++)
        if (t->objects[n]) (void)clReleaseMemObject(t->objects[n]);
    if (t->scanned_buffer) (void)clReleaseMemObject(t->scanned_buffer);
    free(t->memory);
    free(t);
}

sv_slab rig_slab(const rig_textures *t, uint32_t n) {
    const bool host = t->format.carrier == SV_CARRIER_HOST;
    return (sv_slab){.size = sizeof(sv_slab),
                     .first_slice = t->first[n],
                     .slice_count = t->length[n],
                     .memory = host ? t->memory + n * t->texture_bytes : NULL,
                     .object = t->objects[n],
                     .offset = t->format.carrier == SV_CARRIER_BUFFER ? 64 : 0,
                     .bytes = t->texture_bytes};
}

sv_frame rig_begin(const rig_textures *t, const sv_param_value *values, uint32_t count) {
    return (sv_frame){.size = sizeof(sv_frame),
                      .flags = t->frame_flags,
                      .values = values,
                      .value_count = count,
                      .scanned = t->scanned,
                      .scanned_object = t->scanned_buffer,
                      .scanned_offset = t->scanned_buffer ? SCANNED_OFFSET : 0};
}

sv_status rig_frame(rig *r, const rig_textures *t, const sv_param_value *values, uint32_t count,
                    rig_result *out) {
    const sv_plugin *p = r->plugin;
    const sv_frame frame = rig_begin(t, values, count);
    sv_status status = p->begin(p, &frame);
    for (uint32_t n = 0; status == SV_OK && n < t->slab_count; n++) {
        const sv_slab slab = rig_slab(t, n);
        status = p->slab(p, &slab);
    }
    const sv_result result = {
        .size = sizeof result, .depth = out->depth, .status = out->status, .stats = &out->stats};
    if (status == SV_OK) status = p->end(p, &result);
    if (status >= SV_OK) hs_plugin_points(p, &out->points);
    /* After an error, too: slabs may still be on their way. */
    if (t->format.queue && clFinish(t->format.queue) != CL_SUCCESS) fail("OpenCL", "clFinish");
    return status == SV_OK ? out->stats.outcome : status;
}

sv_status rig_run(rig *r, const rig_format *f, const uint8_t *volume, const sv_param_value *values,
                  uint32_t count, rig_result *out) {
    rig_textures *t = rig_textures_make(r, f, volume);
    sv_status status = r->plugin->activate(r->plugin, &t->format);
    if (status == SV_OK) {
        status = rig_frame(r, t, values, count, out);
        r->plugin->deactivate(r->plugin);
    }
    rig_textures_free(t);
    return status;
}
