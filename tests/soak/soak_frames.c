/* SPDX-License-Identifier: MIT */
/*
 * soak_frames PLUGIN.so FRAMES [SEED]: so many frames of a scan loop as a person's hand makes them: cameras
 * turn, volumes come and go, values and marks change, a method is activated anew, pictures are drawn and
 * dropped. How far it is is printed, a line every thousandth. For `make soak`, which watches what it holds.
 */
#include "loop/loop_run.h"
#include "loop/screen.h"
#include "plugin/loader_param.h"
#include "render/host_kernels.h"
#include "support/unit.h"

enum { SIDE = 32, VOLUMES = 4, MARKS = 3, MOST_VALUES = 64 };

typedef struct {
    hs_cl cl;
    hs_source source;
    hs_plugin plugin;
    hs_loop_options options;
    hs_loop *loop;
    hs_screen *screen;
    hs_frame frame;
    hs_mark marks[MARKS];
    sv_param_value values[MOST_VALUES]; /* in a frame; the method first */
    uint32_t count, index, random;
    uint32_t refused; /* frames whose map the host did not take, as the spline's that leaves the volume */
} soak;

static uint32_t below(soak *s, uint32_t count) {
    return unit_random(&s->random) % count;
}

static double between(soak *s, double low, double high) {
    return low + (high - low) * below(s, 10001) / 10000.0;
}

static void take(bool done, const char *what, const hs_error *err) {
    if (done) return;
    (void)fprintf(stderr, "soak_frames: %s: %s\n", what, err->text);
    exit(1);
}

static void look(soak *s) {
    hs_loop_look(s->loop, between(s, -180, 180), between(s, -90, 90), between(s, -180, 180),
                 between(s, 1, 4));
}

static void mark(soak *s) {
    const uint32_t count = below(s, MARKS + 1);
    for (uint32_t i = 0; i < count; i++) {
        for (int k = 0; k < 3; k++) s->marks[i].place[k] = between(s, 0, SIDE);
        s->marks[i].radius = between(s, 0.5, 9);
        s->marks[i].keep = below(s, 2);
    }
    hs_loop_set_marks(s->loop, s->marks, count);
}

/* Any value that a parameter may have; some positions of an enum are retired. */
static double any_value(soak *s, const sv_param_info *info) {
    const uint32_t names = hs_plugin_enum_count(info);
    char name[HS_ENUM_NAME];
    double value = between(s, info->display_min, info->display_max);
    if (info->type == SV_PARAM_ENUM)
        while (!hs_plugin_enum_at(&s->plugin, info, below(s, names), &value, name, sizeof name)) continue;
    else if (info->type != SV_PARAM_FLOAT)
        value = info->min_value +
                info->step * below(s, (uint32_t)((info->max_value - info->min_value) / info->step) + 1);
    return value;
}

/* Values of what a frame may change; of the rest the defaults, but for the method. */
static void set(soak *s) {
    s->count = 1;
    for (uint32_t i = 0; i < hs_plugin_param_count(&s->plugin) && s->count < MOST_VALUES; i++) {
        sv_param_info info = {.size = sizeof info};
        if (s->plugin.instance->param_info(s->plugin.instance, i, &info) != SV_OK) continue;
        if (!(info.flags & SV_PARAM_REACTIVATE) && below(s, 3) > 0)
            s->values[s->count++] = (sv_param_value){.id = info.id, .value = any_value(s, &info)};
    }
    hs_loop_set_values(s->loop, s->values, s->count);
}

/* Another method, or the same anew. */
static void activate(soak *s) {
    hs_error err = {0};
    sv_param_info method;
    take(hs_plugin_find_param(&s->plugin, "method", &method), "there is no parameter method", &err);
    s->values[0] = (sv_param_value){.id = method.id, .value = any_value(s, &method)};
    s->options.value_count = s->count = 1;
    take(hs_loop_reactivate(s->loop, &s->plugin, &s->options, &err), "activation", &err);
}

static void draw(soak *s) {
    hs_error err = {0};
    hs_dvr_settings dvr = s->options.dvr;
    dvr.look = below(s, 2) ? HS_LOOK_LIT : HS_LOOK_THESIS;
    hs_screen_destroy(s->screen);
    s->screen = hs_screen_create(&s->cl, &dvr, &err);
    take(s->screen && hs_loop_draw(s->loop, s->screen, s->index, &s->frame, &err), "picture", &err);
}

static void run(soak *s, uint32_t number) {
    hs_error err = {0};
    if (below(s, 3) == 0) s->index = below(s, VOLUMES);
    if (below(s, 3) == 0) look(s);
    if (below(s, 4) == 0) set(s);
    if (below(s, 16) == 0) mark(s);
    if (number == 0 || below(s, 500) == 0) activate(s);
    hs_loop_want(s->loop, below(s, 2), below(s, 2));
    take(hs_loop_bring(s->loop, s->index, &err) && hs_loop_convert(s->loop, s->index, &err) &&
             hs_loop_ask(s->loop, s->index, &s->frame, &err),
         "frame", &err);
    s->refused += s->frame.outcome < SV_OK;
    if (below(s, 16) == 0) draw(s);
}

int main(int argc, char **argv) {
    static soak s;
    const hs_source_scene scene = {.name = "E02", .size = SIDE, .volumes = VOLUMES};
    const uint32_t frames = argc > 2 ? (uint32_t)strtoul(argv[2], NULL, 10) : 0;
    hs_error err = {0};
    if (frames == 0) {
        (void)fputs("Usage: soak_frames PLUGIN.so FRAMES [SEED]\n", stderr);
        return 2;
    }
    s.random = argc > 3 ? (uint32_t)strtoul(argv[3], NULL, 10) | 1u : 1u;
    hs_loop_defaults(&s.options);
    s.options.turnable = s.options.live = true;
    s.options.dvr.width = s.options.dvr.height = SIDE;
    s.options.values = s.values;
    take(hs_cl_open(&s.cl, &err) && hs_source_open_scene(&s.source, &scene, &err), "start", &err);
    take(hs_plugin_open(&s.plugin, argv[1], NULL, SV_LOG_ERROR, &err), "plugin", &err);
    s.loop = hs_loop_create(&s.cl, &s.source, &s.plugin, &s.options, &err);
    take(s.loop, "loop", &err);
    for (uint32_t i = 0; i < frames; i++) {
        run(&s, i);
        if (i % (frames / 1000 + 1) == 0) (void)printf("%u\n", i), (void)fflush(stdout);
    }
    hs_screen_destroy(s.screen);
    hs_loop_destroy(s.loop);
    hs_plugin_close(&s.plugin);
    hs_source_close(&s.source);
    hs_cl_close(&s.cl);
    (void)printf("%u\n%u maps of them were not taken\n", frames, s.refused);
    return 0;
}
