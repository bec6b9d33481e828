/* SPDX-License-Identifier: MIT */
/*
 * A host that takes no care: calls in any order, and arguments that are wrong in one way each, drawn by a
 * seed. The checking layer blames no plugin that is right for it, whatever comes and from how many threads;
 * and every plugin of tests/wrong/ whose fault only such a host finds is named by its rule.
 */
#include "rules/rules.h"
#include "sdk/wrong/wrong_list.h"
#include "smartvis/confidence.h"
#include "smartvis/needs.h"
#include "smartvis/points.h"
#include "smartvis/timing.h"
#include "support/layer_fixture.h"
#include "support/unit.h"

#include <math.h>
#include <pthread.h>
#include <signal.h>
#include <stdatomic.h>
#include <sys/mman.h>
#include <sys/wait.h>
#include <unistd.h>

typedef struct {
    layer_subject *s;
    uint32_t seed;
    bool active;
    atomic_uint blamed, hosts; /* lines of the layer's, by severity */
    atomic_bool named[RULE_COUNT];
    char first[400]; /* that blames the plugin */
    char *last;      /* line, 400 bytes; or NULL */
} careless;

static void hear(const sv_host *host, int32_t severity, const char *text) {
    careless *c = host->host_data;
    if (!text || strncmp(text, "check: ", 7) != 0 || strstr(text, "rules that were broken")) return;
    if (c->last) (void)snprintf(c->last, 400, "%s", text);
    for (int n = 0; n < RULE_COUNT; n++) {
        const size_t length = strlen(rules[n].id);
        if (strncmp(text + 7, rules[n].id, length) == 0 && text[7 + length] == ':') c->named[n] = true;
    }
    if (severity == SV_LOG_HOST_MISBEHAVING) c->hosts++;
    if (severity == SV_LOG_PLUGIN_MISBEHAVING && c->blamed++ == 0)
        (void)snprintf(c->first, sizeof c->first, "%s", text);
}

static careless *open_host(const char *plugin, uint32_t seed, bool queue) {
    careless *c = unit_memory(sizeof *c);
    c->s = layer_open(plugin);
    c->seed = seed;
    if (queue) layer_take_queue(c->s);
    c->s->host.host_data = c;
    c->s->host.log = hear;
    layer_create(c->s);
    return c;
}

static void close_host(careless *c) {
    if (c->active) c->s->p->deactivate(c->s->p);
    layer_close(c->s);
}

static uint32_t below(careless *c, uint32_t count) {
    c->seed = c->seed * 1664525u + 1013904223u;
    return (c->seed >> 16) % count;
}

/* ---- calls that are wrong in one way, or right */
static void careless_activate(careless *c) {
    sv_format f = c->s->format;
    const uint32_t how = below(c, 14);
    if (how == 0) f.size = 8;
    if (how == 1) f.tile_w = W - 1;
    if (how == 2) f.flags = 0x80;
    if (how == 3) f.voxel_type = 77;
    if (how == 4) f.carrier = 9;
    if (how == 5) f.width = 0;
    if (how == 6) f.max_slab_slices = SLICES + 1;
    if (how == 7) f.spacing_mm[1] = -1.0f;
    if (how == 8) f.row_pitch = 1;
    if (how == 9) f.value_count = 2;
    const bool null = below(c, 20) == 0;
    if (c->s->p->activate(c->s->p, null ? NULL : &f) >= SV_OK) c->active = true;
}

/* A value that is wrong in one way. */
static sv_param_value value_of(careless *c) {
    static const double odd[] = {1e9, -1e9, 1.5, 0.0};
    sv_param_info info = {.size = sizeof info};
    const uint32_t count = c->s->p->param_count(c->s->p);
    sv_param_value v = {.id = 4711};
    if (count == 0 || c->s->p->param_info(c->s->p, below(c, count), &info) != SV_OK) return v;
    if (below(c, 5) > 0) v.id = info.id;
    v.value = below(c, 5) ? odd[below(c, 4)] : (double)NAN;
    if (below(c, 3) == 0) v.value = info.max_value;
    return v;
}

static void careless_begin(careless *c) {
    const sv_frame kept = c->s->frame;
    const sv_param_value value = value_of(c);
    struct {
        sv_frame frame;
        uint8_t later[64];
    } longer = {.later = {1}};
    sv_frame *f = &c->s->frame;
    const uint32_t how = below(c, 12);
    if (how == 0) f->size = 8;
    if (how == 1) f->flags = 0x80;
    if (how == 2) f->value_count = 3;
    if (how == 3) f->probe_rotation[0] = 2.0f;
    if (how == 4) f->scanned = NULL;
    if (how == 5) f->time_ns = 1;
    if (how == 6) f->size = SV_FRAME_SIZE_1_0;
    if (how == 7) f->size = sizeof longer;
    if (how == 8 || how == 9) f->values = &value;
    if (how == 8 || how == 9) f->value_count = 1;
    longer.frame = *f;
    (void)c->s->p->begin(c->s->p, below(c, 20) ? &longer.frame : NULL);
    *f = kept;
}

static void careless_slab(careless *c, uint32_t n) {
    sv_slab slab = layer_slab_of(c->s, n);
    const uint32_t how = below(c, 9);
    if (how == 0) slab.size = 8;
    if (how == 1) slab.slice_count = 0;
    if (how == 2) slab.slice_count = SLAB + 1;
    if (how == 2) slab.bytes = (SLAB + 1) * RAYS;
    if (how == 3) slab.bytes = 5;
    if (how == 4) slab.first_slice = SLICES;
    if (how == 5) slab.memory = NULL;
    if (how == 5) slab.object = NULL;
    (void)c->s->p->slab(c->s->p, below(c, 20) ? &slab : NULL);
}

static void careless_a_slab(careless *c) {
    careless_slab(c, below(c, SLABS));
}

static void careless_result(careless *c) {
    sv_result r = layer_result_of(c->s);
    sv_stats stats = {.size = sizeof stats};
    const sv_param_value value = value_of(c);
    const bool ends = below(c, 3) > 0, null = below(c, 20) == 0;
    r.stats = &stats;
    const uint32_t how = below(c, 9);
    if (how == 0) r.size = 8;
    if (how == 1) r.depth = NULL;
    if (how == 1) r.depth_object = NULL;
    if (how == 2) r.depth = c->s->depth;
    if (how == 2) r.depth_object = (void *)c;
    if (how == 3) r.depth_pitch = 3;
    if (how == 4) stats.size = 4;
    if (ends)
        (void)c->s->p->end(c->s->p, null ? NULL : &r);
    else
        (void)c->s->p->adjust(c->s->p, below(c, 2) ? &value : NULL, below(c, 2), null ? NULL : &r);
    if (c->s->cl.queue) (void)clFinish(c->s->cl.queue);
}

static void careless_question(careless *c) {
    const sv_plugin *p = c->s->p;
    sv_param_info info = {.size = below(c, 2) ? sizeof info : 8};
    char text[16];
    const sv_param_value v = value_of(c);
    (void)p->param_info(p, below(c, 40), below(c, 9) ? &info : NULL);
    (void)p->param_text(p, v.id, v.value, below(c, 9) ? text : NULL, below(c, sizeof text));
    (void)p->get_extension(p, below(c, 2) ? "org.nobody/1" : SV_EXT_POINTS "2");
    (void)p->last_error(p);
}

static void careless_needs(careless *c) {
    const sv_ext_needs *needs = c->s->p->get_extension(c->s->p, SV_EXT_NEEDS);
    sv_needs out = {.size = below(c, 4) ? sizeof out : 3};
    const sv_needs_device device = {below(c, 4) ? sizeof device : 2, below(c, 4) ? 1 : 0xff00, below(c, 3),
                                    0};
    const sv_param_value value = value_of(c);
    sv_format f = c->s->format;
    if (below(c, 3) == 0) memset(&f, (int)below(c, 256), sizeof f);
    f.values = NULL; /* a pointer that leads nowhere is no mistake that a plugin can find */
    f.value_count = 0;
    if (below(c, 3) == 0) f.size = sizeof f;
    if (needs)
        (void)needs->of(c->s->p, below(c, 5) ? &f : NULL, &value, below(c, 2), below(c, 9) ? &device : NULL,
                        below(c, 9) ? &out : NULL);
}

static void careless_extension(careless *c) {
    const sv_plugin *p = c->s->p;
    const sv_ext_confidence *confidence = p->get_extension(p, SV_EXT_CONFIDENCE);
    const sv_ext_points *points = p->get_extension(p, SV_EXT_POINTS);
    const sv_ext_timing *timing = p->get_extension(p, SV_EXT_TIMING);
    sv_confidence_report report = {.size = below(c, 3) ? sizeof report : 2};
    sv_points_report found = {.size = below(c, 3) ? sizeof found : 1};
    sv_stage_times times = {.size = below(c, 3) ? sizeof times : 0};
    const bool null = below(c, 4) == 0;
    const uint32_t which = below(c, 6);
    if (confidence && which == 0) (void)confidence->read(p, null ? NULL : c->s->depth, &report);
    if (confidence && which == 1) (void)confidence->offered(p);
    if (confidence && which == 2) (void)confidence->write(p, null ? NULL : c->s->depth, NULL, 0);
    if (points && which == 3) (void)points->write(p, null ? NULL : &found);
    if (timing && which == 4) (void)timing->stage_times(p, null ? NULL : &times);
    if (timing && which == 5) (void)timing->enable(p, 0);
    if (c->s->cl.queue) (void)clFinish(c->s->cl.queue);
}

static void careless_create(careless *c) {
    const sv_plugin *other = NULL;
    (void)c->s->entry->create(&c->s->host, below(c, 2) ? "org.nobody" : "", &other);
    if (other) other->destroy(other);
}

static void careless_frame(careless *c) {
    c->s->frame.flags = below(c, 3) ? 0 : SV_FRAME_DISCONTINUITY;
    if (layer_begin(c->s) < SV_OK) return;
    for (uint32_t n = 0; n < SLABS; n++)
        if (below(c, 12) > 0)
            (void)layer_slab(c->s, n);
        else if (below(c, 2) > 0)
            careless_slab(c, n);
    c->s->frame.time_ns += 50;
    if (below(c, 3) == 0)
        careless_result(c);
    else
        (void)layer_end(c->s);
}

/* One step of some calls. */
static void stumble(careless *c) {
    static void (*const some[])(careless *) = {careless_begin,     careless_begin, careless_result,
                                               careless_question,  careless_needs, careless_extension,
                                               careless_extension, careless_a_slab};
    enum { SOME = sizeof some / sizeof *some };
    const uint32_t which = below(c, 2 * SOME);
    if (below(c, 8) == 0 && (!c->active || below(c, 4) == 0)) careless_activate(c);
    if (below(c, 80) == 0) careless_create(c);
    if (below(c, 80) == 0) {
        c->s->p->deactivate(c->s->p);
        c->active = false;
    }
    if (which < SOME)
        some[which](c);
    else
        careless_frame(c);
}

static uint32_t steps(void) {
    return getenv("SV_NIGHT") ? 10000 : 500; /* of some five calls each */
}

static const char *const right[] = {
    "smartvis",           "examples/first_edge", "examples/kernel_edge", "wrong/right/results",
    "wrong/right/opencl", "wrong/right/library", "wrong/right/params",   "wrong/right/life"};
enum { RIGHT = sizeof right / sizeof *right, KERNELS = 2 };

/* Nor does it say anything of a host that takes care. */
static void use_with_care(const careless *c, const char *plugin) {
    layer_use(c->s);
    if (c->blamed + c->hosts > 0)
        fail_msg("%s: %u lines before anything is wrong", plugin, c->blamed + c->hosts);
}

static void no_right_plugin_is_blamed(void **state) {
    (void)setenv("SMARTVIS_CHECK_MS", "60000", 1);
    for (uint32_t n = 0; n < RIGHT; n++)
        for (uint32_t queue = 0; queue < 2; queue++) {
            careless *c = open_host(right[n], 7 + n, queue == 1);
            const uint32_t queues = c->s->entry->descriptor(0)->queues;
            const bool takes = queues & (queue ? SV_QUEUE_HOST : SV_QUEUE_OWN);
            if (takes) use_with_care(c, right[n]);
            for (uint32_t k = 0; k < steps() && takes; k++) stumble(c);
            if (c->blamed > 0) fail_msg("%s is blamed %u times: %s", right[n], c->blamed, c->first);
            if (takes) assert_true(c->hosts > 20);
            close_host(c);
        }
}

/* ---- faults that need such a host */
#define WRONG_ENTRY(id, source, check, what) {#id, #source, #check},
static const struct { const char *id, *source, *check; } wrong_ones[] = {WRONG_LIST(WRONG_ENTRY)};
enum { WRONG_COUNT = sizeof wrong_ones / sizeof *wrong_ones };

/* What the layer does not see, as docs/check.md says. */
static const char *const untold[] = {
    "crash_in_create",
    "hang_in_create",     /* a death or a hang in a call that is right: a recording has it */
    "null_host_crashes",  /* the layer refuses such a create itself */
    "reads_past_frame",   /* reads */
    "fails_for_ever",     /* an error may be right */
    "writes_in_adjust",   /* of a frame that has ended nothing is sampled */
    "writes_into_object", /* who wrote into an object: told as the host's */
    "writes_between_rows",
    "ignores_pitch",
    "writes_past_stats",
    "writes_past_object",    /* guard-bands: only behind maps without a pitch */
    "takes_foreign_objects", /* test_layer_rules has a second context for it */
    "closes_descriptors",
    "shrinks_files",
    "writes_to_files",
    "lowers_limits",
    "lowers_hard_limit",
    "takes_signal", /* process-untouched: only */
    "forks",
    "forks_session",
    "closes_when_refused",
    "prints", /* rounding and locale */
};

static bool is_untold(const char *id) {
    for (size_t n = 0; n < sizeof untold / sizeof *untold; n++)
        if (strcmp(untold[n], id) == 0) return true;
    return false;
}

/* What a child has seen of a plugin, for who waits for it. */
typedef struct {
    bool named;
    char last[400];
} sight;

static int rule_of(const char *id) {
    int n = 0;
    while (n < RULE_COUNT && strcmp(rules[n].id, id) != 0) n++;
    return n;
}

static void look_at(int n, uint32_t seed, sight *seen) {
    char path[64];
    (void)signal(SIGSEGV, SIG_DFL); /* not cmocka's */
    (void)alarm(60);
    const int name = rule_of(wrong_ones[n].check);
    const bool queue = strcmp(wrong_ones[n].source, "opencl") == 0;
    (void)snprintf(path, sizeof path, "wrong/%s", wrong_ones[n].id);
    careless *c = open_host(path, seed, queue);
    c->last = seen->last;
    for (uint32_t k = 0; k < 3000 && c->s->p && !c->named[name]; k++) stumble(c);
    seen->named = c->named[name];
    _exit(0);
}

/* A plugin that dies of what it should have refused: the last line says what that was. */
static bool is_told(const sight *seen, int status) {
    return seen->named || (status != 0 && strstr(seen->last, "the plugin owes")); /* a sanitizer exits */
}

/* What was said before often is said seldom, so a plugin may die of the hundredth mistake unnamed: there is
 * another host for that. */
static bool is_found(int n, sight *seen) {
    for (uint32_t seed = 3; seed < 5; seed++) {
        int status = 0;
        *seen = (sight){0};
        const pid_t child = fork();
        if (child == 0) look_at(n, seed, seen);
        assert_int_equal(waitpid(child, &status, 0), child);
        if (is_told(seen, status)) return true;
    }
    return false;
}

static void what_a_careless_host_finds_is_named(void **state) {
    int bad = 0, tried = 0;
    sight *seen = mmap(NULL, sizeof *seen, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
    for (int n = 0; n < WRONG_COUNT; n++) {
        if (!rules[rule_of(wrong_ones[n].check)].seen || is_untold(wrong_ones[n].id)) continue;
        tried++;
        if (is_found(n, seen)) continue;
        print_error("%s: %s is not named; %s\n", wrong_ones[n].id, wrong_ones[n].check, seen->last);
        bad++;
    }
    (void)munmap(seen, sizeof *seen);
    assert_true(tried >= 60);
    assert_int_equal(bad, 0);
}

/* ---- two threads and one instance */
static atomic_bool ends;

static void *disturb(void *context) {
    careless *c = context;
    const sv_frame wrong = {.size = sizeof wrong, .flags = 0x80};
    const sv_ext_confidence *confidence = c->s->p->get_extension(c->s->p, SV_EXT_CONFIDENCE);
    const sv_slab slab = {.size = 8};
    for (uint32_t n = 0; !ends; n++) {
        (void)c->s->p->begin(c->s->p, n % 3 ? &wrong : NULL);
        (void)c->s->p->slab(c->s->p, &slab);
        if (confidence) (void)confidence->write(c->s->p, NULL, NULL, 0);
        (void)sched_yield();
    }
    return NULL;
}

static void two_threads_are_the_hosts_fault(void **state) {
    for (uint32_t n = 0; n < RIGHT; n++) {
        pthread_t other;
        careless *c = open_host(right[n], 1, n == KERNELS);
        ends = false;
        assert_int_equal(layer_activate(c->s), SV_OK);
        assert_int_equal(pthread_create(&other, NULL, disturb, c), 0);
        for (uint32_t k = 0; k < steps() / 4 || (!c->named[RULE_host_threads] && k < 100000); k++)
            (void)layer_frame(c->s);
        ends = true;
        (void)pthread_join(other, NULL);
        c->s->p->deactivate(c->s->p);
        assert_int_equal(layer_activate(c->s), SV_OK); /* and all is known again */
        for (int k = 0; k < 3; k++) assert_true(layer_frame(c->s) >= SV_OK);
        c->s->p->deactivate(c->s->p);
        if (c->blamed > 0) fail_msg("%s is blamed %u times: %s", right[n], c->blamed, c->first);
        assert_true(c->named[RULE_host_threads]);
        close_host(c);
    }
}

/* The first one forks, and must find no OpenCL in this process. */
UNIT_MAIN(NULL, NULL, what_a_careless_host_finds_is_named, no_right_plugin_is_blamed,
          two_threads_are_the_hosts_fault)
