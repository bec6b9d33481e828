/* SPDX-License-Identifier: MIT */
/*
 * The surface told by the wall (docs/surface.md): what its kernels, its definition and the C side all need to
 * know. All arithmetic up to the labels is of integers: probabilities in units of 1 / SV_WALL_SURE, costs of
 * rays in units of 1 / SV_WALL_ONE and of cells in units of 1 / SV_WALL_CELL_ONE.
 */
#ifndef SV_WALL_SHARED_H
#define SV_WALL_SHARED_H

#define SV_WALL_SURE       32768 /* a probability of 1 */
#define SV_WALL_ONE        128   /* a cost of 1 on a ray */
#define SV_WALL_CELL_ONE   2048  /* a cost of 1 in a cell */
#define SV_WALL_PER_MILLE  1000  /* shares and ranks of the settings */
#define SV_WALL_LANES      32    /* rows of what the method keeps of voxels and rays are padded to these */
#define SV_WALL_KERNEL     64    /* taps to either side of the lateral Gaussian, at most */
#define SV_WALL_KERNEL_ONE 256   /* their sum: two passes without rounding between them fit into 32 bits */
#define SV_WALL_REACH      7     /* voxels of a mean to either side, at most: its box has less than 2^12 */
#define SV_WALL_BESIDE     80    /* pixels to either side, at most */
#define SV_WALL_RUN        255   /* longest length of tissue or fluid that is told from a longer one */
#define SV_WALL_RATE_BITS  16    /* fraction of sv_wall_layout.rate */

/* What the distance to the fluid counts in a cell's own cost, in halves of what it counts elsewhere. */
#define SV_WALL_OWN_AWAY 5

/* ---- grey levels */
#define SV_WALL_TURNS         64  /* of the search for the split; it stood still after 12 at most */
#define SV_WALL_SMOOTH        4   /* levels to either side of each of two box filters over the histogram */
#define SV_WALL_LEVEL_ONE     256 /* a grey level: the wall's brightness lies between two */
#define SV_WALL_ROOT_ONE      256 /* a square root of a grey level */
#define SV_WALL_ODDS_BITS     12  /* fraction of ln of the odds, of spreads, of evidence */
#define SV_WALL_SPREAD_LEAST  205 /* 0.05: a wall of one single brightness */
#define SV_WALL_FAR_ABOVE     (32 << SV_WALL_ODDS_BITS) /* evidence is cut off here */
#define SV_WALL_LOGISTIC      193 /* entries of the logistic function, from evidence 0 to 12: */
#define SV_WALL_LOGISTIC_BITS 8   /* fraction of a step between them, a sixteenth */

/* Words of the tables, one behind the other. */
#define SV_WALL_ROOTS       0   /* square roots of the grey levels */
#define SV_WALL_ODDS        256 /* ln of their odds, signed; 257, so that each has a next one */
#define SV_WALL_CURVE       513 /* the logistic function; one more than it has */
#define SV_WALL_TABLE_WORDS 707

typedef enum {
    SV_WALL_SURFACE = 0,  /* the maps hold a surface */
    SV_WALL_NO_FLUID = 1, /* the grey levels show no fluid: depth and confidence are 0, nothing is clipped */
    SV_WALL_EMPTY = 2,    /* too little was scanned to tell, or it is of one grey level: the same */
    SV_WALL_NO_FETUS = 3  /* nothing behind the wall is brighter than it: the same */
} sv_wall_outcome;

/* What the settings become in voxels, labels and cells of one volume. By value; 32-bit members only, so both
 * compilers lay it out alike. */
typedef struct {
    unsigned int width, height, slices;
    unsigned int mean[3];         /* voxels to either side along x, y, z */
    unsigned int beside[2];       /* pixels to either side along x, y */
    unsigned int thin, gap, skin; /* slices; thin and gap at most 255 */
    unsigned int far;             /* slices: from this distance on the cost is full, at most 254 */
    unsigned int rate;         /* cost of a ray per slice of distance, with SV_WALL_RATE_BITS of fraction */
    unsigned int step, labels; /* slices of a label; label l is depth l * step */
    unsigned int cells_x, cells_y;
    unsigned int reach_x, reach_y; /* cells to either side that the Gaussian reaches */
    unsigned int kernel_x[SV_WALL_KERNEL + 1], kernel_y[SV_WALL_KERNEL + 1]; /* weights at 0, 1, .. cells */
    unsigned int cut, left, other;                                           /* of a ray */
    unsigned int slack;                                                      /* of a cell */
    unsigned int valley, fetus_share, wall_share, wall_rank, low_rank, high_rank; /* per mille */
    unsigned int assumed_wall;        /* per mille of mean tissue */
    int sure;                         /* sixteenths */
    int level, first, assumed_spread; /* fixed-point, SV_WALL_ODDS_BITS */
    unsigned int median;              /* 1: 3 x 3 median of the cells */
    float doubt;                      /* own cost at which a surface is as likely wrong as right */
} sv_wall_layout;

#endif
