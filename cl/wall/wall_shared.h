/* SPDX-License-Identifier: MIT */
/*
 * The surface told by the wall (docs/surface.md): what its kernels, its definition and the C side share. The
 * volume is first reduced to blocks of about 2 mm, which overlap by half across the image. A column of blocks
 * is a ray, and a slice of them a layer. Two by two rays are a cell. All arithmetic up to the cheapest layer
 * is of integers: probabilities in units of 1 / SV_WALL_PROBABILITY_ONE, costs in units of 1 /
 * SV_WALL_COST_ONE, smoothed costs in units of 1 / SV_WALL_FINE_COST_ONE.
 */
#ifndef SV_WALL_SHARED_H
#define SV_WALL_SHARED_H

#define SV_WALL_PROBABILITY_ONE 32768 /* a probability of 1 */
#define SV_WALL_LIKELY          16384 /* a cell of tissue counts as the fetus from this probability on */
#define SV_WALL_POSSIBLE        9830  /* 0.3: from this probability of the fetus on a ray keeps its surface */
#define SV_WALL_COST_ONE        128   /* a cost of 1 */
#define SV_WALL_FINE_COST_ONE   2048  /* a cost of 1 after the Gaussian */
#define SV_WALL_PER_MILLE       1000  /* shares and ranks of the settings */
#define SV_WALL_LANES           32    /* rows of blocks, rays and cells are padded to a multiple of this */
#define SV_WALL_BESIDE          32    /* zeros beside rows of levels: as many as lanes, so these lie well */
#define SV_WALL_LAYERS          8     /* layers of the cells' classes are padded to a multiple of this */
#define SV_WALL_BLOCK           10    /* voxels along a side of a block, at most */
#define SV_WALL_SPAN            12    /* voxels that a side of a block touches, at most */
#define SV_WALL_SPAN_ONE        16    /* sum of their weights: the rows of a layer sum up to 16 bits */
#define SV_WALL_KERNEL          64    /* taps to either side of the lateral Gaussian, at most */
#define SV_WALL_KERNEL_ONE      64 /* sum of these taps: two passes without rounding are exact in float32 */
#define SV_WALL_AXIAL_SUM       6  /* weights 1, 4, 1 along a ray smooth layers of one slice */
#define SV_WALL_MAJORITY        3  /* so many of a cell's four rays make it tissue, or wall */
#define SV_WALL_NEAR_FIELD      5 /* one ray of so many must begin with a few dark layers: they are no fluid */
#define SV_WALL_OWN_FLUID       2   /* so many dark blocks near a ray's surface: it has fluid of its own */
#define SV_WALL_PLACE_ONE       256 /* of a layer, where a surface goes on from its rim */
#define SV_WALL_MAX_NEIGHBOUR   64  /* rays or cells to a neighbour, at most */
#define SV_WALL_MAX_WINDOW      7   /* cells to either side that tell what is bright, at most: the sums and */
#define SV_WALL_MAX_LAYERS      8   /* counts of a window's layer have 22 and 10 bits, all sums have 24 */
#define SV_WALL_SUM_BITS        22  /* of a word that holds a sum and a count */
#define SV_WALL_MAX_DISTANCE    254 /* largest distance to the fluid, layers */
#define SV_WALL_RATE_BITS       7   /* fraction of sv_wall_layout.rate */

/* ---- grey levels */
#define SV_WALL_MAX_ITERATIONS 64  /* of the search for the split; it ended after 12 at most */
#define SV_WALL_TISSUE         128 /* tissue is brighter, relative to the threshold around it; and it is at */
#define SV_WALL_DIM_TISSUE     129 /* least that: what a dim block at the start of a scan becomes */
#define SV_WALL_ALL_DIM        32767 /* of sv_wall_layout.dim_front: more layers than a ray has */
#define SV_WALL_VALLEY_REACH   2     /* rays to every side whose levels are summed for a valley */
#define SV_WALL_VALLEY_ONE     8 /* units of sv_wall_layout.valley: eight sums of 25 levels have 16 bits */
#define SV_WALL_BRIGHT_ONE     4 /* units of the brightness around a block */
#define SV_WALL_GAINS          (256 * SV_WALL_BRIGHT_ONE) /* a gain for each of these brightnesses, */
#define SV_WALL_GAIN_BITS      8                          /* with this fraction */
#define SV_WALL_LEVEL_ONE      256 /* units of a grey level; the wall's brightness lies between two */
#define SV_WALL_ROOT_BITS      8   /* fraction of a square root of a grey level */
#define SV_WALL_ROOT_ONE       (1 << SV_WALL_ROOT_BITS)
#define SV_WALL_ODDS_BITS      12  /* fraction of ln of the odds, of spreads, of evidence */
#define SV_WALL_MIN_SPREAD     819 /* 0.2, for a wall of one single brightness */
#define SV_WALL_MAX_EVIDENCE   (32 << SV_WALL_ODDS_BITS) /* the evidence is clamped to this */
#define SV_WALL_LOGISTIC       193 /* entries of the logistic function, from evidence 0 to 12: */
#define SV_WALL_LOGISTIC_BITS  8   /* fraction of a step between them, a sixteenth */

/* Offsets of the tables, in words. */
#define SV_WALL_ROOTS       0   /* square roots of the grey levels */
#define SV_WALL_ODDS        256 /* ln of the odds, signed; 257 entries, so that each level has a next one */
#define SV_WALL_CURVE       513 /* the logistic function and one entry more */
#define SV_WALL_SINES       707 /* sines from 0 to a right angle, SV_WALL_SINE_BITS, and one entry more */
#define SV_WALL_TABLE_WORDS (707 + SV_WALL_SINE_STEPS + 2)

/* ---- along the beams: fixed-point */
#define SV_WALL_SINE_STEPS    256
#define SV_WALL_SINE_BITS     30
#define SV_WALL_ANGLE_BITS    24 /* a right angle */
#define SV_WALL_MM_BITS       8  /* fractions of a millimetre, */
#define SV_WALL_POSITION_BITS 16 /* of a position in the camera's blocks, */
#define SV_WALL_PART_ONE      16 /* of a block, where a level lies between two */
#define SV_WALL_VECTOR_BITS   24 /* and of blocks a millimetre */
#define SV_WALL_LINES         64 /* lines of a plane of beams, for kernels: bits of a word */

/* Planes of what is known of limbs, each a word of lines for each layer of a plane of beams. */
#define SV_WALL_LIMBS_TISSUE 0
#define SV_WALL_LIMBS_SOURCE 1 /* wall, and what was not scanned */
#define SV_WALL_LIMBS_FLOAT  2 /* tissue between fluid; later, what of it floats */
#define SV_WALL_LIMBS_ABOVE  3 /* reached from above */
#define SV_WALL_LIMBS_NEAR   4 /* the near field that was skipped */
#define SV_WALL_LIMBS_PLANES 5

/* Words of what is known of the frame. */
#define SV_WALL_INFO_OUTCOME       0
#define SV_WALL_INFO_THRESHOLD     1
#define SV_WALL_INFO_BRIGHT        2 /* mean of the bright class, in units of 1 / SV_WALL_LEVEL_ONE */
#define SV_WALL_INFO_RAYS          3
#define SV_WALL_INFO_WALL_RAYS     4
#define SV_WALL_INFO_FLUID         5 /* the darkest blocks have at most this grey level */
#define SV_WALL_INFO_DOUBTFUL      6 /* 1: the surface is doubtful */
#define SV_WALL_INFO_BARE          7 /* 1: there is no wall */
#define SV_WALL_INFO_PROBABILITIES 8 /* of 256 brightnesses: p of a later run * 65536 + p of a first run */
#define SV_WALL_INFO_FETUS         264 /* from this brightness on a cell of a later run is the fetus; 256: none */
#define SV_WALL_INFO_FOUND         265 /* of 1000: the share that the outcome is about, */
#define SV_WALL_INFO_WANTED        266 /* and the limit that it was held to */
#define SV_WALL_INFO_LAST          267 /* the outcome as sv_wall_layout.last has it; the next frame reads it */
#define SV_WALL_INFO_UNSEEN        268 /* 1: too few rays show a fetus that is brighter than the wall */
#define SV_WALL_INFO_LAST_FOUND    269 /* FOUND and WANTED of LAST, which hold */
#define SV_WALL_INFO_LAST_WANTED   270 /* for a volume, though limbs are found anew for every camera */
#define SV_WALL_INFO_GAINS         271 /* what levels are multiplied by, for each brightness around them */
#define SV_WALL_INFO_WORDS         (SV_WALL_INFO_GAINS + SV_WALL_GAINS)

/* Without a surface depth and confidence are 0, and nothing is clipped. */
typedef enum {
    SV_WALL_SURFACE = 0,  /* the maps hold a surface */
    SV_WALL_NO_FLUID = 1, /* the surface lies in no fluid that counts */
    SV_WALL_EMPTY = 2,    /* too little was scanned, or all of it has one grey level */
    SV_WALL_NO_FETUS =
        3, /* nothing behind the wall is brighter than the wall, and no clear fluid before it */
    SV_WALL_DOUBTFUL =
        4,           /* most that is as dark as fluid lies elsewhere; a surface if layout.clip_doubtful */
    SV_WALL_OPEN = 5 /* as SV_WALL_NO_FLUID: the scan begins in the fluid, so nothing hides the fetus */
} sv_wall_outcome;

/* As sv_wall_layout.last, for kernels: what SV_WALL_INFO_LAST has. */
#define SV_WALL_REMEMBERED 6

/* The voxels of a block along one axis, first .. first + count - 1. A voxel weighs as much as lies in the
 * block. The weights add up to SV_WALL_SPAN_ONE. */
typedef struct {
    unsigned int first, count;
    unsigned char weight[SV_WALL_SPAN];
} sv_wall_span;

/* The same of SV_WALL_TOGETHER neighbouring rays, so that all of them take neighbouring voxels at a time:
 * weight [k][i] of ray i is that of voxel shift + i + k. Behind the spans in their buffer; count 0: they lie
 * too far apart. */
#define SV_WALL_TAPS     8
#define SV_WALL_TOGETHER 16
typedef struct {
    int shift;
    unsigned int count;
    unsigned char weight[SV_WALL_TAPS][SV_WALL_TOGETHER];
} sv_wall_taps;

/* The settings in voxels, blocks and layers of one volume. It is passed by value and has 32-bit members
 * only, so both compilers lay it out alike. */
typedef struct {
    unsigned int width, height, slices; /* voxels */
    unsigned int columns, rows, layers; /* rays across, rays down, blocks of a ray */
    unsigned int cells[2];              /* across and down: half as many as rays */
    unsigned int depth;                 /* slices of a layer; the last one may have less */
    unsigned int smoothed;       /* 1: a layer is one slice, and its levels are smoothed along the rays */
    unsigned int dilation[2];    /* cells to either side along x, y */
    unsigned int window[3];      /* cells and layers to either side that tell what is bright */
    unsigned int bright_blocks;  /* the mean of all that is bright counts as so many blocks there */
    unsigned int dim;            /* a block is dim if it is brighter, relative to the threshold */
    unsigned int darkness;       /* certainty that it is fluid, per level below the threshold */
    unsigned int valley;         /* of SV_WALL_VALLEY_ONE; 0: no valley parts a run */
    unsigned int near_field;     /* layers, */
    unsigned int skin;           /* and these, too */
    unsigned int dim_front;      /* layers of a dim front that are no wall before a gap */
    unsigned int full_distance;  /* layers: from this distance to the fluid on the cost is full */
    unsigned int rate;           /* cost per layer of distance, with SV_WALL_RATE_BITS of fraction */
    unsigned int median_step[2]; /* rays between the samples of the median */
    unsigned int opening[2][2];  /* rays to either side that a sure and a doubtful surface are opened over */
    unsigned int reach_x, reach_y; /* cells to either side that the Gaussian reaches */
    unsigned int kernel_x[SV_WALL_KERNEL + 1], kernel_y[SV_WALL_KERNEL + 1]; /* weights at 0, 1, .. cells */
    unsigned int cut_cost, occluder_cost;     /* in units of 1 / SV_WALL_COST_ONE */
    unsigned int average_margin, knob_margin; /* in units of 1 / SV_WALL_FINE_COST_ONE */
    /* per mille */
    unsigned int threshold, dark_rank, fluid_rank, gap_share, doubtful_share, seen_share, clear_share;
    unsigned int hysteresis; /* limits of shares are so far in favour of the outcome that was */
    unsigned int last;       /* sv_wall_outcome of the frame before, SV_WALL_EMPTY if there was none; or */
                             /* SV_WALL_REMEMBERED */
    unsigned int tail_rank;
    unsigned int assumed_wall;        /* per mille of mean tissue */
    int slope;                        /* of the logistic function, sixteenths */
    unsigned int one_side;            /* in units of 1 / SV_WALL_PROBABILITY_ONE */
    int fetus_level, first_run_extra; /* fixed-point, SV_WALL_ODDS_BITS, */
    int assumed_spread;               /* and this one, too */
    unsigned int median;              /* 1: take the median of a ray and its eight neighbours */
    float q;                          /* the knob */
    unsigned int told;                /* 1: the beams say whether there is a surface */
    unsigned int clip_doubtful;       /* 1: a doubtful surface clips, too, and is */
    float doubtful_confidence;        /* so sure where another has 1 */
    float half_confidence_cost;       /* cost of the surface at which the confidence is one half; for that, */
                                      /* a layer as bright as the threshold costs 1 more */
} sv_wall_layout;

/*
 * A grid along the beams: its rays are lines i of planes j, its layers samples k, and all lie in the blocks
 * of a camera. Along axis a of these (columns, rows, layers, counted from the middle of block 0) sample k of
 * a line at angle th in a plane at angle ph lies at axis[a] + h (y[a] sin ph + z[a] cos ph) + r x[a] sin th,
 * h = r cos th - sweep, r = first + k * step. So it is the torus of smartvis_plugin.h. Lines are `line_angle`
 * apart, planes `plane_angle`, and the middle of the grid is at 0. It has 32-bit members only, like the
 * layout.
 */
typedef struct {
    unsigned int columns, rows, layers; /* of the camera's blocks */
    unsigned int lines, planes, samples;
    int line_angle, plane_angle; /* of SV_WALL_ANGLE_BITS to a right angle */
    int first, step, sweep;      /* SV_WALL_MM_BITS */
    int axis[3];                 /* the sweep's axis, SV_WALL_POSITION_BITS */
    int x[3], y[3], z[3];        /* the probe's axes, blocks a millimetre, SV_WALL_VECTOR_BITS */
    int near[3];                 /* what is so near a sample along the axes is there, SV_WALL_POSITION_BITS */
} sv_wall_grid;

#endif
