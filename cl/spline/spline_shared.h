/* SPDX-License-Identifier: MIT */
/* The spline solver: what its kernels and the C side share. */
#ifndef SV_SPLINE_SHARED_H
#define SV_SPLINE_SHARED_H

/* Points that the spline solver takes at most, and the finest grid that merges to no more than that. */
#define SV_SPLINE_MAX_POINTS 1400
#define SV_SPLINE_MAX_GRID   37

#define SV_SPLINE_PANEL 32 /* columns that the Cholesky factorisation takes at once */
#define SV_SPLINE_TILE  8  /* rows that one work item updates behind a panel */
#define SV_SPLINE_SPAN  64 /* and columns */

/* Sizes of the solver's buffers: vectors over the points, real numbers and whole numbers of a solution. */
#define SV_SPLINE_VECTORS     16
#define SV_SPLINE_FRAME_WORDS 31
#define SV_SPLINE_INFO_WORDS  2

#endif
