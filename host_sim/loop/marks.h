/* SPDX-License-Identifier: MIT */
/* A user's marks, which change the plugin's depthmap: the one definition, for every door of the machine. */
#pragma once

#include "render/camera.h"

enum { HS_MARKS_MAX = 256 };

/* mm: of a mark that says none; and what a person may ask for. */
#define HS_MARK_RADIUS       5.0
#define HS_MARK_RADIUS_LEAST 0.1
#define HS_MARK_RADIUS_MOST  1e3

typedef struct {
    double place[3]; /* mm along the volume's x, y, z from the centre of its first voxel */
    double radius;   /* mm, > 0 */
    bool keep;       /* else remove */
} hs_mark;

/*
 * Applies marks in their order to a depthmap of n[0] x n[1] pixels and n[2] slices that `camera` sees of
 * `volume`. A mark works on the rays that pass it within its radius, and on what lies at most two radii
 * before or behind it. Tissue is what is brighter than Otsu's threshold of that part of its rays (means of 3
 * x 3 x 3 voxels); a run of tissue ends at 2 mm that are darker. remove: where a ray's first tissue is at the
 * mark, the ray starts at its next run; if there is none, nothing changes, nor where the end of what a mark
 * before it took of the ray is nearer to the mark: marks that overlap, as those of a stroke, take one layer.
 * keep: where the ray's run of tissue at the mark was cut, the ray starts at that run. A start is one slice
 * before its run. HS_ERR_USAGE: a mark is not finite or its radius not above 0, or there are more than
 * HS_MARKS_MAX; none is applied then. Any thread.
 */
bool hs_marks_apply(const hs_mark *marks, uint32_t count, const hs_volume *volume, const hs_camera *camera,
                    const uint32_t n[3], float *depth, hs_error *err);

/* Where a place of the volume lies seen from the box' middle: mm right, down and away; and back. */
void hs_marks_seen(const hs_volume *volume, const hs_camera *camera, const double place[3], double seen[3]);
void hs_marks_place(const hs_volume *volume, const hs_camera *camera, const double seen[3], double place[3]);

/* Moves a mark to keep along its ray to the last tissue before where that depthmap starts the ray: to its far
 * end, or to the start in it. False: nothing is cut there. Any thread. */
bool hs_marks_find_cut(hs_mark *mark, const hs_volume *volume, const hs_camera *camera, const uint32_t n[3],
                       const float *depth);
