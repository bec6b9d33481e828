/* SPDX-License-Identifier: MIT */
/* What the scene tests share: a spec with nothing in it, and a field of one's own tissues. */
#pragma once

#include "scene/scene.h"
#include "scene/scene_field.h"
#include "scene/scene_random.h"
#include "scene/scene_spec.h"
#include "support/near.h"
#include "support/unit.h"

enum { SCENE_CASES = 9 };
extern const char *const scene_cases[SCENE_CASES];

/* The smallest scene file there is: a sac and nothing else. */
#define EMPTY_SCENE                                                                                          \
    "{ \"name\": \"t\", \"title\": \"t\", \"seed\": 1, \"display\": { \"gain_db\": 0 },\n"                   \
    "  \"sac\": { \"centre_mm\": [60, 60, 60], \"radii_mm\": [40, 40, 40] },\n"                              \
    "  \"structures\": [],\n"                                                                                \
    "  \"artefacts\": [] }\n"

/* Reads EMPTY_SCENE. */
hs_scene_spec empty_spec(void);

/* A cube of n^3 voxels of h mm, all of one tissue, far from any surface, with silent
 * interfaces. It is kept for the test, as are the frames below (unit.h). */
hs_field *one_tissue_field(uint32_t n, float h, hs_tissue tissue);

/* Makes the envelope of all slices at once. */
void make_speckle(hs_field *field, const hs_scene_spec *spec);

/* Converts a level to dB. */
double level_db(int16_t level);

/* A voxel of the pixel's ray. */
uint8_t scene_voxel(const uint8_t *voxels, const hs_volume *v, size_t pixel, long z);

/* One pixel's label, interval and clipping depth against the rule, looked at from the tissues again:
 * backwards from the end, where the scene goes forwards. */
void check_scene_pixel(const hs_scene_data *data, size_t pixel);

/* A scene opened from a file with this text; hs_scene_close it. */
hs_scene *scene_of_text(const char *text, hs_error *err);

/* One frame of such a scene, without speckle of its own unless the text lists it. */
hs_scene_data make_text_scene(const char *text, uint32_t size);

/* One frame of a scene. */
hs_scene_data make_scene(const char *name, uint32_t size, uint32_t threads, uint64_t seed, uint32_t frame);

/* The same of an open one, which is closed. */
hs_scene_data scene_frame(hs_scene *scene, const hs_scene_options *options);
