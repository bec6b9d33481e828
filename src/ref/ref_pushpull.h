/* SPDX-License-Identifier: MIT */
/* Push-pull: a pyramid of weighted means. */
#ifndef SV_REF_PUSHPULL_H
#define SV_REF_PUSHPULL_H

#include "ref/ref_method.h"

bool sv_ref_pushpull(const sv_ref_map *map, double *surface);

/* The plugin's method. */
extern const sv_ref_method sv_ref_method_pushpull;

#endif
