/* SPDX-License-Identifier: MIT */
/* The minimum filter: what its kernels and the C side both need to know. */
#ifndef SV_MINIMUM_SHARED_H
#define SV_MINIMUM_SHARED_H

/* Empty columns to either side of a row: at least half of the largest window. */
#define SV_MIN_MARGIN 32

#endif
