/* SPDX-License-Identifier: MIT */
/*
 * Cost volume (docs/cost_volume.md): what its kernels, its definition and the C side share. It works on rays
 * of bins: at most SV_COST_LABELS along a ray, at most 2 * SV_COST_RAYS rays along the longer side of the
 * image. Lengths along a ray are given in units of SV_COST_UNIT_MM and become bins by the spacing.
 */
#ifndef SV_COST_SHARED_H
#define SV_COST_SHARED_H

/* ---- sizes */
#define SV_COST_LABELS  192
#define SV_COST_UNIT_MM 0.9375f /* mm: unit of lengths along a ray, a 128th of 120 mm */
#define SV_COST_RAYS    128
#define SV_COST_VALUES  208 /* floats of a cell: the labels, then: */
#define SV_COST_WEIGHT  192 /* its rays' weights */
#define SV_COST_OPEN    193 /* weights of the rays with a fluid interval */
#define SV_COST_CELLS   32  /* wanted cells along the longer side */

/* ---- fluid and tissue along a ray; lengths in SV_COST_UNIT_MM, but for the window */
#define SV_COST_THIN    3  /* thinner tissue does not split fluid, and belongs to no run */
#define SV_COST_GAP     6  /* shortest first fluid interval */
#define SV_COST_SOLID   2  /* a cell's wall and back are that long and mostly fluid */
#define SV_COST_WINDOW  4  /* cells to either side whose walls and backs are ranked */
#define SV_COST_CONTACT 16 /* fluid that begins this much behind the wall: something touches the wall */
#define SV_COST_SPLIT   4  /* a run is split where bone begins this far behind its front */

/* ---- brightness: means of 3 x 3 x 3 bins, kept as sums */
#define SV_COST_NEIGHBOURS 27 /* bins of such a sum */
#define SV_COST_AXIAL      2  /* brightness is dilated this far in front and behind, SV_COST_UNIT_MM */
#define SV_COST_BONE       3  /* half the tissue's mean: a run so many times as bright holds bone */
#define SV_COST_FRONT      9  /* tenths of the run's maximum brightness: from there on it is bone */

/* ---- what a label pays */
#define SV_COST_TAU         4.0f /* distance to the fluid at which its cost is full, SV_COST_UNIT_MM */
#define SV_COST_CUT         3.0f /* cutting into the fetus */
#define SV_COST_OCCLUDER    2.0f /* leaving what lies in front of the fetus' own fluid */
#define SV_COST_WRONG_FLUID 3.0f /* outside the longest interval, where there is no fetus */

/* ---- evidence that a run is the fetus, before the logistic function; brightness relative to the
 * mean of tissue */
#define SV_COST_NEARBY         10.0f /* times the brightest mean nearby */
#define SV_COST_OWN            4.0f  /* times the brightest mean on the ray itself */
#define SV_COST_THICK          2.0f  /* times how thick it is: */
#define SV_COST_THICK_FROM     9     /* 0 up to this thickness, SV_COST_UNIT_MM, */
#define SV_COST_THICK_FULL     14    /* and 1 from this one on */
#define SV_COST_BIAS           (-19.0f)
#define SV_COST_WALL           11.0f /* what touches the wall: times the brightest mean nearby */
#define SV_COST_WALL_BIAS      (-15.0f)
#define SV_COST_BEHIND_PENALTY 3.0f /* subtracted, times the probability of a run farther back */

/* ---- from the costs to the surface */
#define SV_COST_SIGMA          0.95f /* of the lateral Gaussian, in 32nds of the longer side */
#define SV_COST_REACH          4     /* cells the Gaussian spans to either side */
#define SV_COST_AVERAGE_MARGIN 0.3f  /* labels within this of the minimum are averaged */
#define SV_COST_KNOWN                                                                                        \
    4.0f /* times the share of votes with fluid; below 1 the depth is that much nearer to 0 */
#define SV_COST_MARGIN       0.4f /* lead over any other minimum that gives full confidence */
#define SV_COST_VIEWER_SHIFT 1.0f /* shift towards the viewer at no confidence, SV_COST_UNIT_MM */
#define SV_COST_SPREAD       2.0f /* q = 0 and q = 1 lie this many standard deviations of the minimum away */
#define SV_COST_CHANGE       0.15f /* mean change of a cell's costs from which on the frame before is dropped */
#define SV_COST_EVIDENCE     8     /* one ray in so many must have a fluid interval, or there is no surface */

/* Words of what is known of a frame. */
#define SV_COST_INFO_LEVEL  0 /* T_L of the bins, as a grey level */
#define SV_COST_INFO_RAYS   1 /* scanned rays */
#define SV_COST_INFO_OPEN   2 /* rays with a fluid interval */
#define SV_COST_INFO_WANTED 3 /* 1: the frame has a surface */
#define SV_COST_INFO_BRIGHT 4 /* mean of tissue, as a grey level */
#define SV_COST_INFO_WORDS  5

/* Sizes and lengths for a volume. It is passed by value and has 32-bit members only, so both compilers lay
 * it out alike. */
typedef struct {
    unsigned int width, height, slices; /* of the volume */
    unsigned int shrink;                /* pixels along the side of a ray */
    unsigned int columns, rows;         /* rays */
    unsigned int padded_columns;        /* rays of a row in the bins on the device, a multiple of SV_LANES */
    unsigned int bin_slices, labels;    /* slices of a bin, bins of a ray */
    unsigned int block;                 /* rays along the side of a cell */
    unsigned int cells_x, cells_y;
    unsigned int thin, gap, solid, contact, split, axial; /* bins */
    unsigned int lateral; /* rays to either side that brightness is dilated over */
    float scale;          /* bins in SV_COST_UNIT_MM */
} sv_cost_layout;

/* Returns the rows of rays around a row of cells that the dilation reads, the cells' own among them. */
static inline unsigned int sv_cost_ring_rows(const sv_cost_layout *l) {
    return l->block + 2 * l->lateral;
}

#endif
