/* SPDX-License-Identifier: MIT */
#include "ref/definitions.h"

#include "ref/ref_chain.h"
#include "ref/ref_wall.h"

#include <stdio.h>
#include <string.h>

bool sv_define_surface(const char *method, const uint8_t *status, const double *depth, uint32_t width,
                       uint32_t height, uint32_t kernel, uint32_t merge_grid, double *surface) {
    sv_ref_settings settings = sv_ref_default_settings;
    settings.kernel = kernel;
    settings.merge_grid = merge_grid;
    const sv_ref_task task = {.map = {status, depth, width, height}, .settings = &settings};
    for (uint32_t m = 0; m < SV_METHOD_END; m++) {
        const sv_ref_method *const definition = sv_ref_method_of(m);
        if (definition && !definition->takes_volume && strcmp(sv_ref_method_name(m), method) == 0)
            return sv_ref_chain(definition, &task, surface);
    }
    return false;
}

/* Every constant, and where it lies in the settings. */
#define CONSTANT_AT(name, value) {#name, offsetof(sv_wall_settings, name)},
static const struct {
    const char *name;
    size_t at;
} constants_of_wall[] = {SV_WALL_CONSTANTS(CONSTANT_AT)};
enum { CONSTANTS = sizeof constants_of_wall / sizeof *constants_of_wall };

static double *constant_of(sv_wall_settings *settings, uint32_t index) {
    return (double *)(void *)((char *)settings + constants_of_wall[index].at);
}

const char *sv_define_wall_constant(uint32_t index, double *value) {
    sv_wall_settings settings = sv_wall_settings_default();
    if (index < CONSTANTS) {
        *value = *constant_of(&settings, index);
        return constants_of_wall[index].name;
    }
    *value = index == CONSTANTS ? settings.clip_doubtful : settings.median;
    return index == CONSTANTS ? "clip_doubtful" : index == CONSTANTS + 1 ? "median" : NULL;
}

static sv_wall_settings settings_of(const double *constants) {
    sv_wall_settings settings = sv_wall_settings_default();
    for (uint32_t i = 0; i < CONSTANTS; i++) *constant_of(&settings, i) = constants[i];
    settings.clip_doubtful = constants[CONSTANTS] != 0.0;
    settings.median = constants[CONSTANTS + 1] != 0.0;
    return settings;
}

static sv_beams beams_of(uint32_t kind, const float told[13]) {
    sv_beams beams = {.kind = kind, .sweep_mm = told[12]};
    memcpy(beams.rotation, told, sizeof beams.rotation);
    memcpy(beams.apex_mm, told + 9, sizeof beams.apex_mm);
    for (int i = 0; i < 3; i++) beams.side[i] = 0.0f - told[3 * i + 2];
    return beams;
}

bool sv_define_wall(uint32_t beams, const uint8_t *voxels, const uint16_t *first, const uint16_t *end,
                    const uint32_t size[3], const double spacing_mm[3], const float told[13],
                    const double *constants, float *depth, float *confidence, double facts[8], char *text,
                    size_t bytes) {
    const sv_beams known = beams_of(beams, told);
    const sv_wall_settings settings = settings_of(constants);
    const sv_wall_volume volume = {.voxels = voxels,
                                   .width = size[0],
                                   .height = size[1],
                                   .slices = size[2],
                                   .first = first,
                                   .end = end,
                                   .spacing_mm = {spacing_mm[0], spacing_mm[1], spacing_mm[2]},
                                   .beams = &known};
    sv_wall_outcome outcome;
    sv_wall_facts f;
    if (!sv_wall_check(&volume, text, bytes)) return false;
    (void)snprintf(text, bytes, "no memory");
    if (!sv_wall_surface(&volume, &settings, depth, confidence, &outcome, &f)) return false;
    const double all[8] = {outcome, f.threshold, f.rays, f.wall_rays, f.gap_share, f.wall, f.spread, f.fetus};
    memcpy(facts, all, sizeof all);
    return true;
}
