/* SPDX-License-Identifier: MIT */
/* Volumes on which clipping can only do harm, made from cases of a site and from volumes without a truth. */
#ifndef SITE_VARIANT_H
#define SITE_VARIANT_H

#include "judge/wall_case.h"

/* Made from a case with a truth. What becomes fluid gets levels of the case's own
 * fluid, unless it is black. */
typedef enum {
    SITE_BARE,       /* all before the true surface is fluid: nothing hides the fetus */
    SITE_BARE_BLACK, /* the same, and that fluid is 0 */
    SITE_NO_FETUS,   /* all behind the true surface is fluid; the labelled rays are sac */
    SITE_BLADDER,    /* an ellipsoid of fluid, 40 mm wide, in the front tissue; the truth is the case's */
    SITE_VARIANTS
} site_variant;

/* "bare, noisy fluid", ... */
const char *site_variant_name(site_variant kind);

/* HS_ERR_INPUT if the case has no fluid or no label. */
bool site_variant_make(const wall_case *from, site_variant kind, wall_case *out, hs_error *err);

/* Made from a volume that nothing hides: every ray that ends on tissue is labelled fetus, and its own end is
 * the truth. */
typedef enum {
    SITE_AS_IT_IS,
    SITE_NO_RANGES,   /* all was scanned: what lies outside the fan is black fluid */
    SITE_FLUID,       /* behind 16 slices of noisy fluid */
    SITE_BLACK_FLUID, /* the same with fluid of 0 */
    SITE_BARE_VIEWS
} site_bare_view;

const char *site_bare_view_name(site_bare_view kind);

bool site_bare_view_make(const wall_case *from, site_bare_view kind, wall_case *out, hs_error *err);

/* The scene `real`: its occluders before a volume that nothing hides, with a truth. Writes the volume to a
 * temporary file for a while. */
bool site_occluded_make(const wall_case *from, wall_case *out, hs_error *err);

#endif
