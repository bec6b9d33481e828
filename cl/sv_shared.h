/*
 * What the kernels and the C side both need to know: layouts, limits and words. Read by the OpenCL C compiler
 * and by the C compiler, so it holds only what means the same to both.
 */
#ifndef SV_SHARED_H
#define SV_SHARED_H

/* Rays a work item of the strip kernels holds in one vector. Rows of every per-ray map are padded to a
 * multiple. */
#define SV_LANES 16

/* Samples along a ray per slice (the inverse of the sampling step). Structure, not a tunable: it changes the
 * kernel. */
#ifndef SV_SUBSTEPS
#define SV_SUBSTEPS 1
#endif
#define SV_MAX_SUBSTEPS 4

/* Largest kernel size k of the mean filter, and the spare columns its row buffers need on top of the padded
 * width: (k - 1) / 2 zeros on either side, and one vector of slack for each of the reads that run ahead. */
#define SV_MAX_K     63
#define SV_ROW_SLACK 192

/* Points that the spline solver takes at most, and the finest grid that merges to no more than that. */
#define SV_SPLINE_MAX_POINTS 1400
#define SV_SPLINE_MAX_GRID   37

/* Steps of the membrane's and the plate's solver. */
#define SV_MAX_SOLVER_STEPS 96

/* Weight of a point in the membrane and the plate, against 1 for the smoothness. */
#define SV_MIN_DATA_WEIGHT 1e-3
#define SV_MAX_DATA_WEIGHT 10.0

/*
 * Cost volume (docs/cost_volume.md). A ray is kept as at most SV_COST_LABELS bins of slices along it. Lengths
 * are in bins of a ray of SV_COST_LABELS bins; a shorter volume has a bin a slice, and the lengths shrink
 * with it.
 */
#define SV_COST_LABELS  64
#define SV_COST_VALUES  80    /* floats of a cell: the labels, then: */
#define SV_COST_WEIGHT  64    /* scanned rays */
#define SV_COST_OPEN    65    /* rays with a fluid interval */
#define SV_COST_CELLS   32    /* wanted cells along the longer side of the image */
#define SV_COST_SIGMA   1.75f /* of the lateral Gaussian, in 32nds of the longer side */
#define SV_COST_REACH   6     /* cells the Gaussian spans to either side */
#define SV_COST_GAP     3.75f /* shortest fluid interval that counts */
#define SV_COST_TAU     2.0f  /* distance to the fluid at which its cost is full */
#define SV_COST_BEHIND  3.0f  /* behind the ray's maximum: K */
#define SV_COST_OTHER   0.4f  /* outside the interval before the maximum: g */
#define SV_COST_TISSUE  0.01f /* a bin of tissue cut through: gamma */
#define SV_COST_TISSUES 20.0f /* bins of tissue after which more do not count: T */
#define SV_COST_RANK    0.3f  /* rays ranked at or above this share have full confidence */
#define SV_COST_SLACK   0.05f /* labels within this of the least cost count as the same minimum */
#define SV_COST_MARGIN  0.4f  /* lead over any other minimum that is full confidence */
#define SV_COST_YIELD   3.0f  /* towards the viewer where nothing is sure, bins */
#define SV_COST_SPREAD  2.0f  /* q = 0 and q = 1 lie this many standard deviations of the minimum away */

#define SV_COST_CHANGE   0.15f /* mean change of a cell's costs that makes it forget the frame before */
#define SV_COST_EVIDENCE 8     /* one ray in so many must have a fluid interval, or there is no surface */

/* Words of what the cost volume found out about a frame. */
#define SV_COST_INFO_LEVEL  0 /* T_L of the bins, as a grey level */
#define SV_COST_INFO_RAYS   1 /* scanned rays */
#define SV_COST_INFO_OPEN   2 /* rays with a fluid interval */
#define SV_COST_INFO_WANTED 3 /* 1: the frame has a surface */
#define SV_COST_INFO_WORDS  4

/* Planes of what a ray came to, a byte each. */
#define SV_COST_FIRST   0 /* bin at which its first fluid interval begins; labels: none */
#define SV_COST_MAXIMUM 1 /* largest tissue bin behind that; 0: none */
#define SV_COST_PLACE   2 /* where that is; labels: none */
#define SV_COST_SCANNED 3 /* 1: some voxel was scanned */
#define SV_COST_PLANES  4

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

/* Planes of the reconstruction: weight * near end, weight * far end (fixed point), weight. */
#define SV_SUM_NEAR   0
#define SV_SUM_FAR    1
#define SV_SUM_WEIGHT 2
#define SV_SUM_PLANES 3

/* Scratch of a band in the mean filter: column sums, and a batch of rows of prefix sums. */
#define SV_MEAN_BATCH   4
#define SV_SCRATCH_ROWS (SV_SUM_PLANES * (1 + SV_MEAN_BATCH))

/* Words of the frame's record on the device. The first ten are sv_stats of the ABI, word for word (`size`
 * unused), so that a read of the record is the host's struct. */
#define SV_REC_OUTCOME  1
#define SV_REC_RAYS     2
#define SV_REC_POINTS   3
#define SV_REC_EMPTY    4
#define SV_REC_PASSES   5
#define SV_REC_UNFILLED 6
#define SV_REC_MAX      7 /* float bits, 0..1 */
#define SV_REC_TB       8 /* float bits, 0..1 */
#define SV_REC_SURE     9
#define SV_REC_WORDS    10
#define SV_REC_LEVEL    10 /* bone level 0..255: a ray is bone above it */
#define SV_REC_BONE     11 /* rays above it, whether they give a point or not */
#define SV_REC_EVIDENCE 12 /* sv_job.evidence */
#define SV_REC_PASS0    13 /* unfilled pixels after pass 0, 1, ...; up to the pass limit */

/* What a frame asks of the kernels; passed to them by value. 32-bit members only, so both compilers lay it
 * out alike. */
typedef struct {
    unsigned int width, padded_width, height;
    unsigned int bone_mode;   /* SV_BONE_* */
    unsigned int fluid_level; /* T_L as a grey level: tissue lies above it */
    unsigned int bone_level;  /* absolute mode: T_B as a grey level */
    unsigned int bone_drop;   /* offset mode: grey levels below the volume's maximum */
    unsigned int bone_wanted; /* fraction mode: rays that must qualify at least, >= 1 */
    unsigned int drop_empty;  /* 1: rays with an empty interval give no point */
    unsigned int min_gap;     /* samples: an interval at least this long is sure to be fluid */
    unsigned int
        evidence; /* 1/1000 of the bone rays that must have a sure interval, or there is no surface */
    unsigned int fraction;                      /* fraction bits of a depth */
    unsigned int k;                             /* mean filter: window, odd */
    unsigned int weight_initial, weight_filled; /* mean filter: integer weights, their ratio is omega */
    unsigned int pass_limit;                    /* passes that are enough for any set of points */
} sv_job;

/* Slabs that one launch takes: a launch costs as much as a million voxels. They follow each other, in one
 * buffer. */
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
