/* SPDX-License-Identifier: MIT */
#include "bench/methods_truth.h"

#include "loop/view.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

const char *const methods_scene_names[METHODS_SCENES] = {"D01", "E01", "M02"};

static bool view_scene(const hs_cl *cl, const hs_source *source, const hs_plugin *plugin,
                       const methods_values *values, hs_view *view, hs_error *err) {
    hs_loop_options options;
    hs_loop_defaults(&options);
    options.frames = 1;
    options.lowres = METHODS_SCENE_SIZE;
    options.dvr.width = options.dvr.height = METHODS_SCENE_SIZE;
    options.values = values ? values->all : NULL;
    options.value_count = values ? values->count : 0;
    hs_loop *loop = hs_loop_create(cl, source, plugin, &options, err);
    if (!loop) return false;
    bool ok = hs_loop_view(loop, 0, view, err);
    const hs_error *failed = hs_loop_plugin_error(loop);
    if (ok && plugin && failed->code != HS_OK) {
        hs_view_free(view);
        ok = hs_fail(err, failed->code, "%s", failed->text);
    }
    hs_loop_destroy(loop);
    return ok;
}

/* Picture pixels lie on the label map's: the camera at 0, 0 sees exactly the volume. */
static double difference(const methods_scene *scene, const float *termination) {
    const uint8_t *label = scene->source.scenes[0].label;
    double sum = 0.0;
    size_t rays = 0;
    for (size_t i = 0; i < (size_t)METHODS_SCENE_SIZE * METHODS_SCENE_SIZE; i++) {
        if (label[i] == HS_LABEL_NEITHER) continue;
        sum += fabs((double)termination[i] - (double)scene->truth[i]);
        rays++;
    }
    return rays ? sum / (double)rays : 0.0;
}

bool methods_scene_open(methods_scene *scene, const hs_cl *cl, const char *name, hs_error *err) {
    const hs_source_scene what = {.name = name, .size = METHODS_SCENE_SIZE, .volumes = 1};
    *scene = (methods_scene){0};
    hs_view clear = {0}, full = {0};
    if (!hs_source_open_scene(&scene->source, &what, err)) return false;
    const hs_source truth = {.volumes = scene->source.truths, .count = 1};
    bool ok = view_scene(cl, &truth, NULL, NULL, &clear, err) &&
              view_scene(cl, &scene->source, NULL, NULL, &full, err);
    if (ok) {
        scene->truth = clear.termination;
        clear.termination = NULL;
        scene->unclipped = difference(scene, full.full_termination);
    }
    hs_view_free(&clear);
    hs_view_free(&full);
    if (!ok) methods_scene_close(scene);
    return ok;
}

void methods_scene_close(methods_scene *scene) {
    hs_source_close(&scene->source);
    free(scene->truth);
    *scene = (methods_scene){0};
}

bool methods_scene_difference(const methods_scene *scene, const hs_cl *cl, const hs_plugin *plugin,
                              const methods_variant *variant, double *slices, bool *clipped, hs_error *err) {
    methods_values values;
    hs_view view = {0};
    if (!methods_values_make(plugin, variant, &values, err) ||
        !view_scene(cl, &scene->source, plugin, &values, &view, err))
        return false;
    *slices = difference(scene, view.termination);
    *clipped = view.frame.clipped;
    hs_view_free(&view);
    return true;
}
