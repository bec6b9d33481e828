/* SPDX-License-Identifier: MIT */
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
 * Cost volume (docs/cost_volume.md). It works on rays of bins: at most SV_COST_LABELS along a ray, at most
 * 2 * SV_COST_RAYS rays along the longer side of the image. Lengths along a ray are in bins of a ray of
 * SV_COST_UNIT bins and grow and shrink with its number of bins.
 */
#define SV_COST_LABELS  192
#define SV_COST_UNIT    128.0
#define SV_COST_RAYS    128
#define SV_COST_VALUES  208   /* floats of a cell: the labels, then: */
#define SV_COST_WEIGHT  192   /* its rays' weights */
#define SV_COST_OPEN    193   /* the same of rays with a fluid interval */
#define SV_COST_CELLS   32    /* wanted cells along the longer side */
#define SV_COST_SIGMA   0.95f /* of the lateral Gaussian, in 32nds of the longer side */
#define SV_COST_REACH   4     /* cells the Gaussian spans to either side */
#define SV_COST_THIN    3     /* thinner tissue does not part fluid, and is nobody's */
#define SV_COST_GAP     6     /* shortest first fluid interval */
#define SV_COST_SOLID   2     /* a cell's wall and back are that many mostly fluid bins */
#define SV_COST_WINDOW  4     /* cells to either side whose walls and backs are ranked */
#define SV_COST_CONTACT 16    /* fluid that begins this much behind the wall: something touches the wall */
#define SV_COST_SPLIT   4     /* a run is parted where bone begins this far behind its front */
#define SV_COST_DILATE  2     /* brightness is looked for this far before and behind */
#define SV_COST_SLIM    9     /* a run so thick says nothing yet by its thickness, */
#define SV_COST_STOUT   14    /* one so thick all it can */
#define SV_COST_TAU     4.0f  /* distance to the fluid at which its cost is full */
#define SV_COST_CUT     3.0f  /* cutting into the fetus */
#define SV_COST_LEFT    2.0f  /* leaving what lies before the fetus' own fluid */
#define SV_COST_OTHER   3.0f  /* outside the longest interval, where there is no fetus */
/* Evidence that a run is the fetus, before the logistic function. Brightness is relative to the mean of
 * tissue. */
#define SV_COST_NEARBY    10.0f /* times the brightest mean nearby */
#define SV_COST_OWN       4.0f  /* times the brightest mean on the ray itself */
#define SV_COST_THICK     2.0f  /* if it is stout */
#define SV_COST_BIAS      (-19.0f)
#define SV_COST_WALL      11.0f /* what touches the wall: times the brightest mean nearby */
#define SV_COST_WALL_BIAS (-15.0f)
#define SV_COST_DOUBT     3.0f /* less for a sure run farther back */
#define SV_COST_SLACK     0.3f /* labels within this of the least cost count as the same minimum */
#define SV_COST_KNOWN                                                                                        \
    4.0f /* times the share of votes with fluid: where that is below 1, the surface goes to 0 */
#define SV_COST_MARGIN 0.4f /* lead over any other minimum that is full confidence */
#define SV_COST_YIELD  1.0f /* towards the viewer where nothing is sure, bins */
#define SV_COST_SPREAD 2.0f /* q = 0 and q = 1 lie this many standard deviations of the minimum away */

#define SV_COST_CHANGE   0.15f /* mean change of a cell's costs that makes it forget the frame before */
#define SV_COST_EVIDENCE 8     /* one ray in so many must have a fluid interval, or there is no surface */

/* Words of what the cost volume found out about a frame. */
#define SV_COST_INFO_LEVEL  0 /* T_L of the bins, as a grey level */
#define SV_COST_INFO_RAYS   1 /* scanned rays */
#define SV_COST_INFO_OPEN   2 /* rays with a fluid interval */
#define SV_COST_INFO_WANTED 3 /* 1: the frame has a surface */
#define SV_COST_INFO_BRIGHT 4 /* mean of tissue, as a grey level */
#define SV_COST_INFO_WORDS  5

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

/* Planes of the reconstruction: weight * near end, weight * far end (fixed point), weight. */
#define SV_SUM_NEAR   0
#define SV_SUM_FAR    1
#define SV_SUM_WEIGHT 2
#define SV_SUM_PLANES 3

/* Scratch of a band in the mean filter: column sums, and a batch of rows of prefix sums. */
#define SV_MEAN_BATCH   4
#define SV_SCRATCH_ROWS (SV_SUM_PLANES * (1 + SV_MEAN_BATCH))

/* Words of the frame's record on the device. The first are sv_stats of the ABI, word for word (`size` unused),
 * and those from SV_REC_EMPTY on sv_points_report, so that a read of the record is the host's struct. */
#define SV_REC_OUTCOME     1
#define SV_REC_RAYS        2
#define SV_REC_POINTS      3
#define SV_REC_UNFILLED    4
#define SV_REC_STATS_WORDS 5
#define SV_REC_EMPTY       5
#define SV_REC_PASSES      6
#define SV_REC_MAX         7 /* float bits, 0..1 */
#define SV_REC_TB          8 /* float bits, 0..1 */
#define SV_REC_SURE        9
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
