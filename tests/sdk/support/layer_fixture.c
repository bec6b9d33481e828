/* SPDX-License-Identifier: MIT */
#include "support/layer_fixture.h"

#include "support/plain_format.h"

#include "smartvis/confidence.h"
#include "support/unit.h"

#include <dlfcn.h>

const char *layer_build(void) {
    const char *folder = getenv("SV_BUILD_DIR");
    if (!folder) fail_msg("SV_BUILD_DIR is not set: run this with ctest");
    return folder;
}

/* ---- the host */
static void keep(const sv_host *host, int32_t severity, const char *text) {
    layer_subject *s = host->host_data;
    const size_t used = strlen(s->log);
    (void)snprintf(s->log + used, sizeof s->log - used, "%d %s\n", severity, text ? text : "(null)");
    void (*act)(void *) = s->on_log;
    s->on_log = NULL;
    if (act) act(s);
}

static void fill(layer_subject *s) {
    for (uint32_t i = 0; i < RAYS; i++) {
        const uint32_t far = 12 + i % W / 4;
        for (uint32_t z = 0; z < SLICES; z++) s->volume[z][i] = (uint8_t)(z < 4 ? 120 : z < far ? 8 : 200);
        s->ranges[i] = (sv_scanned){0, SLICES};
    }
    s->format = plain_format(W, H, SLICES, 1);
    s->format.max_slab_slices = SLAB;
    s->format.flags = SV_FORMAT_SCANNED;
    s->stats.size = sizeof s->stats;
    s->frame = (sv_frame){.size = sizeof s->frame, .index = 7, .time_ns = 100, .scanned = s->ranges};
}

layer_subject *layer_load(const char *folder) {
    layer_subject *s = unit_memory(sizeof *s);
    fill(s);
    s->library = dlopen(unit_text("%s/smartvis_check.so", folder), RTLD_NOW | RTLD_LOCAL);
    if (!s->library) fail_msg("%s", dlerror());
    s->entry = dlsym(s->library, SV_ENTRY_SYMBOL);
    s->host = (sv_host){sizeof s->host, SV_ABI_MINOR, s, "test_layer", "1", keep, NULL};
    return s;
}

layer_subject *layer_open(const char *plugin) {
    (void)setenv("SMARTVIS_CHECK_PLUGIN", unit_text("%s/%s.so", layer_build(), plugin), 1);
    return layer_load(layer_build());
}

void layer_create(layer_subject *s) {
    s->created = s->entry->create(&s->host, s->entry->descriptor(0)->id, &s->p);
}

/* Buffers and the host's queue. */
void layer_take_queue(layer_subject *s) {
    cl_int code = CL_SUCCESS;
    must(hs_cl_open_bare(&s->cl, &err));
    s->format.context = s->cl.context;
    s->format.device = s->cl.device;
    s->format.queue = s->cl.queue;
    s->format.carrier = SV_CARRIER_BUFFER;
    for (int n = 0; n < SLABS; n++)
        s->objects[n] = clCreateBuffer(s->cl.context, CL_MEM_READ_WRITE | CL_MEM_COPY_HOST_PTR, SLAB * RAYS,
                                       s->volume[n * SLAB], &code);
    s->map = clCreateBuffer(s->cl.context, CL_MEM_READ_WRITE, sizeof s->depth, NULL, &code);
    assert_int_equal(code, CL_SUCCESS);
}

void layer_close(layer_subject *s) {
    if (s->p) s->p->destroy(s->p);
    for (int n = 0; n < SLABS; n++)
        if (s->objects[n]) (void)clReleaseMemObject(s->objects[n]);
    if (s->map) (void)clReleaseMemObject(s->map);
    if (s->cl.context) hs_cl_close(&s->cl);
    (void)dlclose(s->library);
}

sv_slab layer_slab_of(const layer_subject *s, uint32_t n) {
    return (sv_slab){.size = sizeof(sv_slab),
                     .first_slice = n * SLAB,
                     .slice_count = SLAB,
                     .memory =
                         s->objects[0] && s->format.carrier != SV_CARRIER_HOST ? NULL : s->volume[n * SLAB],
                     .object = s->format.carrier == SV_CARRIER_HOST ? NULL : s->objects[n],
                     .bytes = SLAB * RAYS};
}

sv_result layer_result_of(layer_subject *s) {
    return (sv_result){.size = sizeof(sv_result),
                       .depth = s->map ? NULL : s->depth,
                       .depth_object = s->map,
                       .status = s->status,
                       .stats = &s->stats};
}

sv_status layer_activate(layer_subject *s) {
    return s->p->activate(s->p, &s->format);
}
sv_status layer_begin(layer_subject *s) {
    return s->p->begin(s->p, &s->frame);
}
sv_status layer_slab(layer_subject *s, uint32_t n) {
    const sv_slab slab = layer_slab_of(s, n);
    return s->p->slab(s->p, &slab);
}
sv_status layer_end(layer_subject *s) {
    const sv_result result = layer_result_of(s);
    const sv_status status = s->p->end(s->p, &result);
    if (s->cl.queue) (void)clFinish(s->cl.queue);
    return status;
}

sv_status layer_frame(layer_subject *s) {
    sv_status status = layer_begin(s);
    for (uint32_t n = 0; n < SLABS && status >= 0; n++) status = layer_slab(s, n);
    s->frame.time_ns += 50;
    return status < 0 ? status : layer_end(s);
}

/* Activates, begins, and gives `count` slabs. */
void layer_start(layer_subject *s, uint32_t count) {
    assert_int_equal(layer_activate(s), SV_OK);
    assert_int_equal(layer_begin(s), SV_OK);
    for (uint32_t n = 0; n < count; n++) (void)layer_slab(s, n);
}

/* ---- what a host does that is right */
void layer_use(layer_subject *s) {
    sv_param_info info = {.size = sizeof info};
    char text[8];
    if (layer_activate(s) < 0) return;
    for (int n = 0; n < 3; n++) (void)layer_frame(s);
    const sv_result result = layer_result_of(s);
    (void)s->p->adjust(s->p, NULL, 0, &result);
    const sv_ext_confidence *confidence = s->p->get_extension(s->p, SV_EXT_CONFIDENCE);
    if (confidence && confidence->offered(s->p)) (void)confidence->write(s->p, s->depth, NULL, 0);
    for (uint32_t n = 0; n < s->p->param_count(s->p) && n < 8; n++)
        if (s->p->param_info(s->p, n, &info) == SV_OK)
            (void)s->p->param_text(s->p, info.id, info.default_value, text, sizeof text);
    if (s->cl.queue) (void)clFinish(s->cl.queue);
    s->p->deactivate(s->p);
}
