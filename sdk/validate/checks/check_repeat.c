/* SPDX-License-Identifier: MIT */
/* Checks that a map depends on its frame and on nothing else. */
#include "validate/checks/check.h"

#include <pthread.h>
#include <sched.h>
#include <stdatomic.h>

void check_same_frame_same_bits(v_run *run) {
    v_rig *r = v_rig_good(run);
    for (uint32_t i = 0; i < 2 + run->level; i++)
        v_rig_expect(r, &r->good, "the same frame again gives another map");
    v_deactivate(&r->s, r->s.plugin);
    v_activate(&r->s, r->s.plugin, &r->stage);
    v_rig_expect(r, &r->good, "the same frame after another activation gives another map");
}

void check_frames_independent(v_run *run) {
    v_volume other;
    v_rig *r = v_rig_good(run);
    const stage_way way = r->stage.way;
    v_volume_make(run, &other, V_OTHER, way.width, way.height, way.slices);
    v_stage_fill(&r->stage, &other);
    (void)v_rig_frame(r, NULL, 0);
    v_stage_fill(&r->stage, &r->volume);
    v_rig_expect(r, &r->good, "a frame after SV_FRAME_DISCONTINUITY depends on the frame before");
    /* A frame that was broken off leaves no trace either. */
    v_stage_fill(&r->stage, &other);
    (void)v_begin(r->s.plugin, &r->stage, NULL, 0);
    (void)v_slab(r->s.plugin, &r->stage, 0);
    (void)v_slab(r->s.plugin, &r->stage, 0); /* is refused: the slabs are the host's again */
    if (r->stage.device.queue) (void)clFinish(r->stage.device.queue);
    v_stage_fill(&r->stage, &r->volume);
    v_rig_expect(r, &r->good, "a frame depends on one that was broken off");
    v_deactivate(&r->s, r->s.plugin);
    v_activate(&r->s, r->s.plugin, &r->stage);
    v_rig_expect(r, &r->good, "a frame after another activation depends on the frames before");
}

void check_slab_splits(v_run *run) {
    v_rig *r = v_rig_open(run);
    stage_way way = v_standard_way(&r->s);
    way.longest = way.slices;
    v_rig_set(r, &way, V_LAYERS);
    const v_map whole = v_rig_frame(r, NULL, 0);
    for (uint32_t turn = 0; turn < 3 + 2 * run->level; turn++) {
        uint32_t lengths[STAGE_MAX_SLABS] = {0};
        const uint32_t longest = turn == 0 ? 1 : turn == 1 ? 2 : 2 + v_random(run, way.slices);
        for (uint32_t n = 0, left = way.slices; left > 0; n++) {
            lengths[n] = turn < 2 ? 1 : 1 + v_random(run, longest);
            if (turn == 1 && n % 2) lengths[n] = 2;
            if (lengths[n] > left || n == STAGE_MAX_SLABS - 1) lengths[n] = left;
            left -= lengths[n];
        }
        way.lengths = lengths;
        v_rig_again(r, &way);
        v_rig_expect(r, &whole,
                     "the volume in %u slabs (the first of %u slices) gives another map than in one",
                     r->stage.slab_count, lengths[0]);
    }
}

/* ---- two instances */
static v_params params;

/* A value that a frame may have beside the default's, if there is such a parameter. */
static sv_param_value another_value(void) {
    for (uint32_t i = 0; i < params.count; i++)
        if (!(params.info[i].flags & SV_PARAM_REACTIVATE) && params.info[i].type == SV_PARAM_FLOAT)
            return (sv_param_value){params.info[i].id, 0, v_param_other(&params.info[i])};
    return (sv_param_value){0};
}

void check_instances_interleaved(v_run *run) {
    stage st;
    v_volume other;
    v_map alone[2], map[2];
    v_rig *a = v_rig_standard(run);
    v_params_read(&a->s, &params);
    const sv_param_value value = another_value();
    const uint32_t count = value.id ? 1 : 0;
    const sv_plugin *first = a->s.plugin, *second = v_another(&a->s);
    v_volume_make(run, &other, V_OTHER, a->stage.way.width, a->stage.way.height, a->stage.way.slices);
    v_stage_make(run, &st, &a->stage.way, &a->device);
    v_stage_fill(&st, &other);
    alone[0] = v_rig_frame(a, NULL, 0);
    v_activate(&a->s, second, &st);
    alone[1] = v_frame(&a->s, second, &st, &value, count);
    for (uint32_t turn = 0; turn < 2; turn++) {
        sv_status status[2] = {v_begin(first, &a->stage, NULL, 0), v_begin(second, &st, &value, count)};
        for (uint32_t n = 0; n < st.slab_count; n++) {
            if (status[0] >= 0) status[0] = v_slab(first, &a->stage, n);
            if (status[1] >= 0) status[1] = v_slab(second, &st, n);
        }
        if (status[0] >= 0) status[0] = v_end(first, &a->stage);
        if (status[1] >= 0) status[1] = v_end(second, &st);
        for (int i = 0; i < 2; i++) {
            V_EXPECT(run, status[i] >= 0, "two instances in turn: instance %d: %s", i + 1,
                     v_status(status[i]));
            map[i] = v_collect(i ? &st : &a->stage, status[i]);
            v_map_expect(run, &alone[i], &map[i],
                         "instance %d gives another map beside another instance than alone", i + 1);
        }
    }
    v_deactivate(&a->s, second);
    second->destroy(second);
    v_rig_expect(a, &alone[0], "an instance gives another map after another one was destroyed");
    stage_free(&st);
}

/* ---- threads */
typedef struct {
    v_subject *s;
    const sv_plugin *plugin;
    stage_device device;
    stage stage;
    v_volume volume;
    v_map alone;
    v_run run; /* its own: a finding ends the thread's part only */
    v_report report;
    uint32_t frames;
    pthread_barrier_t *together;
} worker;

static void *work(void *context) {
    worker *w = context;
    if (setjmp(w->run.escape)) return NULL;
    for (uint32_t i = 0; i < w->frames; i++) {
        v_map map;
        (void)pthread_barrier_wait(w->together);
        const sv_status status = v_try_frame(w->plugin, &w->stage, NULL, 0, &map);
        if (status < 0 && w->report.verdict == V_PASS) v_warn(&w->run, "a frame fails: %s", v_status(status));
        if (status < 0) continue;
        const char *difference = v_map_difference(&w->alone, &map);
        if (difference) v_warn(&w->run, "the map is another one than alone: %s", difference);
    }
    return NULL;
}

static void prepare(v_subject *s, worker *w, const stage_way *way, uint32_t n) {
    w->run = *s->run;
    w->run.report = &w->report;
    w->run.watch = NULL; /* it belongs to one thread */
    w->s = s;
    w->plugin = n == 0 ? s->plugin : v_another(s);
    if (!way->own_queue) v_device_open(s->run, &w->device);
    v_volume_make(s->run, &w->volume, n % 2 ? V_OTHER : V_LAYERS, way->width, way->height, way->slices);
    v_stage_make(s->run, &w->stage, way, &w->device);
    v_stage_fill(&w->stage, &w->volume);
    v_activate(s, w->plugin, &w->stage);
    w->alone = v_frame(s, w->plugin, &w->stage, NULL, 0);
    w->stage.data = &w->run;
}

void check_instances_parallel(v_run *run) {
    enum { WORKERS = 3 };
    static worker workers[WORKERS];
    pthread_t threads[WORKERS];
    pthread_barrier_t together;
    memset(workers, 0, sizeof workers);
    v_subject *s = &v_rig_open(run)->s;
    const stage_way way = v_standard_way(s);
    V_EXPECT(run, pthread_barrier_init(&together, NULL, WORKERS) == 0,
             "no barrier: the check could not be made");
    for (uint32_t n = 0; n < WORKERS; n++) {
        workers[n].frames = 2 + 2 * run->level;
        workers[n].together = &together;
        prepare(s, &workers[n], &way, n);
    }
    v_where(run, "frames of %d instances at once", WORKERS);
    for (uint32_t n = 0; n < WORKERS; n++)
        V_EXPECT(run, pthread_create(&threads[n], NULL, work, &workers[n]) == 0,
                 "no thread: the check could not be made");
    for (uint32_t n = 0; n < WORKERS; n++) (void)pthread_join(threads[n], NULL);
    for (uint32_t n = 0; n < WORKERS; n++)
        V_EXPECT(run, workers[n].report.verdict == V_PASS,
                 "%d instances on threads of their own, instance %u: %s", WORKERS, n + 1,
                 workers[n].report.text);
    for (uint32_t n = 0; n < WORKERS; n++) {
        worker *w = &workers[n];
        v_deactivate(s, w->plugin);
        if (n > 0) w->plugin->destroy(w->plugin);
        stage_free(&w->stage);
        v_device_close(&w->device);
    }
}

/* ---- [any] calls beside frames */
static atomic_bool asking;
static atomic_uint rounds; /* of all these calls */

static void *ask(void *context) {
    const sv_plugin *p = context;
    char text[64];
    while (atomic_load(&asking)) {
        const uint32_t count = p->param_count(p);
        for (uint32_t i = 0; i < count && i < V_MAX_PARAMS; i++) {
            sv_param_info info = {.size = sizeof info};
            if (p->param_info(p, i, &info) == SV_OK)
                (void)p->param_text(p, info.id, info.default_value, text, sizeof text);
        }
        (void)p->param_text(p, 0xfffffff0u, 0.0, text, sizeof text);
        (void)p->get_extension(p, "smartvis.validator.no-such-thing/1");
        atomic_fetch_add(&rounds, 1);
    }
    return NULL;
}

/* On a busy machine frames can be over before the other thread has run at all. */
static void wait_for_calls(void) {
    const unsigned before = atomic_load(&rounds);
    while (atomic_load(&rounds) == before) (void)sched_yield();
}

void check_any_calls(v_run *run) {
    pthread_t thread;
    v_rig *r = v_rig_good(run);
    atomic_store(&asking, true);
    V_EXPECT(run, pthread_create(&thread, NULL, ask, (void *)(uintptr_t)r->s.plugin) == 0,
             "no thread: the check could not be made");
    for (uint32_t i = 0; i < 4 + 4 * run->level; i++) {
        wait_for_calls();
        v_rig_expect(r, &r->good, "a frame gives another map while another thread makes [any] calls");
    }
    const char *reason = r->s.plugin->last_error(r->s.plugin);
    V_EXPECT(run, !reason[0] || r->good.returned != SV_OK, "an [any] call changes last_error: %s", reason);
    atomic_store(&asking, false);
    (void)pthread_join(thread, NULL);
}
