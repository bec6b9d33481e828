/* SPDX-License-Identifier: MIT */
/* Fits of fans that are kept: a volume with the same grid, outline and words on its probe as one before has
 * the same fan, to the bit. */
#pragma once

#include "volume/volume.h"

typedef struct hs_fit hs_fit;
struct border; /* of fan_shape.h, whose short names are for few */

enum { HS_FITS_KEPT = 4 };

/* The last fits, for volumes of one scan: zeroed, there are none. */
typedef struct {
    hs_fit *kept[HS_FITS_KEPT]; /* owned */
    uint32_t next;
} hs_fits;
void hs_fits_free(hs_fits *fits);

/* What a fit of this outline begins from; NULL without memory, which keeps nothing. */
hs_fit *hs_fit_begin(const hs_volume *volume, const struct border *b);

/* Keeps what the fit said of the volume, instead of the oldest. NULL is allowed; `fits` owns it from then on.
 */
void hs_fits_keep(hs_fits *fits, hs_fit *fit, const hs_volume *volume);

/* Says of the volume what was found for the same outline. False: there was none. */
bool hs_fits_recall(const hs_fits *fits, hs_volume *volume, const struct border *b);
