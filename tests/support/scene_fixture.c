/* SPDX-License-Identifier: MIT */
#include "support/scene_fixture.h"

#include <math.h>

const char *const scene_cases[SCENE_CASES] = {"D01", "D02", "E01", "E02", "E03", "E04", "M01", "M02", "M03"};

void empty_spec(hs_scene_spec *spec) {
    hs_error err = {0};
    if (!hs_scene_read_text("empty.json", EMPTY_SCENE, spec, &err)) fail_msg("%s", err.text);
}

void one_tissue_field(hs_field *field, uint32_t n, float h, hs_tissue tissue) {
    const uint32_t size[3] = {n, n, n};
    const float spacing[3] = {h, h, h};
    hs_error err = {0};
    memset(field, 0, sizeof *field);
    if (!hs_field_init(field, size, spacing, &err)) fail_msg("%s", err.text);
    field->threads = 2;
    field->seed = 7;
    field->noise_seed = hs_random_key(7, 1000);
    size_t count = (size_t)n * n * n;
    memset(field->tissue, (int)tissue, count);
    memset(field->surface, tissue == HS_TISSUE_FLUID ? HS_DISTANCE_FAR : -HS_DISTANCE_FAR, count);
    memset(field->bone, HS_DISTANCE_FAR, count);
    for (size_t i = 0; i < count; i++) field->diffuse[i] = field->coherent[i] = HS_LEVEL_SILENT;
}

void assert_near_at(double found, double expected, double tolerance, const char *what, const char *file,
                    int line) {
    if (fabs(found - expected) <= tolerance) return;
    print_error("%s is %g, expected %g +- %g\n", what, found, expected, tolerance);
    _fail(file, line);
}

double level_db(int16_t level) {
    return (double)level / HS_LEVEL_ONE;
}

void make_scene(const char *name, uint32_t size, uint32_t threads, uint64_t seed, uint32_t frame,
                hs_scene_data *out, hs_scene_times *times) {
    hs_error err = {0};
    hs_scene *scene = hs_scene_open(name, &err);
    if (!scene) fail_msg("%s", err.text);
    const hs_scene_options options = {.size = size, .threads = threads, .seed = seed, .frame = frame};
    if (!hs_scene_frame(scene, &options, out, times, &err)) fail_msg("%s", err.text);
    hs_scene_close(scene);
}
