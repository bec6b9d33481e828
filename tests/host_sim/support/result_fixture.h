/* SPDX-License-Identifier: MIT */
/* What the tests of written results share: a source that lies askew in the patient, is longer in one
 * direction than in another and holds 16 bits, a plugin whose depthmap is a plane, and a folder. */
#pragma once

#include "result/result_write.h"
#include "support/loop_fixture.h"
#include "support/metaimage_files.h"

enum { SOURCE_X = 40, SOURCE_Y = 48, SOURCE_Z = 44, SOURCE_LOWEST = -700 };
enum { SOURCE_VOXELS = SOURCE_X * SOURCE_Y * SOURCE_Z };

/* The directions of x, y and z, one after the other: no axis of the patient, and a mirror image. */
extern const double source_directions[9];
extern const double source_spacing[3]; /* mm */
extern const double source_offset[3];  /* mm */

/* Voxel i of a file that source_write made, its volumes one after the other; voxel 7 holds SOURCE_LOWEST. */
int16_t source_voxel(size_t i);

/* Writes such a file of `frames` volumes, with more lines for the header. */
void source_write(const char *path, uint32_t frames, const char *lines);

typedef struct {
    hs_cl cl;
    hs_plugin *plugin;
    char source[128]; /* a file of one volume in the folder */
} result_fixture;

/* cmocka group fixtures: *state is a result_fixture. The teardown fails if files are left that results do not
 * have. */
int result_set_up(void **state);
int result_tear_down(void **state);

/* Options for a depthmap of a tilted plane; `values` has room for 2. */
hs_loop_options result_options(sv_param_value *values);

/* Reads, makes a loop; both are given back when the test ends. The test fails if that cannot be. */
hs_loop *result_loop(const result_fixture *f, const char *const *paths, uint32_t count,
                     const hs_metaimage_options *read, const hs_loop_options *options, hs_source **source);

/* The same, and writes `what` to the folder; the confidence only if there is one. */
hs_result_report result_write(const result_fixture *f, const char *const *paths, uint32_t count,
                              const hs_metaimage_options *read, const hs_loop_options *options,
                              uint32_t what);
