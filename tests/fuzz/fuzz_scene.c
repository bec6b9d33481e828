/* SPDX-License-Identifier: MIT */
/* A scene file of any bytes. What is accepted is generated, as small as it goes, and its truth must be within
 * the volume. */
#include "fuzz/fuzz_target.h"
#include "fuzz/memory_file.h"
#include "scene/scene.h"

#include <math.h>

enum { SIDE = 32 };

static void check_truth(const hs_scene_data *data) {
    for (uint32_t i = 0; i < data->full.nx * data->full.ny; i++) {
        FUZZ_HOLDS(data->label[i] <= HS_LABEL_FETUS);
        FUZZ_HOLDS(isfinite(data->clip[i]) && data->clip[i] <= (float)data->full.nz);
        if (data->label[i] == HS_LABEL_NEITHER) continue;
        FUZZ_HOLDS(data->near_end[i] <= data->far_end[i] && data->far_end[i] <= (float)data->full.nz);
    }
}

/* One input in eight, and always the same ones. */
static int is_chosen(const uint8_t *data, size_t size) {
    uint32_t sum = 2166136261u;
    for (size_t i = 0; i < size; i++) sum = (sum ^ data[i]) * 16777619u;
    return (sum >> 16) % 8 == 0;
}

static void generate(const hs_scene *scene) {
    hs_error err = {0};
    hs_scene_data made;
    const hs_scene_options options = {.size = SIDE, .threads = 1};
    if (hs_scene_frame(scene, &options, &made, &err)) {
        check_truth(&made);
        hs_scene_free(&made);
    } else {
        FUZZ_HOLDS(err.code != HS_OK && err.text[0]);
    }
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    memory_file file;
    memory_file_open(&file, data, size);
    hs_error err = {0};
    hs_scene *scene = hs_scene_open(file.path, &err);
    if (scene) {
        if (is_chosen(data, size)) generate(scene);
        hs_scene_close(scene);
    } else {
        FUZZ_HOLDS(err.code != HS_OK && err.text[0]);
    }
    memory_file_close(&file);
    return 0;
}
