/* SPDX-License-Identifier: MIT */
/* A volume with its ground truth, to judge the definition of the wall's surface on: from files or from a
 * scene. */
#ifndef WALL_CASE_H
#define WALL_CASE_H

#include "eval/eval_case.h"

#include "ref/ref_wall.h"

typedef struct {
    char name[64];
    uint32_t nx, ny, nz;
    double spacing_mm[3];
    uint8_t *full;         /* nx * ny * nz voxels */
    uint16_t *first, *end; /* scanned slices of each ray */
    uint8_t *label;        /* per ray: 0 neither, 1 sac, 2 fetus; NULL: no truth is known */
    float *truth;          /* per ray: slice at which it ends in the ground truth; NULL with `label` */
    uint8_t *clean;        /* the ground truth: `full` without what hides; NULL with `label` */
} wall_case;

/* Copies a case of the report: its volume, truth and label. Voxels of 0 were not scanned. */
bool wall_case_take(const hs_eval_source *source, wall_case *out, hs_error *err);

/* Reads "FULL,TRUTH,LABEL[,FIRST,END]" as `host_sim report --case` does (eval/eval_source.h), with its
 * errors. With maps the voxels are the file's, so black fluid is 0; without, scanned voxels are 1 .. 255. */
bool wall_case_files(const char *files, wall_case *out, hs_error *err);

/* Reads NAME_full.mha, NAME_truth.mha, NAME_label.mha, scan_first.mha and scan_end.mha of a folder likewise.
 * */
bool wall_case_read(const char *folder, const char *name, wall_case *out, hs_error *err);

/* Makes a scene of 128^3 voxels in a pose and a frame of its motion (surf_case.h). Zeros at the ends of a ray
 * were not scanned. */
bool wall_case_make(const char *scene, uint64_t seed, uint32_t pose, uint32_t frame, wall_case *out,
                    hs_error *err);

/* A volume without a truth; the zeros at the ends of each ray were not scanned. */
bool wall_case_open(const char *path, wall_case *out, hs_error *err);

/* Resamples the volume for a camera that is turned by `degrees` about axis 0 (x), 1 (y) or 2 (z, then looked
 * at from the side): a cube of `side`^3 voxels that holds all of it. */
bool wall_case_turn(const wall_case *from, int axis, double degrees, uint32_t side, wall_case *out,
                    hs_error *err);

/* Grey levels become 255 (level / 255)^gamma * gain + black, at scanned voxels only. */
void wall_case_change(wall_case *c, double gain, double gamma, double black);

void wall_case_free(wall_case *c);

/* The full volume as the wall's definition takes it; borrows the case's arrays. */
sv_wall_volume wall_case_volume(const wall_case *c);

/* Slice at which a ray that starts in slice `start` ends (thesis Eq. 3.22 - 3.24,
 * defaults of spec 9), or nz. */
float wall_termination(const uint8_t *voxels, size_t plane, uint32_t nz, size_t pixel, uint32_t start);

#endif
