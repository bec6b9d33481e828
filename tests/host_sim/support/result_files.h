/* SPDX-License-Identifier: MIT */
/* Written results as another program finds them: MetaImage and PLY files read byte by byte, without the code
 * under test, and places in the patient from what stands in them. */
#pragma once

#include "support/metaimage_files.h"

/* An uncompressed or compressed .mha of this project: its text, and its voxels in memory. */
typedef struct {
    char text[65536];
    uint32_t dims, size[4];
    double spacing[3], origin[3], direction[9]; /* column a of `direction`: axis a */
    char type[32];
    size_t voxel_bytes, voxels; /* of one voxel; in all */
    uint8_t *data;
} result_file;

/* Fails the test if the file is not as this project writes them; the voxels are kept for the test. */
void result_open(result_file *file, const char *path);

/* The world's place of an index, and the index of a world's place. */
void result_world(const result_file *file, const double index[3], double world[3]);
void result_index(const result_file *file, const double world[3], double index[3]);

/* A float map between its pixels' middles, clamped at its edges. */
double result_map_at(const result_file *map, double x, double y);

/* A PLY file of this project. */
typedef struct {
    uint32_t vertices, faces;
    float (*vertex)[3];
    int32_t (*face)[3];
} result_mesh;
void result_mesh_open(result_mesh *mesh, const char *path);
