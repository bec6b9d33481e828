/* SPDX-License-Identifier: MIT */
/*
 * Calls of the machine's library (smartvis_host.h) in any order with any numbers: right structs of which some
 * words are overwritten, pointers that are NULL, objects in any order, at times from two threads at once. On
 * OpenCL without a device, with a plugin that reads all that it is promised (every_carrier.c). Whatever
 * comes, a code is one of the header's, a failure says why, and what a result points to is there.
 */
#include "door/smartvis_host.h"
#include "fuzz/fake_cl.h"
#include "fuzz/fuzz_bytes.h"
#include "fuzz/fuzz_target.h"

#include <dlfcn.h>
#include <math.h>
#include <pthread.h>
#include <stdlib.h>

enum { VOLUMES = 3, CLIPPERS = 2, VIEWS = 2, AXIS = 9, MAX_CALLS = 48, MARKS = 4, IDS = 3 };
enum { MAX_GRID = 1 << 18, HUGE_GRID = 1 << 30 };

typedef struct {
    svh_host *host;
    svh_volume *volume[VOLUMES];
    svh_clipper *clipper[CLIPPERS];
    svh_view view[VIEWS];
    svh_error error;
    fuzz_bytes in;
    int shares; /* with another thread: objects stay */
} machine;

/* ------------------------------------------------------------------------------------------- any thing */

/* One time in sixteen. */
static int rarely(machine *m) {
    return fuzz_u8(&m->in) % 16 == 1;
}

static svh_volume *any_volume(machine *m) {
    return m->volume[fuzz_u8(&m->in) % VOLUMES];
}

static svh_clipper *any_clipper(machine *m) {
    return m->clipper[fuzz_u8(&m->in) % CLIPPERS];
}

static svh_view *any_view(machine *m) {
    return rarely(m) ? NULL : &m->view[fuzz_u8(&m->in) % VIEWS];
}

/* A double of any kind, but most often one that might be meant. */
static double any_number(machine *m) {
    const uint8_t kind = fuzz_u8(&m->in);
    return kind == 1 ? fuzz_double(&m->in) : kind == 2 ? (double)NAN : (double)fuzz_u8(&m->in) / 16.0 - 2.0;
}

/* A struct of which some words are others. */
static void spoil(machine *m, void *object, size_t bytes) {
    if (fuzz_u8(&m->in) % 4 == 1) fuzz_words(&m->in, object, bytes, 1 + fuzz_u8(&m->in) % 3);
}

/* ------------------------------------------------------------------------------------- what must hold */

static int holds(machine *m, int32_t code) {
    FUZZ_HOLDS(code == SVH_OK || (code >= SVH_USAGE && code <= SVH_DEVICE) || code == SVH_MEMORY);
    if (code != SVH_OK && m->error.size == sizeof m->error) {
        FUZZ_HOLDS(m->error.code == code && m->error.text[0]);
        FUZZ_HOLDS(memchr(m->error.text, 0, sizeof m->error.text) &&
                   memchr(m->error.call, 0, sizeof m->error.call));
    }
    m->error = (svh_error){.size = sizeof m->error};
    return code == SVH_OK;
}

/* Where the caller's own struct may say that there is no place for the error. */
static svh_error *place(machine *m) {
    const uint8_t how = fuzz_u8(&m->in);
    if (how % 16 == 1) m->error.size = how / 16;
    return how % 16 == 1 && how < 128 ? NULL : &m->error;
}

static void read_text(const char *text) {
    FUZZ_HOLDS(text && strlen(text) < 4096);
}

/* The values of a grid; 0: more than there is memory for here, or none. */
static size_t rays_of(const svh_view *view) {
    const double count = (double)view->n[0] * view->n[1] * view->n[2];
    return count > MAX_GRID ? 0 : (size_t)view->n[0] * view->n[1];
}

/* Grids that are neither small nor refused are right, but slow. */
static int is_slow(const svh_view *view) {
    if (!view) return 0;
    const double count = (double)view->n[0] * view->n[1] * view->n[2];
    return count > MAX_GRID && view->n[0] < HUGE_GRID;
}

static void check_result(const svh_result *r) {
    const size_t rays = (size_t)r->n[0] * r->n[1];
    FUZZ_HOLDS(rays > 0 && r->depth && r->status && r->outcome >= 0 && r->outcome <= 2);
    for (size_t i = 0; i < rays; i++) FUZZ_HOLDS(isfinite(r->depth[i]) && r->status[i] < 16);
    for (size_t i = 0; r->confidence && i < rays; i++) FUZZ_HOLDS(r->confidence[i] >= 0.0f);
    read_text(r->why);
}

/* ----------------------------------------------------------------------------------------------- calls */

/* Which of the volumes goes for another one: the first is the other thread's, too. */
static int free_place(machine *m) {
    const uint8_t at = fuzz_u8(&m->in);
    return m->shares ? 1 + at % (VOLUMES - 1) : at % VOLUMES;
}

static void call_take(machine *m) {
    static uint8_t bytes[AXIS * AXIS * AXIS], mask[sizeof bytes];
    static double values[sizeof bytes];
    svh_voxels v = {.size = sizeof v, .spacing = {1, 1, 1}};
    svh_volume *out = NULL;
    for (int a = 0; a < 3; a++) v.n[a] = 1 + fuzz_u8(&m->in) % AXIS;
    const size_t count = (size_t)v.n[0] * v.n[1] * v.n[2];
    fuzz_take(&m->in, bytes, fuzz_u8(&m->in) % 64);
    for (size_t i = 0; i < sizeof mask; i++) mask[i] = bytes[i] % 5 != 1;
    for (int i = 0; i < 8; i++) values[fuzz_u8(&m->in)] = any_number(m);
    const uint32_t n[3] = {v.n[0], v.n[1], v.n[2]};
    spoil(m, &v, offsetof(svh_voxels, bytes));
    /* Voxels that are not there nobody can check. */
    if ((double)v.n[0] * v.n[1] * v.n[2] > (double)count) memcpy(v.n, n, sizeof n);
    const uint8_t which = fuzz_u8(&m->in);
    if (which % 8 != 1) v.bytes = bytes + sizeof bytes - count; /* up to its end */
    if (which % 8 == 1 || which % 8 == 2) v.values = values + sizeof bytes - count;
    if (which & 8) v.mask = mask + sizeof bytes - count;
    if (which & 16) v.kretz = which & 32 ? "/none.vol" : "/";
    const int none = rarely(m);
    if (holds(m, svh_volume_take(m->host, none ? NULL : &v, &out, place(m)))) {
        const int at = free_place(m);
        svh_volume_free(m->volume[at]);
        m->volume[at] = out;
    } else
        FUZZ_HOLDS(!out);
}

static void call_read(machine *m) {
    static const char *const paths[] = {"/none.mha", "/", "", "/dev/null", NULL};
    svh_file how = {.size = sizeof how};
    svh_volume *out = NULL;
    spoil(m, &how, sizeof how);
    FUZZ_HOLDS(!holds(
        m, svh_volume_read(m->host, paths[fuzz_u8(&m->in) % 5], rarely(m) ? NULL : &how, &out, place(m))));
    FUZZ_HOLDS(!out);
}

static void call_about(machine *m) {
    svh_about about = {.size = rarely(m) ? fuzz_u8(&m->in) : sizeof about};
    uint32_t sum = 0;
    if (!holds(m, svh_volume_about(any_volume(m), rarely(m) ? NULL : &about, place(m)))) return;
    if (!about.levels) return; /* it was not asked */
    for (size_t i = 0; i < (size_t)about.n[0] * about.n[1] * about.n[2]; i++) sum += about.levels[i];
    FUZZ_HOLDS(sum <= 255u * AXIS * AXIS * AXIS);
    read_text(about.doubt);
    read_text(about.question);
    read_text(about.beams);
}

static void call_plan(machine *m) {
    svh_view *view = any_view(m);
    if (view && fuzz_u8(&m->in) % 4) {
        *view = (svh_view){.size = sizeof *view, .from = fuzz_u8(&m->in) % 8, .around = fuzz_u8(&m->in) % 2};
        view->yaw = any_number(m) * 90.0;
        view->pitch = any_number(m) * 45.0;
        view->roll = any_number(m);
        view->lowres = fuzz_u8(&m->in) % 24;
    }
    if (view) spoil(m, view, sizeof *view);
    (void)holds(m, svh_plan(any_volume(m), view, place(m)));
}

static void call_convert(machine *m) {
    const svh_view *view = any_view(m);
    svh_volume *volume = any_volume(m);
    const size_t rays = view ? rays_of(view) : 1;
    if (is_slow(view) || rays == 0) return;
    uint8_t *voxels = malloc(view ? rays * view->n[2] + 1 : 1);
    uint16_t *ranges = malloc(rays * 2 * sizeof *ranges);
    if (!voxels || !ranges) abort();
    const int none = rarely(m);
    (void)holds(m, svh_convert(volume, view, none ? NULL : voxels, ranges, place(m)));
    free(voxels);
    free(ranges);
}

static uint32_t any_marks(machine *m, svh_mark marks[MARKS]) {
    const uint32_t count = fuzz_u8(&m->in) % (MARKS + 1);
    for (uint32_t i = 0; i < count; i++) {
        marks[i] = (svh_mark){.radius = any_number(m), .keep = i % 2};
        for (int a = 0; a < 3; a++) marks[i].place[a] = any_number(m);
    }
    return count;
}

/* What is made of a map that anybody wrote. */
static void call_map(machine *m) {
    const svh_view *view = any_view(m);
    const svh_volume *volume = any_volume(m);
    svh_about about = {.size = sizeof about};
    svh_mark marks[MARKS];
    const size_t rays = view ? rays_of(view) : 1;
    if (is_slow(view) || rays == 0) return;
    const size_t count =
        svh_volume_about(volume, &about, NULL) ? 1 : (size_t)about.n[0] * about.n[1] * about.n[2];
    float *depth = malloc(rays * sizeof *depth);
    uint8_t *voxels = malloc(count);
    if (!depth || !voxels) abort();
    for (size_t i = 0; i < rays; i++) depth[i] = i % 16 ? (float)(i % 7) : (float)any_number(m);
    float *given = rarely(m) ? NULL : depth;
    const uint32_t mark_count = any_marks(m, marks);
    (void)holds(m, svh_mark_depth(volume, view, rarely(m) ? NULL : marks, mark_count, given, place(m)));
    if (holds(m, svh_mask(volume, view, given, voxels, place(m))))
        for (size_t i = 0; i < count; i++) FUZZ_HOLDS(voxels[i] <= 1);
    (void)holds(m, svh_clipped(volume, view, given, rarely(m) ? NULL : voxels, place(m)));
    svh_mesh mesh = {.size = rarely(m) ? fuzz_u8(&m->in) : sizeof mesh};
    if (holds(m, svh_surface(volume, view, given, &mesh, place(m)))) {
        for (uint32_t i = 0; i < 3 * mesh.triangle_count; i++)
            FUZZ_HOLDS(mesh.triangles[i] >= 0 && (uint32_t)mesh.triangles[i] < mesh.vertex_count);
        for (uint32_t i = 0; i < 3 * mesh.vertex_count; i++) FUZZ_HOLDS(isfinite(mesh.vertices[i]));
        svh_mesh_free(&mesh);
    }
    free(depth);
    free(voxels);
}

static void call_open(machine *m) {
    svh_clipper *out = NULL;
    const uint8_t which = fuzz_u8(&m->in);
    const char *const path = which % 8 == 1 ? "/none.so" : which % 8 == 2 ? "" : FUZZ_PLUGIN;
    const char *const id = which & 64 ? "nobody" : NULL;
    if (holds(m, svh_clipper_open(m->host, path, id, rarely(m) ? NULL : &out, place(m)))) {
        const uint8_t at = fuzz_u8(&m->in) % CLIPPERS;
        svh_clipper_free(m->clipper[at]);
        m->clipper[at] = out;
    }
}

static void call_facts(machine *m) {
    svh_plugin plugin = {.size = rarely(m) ? fuzz_u8(&m->in) : sizeof plugin};
    svh_param param = {.size = rarely(m) ? fuzz_u8(&m->in) : sizeof param};
    char name[64] = "";
    svh_clipper *clipper = any_clipper(m);
    if (holds(m, svh_clipper_about(clipper, &plugin, place(m)))) {
        read_text(plugin.path);
        read_text(plugin.id);
    }
    if (holds(m, svh_param_at(clipper, fuzz_u8(&m->in), rarely(m) ? NULL : &param, place(m))))
        read_text(param.key);
    (void)holds(m,
                svh_param_name(clipper, fuzz_u8(&m->in), any_number(m), rarely(m) ? NULL : name, place(m)));
    FUZZ_HOLDS(memchr(name, 0, sizeof name));
}

static void call_set(machine *m) {
    char text[12];
    svh_clipper *clipper = any_clipper(m);
    fuzz_take(&m->in, text, sizeof text - 1);
    text[sizeof text - 1] = '\0';
    (void)holds(m, svh_set(clipper, rarely(m) ? NULL : text, place(m)));
    if (fuzz_u8(&m->in) % 4 == 1)
        (void)holds(m, svh_set_number(clipper, fuzz_u8(&m->in) % 4, any_number(m), place(m)));
    if (fuzz_u8(&m->in) % 2) svh_reset(clipper);
}

static void call_needs(machine *m) {
    uint64_t bytes;
    const svh_view *view = any_view(m);
    (void)holds(m, svh_needs(any_clipper(m), any_volume(m), view, rarely(m) ? NULL : &bytes, place(m)));
}

static void call_clip(machine *m) {
    svh_mark marks[MARKS];
    svh_result result = {.size = sizeof result};
    svh_frame frame = {.size = sizeof frame, .flags = fuzz_u8(&m->in) % 8, .marks = marks};
    const svh_view *view = any_view(m);
    frame.mark_count = any_marks(m, marks);
    spoil(m, &frame, offsetof(svh_frame, marks));
    if (rarely(m)) frame.marks = NULL;
    if (rarely(m)) result.size = fuzz_u8(&m->in);
    if (is_slow(view)) return;
    svh_clipper *clipper = any_clipper(m);
    svh_volume *volume = any_volume(m);
    if (holds(m, svh_clip(clipper, volume, view, rarely(m) ? NULL : &frame, &result, place(m))))
        check_result(&result);
}

static void call_adjust(machine *m) {
    uint32_t ids[IDS];
    double values[IDS];
    svh_result result = {.size = rarely(m) ? fuzz_u8(&m->in) : sizeof result};
    const uint32_t count = fuzz_u8(&m->in) % (IDS + 1);
    for (uint32_t i = 0; i < count; i++) {
        ids[i] = fuzz_u8(&m->in) % 4;
        values[i] = any_number(m);
    }
    svh_clipper *clipper = any_clipper(m);
    if (holds(m, svh_adjust(clipper, rarely(m) ? NULL : ids, values, count, &result, place(m))))
        check_result(&result);
}

/* What is freed may be asked for again: it is NULL then. */
static void call_free(machine *m) {
    const uint8_t which = fuzz_u8(&m->in);
    if (m->shares) return;
    svh_volume_free(m->volume[which % VOLUMES]);
    m->volume[which % VOLUMES] = NULL;
    if (which < 128) return;
    svh_clipper_free(m->clipper[which % CLIPPERS]);
    m->clipper[which % CLIPPERS] = NULL;
}

static void call_host(machine *m) {
    svh_options options = {.size = sizeof options};
    svh_host *other = NULL;
    if (m->shares) return;
    fuzz_words(&m->in, &options, offsetof(svh_options, program), fuzz_u8(&m->in) % 3);
    if (!holds(m, svh_open(&options, rarely(m) ? NULL : &other, place(m)))) return;
    /* What was made of the one before lives on. */
    svh_close(m->host);
    m->host = other;
    if (options.guard == SVH_GUARD_OFF) return;
    options = (svh_options){.size = sizeof options, .guard = SVH_GUARD_OFF};
    svh_close(m->host);
    FUZZ_HOLDS(svh_open(&options, &m->host, NULL) == SVH_OK);
}

static void one_call(machine *m) {
    static void (*const calls[])(machine *) = {call_take,    call_read, call_about, call_plan,  call_plan,
                                               call_convert, call_map,  call_open,  call_facts, call_set,
                                               call_needs,   call_clip, call_clip,  call_clip,  call_adjust,
                                               call_free,    call_host};
    calls[fuzz_u8(&m->in) % (sizeof calls / sizeof *calls)](m);
}

static void *all_calls(void *given) {
    machine *m = given;
    for (int i = 0; i < MAX_CALLS && m->in.left > 0; i++) one_call(m);
    return NULL;
}

/* ------------------------------------------------------------------------------------------- an input */

/* A volume, a plugin and a planned view: what most calls are about. */
static void begin(machine *m) {
    static uint8_t bytes[6 * 6 * 8];
    const svh_options options = {.size = sizeof options, .guard = SVH_GUARD_OFF};
    const svh_voxels voxels = {.size = sizeof voxels,
                               .n = {6, 6, 8},
                               .spacing = {1, 1, 1},
                               .scanned = SVH_ALL_SCANNED,
                               .bytes = bytes};
    m->error.size = sizeof m->error;
    FUZZ_HOLDS(holds(m, svh_open(&options, &m->host, &m->error)));
    FUZZ_HOLDS(holds(m, svh_volume_take(m->host, &voxels, &m->volume[0], &m->error)));
    FUZZ_HOLDS(holds(m, svh_clipper_open(m->host, FUZZ_PLUGIN, NULL, &m->clipper[0], &m->error)));
    for (int i = 0; i < VIEWS; i++) {
        m->view[i].size = sizeof m->view[i];
        FUZZ_HOLDS(holds(m, svh_plan(m->volume[0], &m->view[i], &m->error)));
    }
}

static void end(machine *m) {
    if (!m->shares) svh_close(m->host); /* the others end it */
    for (int i = 0; i < CLIPPERS; i++) svh_clipper_free(m->clipper[i]);
    for (int i = 0; i < VOLUMES; i++) svh_volume_free(m->volume[i]);
}

/* Two threads with the same host and the same volume, each with what it makes itself beside. */
static void on_two_threads(machine *m) {
    machine other = *m;
    pthread_t thread;
    m->shares = other.shares = 1;
    other.in = (fuzz_bytes){m->in.at + m->in.left / 2, m->in.left - m->in.left / 2};
    m->in.left /= 2;
    memset(other.volume + 1, 0, sizeof other.volume - sizeof *other.volume);
    memset(other.clipper, 0, sizeof other.clipper);
    FUZZ_HOLDS(pthread_create(&thread, NULL, all_calls, &other) == 0);
    (void)all_calls(m);
    FUZZ_HOLDS(pthread_join(thread, NULL) == 0);
    other.volume[0] = NULL;
    end(&other);
    m->shares = 0;
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    static machine m;
    static void *plugin; /* stays loaded: the fuzzer counts in it */
    if (!plugin) plugin = dlopen(FUZZ_PLUGIN, RTLD_NOW);
    FUZZ_HOLDS(plugin);
    memset(&m, 0, sizeof m);
    m.in = (fuzz_bytes){data, size};
    const uint8_t head = fuzz_u8(&m.in);
    begin(&m);
    fake_cl_fail(head & 1 ? head / 2 : 0); /* of the first calls one, or none */
    if (head % 32 == 2)
        on_two_threads(&m);
    else
        (void)all_calls(&m);
    fake_cl_fail(0);
    end(&m);
    return 0;
}
