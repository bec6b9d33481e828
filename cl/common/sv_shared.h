/* SPDX-License-Identifier: MIT */
/*
 * What the kernels and the C side share: layouts, limits and words. The OpenCL C compiler and the C compiler
 * read it, so it holds only what means the same to both.
 */
#ifndef SV_SHARED_H
#define SV_SHARED_H

/* Rays a work item of the strip kernels holds in one vector. Rows of every per-ray map are padded
 * to a multiple. */
#define SV_LANES 16

/* Samples along a ray per slice (the inverse of the sampling step). Structure, not a tunable: it
 * changes the kernel. */
#ifndef SV_SUBSTEPS
#define SV_SUBSTEPS 1
#endif
#define SV_MAX_SUBSTEPS 4

/* Status map, as in smartvis_plugin.h. */
#define SV_STATUS_NONE    0
#define SV_STATUS_INITIAL 1
#define SV_STATUS_EMPTY   2

/* Bone threshold modes (spec 3). */
#define SV_BONE_ABSOLUTE 0
#define SV_BONE_OFFSET   1
#define SV_BONE_FRACTION 2

/* Planes of the 8-bit and of the 16-bit ray state; a plane is padded_width * height values. Depths are
 * counted in samples: slice * SV_SUBSTEPS. */
#define SV_STATE_MAX       0 /* largest intensity so far */
#define SV_STATE_TISSUE    1 /* 255 if the last scanned sample was tissue, else 0 */
#define SV_STATE_LAST      2 /* voxel of the last slice (used for SV_SUBSTEPS > 1) */
#define SV_STATE8_PLANES   3
#define SV_STATE_ENTRY     0 /* last entry into tissue */
#define SV_STATE_EXIT      1 /* last exit from tissue, that is entry into fluid */
#define SV_STATE_MAX_ENTRY 2 /* entry that was current when the maximum was met */
#define SV_STATE_MAX_EXIT  3 /* exit that was current when the maximum was met */
#define SV_STATE16_PLANES  4

/* Planes of the scanned ranges: a ray's slices first .. end - 1 were scanned. */
#define SV_SCANNED_FIRST  0
#define SV_SCANNED_END    1
#define SV_SCANNED_PLANES 2

/* Words of the frame's record on the device. The first are sv_stats of the ABI, word for word
 * (`size` unused), and those from SV_REC_EMPTY on sv_points_report, so that a read of the record is
 * the host's struct. */
#define SV_REC_OUTCOME     1
#define SV_REC_RAYS        2
#define SV_REC_POINTS      3
#define SV_REC_UNFILLED    4
#define SV_REC_STATS_WORDS 5
#define SV_REC_EMPTY       5
#define SV_REC_PASSES      6
#define SV_REC_MAX         7 /* float bits, 0..1 */
#define SV_REC_TB          8 /* float bits, 0..1 */
#define SV_REC_EVIDENT     9
#define SV_REC_LEVEL       10 /* bone level 0..255: a ray is bone above it */
#define SV_REC_BONE        11 /* rays above it, whether they give a point or not */
#define SV_REC_EVIDENCE    12 /* sv_job.evidence */
#define SV_REC_PASS0       13 /* unfilled pixels after pass 0, 1, ...; up to the pass limit */

/* What a frame asks of the kernels. It is passed by value and has 32-bit members only, so both compilers lay
 * it out alike. */
typedef struct {
    unsigned int width, padded_width, height;
    unsigned int bone_mode;   /* SV_BONE_* */
    unsigned int fluid_level; /* T_L as a grey level: tissue lies above it */
    unsigned int bone_level;  /* absolute mode: T_B as a grey level */
    unsigned int bone_drop;   /* offset mode: grey levels below the volume's maximum */
    unsigned int bone_wanted; /* fraction mode: rays that must qualify at least, >= 1 */
    unsigned int drop_empty;  /* 1: rays with an empty interval give no point */
    unsigned int min_gap;     /* samples: an interval at least this long is evidence of fluid */
    unsigned int evidence; /* thousandths of the bone rays that must have such an interval, or no surface */
    unsigned int fraction; /* fraction bits of a depth */
    unsigned int k;        /* mean filter: window, odd */
    unsigned int weight_initial, weight_filled; /* mean filter: integer weights, their ratio is omega */
    unsigned int pass_limit;                    /* passes that are enough for any set of points */
} sv_job;

/* Slabs that one launch takes: a launch costs as much as a million voxels. They follow each other,
 * in one buffer. */
#define SV_BATCH 8
#ifdef __OPENCL_VERSION__
typedef ulong sv_offset;
#else
typedef unsigned long long sv_offset;
#endif
typedef struct {
    sv_offset offset[SV_BATCH];    /* bytes from the buffer's start to each slab's texture */
    unsigned int slices[SV_BATCH]; /* slices of each slab */
    unsigned int count;            /* slabs */
    unsigned int first_slice;      /* of the first slab */
} sv_batch;

#define SV_OUTCOME_OK         0
#define SV_OUTCOME_NO_SURFACE 1
#define SV_OUTCOME_PARTIAL    2

#endif
