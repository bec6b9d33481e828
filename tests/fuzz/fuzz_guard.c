/* SPDX-License-Identifier: MIT */
/*
 * The guard's protocol: the host's side against a child that says and writes anything. The child is played
 * here: this file stands in for guard/child.h. It answers every order rightly, from valid facts on; then the
 * input changes the answer and scribbles in the shared block, between the host's calls, too. Whatever comes,
 * what the host holds is bounded and stays as it was, and what failed has a reason.
 */
#include "core/system.h"
#include "fuzz/fuzz_bytes.h"
#include "fuzz/fuzz_target.h"
#include "guarded/guard_link.h"
#include "guarded/guarded.h"
#include "plugin/loader_param.h"

#include <stdio.h>
#include <stdlib.h>

enum { WIDTH = 9, HEIGHT = 7, SLICES = 4, PIXELS = WIDTH * HEIGHT, MAX_CALLS = 40, PARAMS = 3 };

static fuzz_bytes *input;
static hs_guard_block *shared; /* the child's view; NULL: there is no child */
static hs_guard_reply answer;

static size_t shared_bytes(void) {
    return hs_guard_map_offset(HS_GUARD_MAPS, PIXELS);
}

/* The facts up to those that the input can change. */
enum { FACTS = offsetof(hs_guard_facts, param[PARAMS + 1]) };

/* ---------------------------------------------------------------------------------------- the child -- */

static void fill_facts(hs_guard_facts *f) {
    f->abi_major = SV_ABI_MAJOR;
    f->plugin_count = 2;
    f->chosen = 1;
    f->param_count = PARAMS;
    f->extensions = HS_GUARD_HAS_TIMING | HS_GUARD_HAS_CONFIDENCE | HS_GUARD_HAS_POINTS | HS_GUARD_HAS_NEEDS;
    for (int i = 0; i < 2; i++) {
        (void)snprintf(f->plugin[i].id, sizeof f->plugin[i].id, "org.smartvis.fuzz.%d", i);
        f->plugin[i].extension_count = 1;
        (void)snprintf(f->plugin[i].extension[0], sizeof f->plugin[i].extension[0], SV_EXT_POINTS);
    }
    for (uint32_t i = 0; i < PARAMS; i++) {
        hs_guard_param *p = &f->param[i];
        p->texts = 31;
        p->numbers = (sv_param_info){.size = sizeof p->numbers,
                                     .id = i + 1,
                                     .type = i == 0 ? SV_PARAM_FLOAT : SV_PARAM_ENUM,
                                     .max_value = 2,
                                     .step = 1};
        (void)snprintf(p->key, sizeof p->key, "p%u", i);
    }
}

/* Bytes of the input over fields that matter, or over any. */
static void scribble(void) {
    hs_guard_facts *f = &shared->facts;
    const struct {
        void *at;
        size_t bytes;
    } fields[] = {{&f->plugin_count, 16},
                  {&f->plugin[0], sizeof f->plugin[0]},
                  {&f->plugin[1].extension_count, 4},
                  {&f->param[0], sizeof f->param[0]},
                  {f->param[1].key, sizeof f->param[1].key},
                  {shared->call, sizeof shared->call},
                  {&shared->step, 8},
                  {&shared->since_ns, 8},
                  {shared->last_error, sizeof shared->last_error},
                  {&shared->offered, 4},
                  {&shared->slab_count, 4},
                  {shared->slabs, sizeof shared->slabs[0]},
                  {&shared->stats, sizeof shared->stats},
                  {&shared->points, sizeof shared->points},
                  {&shared->confidence, 4},
                  {shared->text, sizeof shared->text},
                  {&shared->times, sizeof shared->times},
                  {shared, sizeof *shared}};
    for (unsigned n = fuzz_u8(input) % 4; n > 0; n--) {
        const size_t which = fuzz_u8(input) % (sizeof fields / sizeof *fields);
        const size_t from = fuzz_u32(input) % fields[which].bytes, left = fields[which].bytes - from;
        const uint8_t wanted = fuzz_u8(input);
        uint8_t *at = (uint8_t *)fields[which].at + from;
        if (wanted < 255)
            fuzz_take(input, at, wanted < left ? wanted : left);
        else
            memset(at, 'x', left); /* a text without an end */
    }
}

/* The order has come: the right answer, and what becomes of it. */
static void play(const hs_guard_order *order) {
    answer = (hs_guard_reply){.op = order->op, .number = order->number};
    if (order->op == HS_GUARD_OPEN) fill_facts(&shared->facts);
    (void)snprintf(shared->call, sizeof shared->call, "call");
    shared->stats.outcome = shared->confidence = SV_OK;
    if (fuzz_u8(input) % 8 == 7) answer.status = (sv_status)(int8_t)fuzz_u8(input);
    if (fuzz_u8(input) % 32 == 31) answer.op ^= fuzz_u8(input);
    if (fuzz_u8(input) % 32 == 31) answer.number -= fuzz_u8(input);
    scribble();
}

/* ------------------------------------------------------------------------- in place of guard/child*.c -- */

bool hs_child_start(hs_child *child, const hs_child_limits *limits, const char *program, char *const argv[],
                    const intptr_t *passed, uint32_t passed_count, hs_error *err) {
    (void)argv;
    FUZZ_HOLDS(!shared && passed_count == 2 && limits->memory_bytes && limits->said_bytes);
    *child = (hs_child){0};
    if (fuzz_u8(input) % 32 == 31) return hs_fail(err, HS_ERR_INPUT, "%s: cannot be run", program);
    shared = sys_shared_map(passed[0], shared_bytes(), true);
    if (!shared) abort();
    *child = (hs_child){.process = 1, .channel = -1, .output = -1};
    return true;
}

static void end(hs_child *child, hs_child_fate why) {
    if (!child->process) return;
    sys_shared_unmap(shared, shared_bytes());
    shared = NULL;
    child->process = 0;
    child->end = (hs_child_end){.fate = why};
}

bool hs_child_send(intptr_t channel, const void *message, size_t bytes) {
    FUZZ_HOLDS(shared && channel == -1 && bytes == sizeof(hs_guard_order));
    play(message);
    return fuzz_u8(input) % 32 != 31;
}

bool hs_child_receive(intptr_t channel, void *message, size_t bytes) {
    FUZZ_HOLDS(shared && channel == -1 && bytes == sizeof answer);
    memcpy(message, &answer, bytes);
    return fuzz_u8(input) % 32 != 31;
}

hs_child_news hs_child_wait(hs_child *child, double seconds) {
    const uint8_t what = fuzz_u8(input);
    FUZZ_HOLDS(seconds >= 0);
    if (!child->process) return HS_CHILD_ENDED;
    if (what < 240) return HS_CHILD_MESSAGE;
    if (what < 248) return HS_CHILD_NOTHING; /* its time is over: the limits are 0 */
    end(child, what & 1 ? HS_CHILD_LEFT : HS_CHILD_CRASHED);
    return HS_CHILD_ENDED;
}

void hs_child_wait_end(hs_child *child, double seconds) {
    (void)seconds;
    end(child, HS_CHILD_LEFT);
}

void hs_child_kill(hs_child *child, hs_child_fate why, double seconds) {
    (void)seconds;
    end(child, why);
}

void hs_child_close(hs_child *child) {
    end(child, HS_CHILD_GONE);
    *child = (hs_child){0};
}

uint64_t hs_child_dropped(hs_child *child) {
    (void)child;
    return 0;
}

void hs_child_tell(const hs_child_end *how, char *out, size_t bytes) {
    (void)snprintf(out, bytes, "ended as %d", (int)how->fate);
}

/* ----------------------------------------------------------------------------------------- the host -- */

static void check_text(const char *text, size_t bytes) {
    FUZZ_HOLDS(!text || strnlen(text, bytes) < bytes);
}

/* What holds at any time. `facts`: as they were when the plugin was opened. */
static void check_host(const hs_plugin *plugin, const hs_guard_facts *facts) {
    const hs_guard *guard = hs_guard_of(plugin->instance);
    FUZZ_HOLDS(memcmp(facts, &guard->facts, FACTS) == 0);
    FUZZ_HOLDS(guard->restarts <= guard->options.restarts);
    FUZZ_HOLDS(guard->child.process || !shared);
    check_text(plugin->instance->last_error(plugin->instance), sizeof guard->last_error);
    check_text(hs_guarded_call(plugin, "call"), sizeof guard->call);
    for (uint32_t i = 0; i < plugin->count; i++) {
        const sv_descriptor *d = plugin->descriptor[i];
        uint32_t count = 0;
        check_text(d->id, sizeof facts->plugin[0].id);
        check_text(d->summary, sizeof facts->plugin[0].summary);
        for (; d->extensions[count]; count++) check_text(d->extensions[count], 64);
        FUZZ_HOLDS(count <= HS_GUARD_EXTENSIONS);
    }
}

static void ask_params(const hs_plugin *plugin) {
    sv_param_info info = {.size = sizeof info};
    sv_param_value value;
    hs_error err = {0};
    char text[HS_ENUM_NAME];
    double number;
    const sv_status status = plugin->instance->param_info(plugin->instance, fuzz_u8(input), &info);
    if (status != SV_OK) return;
    check_text(info.key, sizeof((hs_guard_param *)0)->key);
    check_text(info.help, sizeof((hs_guard_param *)0)->help);
    hs_plugin_value_text(plugin, &info, 1.0, text, sizeof text);
    check_text(text, sizeof text);
    if (hs_plugin_enum_count(&info) && hs_plugin_enum_at(plugin, &info, 0, &number, text, sizeof text))
        check_text(text, sizeof text);
    if (!hs_plugin_parse_param(plugin, "p0=0.5", &value, &err)) FUZZ_HOLDS(err.text[0]);
}

static void ask_extensions(const hs_plugin *plugin) {
    const sv_plugin *p = plugin->instance;
    float map[PIXELS];
    sv_points_report points = {.size = sizeof points};
    sv_stage_times times = {.size = sizeof times};
    sv_confidence_report report = {.size = sizeof report};
    static const sv_format format = {.size = sizeof format};
    static const sv_needs_device device = {.size = sizeof device};
    sv_needs needs = {.size = sizeof needs};
    const sv_ext_confidence *confidence = hs_plugin_confidence(p);
    const sv_ext_timing *timing = hs_plugin_timing(p);
    hs_plugin_points(p, &points);
    FUZZ_HOLDS(points.size == 0 || points.size == sizeof points);
    if (confidence && hs_guard_of(p)->pixels == PIXELS) {
        (void)confidence->write(p, map, NULL, 0);
        (void)confidence->read(p, map, &report);
    }
    if (timing) (void)(timing->enable(p, 1) + timing->stage_times(p, &times));
    if (hs_plugin_needs(p)) (void)hs_plugin_needs(p)->of(p, &format, NULL, 0, &device, &needs);
    FUZZ_HOLDS(needs.size == sizeof needs && times.size == sizeof times && report.size == sizeof report);
}

static void activate(const hs_plugin *plugin) {
    static const sv_param_value value = {.id = 1};
    const sv_format format = {.size = sizeof format,
                              .width = WIDTH,
                              .height = HEIGHT,
                              .slices = SLICES,
                              .max_slab_slices = 1,
                              .voxel_type = SV_VOXEL_U8,
                              .carrier = SV_CARRIER_HOST,
                              .values = &value,
                              .value_count = 1};
    plugin->instance->deactivate(plugin->instance);
    (void)plugin->instance->activate(plugin->instance, &format);
}

/* A frame as the loop calls it, with scribbles in between; `memory` are the slabs. */
static void run_frame(const hs_plugin *plugin, const uint8_t *memory, int adjust) {
    const sv_plugin *p = plugin->instance;
    const sv_frame frame = {.size = sizeof frame};
    sv_stats stats = {.size = sizeof stats};
    float *depth = calloc(PIXELS, sizeof *depth);
    uint8_t *status = calloc(PIXELS, 1);
    if (!depth || !status) abort();
    const sv_result result = {.size = sizeof result, .depth = depth, .status = status, .stats = &stats};
    sv_status last = p->begin(p, &frame);
    for (uint32_t i = 0; last == SV_OK && i < SLICES; i++) {
        const sv_slab slab = {.size = sizeof slab,
                              .first_slice = i,
                              .slice_count = 1,
                              .memory = memory + (size_t)i * PIXELS,
                              .bytes = PIXELS};
        if (shared) scribble();
        last = p->slab(p, &slab);
        FUZZ_HOLDS(last == SV_OK); /* it lies in the guard's memory, whatever the child has written */
    }
    if (last == SV_OK) last = p->end(p, &result);
    if (last == SV_OK && adjust) last = p->adjust(p, NULL, 0, &result);
    FUZZ_HOLDS(last != SV_OK || stats.size == sizeof stats);
    free(status);
    free(depth);
}

/* Uses a plugin that is open. */
static void use(hs_plugin *plugin) {
    static hs_guard_facts facts;
    hs_error err = {0};
    memcpy(&facts, &hs_guard_of(plugin->instance)->facts, FACTS);
    const uint8_t *memory = hs_guarded_memory(plugin, (size_t)SLICES * PIXELS, &err);
    if (!memory) abort();
    for (int i = 0; i < MAX_CALLS && input->left > 0; i++) {
        const uint8_t what = fuzz_u8(input);
        if (shared) scribble();
        if (what % 8 == 0)
            activate(plugin);
        else if (what % 8 == 1)
            ask_params(plugin);
        else if (what % 8 == 2)
            ask_extensions(plugin);
        else
            run_frame(plugin, memory, what % 8 == 3);
        check_host(plugin, &facts);
    }
}

static bool open_it(hs_plugin *plugin, hs_error *err) {
    hs_guard_options options;
    hs_guard_defaults(&options);
    options.choice = HS_GUARD_ON;
    options.frame_s = options.setup_s = 0;
    return hs_guarded_open(plugin, "/fuzz.so", NULL, SV_LOG_ERROR, &options, err);
}

/* A plugin that was opened rightly, and is as then for each input: opening takes far longer than all else. */
static hs_plugin *standing(void) {
    static hs_plugin plugin;
    static fuzz_bytes nothing = {(const uint8_t *)"", 0}; /* zeros: a child that does as it is told */
    hs_error err = {0};
    input = &nothing;
    if (!plugin.instance && !open_it(&plugin, &err)) abort();
    hs_guard *guard = hs_guard_of(plugin.instance);
    plugin.instance->deactivate(plugin.instance);
    memset(guard->block, 0, sizeof *guard->block);
    guard->block->magic = HS_GUARD_MAGIC;
    guard->restarts = 0;
    guard->ended = err;
    if (!guard->child.process && !hs_guard_start(guard, &err)) abort();
    return &plugin;
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    fuzz_bytes b = {data, size};
    hs_plugin plugin;
    hs_error err = {0};
    if (fuzz_u8(&b) % 16 != 15) {
        hs_plugin *p = standing();
        input = &b;
        use(p);
        return 0;
    }
    hs_guard_end_child(hs_guard_of(standing()->instance)); /* one child at a time */
    input = &b;
    if (open_it(&plugin, &err)) {
        use(&plugin);
        if (!hs_guarded_close(&plugin, &err)) FUZZ_HOLDS(err.code != HS_OK && err.text[0]);
    } else {
        FUZZ_HOLDS(err.code != HS_OK && err.text[0]);
    }
    FUZZ_HOLDS(!shared);
    return 0;
}
