/* SPDX-License-Identifier: MIT */
/* What the tests of the renderer share: volumes, views, a picture by the kernels, and its comparison. */
#pragma once

#include "render/dvr.h"
#include "support/host_fixture.h"

/* A volume, and where it is seen from. */
typedef struct {
    uint32_t size[3];
    double spacing[3];
    double yaw, pitch;
    int pattern;
} scene_case;

enum { SCENES = 15 };
extern const scene_case dvr_scenes[SCENES];

/* How a scene is drawn. */
typedef struct {
    uint32_t width, height;
    float low, high, step, termination, offset, ghost;
    int map; /* MAP_* */
} view_case;

enum { MAP_NONE, MAP_RANDOM, MAP_ZERO, MAP_NEGATIVE, MAP_BEYOND, MAP_ODD };

enum { VIEWS = 11 };
extern const view_case dvr_views[VIEWS];

/* The size of the depthmaps, and their slices. */
#define MAP_W 7u
#define MAP_H 5u
#define MAP_S 11u

/* The settings of a view. */
hs_dvr_settings dvr_settings_of(const view_case *v);

/* MAP_ODD holds what a broken plugin might: NaN and infinities beside depths. */
void dvr_fill_map(test_random *random, int kind, float map[MAP_W * MAP_H]);

/* What the kernels made: colours, ends of the rays. */
typedef struct {
    uint8_t *rgba;
    float *termination;
} dvr_picture;

/* Kept for the test. `map` and `confidence` have MAP_W * MAP_H values and may be NULL. */
dvr_picture dvr_render(const hs_cl *cl, const hs_volume *volume, const hs_camera *camera,
                       const hs_dvr_settings *s, const float *map, const float *confidence);

/* A scene's volume, and what it is looked at with. */
hs_volume dvr_lay_out(test_random *random, size_t scene, size_t view, float doubt, hs_camera *camera,
                      hs_dvr_settings *s, float map[MAP_W * MAP_H]);

/* The picture against the definition, with a random confidence if `with_confidence` is true. */
void dvr_check_case(const hs_cl *cl, size_t scene, size_t view, float doubt, bool with_confidence);

/* Fails if they differ in a bit. */
void dvr_assert_same(const dvr_picture *a, const dvr_picture *b, size_t pixels, size_t scene, size_t view);
