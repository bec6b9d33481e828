/* SPDX-License-Identifier: MIT */
/* The mean filter: what its kernels and the C side share. */
#ifndef SV_MEAN_SHARED_H
#define SV_MEAN_SHARED_H

/* Largest kernel size k of the mean filter, and the spare columns its row buffers need on top of the padded
 * width: (k - 1) / 2 zeros on either side, and one vector of slack for each of the reads that run ahead. */
#define SV_MAX_K     63
#define SV_ROW_SLACK 192

/* Planes of the reconstruction: weight * near end, weight * far end (fixed point), weight. */
#define SV_SUM_NEAR   0
#define SV_SUM_FAR    1
#define SV_SUM_WEIGHT 2
#define SV_SUM_PLANES 3

/* Scratch of a band in the mean filter: column sums, and a batch of rows of prefix sums. */
#define SV_MEAN_BATCH   4
#define SV_SCRATCH_ROWS (SV_SUM_PLANES * (1 + SV_MEAN_BATCH))

#endif
