/* SPDX-License-Identifier: MIT */
/* How far the pictures of a method are from those of a scene's ground truth. */
#ifndef METHODS_TRUTH_H
#define METHODS_TRUTH_H

#include "bench/methods_variant.h"
#include "loop/source.h"
#include "render/host_cl.h"

/* Voxels an axis of the scenes, pixels across their maps and pictures. */
enum { METHODS_SCENES = 3, METHODS_SCENE_SIZE = 128 };
extern const char *const methods_scene_names[METHODS_SCENES];

/* One scene with the depths at which rays through its ground truth end. Zeroed: nothing to free. */
typedef struct {
    hs_source source;
    float *truth;     /* termination depths of the truth, slices; size * size */
    double unclipped; /* difference of the full volume's, slices */
} methods_scene;

/* HS_ERR_INPUT, HS_ERR_DEVICE, HS_ERR_MEMORY. */
bool methods_scene_open(methods_scene *scene, const hs_cl *cl, const char *name, hs_error *err);
void methods_scene_close(methods_scene *scene);

/*
 * One frame of the host's scan loop with the variant: the mean of |termination depth - that of the
 * truth| over the rays that cross the sac or meet the fetus (labels 1 and 2), slices. Seen from the
 * probe, with as many map and picture pixels as the volume has. A variant that finds no surface
 * clips nothing: *clipped is false.
 */
bool methods_scene_difference(const methods_scene *scene, const hs_cl *cl, const hs_plugin *plugin,
                              const methods_variant *variant, double *slices, bool *clipped, hs_error *err);

#endif
