/* SPDX-License-Identifier: MIT */
/* What a run found, as files that other programs open: docs/results.md. */
#pragma once

#include "loop/loop.h"
#include "loop/source.h"
#include "loop/view.h"
#include "volume/metaimage.h"

/* --- result_surface.c: where the maps lie among the voxels of the source and in the patient, and the
 * clipping surface as triangles. */

/* The low-resolution volume's grid as a volume: pixel (i, j) of the maps is its voxel (i, j, 0), and a depth
 * of d slices is its voxel (i, j, d). So a depth in mm is d * spacing[2], measured from the map itself. */
typedef struct {
    double spacing[3]; /* mm */
    hs_pose pose;
} hs_result_grid;

/* `volume` is what the maps were made from; it says where it lies in the patient. */
void hs_result_grid_of(const hs_maps *maps, const hs_volume *volume, hs_result_grid *grid);

/* mask[i] is 1 where a voxel is kept and 0 where its centre lies before the depthmap: the camera undone. As
 * many bytes as the volume has voxels. */
void hs_result_mask(const hs_maps *maps, const hs_volume *volume, uint8_t *mask);

#define HS_SURFACE_STEEPEST 4.0 /* mm of depth per mm across; a steeper cell is a step, and cut */

/* What became of a depthmap. */
typedef struct {
    uint32_t vertices, triangles;
} hs_surface_size;

/* The clipping surface. Free with hs_mesh_free. */
typedef struct {
    hs_surface_size size;
    float (*vertices)[3];    /* mm of the patient (hs_pose) */
    int32_t (*triangles)[3]; /* numbers of vertices */
} hs_mesh;

/* A vertex for every pixel whose surface lies in the volume and in its box, and two triangles for every cell
 * of four of them whose depths differ by no more than HS_SURFACE_STEEPEST allows. Their front is towards the
 * camera. Vertices without a triangle are left out. HS_ERR_MEMORY; the mesh is zeroed then. */
bool hs_result_surface(const hs_maps *maps, const hs_volume *volume, const hs_crop *box, hs_mesh *mesh,
                       hs_error *err);
void hs_mesh_free(hs_mesh *mesh); /* safe on a zeroed struct */

/* Writes it as a PLY file (binary). HS_ERR_OUTPUT names the path; HS_ERR_MEMORY. */
bool hs_result_write_surface(const char *path, const hs_maps *maps, const hs_volume *volume,
                             const hs_crop *box, hs_surface_size *size, hs_error *err);

/* --- result_write.c: the files. */

typedef struct hs_result_voxels hs_result_voxels;

/* Files are read through once for their smallest value, unless they hold MET_UCHAR. HS_ERR_INPUT if they
 * cannot be read any more, or are not of one type; HS_ERR_MEMORY. NULL on failure. `err` must outlive it. */
hs_result_voxels *hs_result_voxels_open(const hs_source *source, hs_error *err);
void hs_result_voxels_close(hs_result_voxels *voxels); /* NULL is allowed */

/* Turns to volume `index` of the source: 0 first, then one after the other. */
bool hs_result_voxels_turn(hs_result_voxels *voxels, uint32_t index);

enum { HS_RESULT_CHUNK = 8192 }; /* voxels that are handed on at once, at most */

/* The volume's next `count` voxels, at most HS_RESULT_CHUNK, in this machine's byte order; good until the
 * next call. NULL on failure. */
const uint8_t *hs_result_voxels_next(hs_result_voxels *voxels, size_t count);

/* Bits of what can be written. */
typedef enum {
    HS_RESULT_DEPTHMAP = 1 << 0,
    HS_RESULT_CONFIDENCE = 1 << 1,
    HS_RESULT_STATUS = 1 << 2,
    HS_RESULT_CLIPPED = 1 << 3,
    HS_RESULT_MASK = 1 << 4,
    HS_RESULT_SURFACE = 1 << 5
} hs_result;

enum { HS_RESULT_COUNT = 6, HS_RESULT_ALL = (1 << HS_RESULT_COUNT) - 1 };

/* "depthmap", ... of bit `index`: for command lines and the files' names. */
const char *hs_result_name(uint32_t index);

/* "depthmap,mask" or "all" as bits. HS_ERR_USAGE names `option`, the word and what is known. */
bool hs_result_parse(const char *option, const char *text, uint32_t *what, hs_error *err);

/* What was written. */
typedef struct {
    uint32_t what;           /* bits; without the confidence if the plugin has none */
    uint32_t volumes;        /* of the source; more than one: sequences */
    uint32_t clipped;        /* of them; for the others nothing is cut away */
    double fill;             /* of clipped.mha */
    hs_surface_size surface; /* of the last volume */
} hs_result_report;

/*
 * Writes one file each into the folder: NAME.mha, and surface.ply. A source of several volumes gives
 * sequences of four dimensions, and surface_0000.ply, surface_0001.ply, ... The maps lie in the patient where
 * the camera saw them; clipped and mask have the source's own voxels. The loop's camera must stand
 * still.
 *
 * `wanted` must be there, `welcome` may: a confidence that is only welcome and that the plugin does not give
 * is left out; else HS_ERR_PLUGIN. A plugin that fails gives zeros, and clips nothing. Other errors:
 * HS_ERR_INPUT (a file that changed), HS_ERR_OUTPUT, HS_ERR_DEVICE, HS_ERR_MEMORY. What is not complete is
 * not left behind.
 */
bool hs_results_write(hs_loop *loop, const hs_source *source, uint32_t wanted, uint32_t welcome,
                      const char *folder, hs_result_report *report, hs_error *err);

/* How a depthmap differs from one that was kept. */
typedef struct {
    uint32_t rays, different;  /* of them: those whose depths are more than `tolerance` apart */
    double tolerance, largest; /* mm */
    uint32_t x, y;             /* where the largest difference is, if any ray differs */
} hs_result_difference;

/* Compares the folder's depthmap.mha with the map `reference`, both of one volume and width x height rays.
 * Writes a row for each ray that differs to the folder's differences.csv. HS_ERR_INPUT: a map cannot be read,
 * or has another size; HS_ERR_OUTPUT, HS_ERR_MEMORY. */
bool hs_result_compare(const char *folder, const char *reference, uint32_t width, uint32_t height,
                       double tolerance, hs_result_difference *out, hs_error *err);
