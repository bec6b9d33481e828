/* SPDX-License-Identifier: MIT */
/* One case of the evaluation: a volume with its ground truth, a plugin on it, the table of its rays and what
 * is measured of a depthmap. */
#pragma once

#include "loop/loop.h"
#include "loop/source.h"
#include "plugin/loader.h"

/* ---------------------------------------------------------------------------------------------- volume -- */
/* Where a case of the evaluation comes from: a scene, or files with a ground truth. */

typedef struct {
    /* A built-in scene, a scene file, or "FULL,TRUTH,LABEL[,FIRST,END][,REFERENCE]": files. FULL and TRUTH
     * are volumes of the same size and spacing, MetaImage or Kretz, of which the Cartesian copy counts; LABEL
     * is MetaImage, and has one slice of as many columns, with HS_LABEL_* in it. FIRST and END, for MetaImage
     * volumes, are maps of what was scanned of every ray (hs_scanned_maps_load) with FIRST <= END; a ray with
     * a label has FIRST < END. Without them the zeros of FULL tell, as HS_PADDING_AUTO reads them. REFERENCE
     * is FULL as an expert edited it, for the eye. */
    const char *name;
    uint32_t size;             /* voxels per axis of a scene */
    uint32_t lowres;           /* pixels of the map per axis; 0: hs_loop_lowres */
    uint64_t seed;             /* of a scene; 0: its own */
    const char *real;          /* the volume of the scene "real"; not read for others */
    hs_metaimage_options read; /* how FULL and TRUTH are read */
} hs_eval_request;

/* A volume with its ground truth and label map. Owned by the caller; must not move while open. */
typedef struct {
    hs_source source;
    const uint8_t *label;             /* nx * ny, in the scene or in `given_label` */
    hs_volume given_truth;            /* of files; zeroed for scenes */
    hs_volume given_label;            /* the same */
    hs_volume given_reference;        /* what an expert left of it; zeroed: not given */
    char doubt[HS_DOUBT_BYTES + 160]; /* of files: what is doubtful of size or the probe's side, or "" */
} hs_eval_source;

/* HS_ERR_INPUT names the file, and what does not fit. On failure everything is freed. */
bool hs_eval_source_open(hs_eval_source *source, const hs_eval_request *request, hs_error *err);
void hs_eval_source_close(hs_eval_source *source);

/* ----------------------------------------------------------------------------------------------- table -- */
/*
 * What every start depth does to every viewing ray of a case, so that a setting costs one look-up per ray.
 *
 * With a hard cut (ghost width 0) a ray's termination depth depends on nothing but the step it starts at. The
 * table is made by the renderer itself: one picture per start step, each from a depthmap of one constant. The
 * evaluation picture has one pixel per ray of the low-resolution map, so the renderer's interpolation of the
 * map meets its pixel centres and changes nothing.
 */

typedef struct {
    uint32_t width, height; /* of the map and the evaluation picture, pixels */
    uint32_t steps;         /* of a whole ray; the termination depth of a ray that never ends */
    float steps_per_slice;  /* DVR steps of one low-resolution slice */
    uint8_t *label;         /* HS_LABEL_* per pixel */
    float *truth;           /* g: termination depth in the ground truth per pixel, steps */
    float *full;            /* the same in the full volume, unclipped */

    /* All rays: those of the sac, those of the fetus, those outside. */
    uint32_t count;       /* n of Eq. 4.6: sac and fetus */
    uint32_t first_fetus; /* rays 0 .. first_fetus - 1 are label 1, those up to count label 2 */
    uint32_t all;         /* rays count .. all - 1 are label 0 */
    uint32_t occluded;    /* rays whose occluder is in the way: full volume's e > HS_EVAL_TOLERANCE */
    uint32_t *pixel;      /* all: y * width + x */
    uint8_t *is_occluded; /* all: 0 or 1; 0 outside */
    int16_t *error;       /* all rows of steps + 1: e = g - d (Eq. 4.5) of the ray that starts there */
} hs_eval_table;

/* Builds the table for frame 0 of the loop, whose picture must be as large as its map, with step 1 and no
 * ghost. `truth` is the ground truth on the same grid as `full`; `label` has full->nx * full->ny pixels.
 * HS_ERR_USAGE, HS_ERR_INPUT (no pixel of labels 1 and 2), HS_ERR_MEMORY or HS_ERR_DEVICE; the table is
 * zeroed then. */
bool hs_eval_table_build(hs_eval_table *table, hs_loop *loop, const hs_volume *full, const hs_volume *truth,
                         const uint8_t *label, hs_error *err);
void hs_eval_table_free(hs_eval_table *table);

/* The first of `steps` steps that is drawn of a ray that starts at a depth of so many slices: the renderer's
 * rule (host_sim/render/dvr.h, CLIPPING), in its own precision. */
uint32_t hs_eval_start_step(float depth, float steps_per_slice, uint32_t steps);

/* -------------------------------------------------------------------------------------------- measures -- */
/* Quality of a depthmap by the termination depths of its rays (spec 7; thesis 4, Eq. 4.5 - 4.10). */

/* Mean errors are in DVR steps. e > 0: the ray ends too early, an occluder is left. e < 0: the fetus is
 * cut. */
typedef enum {
    HS_MEASURE_ABS, /* Eq. 4.6, over labels 1 and 2 */
    HS_MEASURE_POS, /* Eq. 4.8: over the rays with e > 0; 0 if there is none */
    HS_MEASURE_NEG, /* Eq. 4.10: over the rays with e < 0, as an absolute value; 0 if there is none */
    HS_MEASURE_ABS_SAC,
    HS_MEASURE_POS_SAC,
    HS_MEASURE_NEG_SAC,
    HS_MEASURE_ABS_FETUS,
    HS_MEASURE_POS_FETUS,
    HS_MEASURE_NEG_FETUS,
    HS_MEASURE_FETUS_CUT,     /* share of the fetus' rays with e < -HS_EVAL_TOLERANCE, 0 .. 1 */
    HS_MEASURE_OCCLUDER_LEFT, /* share of the occluded rays with e > HS_EVAL_TOLERANCE, 0 .. 1 */
    HS_MEASURE_ABS_OUTSIDE,   /* as Eq. 4.6, over label 0, which no other measure counts */
    HS_MEASURE_COUNT
} hs_measure;

/* "e_abs", "e_pos_fetus", ...: the column of the CSV files. */
const char *hs_measure_key(hs_measure measure);

/* All measures of one result. A measure over no ray at all (a label that does not occur) is NAN. */
typedef struct {
    float of[HS_MEASURE_COUNT];
} hs_measures;

/* The result of one depthmap; NULL: of the full volume, unclipped. */
void hs_eval_measure_map(const hs_eval_table *table, const float *map, hs_measures *out);

/* CRC-32 of a map's bytes: maps with the same are the same bits. */
uint32_t hs_eval_map_crc(const hs_eval_table *table, const float *map);

/* The direct way, from a picture of termination depths in steps: for tests and checks of the table. */
void hs_eval_measure_picture(const hs_eval_table *table, const float *termination, hs_measures *out);

/* Error e per pixel of such a picture, steps; NAN where the label is 0. */
void hs_eval_error_picture(const hs_eval_table *table, const float *termination, float *out);

/* ------------------------------------------------------------------------------------------------ case -- */
/* One case of the evaluation: a volume with its ground truth, a plugin on it, and the table of its rays. */

#define HS_EVAL_MAX_VALUES 64u /* parameter values of a frame */

/* A list of parameter values; a later one for the same parameter counts. */
typedef struct {
    sv_param_value at[HS_EVAL_MAX_VALUES];
    uint32_t count;
} hs_eval_values;

/* Adds a value, in the place of one of the same id. False (HS_ERR_USAGE) if the list is full. */
bool hs_eval_values_add(hs_eval_values *values, uint32_t id, double value, hs_error *err);

/* Adds "key=value" texts; errors name key and value. */
bool hs_eval_values_parse(hs_eval_values *values, const hs_plugin *plugin, const char *const *sets,
                          uint32_t count, hs_error *err);

#define HS_EVAL_MAX_LINE 64u /* positions of a parameter */

/* The positions of the plugin's knob (its primary parameter) that are looked at. */
typedef struct {
    bool exists; /* false: the plugin has no knob; then `count` is 1 and `value` means nothing */
    sv_param_info info;
    uint32_t count; /* 1 .. HS_EVAL_MAX_LINE */
    double value[HS_EVAL_MAX_LINE];
} hs_eval_knob;

/* `wanted` positions over the display range, ends included; fewer where its step does not allow more. */
void hs_eval_knob_spread(hs_eval_knob *knob, const hs_plugin *plugin, uint32_t wanted);

/* Owned by the caller; must not move while open. */
typedef struct {
    hs_eval_source from;
    hs_loop *loop; /* its picture is as large as the map */
    const hs_plugin *plugin;
    hs_eval_table table;
    float *map;         /* width * height slices: scratch */
    float *termination; /* the same in steps */
    uint64_t frame;     /* frames so far */
    double volume_max;  /* 0 .. 1, of the low-resolution volume, as the plugin reports it; 0: it does not */
} hs_eval_case;

/* Makes or reads the volume, the loop (with `fixed` for the parameters that only activate reads) and the
 * table, and runs the plugin once for volume_max. A plugin that cannot be activated is HS_ERR_PLUGIN here:
 * there is nothing to evaluate. `plugin` may be NULL: then there is the table alone, for maps from
 * elsewhere. */
bool hs_eval_case_open(hs_eval_case *c, const hs_cl *cl, const hs_plugin *plugin, const hs_eval_values *fixed,
                       const hs_eval_request *request, hs_error *err);
void hs_eval_case_close(hs_eval_case *c);

/* Ends the loop, so that another may use the plugin's instance, which serves one at a time. Then only
 * hs_eval_case_replace and hs_eval_case_close may follow; volume and table stay. */
void hs_eval_case_release(hs_eval_case *c);

/* Puts another plugin on the same volume; the table stays. HS_ERR_PLUGIN if it cannot be activated: then only
 * hs_eval_case_close may follow. */
bool hs_eval_case_replace(hs_eval_case *c, const hs_cl *cl, const hs_plugin *plugin,
                          const hs_eval_values *fixed, hs_error *err);

/* Measures one setting for every position of the knob. What the plugin does not clip (hs_outcome_clips)
 * is measured unclipped, as the host renders it. *outcome is the plugin's for the first position. */
bool hs_eval_case_measure(hs_eval_case *c, const hs_eval_values *values, const hs_eval_knob *knob,
                          hs_measures *out, sv_status *outcome, hs_error *err);

/* The direct way: the frame with these values, its picture of termination depths (into c->termination) by the
 * renderer, and Eq. 4.5 - 4.10 on that. The depthmap is in c->map; *outcome is the plugin's. */
bool hs_eval_case_direct(hs_eval_case *c, const hs_eval_values *values, hs_measures *out, sv_status *outcome,
                         hs_error *err);

/* Milliseconds from begin until the device has finished after end: the median of
 * `repeats` frames, 1 .. 15. */
bool hs_eval_case_time(hs_eval_case *c, const hs_eval_values *values, uint32_t repeats, double *ms,
                       hs_error *err);
