/* SPDX-License-Identifier: MIT */
/*
 * What the tests of the scan loop share: a plugin whose depthmap is a plane, over a volume of layers: every
 * picture and every termination depth can be computed by hand.
 *
 * 48 slices of 1 mm: 4 .. 11 an occluder (153), 12 .. 29 fluid (10), from 30 on the fetus (255); above T_H an
 * opacity is 1, so a ray ends in the first sample of tissue. The low-resolution volume has 16^3 voxels of 3
 * slices: depth d of the map lies at step 3 (d + 0.5) - 0.5.
 */
#pragma once

#include "loop/loop_run.h"
#include "loop/view.h"
#include "support/host_fixture.h"

enum { N = 48, LOW = 16, PICTURE = 64, OCCLUDER = 4, FLUID = 12, FETUS = 30, FRAMES = 10 };

/* The plane plugin's parameters (tests/base/plugins/plane.c). */
enum { DEPTH = 1, SHAPE = 2, FAIL = 3, EVERY = 4, NOTE = 5 };
enum { FAIL_ACTIVATE = 1, FAIL_BEGIN = 2, FAIL_SLAB = 3, FAIL_END = 4 };

typedef struct {
    hs_cl cl;
    hs_plugin *plugin;
    hs_volume layers; /* as above */
    hs_volume bright; /* everything is fetus: another volume of a sequence, and a "ground truth" */
    const hs_volume *both[2];
    hs_source source; /* layers only */
} fixture;

/* What these make is given back when the test ends. One of the two volumes: */
hs_volume make_layers(bool bright);

/* cmocka group fixtures: *state is a fixture. */
int set_up(void **state);
int tear_down(void **state);

/* FRAMES frames in slabs of 6, 6 and 4 slices; the values are borrowed. */
hs_loop_options options_with(const sv_param_value *values, uint32_t count);
/* The same on the plugin's own queue from host memory, or on the host's from a buffer. */
hs_loop_options options_on(bool own_queue, const sv_param_value *values, uint32_t count);

/* A plugin of the tests' own; the fixture's is plane.so. */
hs_plugin *open_plugin(const char *name);

/* Files as a source; NULL: with the defaults. */
hs_source *open_source(const char *const *paths, uint32_t count, const hs_source_files *how);

/* A loop; the test fails if it cannot be made. A plugin serves one at a time: that of an earlier call ends.
 */
hs_loop *make_loop_from(const hs_cl *cl, const hs_source *source, const hs_plugin *plugin,
                        const hs_loop_options *options);
/* Ends one of these before its time. */
void end_loop(hs_loop *loop);

/* A loop over the fixture's source. */
hs_loop *make_loop_of(const fixture *f, const hs_plugin *plugin, const hs_loop_options *options);
/* Makes such a loop with the plane plugin. */
hs_loop *make_loop(const fixture *f, const hs_loop_options *options);

/* A frame, all of it on the host. */
hs_view view_of(hs_loop *loop, uint32_t index);

/* The step at which a ray ends that starts at depth d of the map. */
float end_of_ray(double d);

/* The picture's red for a ray that ends in voxel `end`. */
uint8_t red_at(float end, const hs_dvr_settings *dvr);
