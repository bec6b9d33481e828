/* SPDX-License-Identifier: MIT */
#include "support/rig.h"

#include "programs/shared_programs.h"

#include "smartvis/device.h"
#include "smartvis/lookup.h"
#include <dlfcn.h>

static void stop(const char *what, const char *detail) {
    (void)fprintf(stderr, "rig: %s: %s\n", what, detail);
    exit(2);
}

static void keep_log(const sv_host *host, int32_t severity, const char *text) {
    rig *r = host->host_data;
    if (strchr(text, '\n')) stop("a line of the log has a newline", text);
    r->last_severity = severity;
    (void)snprintf(r->last_log, sizeof r->last_log, "%s", text);
    r->log_lines++;
    const size_t used = strlen(r->all_logs);
    (void)snprintf(r->all_logs + used, sizeof r->all_logs - used, "%s\n", text);
}

static void open_device(rig *r) {
    sv_devices devices;
    if (!sv_devices_open(&devices, CL_QUEUE_PROFILING_ENABLE, &r->device, &r->context, &r->queue))
        stop("OpenCL", devices.why);
    shared_programs_begin(r->context);
}

static void release(void *object) {
    (void)clReleaseMemObject(object);
}

cl_mem rig_keep(cl_mem object) {
    if (!object) stop("OpenCL", "no object");
    unit_keep(release, object);
    return object;
}

cl_mem rig_buffer(const rig *r, size_t bytes) {
    return rig_keep(clCreateBuffer(r->context, CL_MEM_READ_WRITE, bytes, NULL, NULL));
}

cl_mem rig_foreign_buffer(const rig *r, size_t bytes) {
    cl_context other = clCreateContext(NULL, 1, &r->device, NULL, NULL, NULL);
    if (!other) stop("OpenCL", "no other context");
    cl_mem buffer = rig_keep(clCreateBuffer(other, CL_MEM_READ_WRITE, bytes, NULL, NULL));
    (void)clReleaseContext(other); /* the buffer keeps it */
    return buffer;
}

bool rig_is_cpu(const rig *r) {
    cl_device_type type = 0;
    if (clGetDeviceInfo(r->device, CL_DEVICE_TYPE, sizeof type, &type, NULL) != CL_SUCCESS)
        stop("OpenCL", "clGetDeviceInfo");
    return (type & CL_DEVICE_TYPE_CPU) != 0;
}

void rig_open(rig *r, const char *path) {
    memset(r, 0, sizeof *r);
    const char *build = getenv("SV_BUILD_DIR");
    const char *const standard = unit_text("%s/smartvis.so", build ? build : ".");
    r->library = dlopen(path ? path : standard, RTLD_NOW | RTLD_LOCAL);
    if (!r->library) stop("dlopen", dlerror());
    r->entry = dlsym(r->library, SV_ENTRY_SYMBOL);
    if (!r->entry) stop("dlsym", dlerror());
    r->host =
        (sv_host){.size = sizeof r->host, .host_data = r, .name = "rig", .version = "1", .log = keep_log};
    if (r->entry->create(&r->host, r->entry->descriptor(0)->id, &r->plugin) != SV_OK)
        stop("create", r->last_log);
    open_device(r);
}

void rig_close(rig *r) {
    r->plugin->deactivate(r->plugin); /* an inactive one only says so */
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
    return unit_end(state);
}

rig_result rig_result_make(uint32_t width, uint32_t height) {
    const size_t rays = (size_t)width * height;
    return (rig_result){.depth = unit_memory(rays * sizeof(float)),
                        .status = unit_memory(rays),
                        .stats = {.size = sizeof(sv_stats)}};
}

static sv_param_info info_of(const rig *r, const char *key) {
    sv_param_info info = {.size = sizeof info};
    for (uint32_t i = 0; i < r->plugin->param_count(r->plugin); i++)
        if (r->plugin->param_info(r->plugin, i, &info) == SV_OK && strcmp(info.key, key) == 0) return info;
    stop("no parameter", key);
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
    if (!sv_lookup_value(r->plugin, &info, name, &value)) stop("no value of an enum", name);
    return value;
}

int rig_enable(const rig *r, const sv_param_info *param, double method, sv_param_value *out) {
    sv_param_info on;
    uint64_t values = param->depends_values;
    int count = 0;
    for (uint32_t id = param->depends_on; id != 0; id = on.depends_on) {
        if (!sv_lookup_id(r->plugin, id, &on))
            stop("a parameter depends on one that is not there", param->key);
        if (strcmp(on.key, "method") == 0) return values >> (uint32_t)method & 1u ? count : -1;
        if (count == RIG_MAX_ENABLE) stop("a parameter depends on too many", param->key);
        double value = on.min_value;
        for (; !(values & 1u); values >>= 1) value += on.step;
        out[count++] = (sv_param_value){.id = id, .value = value};
        values = on.depends_values;
    }
    return count;
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

/* The format's parameters. Where they name no method, and the plugin has one to name, it is the mean filter:
 * rig_expect knows its map. */
static void name_method(const rig *r, stage_way *way) {
    sv_param_info info = {.size = sizeof info};
    double mean = 0.0;
    bool named =
        !sv_lookup_key(r->plugin, "method", &info) || !sv_lookup_value(r->plugin, &info, "mean", &mean);
    for (uint32_t i = 0; i < way->fixed_count; i++) named = named || way->fixed[i].id == info.id;
    if (!named) way->fixed[way->fixed_count++] = (sv_param_value){info.id, 0, mean};
}

static void refused(void *data, const char *what, cl_int code) {
    stop("OpenCL or memory", what);
}

static void free_stage(void *st) {
    stage_free(st);
}

stage *rig_stage(const rig *r, const rig_format *f, const uint8_t *volume) {
    const stage_device device = {r->device, r->context, r->queue};
    stage *st = unit_memory(sizeof *st);
    stage_way way = {.width = f->width,
                     .height = f->height,
                     .slices = f->slices,
                     .longest = f->slab_slices ? f->slab_slices : f->slices,
                     .lengths = f->lengths,
                     .tiles_x = f->tiles_x ? f->tiles_x : 4,
                     .extra_w = f->extra_w,
                     .extra_h = f->extra_h,
                     .extra_pitch = f->extra_pitch,
                     .carrier = f->carrier ? f->carrier : SV_CARRIER_HOST,
                     .own_queue = f->own_queue,
                     .ranges = f->scanned != NULL,
                     .ranges_in_buffer = f->scanned_in_buffer,
                     .registered = f->in_place,
                     .spacing_mm = {f->voxel_mm, f->voxel_mm, f->voxel_mm},
                     .padding = f->padding,
                     .hatch = 255};
    for (; way.fixed_count < RIG_MAX_FIXED && f->fixed[way.fixed_count].id; way.fixed_count++)
        way.fixed[way.fixed_count] = f->fixed[way.fixed_count];
    /* Buffers, where the device has no such images: the tests are for its kernels. */
    if (way.carrier == SV_CARRIER_IMAGE && !stage_has_images(&device)) way.carrier = SV_CARRIER_BUFFER;
    name_method(r, &way);
    stage_make(st, &way, &device, refused, NULL);
    st->frame_flags = 0;
    stage_fill(st, volume, f->scanned);
    unit_keep(free_stage, st);
    return st;
}

void rig_tell(stage *st, const sv_beams *beams) {
    memcpy(st->told.probe_rotation, beams->rotation, sizeof beams->rotation);
    memcpy(st->told.probe_side, beams->side, sizeof beams->side);
    memcpy(st->told.beam_apex_mm, beams->apex_mm, sizeof beams->apex_mm);
    st->told.beams = beams->kind;
    st->told.beam_sweep_mm = beams->sweep_mm;
}

sv_status rig_frame(rig *r, const stage *st, const sv_param_value *values, uint32_t count, rig_result *out) {
    const sv_result result = {
        .size = sizeof result, .depth = out->depth, .status = out->status, .stats = &out->stats};
    const sv_status status = stage_run(st, r->plugin, values, count, &result);
    if (status >= SV_OK) hs_plugin_points(r->plugin, &out->points);
    if (st->format.queue && clFinish(st->format.queue) != CL_SUCCESS)
        stop("OpenCL", "clFinish"); /* their report */
    return status == SV_OK ? out->stats.outcome : status;
}

sv_status rig_run(rig *r, const rig_format *f, const uint8_t *volume, const sv_param_value *values,
                  uint32_t count, rig_result *out) {
    const void *mark = unit_mark();
    const stage *t = rig_stage(r, f, volume);
    sv_status status = r->plugin->activate(r->plugin, &t->format);
    if (status == SV_OK) {
        status = rig_frame(r, t, values, count, out);
        r->plugin->deactivate(r->plugin);
    }
    unit_return(mark);
    return status;
}
