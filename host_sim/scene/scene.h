/* SPDX-License-Identifier: MIT */
/* Synthetic scenes with a ground truth that is exact by construction (spec 6). docs/scenes.md has the file
 * format. */
#pragma once

#include "volume/volume.h"

/* Values of the label map. */
enum { HS_LABEL_NEITHER = 0, HS_LABEL_SAC = 1, HS_LABEL_FETUS = 2 };

/* What a scene generates. Maps are nx * ny for the camera at 0, 0 (rays along +z), in source voxels:
 * depth 0 is the centre of the first slice. */
typedef struct {
    hs_volume full;   /* what the probe delivers */
    hs_volume truth;  /* the same with everything before a correct clipping surface removed (set to 1) */
    bool truth_later; /* `truth` is of zeros until hs_scene_fill_truth */
    uint8_t *label;   /* HS_LABEL_* */
    /* Nearest and farthest admissible clipping depth; NAN where the label is 0. Both are voxel centres, and
     * all voxels from near to far are fluid. A fetus that is touched by its occluder has no fluid before it:
     * near = far = the first voxel of the fetus. */
    float *near_end, *far_end;
    /* The clipping surface of `truth`: the middle of the interval, or deeper where an occluder beside the ray
     * ends deeper, always inside the interval; on label 0 carried on from the nearest pixel that has one.
     * Voxels z < clip are removed. */
    float *clip;
    /* hs_tissue of each voxel (scene/scene_spec.h), nx * ny * nz: what the truth was read from. NULL with
     * hs_scene_options.lean. */
    uint8_t *tissue;
} hs_scene_data;

/* Makes the voxels of `truth` if they are to come later. One thread at a time. */
void hs_scene_fill_truth(hs_scene_data *data);

/* Frees everything and zeroes the struct. Safe on a zeroed struct. */
void hs_scene_free(hs_scene_data *data);

/* The share of the fetus' pixels, 0 .. 1, on which the truth's surface lies in echoes and not in fluid: the
 * occluder touches the fetus there, or the probe does not tell them apart. 0 without a fetus. */
double hs_scene_touched(const hs_scene_data *data);

typedef enum {
    HS_SCENES_THESIS,  /* the nine cases: E01 .. E04, M01 .. M03, D01, D02 */
    HS_SCENES_HARD,    /* H01 and on: what the nine do not have */
    HS_SCENES_EXAMPLE, /* a whole fetus, made to look like a real scan */
    HS_SCENES_REAL,    /* "real": before a volume that is given */
    HS_SCENES_GROUPS
} hs_scene_group;

/* The built-in scenes of a group, in their order; NULL from the last on. */
const char *hs_scene_of_group(hs_scene_group group, uint32_t index);

/* Writes the folder of the built-in scenes: SMARTVIS_SCENES, or below the program's folder or beside it. */
void hs_scene_folder(char *folder, size_t size);

/* The file of a scene as text, and `path`, its place for messages. A name with a dot or a slash is a
 * path; "R<seed>_<number>" is a random scene, which has no file; others are built-in. free() it. NULL:
 * HS_ERR_INPUT or HS_ERR_MEMORY. */
char *hs_scene_text(const char *name_or_path, char *path, size_t size, hs_error *err);

/* What a scene is made in, one after the other. */
enum {
    HS_SCENE_STEP_RASTER,        /* solids to voxels */
    HS_SCENE_STEP_ECHO,          /* echogenicity and interfaces */
    HS_SCENE_STEP_ATTENUATION,   /* attenuation and time-gain compensation */
    HS_SCENE_STEP_EDGE_SHADOW,   /* refraction at the edges */
    HS_SCENE_STEP_REVERBERATION, /* bands behind parallel reflectors */
    HS_SCENE_STEP_HAZE,          /* haze and clutter behind the wall */
    HS_SCENE_STEP_CORNER,        /* a corner without contact */
    HS_SCENE_STEP_FAR_BAND,      /* dark gap and bright band at the far head bone */
    HS_SCENE_STEP_SPECKLE,       /* scatterers and point spread */
    HS_SCENE_STEP_SIDE_LOBES,    /* haze beside strong reflectors */
    HS_SCENE_STEP_NOISE,         /* electronic noise */
    HS_SCENE_STEP_COMPRESS,      /* log compression to 8 bits */
    HS_SCENE_STEP_FAN,           /* zeros outside the probe's fan */
    HS_SCENE_STEP_CAMERA,        /* voxels of a turned camera */
    HS_SCENE_STEP_TRUTH,         /* intervals, label map, clipped volume */
    HS_SCENE_STEPS
};

/* A scene that was read from its file. Read-only after that: any number of threads may generate from it. */
typedef struct hs_scene hs_scene;

/* `name_or_path` is a built-in scene ("E01", "H01"), a random one ("R7_3": number 3 of the set with seed 7)
 * or the path of a scene file. Errors name file, line and field. */
hs_scene *hs_scene_open(const char *name_or_path, hs_error *err);
void hs_scene_close(hs_scene *scene);
const char *hs_scene_name(const hs_scene *scene);
/* The scene as a file's text. Borrowed. */
const char *hs_scene_json(const hs_scene *scene);
/* What the thesis says of the case, one sentence. */
const char *hs_scene_title(const hs_scene *scene);

typedef struct {
    /* Voxels per axis, 32 .. 512; not read for a `real` scene, which has its volume's. */
    uint32_t size;
    /* 0: the scene's own. Speckle, noise and the places of particles come from it. */
    uint64_t seed;
    /* Of the scene's motion; 0 is the scene as it stands in the file. Every frame has speckle of its own. */
    uint32_t frame;
    /* 0: one per processor. The bytes do not depend on it. */
    uint32_t threads;
    /* MetaImage volume that a scene of kind "real" puts its occluders before; NULL for all others. */
    const char *real;
    /* Only what pictures need: `tissue` is freed, and `truth` of a synthetic scene may come later. */
    bool lean;
} hs_scene_options;

/* One frame of a scene with its truth. On failure *out is zeroed. Same arguments, same bytes. */
bool hs_scene_frame(const hs_scene *scene, const hs_scene_options *options, hs_scene_data *out,
                    hs_error *err);
