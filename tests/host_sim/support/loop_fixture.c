/* SPDX-License-Identifier: MIT */
#include "support/loop_fixture.h"

#include <math.h>

hs_volume make_layers(bool bright) {
    hs_volume v;
    must(hs_volume_init(&v, N, N, N, &err));
    keep_volume(&v);
    for (size_t i = 0; i < hs_volume_count(&v); i++) {
        const size_t z = i / (N * N);
        v.voxels[i] = bright || z >= FETUS ? 255 : z >= OCCLUDER && z < FLUID ? 153 : 10;
    }
    return v;
}

int set_up(void **state) {
    static fixture f;
    hs_error err = {0};
    if (!hs_cl_open(&f.cl, &err)) {
        print_error("%s\n", err.text);
        return -1;
    }
    f.plugin = open_plugin("plane");
    f.layers = make_layers(false);
    f.bright = make_layers(true);
    f.both[0] = &f.layers;
    f.both[1] = &f.bright;
    f.source = (hs_source){.volumes = f.both, .count = 1};
    *state = &f;
    return 0;
}

int tear_down(void **state) {
    fixture *f = *state;
    unit_return(NULL);
    hs_cl_close(&f->cl);
    return 0;
}

hs_loop_options options_with(const sv_param_value *values, uint32_t count) {
    hs_loop_options o;
    hs_loop_defaults(&o);
    o.frames = FRAMES;
    o.lowres = LOW;
    o.slab_slices = 6; /* slabs of 6, 6 and 4 slices */
    o.dvr.width = o.dvr.height = PICTURE;
    o.values = values;
    o.value_count = count;
    return o;
}

hs_loop_options options_on(bool own_queue, const sv_param_value *values, uint32_t count) {
    hs_loop_options o = options_with(values, count);
    o.own_queue = own_queue;
    o.carrier = own_queue ? SV_CARRIER_HOST : SV_CARRIER_BUFFER;
    return o;
}

static void close_plugin(void *plugin) {
    hs_plugin_close(plugin);
}

hs_plugin *open_plugin(const char *name) {
    hs_plugin *plugin = unit_memory(sizeof *plugin);
    const char *build = getenv("SV_BUILD_DIR");
    const char *const path = unit_text("%s/tests/plugins/%s.so", build ? build : ".", name);
    must(hs_plugin_open(plugin, path, NULL, SV_LOG_WARNING, &err));
    unit_keep(close_plugin, plugin);
    return plugin;
}

static void close_source(void *source) {
    hs_source_close(source);
}

hs_source *open_source(const char *const *paths, uint32_t count, const hs_source_files *how) {
    hs_source *source = unit_memory(sizeof *source);
    must(hs_source_open_files(source, paths, count, how, &err));
    unit_keep(close_source, source);
    return source;
}

/* Loops that were made, the last one first. */
typedef struct made {
    struct made *before;
    const hs_plugin *plugin;
    hs_loop *loop; /* NULL: it has ended */
} made;
static made *last_made;

static void forget_loop(void *what) {
    const made *m = what;
    hs_loop_destroy(m->loop);
    last_made = m->before;
}

void end_loop(hs_loop *loop) {
    for (made *m = last_made; m; m = m->before)
        if (m->loop == loop) m->loop = NULL;
    hs_loop_destroy(loop);
}

hs_loop *make_loop_from(const hs_cl *cl, const hs_source *source, const hs_plugin *plugin,
                        const hs_loop_options *options) {
    hs_error err = {0};
    made *m = unit_memory(sizeof *m);
    for (made *other = last_made; plugin && other; other = other->before)
        if (other->plugin == plugin && other->loop) end_loop(other->loop);
    *m = (made){last_made, plugin, hs_loop_create(cl, source, plugin, options, &err)};
    if (!m->loop) fail_msg("%s", err.text);
    last_made = m;
    unit_keep(forget_loop, m);
    return m->loop;
}

hs_loop *make_loop_of(const fixture *f, const hs_plugin *plugin, const hs_loop_options *options) {
    return make_loop_from(&f->cl, &f->source, plugin, options);
}

hs_loop *make_loop(const fixture *f, const hs_loop_options *options) {
    return make_loop_of(f, f->plugin, options);
}

static void free_view(void *view) {
    hs_view_free(view);
}

hs_view view_of(hs_loop *loop, uint32_t index) {
    hs_view *view = unit_memory(sizeof *view);
    must(hs_loop_view(loop, index, view, &err));
    unit_keep(free_view, view);
    return *view;
}

float end_of_ray(double d) {
    const double start = d > 0 ? ceil(3 * (d + 0.5) - 0.5 - 1e-3) : 0;
    if (start < FLUID) return (float)fmax(start, OCCLUDER);
    return (float)fmin(fmax(start, FETUS), N);
}

uint8_t red_at(float end, const hs_dvr_settings *dvr) {
    const double intensity = end >= N ? 0 : end >= FETUS ? 255 : 153;
    return (uint8_t)(intensity * (double)dvr->skin[0] + 0.5);
}
