/* SPDX-License-Identifier: MIT */
/* Ray profiles (spec 3; thesis Algorithm 4.1, lines 2-14). */
#ifndef SV_REF_PROFILE_H
#define SV_REF_PROFILE_H

#include "ref/ref_volume.h"

/* What is known of a ray at its end. Depths in slices. */
typedef struct {
    uint8_t maximum;  /* largest intensity */
    double max_entry; /* entry into tissue current at the (first) maximum: far end d_f of the interval */
    double max_exit;  /* exit from tissue current there: near end d_n */
} sv_ref_ray;

/* rays: width * height, row by row. `substeps` samples per slice (1 .. 4), linear in between. */
void sv_ref_profile(const sv_ref_volume *volume, double fluid_threshold, uint32_t substeps, sv_ref_ray *rays);

#endif
