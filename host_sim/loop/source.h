/* SPDX-License-Identifier: MIT */
/* Where the scan loop's volumes come from: files, or a synthetic scene with its ground truth. */
#pragma once

#include "loop/sequence.h"
#include "scene/scene.h"
#include "volume/crop.h"

/* Volumes of a sequence that a thread of their own reads ahead. */
typedef struct hs_stream hs_stream;

/* A volume of which a box is left. */
typedef struct {
    hs_volume volume; /* without beams: it is Cartesian */
    uint32_t index;
    bool filled; /* with volume `index` */
} hs_cropped;

/* One or more volumes of the same size and spacing; a loop over more frames than volumes starts again at the
 * first. Owned by the caller. */
typedef struct {
    const hs_volume **volumes; /* count pointers */
    const hs_volume **truths;  /* the same for the ground truth of scenes, or NULL */
    uint32_t count;            /* >= 1 */
    char title[256];           /* what a scene is about; "" for files */
    hs_scene_data *scenes;     /* what volumes and truths point into: scenes ... */
    hs_volume *file;           /* ... or the one volume of a file */
    hs_sequence *sequence;     /* the files; NULL for scenes */
    uint32_t left_out;         /* volumes of the files that are invalid, as they say themselves */
    hs_stream *stream;         /* several volumes, read as they are played: `volumes` is NULL then */
    hs_crop crop;              /* all volumes and truths are told with this box alone */
    uint32_t crops;            /* counts its changes */
    hs_cropped *cropped;       /* a volume and a truth; NULL until there is a box */
} hs_source;

/* Reads `count` files, MetaImage (.mha, .mhd) or Kretz (.vol), each of one volume or of a sequence; `paths`
 * must outlive it; `how` may be NULL. Several volumes, of one file or of more, are read as they are played.
 * The errors are those of hs_sequence_open, and of hs_sequence_read for the first volume. */
bool hs_source_open_files(hs_source *source, const char *const *paths, uint32_t count,
                          const hs_source_files *how, hs_error *err);

/* Which scene, and how much of it. */
typedef struct {
    const char *name; /* a built-in case or a scene file */
    uint32_t size;    /* voxels per axis, 32 .. 512 */
    uint64_t seed;    /* 0: the scene's own */
    uint32_t volumes; /* of its motion, >= 1; 1: it stands still */
    const char *real; /* the MetaImage file of a scene of kind "real"; NULL for all others */
} hs_source_scene;

/* Generates the volumes of a scene with their ground truth. */
bool hs_source_open_scene(hs_source *source, const hs_source_scene *what, hs_error *err);

/* Frees everything. Safe on a zeroed struct. */
void hs_source_close(hs_source *source);

/* Leaves a box of all volumes and truths: what lies outside was not scanned. One in probe geometry is its
 * Cartesian copy then, so loops on it must be built anew where the box comes or goes; others bring the
 * volume anew. What was brought before must not be used any more. HS_ERR_INPUT: it holds no voxel;
 * HS_ERR_MEMORY. The source is as it was then. */
bool hs_source_crop(hs_source *source, const hs_crop *crop, hs_error *err);

/* Size, spacing, geometry and name of all its volumes; no voxels that may be read. */
const hs_volume *hs_source_shape(const hs_source *source);

/* The volume of frame `index`. That of a stream is waited for, and stays as it is until this is called
 * again; NULL with the errors of hs_stream_get. */
const hs_volume *hs_source_bring(const hs_source *source, uint32_t index, hs_error *err);

/* The volume of frame `index` without a reason if there is none, for sources that are no stream and have all
 * of them; and its ground truth or NULL. A scene's is made when it is first asked for. */
const hs_volume *hs_source_volume(const hs_source *source, uint32_t index);
const hs_volume *hs_source_truth(const hs_source *source, uint32_t index);
bool hs_source_has_truth(const hs_source *source);

/* Where the volume of frame `index` was read from; NULL for scenes. Owned by the source. */
const hs_source_origin *hs_source_origin_of(const hs_source *source, uint32_t index);

/* What the scene of frame `index` consists of, its label map and clipping surface included; NULL for files.
 * Owned by the source. */
const hs_scene_data *hs_source_scene_data(const hs_source *source, uint32_t index);

/* Gives a source of one file a ground truth of the same size. It is borrowed and must outlive the source.
 * HS_ERR_MEMORY. */
bool hs_source_set_truth(hs_source *source, const hs_volume *truth, hs_error *err);
