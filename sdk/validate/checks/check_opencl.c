/* SPDX-License-Identifier: MIT */
/* Checks of a plugin's OpenCL calls and allocations, seen through the spies. */
#include "validate/checks/check.h"

#include "smartvis/needs.h"
#include "validate/drive/process.h"
#include "validate/spy/cl_spy.h"
#include "validate/spy/heap_spy.h"

#include <time.h>

static void watch(v_subject *s) {
    spy_watch(s->entry);
    heap_spy_watch(s->entry);
}

/* Opened, watched, and then activated. */
static v_rig *open_watched(v_run *run) {
    v_rig *r = v_rig_open(run);
    watch(&r->s);
    const stage_way way = v_standard_way(&r->s);
    v_rig_set(r, &way, V_LAYERS);
    return r;
}

/* A frame and an adjust, with `look` after every call of the plugin. */
static void frame_with(v_rig *r, void (*look)(v_rig *r, const char *call)) {
    const sv_plugin *p = r->s.plugin;
    stage *st = &r->stage;
    stage_poison(st, STAGE_POISON);
    const sv_result result = stage_result(st);
    sv_status status;
#define CALL(name, expression)                                                                               \
    spy_reset();                                                                                             \
    heap_spy_reset();                                                                                        \
    status = (expression);                                                                                   \
    look(r, name);                                                                                           \
    V_EXPECT(r->s.run, status >= 0, "%s: %s: %s", name, v_status(status), p->last_error(p))
    CALL("begin", v_begin(p, st, NULL, 0));
    for (uint32_t n = 0; n < st->slab_count; n++) {
        CALL("slab", v_slab(p, st, n));
    }
    CALL("end", p->end(p, &result));
    CALL("adjust", p->adjust(p, NULL, 0, &result));
#undef CALL
    if (st->device.queue) (void)clFinish(st->device.queue);
}

/* ---- the frame path */
static void inspect_calls(v_rig *r, const char *call) {
    const bool own = r->stage.way.own_queue;
    v_run *run = r->s.run;
    V_EXPECT(run, spy_count(SPY_CREATE) == 0, "%s makes an OpenCL object: %s", call, spy_first(SPY_CREATE));
    V_EXPECT(run, spy_count(SPY_BUILD) == 0, "%s builds a program: %s", call, spy_first(SPY_BUILD));
    V_EXPECT(run, spy_count(SPY_RETAIN) == 0, "%s retains an OpenCL object: %s", call, spy_first(SPY_RETAIN));
    V_EXPECT(run, own || spy_count(SPY_WAIT) == 0, "%s waits for the host's queue: %s", call,
             spy_first(SPY_WAIT));
    V_EXPECT(run, own || spy_blocking() == 0, "%s makes a blocking call on the host's queue: %s", call,
             spy_first_blocking());
}

void check_frame_path_opencl(v_run *run) {
    v_rig *r = open_watched(run);
    const char *unknown = library_unknown_import(r->s.library);
    const uint32_t calls = spy_calls();
    frame_with(r, inspect_calls);
    frame_with(r, inspect_calls);
    if (calls == 0) v_skip(run, "the plugin makes no OpenCL calls that the validator can see");
    if (unknown && unknown[0] == 'c') v_warn(run, "the validator does not watch %s", unknown);
}

static void inspect_heap(v_rig *r, const char *call) {
    V_EXPECT(r->s.run, heap_spy_count() == 0, "%s allocates memory %u times", call, heap_spy_count());
}

void check_frame_path_heap(v_run *run) {
    if (!heap_spy_works()) v_skip(run, "the sanitizer keeps the heap for itself");
    v_rig *r = open_watched(run);
    frame_with(r, inspect_heap);
    frame_with(r, inspect_heap);
}

static void inspect_launches(v_rig *r, const char *call) {
    if (spy_cold() > 0)
        v_warn(r->s.run, "%s launches %u kernels for the first time; activate should have done that", call,
               spy_cold());
}

/* ---- what it says that it will take */
static uint32_t commands; /* of the frame under way */
static void add_commands(v_rig *r, const char *call) {
    (void)r;
    if (strcmp(call, "adjust") != 0) commands += spy_count(SPY_ENQUEUE);
}

void check_needs(v_run *run) {
    v_rig *r = v_rig_open(run);
    const sv_plugin *p = r->s.plugin;
    const sv_ext_needs *ext = p->get_extension(p, SV_EXT_NEEDS);
    if (!ext) v_skip(run, "the plugin has no " SV_EXT_NEEDS);
    V_EXPECT(run, SV_HAS(ext, of) && ext->of, "the table of " SV_EXT_NEEDS " is not whole");
    stage_way way = v_standard_way(&r->s);
    if (way.own_queue) v_skip(run, "the plugin works on a device that the validator does not know");
    watch(&r->s);
    for (uint32_t n = 0; n < 3; n++) {
        const stage_way sized = v_sized(way, 40 + 70 * n, 30 + 90 * n, 20 + 11 * n);
        v_rig_set(r, &sized, V_LAYERS);
        const uint64_t taken = spy_live_bytes();
        const sv_needs_device facts = stage_facts(r->device.device);
        sv_format format = r->stage.format;
        sv_needs needs = {.size = sizeof needs};
        format.context = NULL;
        format.device = NULL;
        format.queue = NULL;
        spy_reset();
        v_where(run, "needs of %u x %u x %u", format.width, format.height, format.slices);
        const sv_status status = ext->of(p, &format, NULL, 0, &facts, &needs);
        V_EXPECT(run, status == SV_OK, "%s: %s: %s", run->report->where, v_status(status), p->last_error(p));
        V_EXPECT(run, spy_calls() == 0, "%s calls OpenCL", run->report->where);
        V_EXPECT(run, needs.device_bytes == taken, "%s: %llu bytes of buffers, activate takes %llu",
                 run->report->where, (unsigned long long)needs.device_bytes, (unsigned long long)taken);
        commands = 0;
        frame_with(r, add_commands);
        V_EXPECT(run, needs.commands >= commands, "%s: %u commands a frame, one enqueues %u",
                 run->report->where, needs.commands, commands);
        v_rig_drop(r);
    }
}

void check_first_launches(v_run *run) {
    v_rig *r = open_watched(run);
    if (spy_calls() == 0) v_skip(run, "the plugin makes no OpenCL calls that the validator can see");
    frame_with(r, inspect_launches);
}

/* ---- whose objects are whose */
static cl_uint count_of_queue(const stage_device *d) {
    cl_uint count = 0;
    (void)clGetCommandQueueInfo(d->queue, CL_QUEUE_REFERENCE_COUNT, sizeof count, &count, NULL);
    return count;
}

/* The count once it is back at `wanted`, or what it is after two seconds: a runtime may let go of commands,
 * and so of their queue, a little after they have ended. */
static cl_uint settled_count_of_queue(const stage_device *d, cl_uint wanted) {
    enum { TRIES = 200 };
    const struct timespec wait = {.tv_nsec = 10000000};
    cl_uint count = count_of_queue(d);
    for (int i = 0; i < TRIES && count != wanted; i++) {
        (void)nanosleep(&wait, NULL);
        count = count_of_queue(d);
    }
    return count;
}

void check_opencl_balance(v_run *run) {
    v_rig *r = v_rig_open(run);
    watch(&r->s);
    const stage_way way = v_standard_way(&r->s);
    cl_uint before = 0;
    if (!way.own_queue) {
        v_device_open(run, &r->device);
        before = count_of_queue(&r->device);
    }
    uint32_t calls = 0;
    for (int i = 0; i < 3; i++) {
        v_rig_set(r, &way, V_LAYERS);
        V_EXPECT(run, way.own_queue || spy_count(SPY_RETAIN) == 0, "activate retains an OpenCL object: %s",
                 spy_first(SPY_RETAIN));
        (void)v_rig_frame(r, NULL, 0);
        calls += spy_calls();
        v_rig_drop(r);
        V_EXPECT(run, spy_live() == 0, "after deactivate %d OpenCL objects that the plugin made are %s",
                 (int)spy_live(),
                 spy_live() > 0 ? "still there" : "too few: it released what is not its own");
    }
    if (!way.own_queue) {
        const cl_uint after = settled_count_of_queue(&r->device, before);
        V_EXPECT(run, after == before, "the host's queue has %u references, before it had %u", after, before);
    }
    if (calls == 0) v_skip(run, "the plugin makes no OpenCL calls that the validator can see");
}

/* ---- calls that fail */
/* activate and a frame, with what was told to fail. The first error, or what the frame came to. */
static sv_status attempt(v_rig *r, v_map *map) {
    const sv_plugin *p = r->s.plugin;
    v_where(r->s.run, "activate, with a call that fails");
    const sv_status status = p->activate(p, &r->stage.format);
    return status < 0 ? status : v_try_frame(p, &r->stage, NULL, 0, map);
}

/* What must hold after an attempt in which `failed` failed: an error with its reason, or the good map. */
static void judge(v_rig *r, const char *failed, sv_status status, const v_map *map) {
    const sv_plugin *p = r->s.plugin;
    v_run *run = r->s.run;
    if (status >= 0) {
        v_map_expect(run, &r->good, map, "%s failed, the frame succeeded, and its map is another one",
                     failed);
    } else {
        const char *reason = p->last_error(p);
        V_EXPECT(run, reason && reason[0], "%s failed, %s came without a reason", failed, v_status(status));
    }
}

/* deactivate, whatever state the instance is in: an inactive one only complains. */
static void to_inactive(v_rig *r) {
    v_where(r->s.run, "deactivate after a call that failed");
    r->s.plugin->deactivate(r->s.plugin);
}

/* The nth of `count` things that are tried: all if they are few, else the first ones and some of the rest. */
static uint32_t nth_of(v_run *run, uint32_t turn, uint32_t turns, uint32_t count) {
    if (turns >= count) return turn + 1;
    const uint32_t from = (uint32_t)((uint64_t)turn * count / turns);
    const uint32_t to = (uint32_t)((uint64_t)(turn + 1) * count / turns);
    return 1 + from + v_random(run, to - from);
}

static void frame_is_good(v_rig *r, const char *after) {
    v_map map;
    const sv_status status = attempt(r, &map);
    V_EXPECT(r->s.run, status >= 0, "after %s had failed once, all fails: %s: %s", after, v_status(status),
             r->s.plugin->last_error(r->s.plugin));
    v_map_expect(r->s.run, &r->good, &map, "after %s had failed once, the map is another one", after);
    to_inactive(r);
}

void check_opencl_faults(v_run *run) {
    v_map map;
    v_rig *r = open_watched(run);
    r->good = v_rig_frame(r, NULL, 0);
    to_inactive(r);
    spy_reset();
    V_EXPECT(run, attempt(r, &map) >= 0, "activate or a frame fails: %s",
             r->s.plugin->last_error(r->s.plugin));
    const uint32_t calls = spy_calls() - spy_count(SPY_RELEASE);
    to_inactive(r);
    if (calls == 0) v_skip(run, "the plugin makes no OpenCL calls that the validator can see");
    const uint32_t turns = run->level >= 10 || 8 * run->level > calls ? calls : 8 * run->level;
    for (uint32_t turn = 0; turn < turns; turn++) {
        const uint32_t nth = nth_of(run, turn, turns, calls);
        char failed[120];
        spy_reset();
        spy_fail(nth, nth % 2 ? CL_OUT_OF_RESOURCES : CL_OUT_OF_HOST_MEMORY);
        const sv_status status = attempt(r, &map);
        if (!spy_failed()) {
            to_inactive(r);
            continue;
        }
        (void)snprintf(failed, sizeof failed, "OpenCL call %u of %u, %s,", nth, calls, spy_failed());
        judge(r, failed, status, &map);
        spy_reset();
        to_inactive(r);
        V_EXPECT(run, spy_live() == 0, "%s failed, and %d OpenCL objects are still there", failed,
                 (int)spy_live());
        if (turn % 8 == 0) frame_is_good(r, failed);
    }
    v_note(run, "%u of %u OpenCL calls failed once each", turns, calls);
    v_activate(&r->s, r->s.plugin, &r->stage);
}

void check_heap_faults(v_run *run) {
    v_map map;
    if (!heap_spy_works()) v_skip(run, "the sanitizer keeps the heap for itself");
    v_rig *r = open_watched(run);
    r->good = v_rig_frame(r, NULL, 0);
    to_inactive(r);
    heap_spy_reset();
    v_where(run, "create");
    const sv_plugin *extra = v_another(&r->s);
    extra->destroy(extra);
    const uint32_t in_create = heap_spy_count();
    V_EXPECT(run, attempt(r, &map) >= 0, "activate or a frame fails: %s",
             r->s.plugin->last_error(r->s.plugin));
    const uint32_t all = heap_spy_count();
    to_inactive(r);
    if (all == 0) v_skip(run, "the plugin makes no allocations that the validator can see");
    const uint32_t turns = run->level >= 10 || 8 * run->level > all ? all : 8 * run->level;
    for (uint32_t turn = 0; turn < turns; turn++) {
        const uint32_t nth = nth_of(run, turn, turns, all);
        char failed[120];
        (void)snprintf(failed, sizeof failed, "allocation %u of %u", nth, all);
        heap_spy_reset();
        if (nth <= in_create) {
            extra = NULL;
            v_where(run, "create, with an allocation that fails");
            heap_spy_fail(nth);
            const sv_status status = r->s.entry->create(&r->s.host.api, r->s.descriptor->id, &extra);
            V_EXPECT(run, (status < 0) == (extra == NULL), "%s failed in create: %s, and *out is %s", failed,
                     v_status(status), extra ? "set" : "NULL");
            heap_spy_reset();
            if (extra) extra->destroy(extra);
            continue;
        }
        heap_spy_fail(nth - in_create);
        const sv_status status = attempt(r, &map);
        heap_spy_reset();
        judge(r, failed, status, &map);
        to_inactive(r);
    }
    frame_is_good(r, "an allocation");
    v_note(run, "%u of %u allocations failed once each", turns, all);
    v_activate(&r->s, r->s.plugin, &r->stage);
}

/* ---- what stays behind */
void check_activations(v_run *run) {
    enum { SETTLED = 4 }; /* runtimes keep something from the first times */
    const uint32_t turns = 20 * run->level;
    uint32_t files = 0, threads = 0, blocks = 0;
    v_rig *r = open_watched(run);
    for (uint32_t i = 0; i < turns; i++) {
        if (i % 10 < 2) (void)v_rig_frame(r, NULL, 0);
        v_deactivate(&r->s, r->s.plugin);
        if (i == SETTLED || i == turns - 1) {
            const uint32_t f = v_process_files(), t = v_process_threads(), b = heap_spy_live();
            V_EXPECT(run, i == SETTLED || f <= files, "%u activations leave %u open files behind",
                     i - SETTLED, f - files);
            V_EXPECT(run, i == SETTLED || t <= threads, "%u activations leave %u threads behind", i - SETTLED,
                     t - threads);
            V_EXPECT(run, i == SETTLED || b <= blocks, "%u activations leave %u blocks of memory behind",
                     i - SETTLED, b - blocks);
            files = f;
            threads = t;
            blocks = b;
        }
        V_EXPECT(run, spy_live() == 0, "an activation leaves %d OpenCL objects behind", (int)spy_live());
        v_activate(&r->s, r->s.plugin, &r->stage);
    }
    v_note(run, "%u activations", turns);
}
