/* SPDX-License-Identifier: MIT */
/* A scene as files: MetaImage volumes and maps, or what a probe would have scanned as Kretz files (.vol). */
#ifndef HS_SCENE_EXPORT_H
#define HS_SCENE_EXPORT_H

#include "scene/scene.h"
#include "volume/kretz.h"

/* Writes <prefix>_full.mha, _truth.mha, _label.mha, _near.mha and _far.mha: volumes, and maps of one
 * slice. Where the label is 0, near and far hold -1 in the files. HS_ERR_OUTPUT or HS_ERR_MEMORY. */
bool hs_scene_export(const hs_scene_data *data, const char *prefix, hs_error *err);

/* A geometry (hs_beams). Zeros stand for what hs_vol_geometry chooses. */
typedef struct {
    uint32_t samples, lines, planes;
    double pitch;       /* mm */
    double start, axis; /* mm; NAN stands for what hs_vol_geometry chooses */
    double theta, phi;  /* degrees from the first to the last line, and plane */
    double skew;        /* 0: even steps; up to 0.9: closer in the middle */
    bool descending;    /* sweep angles from high to low */
    bool mirrored;      /* to be read as hs_kretz_options.mirrored says */
} hs_vol_spec;

/*
 * The beams of a spec, voxels not filled. What the spec leaves open is chosen so that the fan lies in the
 * volume: the samples start 15 % of the volume's depth behind the centre of curvature, the axis lies 10 % of
 * it behind that centre, the pitch is the voxels', and the outer lines and planes reach the volume's sides at
 * its far end; three lines to five voxels, two planes to five. NULL: HS_ERR_USAGE names what cannot be, or
 * HS_ERR_MEMORY.
 */
hs_beams *hs_vol_geometry(const hs_vol_spec *spec, const hs_volume *volume, hs_error *err);

/* Samples the volume along the beams, linearly. The middle of its first slice's outer face lies where the
 * samples of the middle line start. What lies outside the volume, or was not scanned, is a black echo. */
void hs_vol_fill(hs_beams *beams, const hs_volume *volume);

/* Files under way. Zeroed: none. */
typedef struct {
    hs_kretz_writer full, truth;
    hs_beams *beams;
} hs_vol_export;

/* Writes one of `frames` frames of a scene, in their order, to <prefix>_full.vol and <prefix>_truth.vol: the
 * first one opens them, the last one ends them. A scene of one frame gets its <prefix>_label.mha, too: on
 * the columns of the Cartesian copy, the scene's label where the column's middle stands, and 0 where the end
 * of its interval was not scanned. On failure nothing is left behind, and the struct is zeroed: HS_ERR_USAGE,
 * HS_ERR_OUTPUT or HS_ERR_MEMORY. */
bool hs_vol_export_frame(hs_vol_export *out, const hs_vol_spec *spec, const char *prefix, uint32_t frames,
                         const hs_scene_data *data, hs_error *err);

/* Gives files under way up. Safe on a zeroed struct. */
void hs_vol_export_discard(hs_vol_export *out);

#endif
