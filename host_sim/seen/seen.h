/* SPDX-License-Identifier: MIT */
/*
 * smartvis_seen.so: how the machine sees a volume, for other programs in their own process: from numbers to
 * grey levels and what of them was scanned, and from there to the grid on which a plugin sees them. Python
 * calls it, so that smartvis.clip and host_sim run give a plugin the same bytes.
 *
 * Structs begin with their size, set by the caller; memory is the caller's, and lives until the call returns,
 * but for `levels`. Not for several threads at a time. A function that fails returns 0, and hs_seen_error
 * says why.
 */
#pragma once

#include "smartvis_plugin.h"

#include <stdint.h>

/* What is scanned (hs_padding). */
enum { HS_SEEN_AUTO = 0, HS_SEEN_ALL_SCANNED = 1, HS_SEEN_ZEROS = 2 };

typedef struct {
    uint32_t size, n[3]; /* voxels along x, y, z */
    double spacing[3];   /* mm; ignored if unsaid */
    uint32_t unsaid;     /* nobody knows the spacing */
    uint32_t padding;    /* HS_SEEN_* ; a `mask` takes its place */
    double direction[9]; /* row-major; column a is where index a grows to in the patient */
    uint32_t probe;      /* hs_probe: the face that the probe touches */
    uint32_t probe_said; /* ... and that is known */
    uint32_t apex_said;  /* where the lines meet that scanned it is known, */
    double apex[3];      /* ... mm along its axes from its corner; the probe is said, too */
    double
        window[2]; /* values that become 0 and 255; both 0: bytes as they are, other values by their range */
    const uint8_t *bytes; /* the voxels, x fastest, or ... */
    const double *values; /* ... the voxels as numbers */
    const uint8_t *mask;  /* 1 where a voxel was scanned, or NULL */
    const char *kretz; /* a Kretz file, if `bytes` are the Cartesian copy of a volume of it, or NULL; read */
    uint32_t number, mirrored; /* of it: which volume, and hs_kretz_options.mirrored */
    uint8_t *levels;           /* out, a byte a voxel: 0 was not scanned; read again by hs_seen_look */
    double low, high;          /* out: what became 0 and 255 */
    double outside;            /* out: what lies outside the scan, ... */
    uint32_t has_outside;      /* ... if a constant does */
    char doubt[200];           /* out: what is not plausible about the size, or "" */
    char question[160];        /* out: what to ask of where the probe was, or "" */
    char beams[160];           /* out: how they ran, and how sure that is (hs_course_words) */
    uint32_t has_beams;        /* out: it is seen in the probe's geometry */
    uint32_t fitted; /* out: the fan was fitted anew; else that of a volume with the same outline is meant */
    uint64_t found[160]; /* out: what was found of the scan; for hs_seen_plan and _look */
} hs_seen_volume;

typedef struct {
    uint32_t size;
    uint32_t turned;    /* `rotation` is where the camera looks; else from the probe's side */
    double rotation[9]; /* row-major: columns are the camera's right, down and forward in the volume's axes;
                           out */
    uint32_t lowres;    /* pixels across; 0: 1 mm each, as host_sim has it */
    uint32_t n[3];      /* out: width, height, slices */
    double box[2];      /* out: mm across, and deep */
    float probe_rotation[9], probe_side[3]; /* out: sv_frame's, with what follows */
    uint32_t beams;
    float beam_apex_mm[3], beam_sweep_mm;
} hs_seen_view;

/* The reason of the last failure in this thread; static. */
SV_EXPORT const char *hs_seen_error(void);

/* Fills in levels, and what is known of them. A Kretz file is seen as host_sim sees it, unless `bytes` are
 * no more what lies in it. What it took is given back by hs_seen_drop. */
SV_EXPORT int32_t hs_seen_take(hs_seen_volume *volume);
SV_EXPORT void hs_seen_drop(hs_seen_volume *volume);

/* Fills in the view's grid. */
SV_EXPORT int32_t hs_seen_plan(const hs_seen_volume *volume, hs_seen_view *view);

/* The voxels of that grid, n[2] * n[1] * n[0] bytes, and of every ray its first scanned slice and the first
 * one behind the scan, n[1] * n[0] pairs. The first call opens the device and builds kernels. */
SV_EXPORT int32_t hs_seen_look(const hs_seen_volume *volume, const hs_seen_view *view, uint8_t *voxels,
                               uint16_t *ranges);

/* Applies `count` marks, hs_mark of loop/marks.h, to a depthmap of that grid (hs_marks_apply). */
SV_EXPORT int32_t hs_seen_mark(const hs_seen_volume *volume, const hs_seen_view *view, const void *marks,
                               uint32_t count, float *depth);

/* A plugin's sv_confidence_report in words for who holds the probe; 0: it tells no reason. */
SV_EXPORT int32_t hs_seen_reason(const void *report, char words[320]);

/* Gives device and memory back. */
SV_EXPORT void hs_seen_close(void);
