/* SPDX-License-Identifier: MIT */
/* Where a case of the evaluation comes from: a scene, or files with a ground truth. */
#ifndef HS_EVAL_SOURCE_H
#define HS_EVAL_SOURCE_H

#include "loop/source.h"

typedef struct {
    /* A built-in scene, a scene file, or "FULL,TRUTH,LABEL[,FIRST,END]": files. FULL and TRUTH are volumes of
     * the same size and spacing, MetaImage or Kretz, of which the Cartesian copy counts; LABEL is MetaImage,
     * and has one slice of as many columns, with HS_LABEL_* in it. FIRST and END, for MetaImage volumes, are
     * maps of what was scanned of every ray (hs_scanned_maps_apply) with FIRST <= END; a ray with a label has
     * FIRST < END. Without them the zeros of FULL tell, as HS_PADDING_AUTO reads them. */
    const char *name;
    uint32_t size;    /* voxels per axis of a scene */
    uint32_t lowres;  /* pixels of the map per axis; 0: a third of the source */
    uint64_t seed;    /* of a scene; 0: its own */
    const char *real; /* the volume of the scene "real"; not read for others */
} hs_eval_request;

/* A volume with its ground truth and label map. Owned by the caller; must not move while open. */
typedef struct {
    hs_source source;
    const uint8_t *label;  /* nx * ny, in the scene or in `given_label` */
    hs_volume given_truth; /* of files; zeroed for scenes */
    hs_volume given_label; /* the same */
} hs_eval_source;

/* HS_ERR_INPUT names the file, and what does not fit. On failure everything is freed. */
bool hs_eval_source_open(hs_eval_source *source, const hs_eval_request *request, hs_error *err);
void hs_eval_source_close(hs_eval_source *source);

#endif
