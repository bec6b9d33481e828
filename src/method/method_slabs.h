/* SPDX-License-Identifier: MIT */
/* What the methods that take the slabs themselves share. */
#ifndef SV_METHOD_SLABS_H
#define SV_METHOD_SLABS_H

#include "method/method.h"

/* A launch of a method's kernel on a slab, with the arguments that all such kernels begin with: from the
 * texture to the scanned ranges, as cost_bins has them (cl/cost/cost_rays.cl). `unread`: any buffer; the
 * kernel gets it where frames bring no ranges. */
sv_launch sv_slab_launch(const sv_map *map, cl_kernel kernel, const char *name, const sv_placed_slab *slab,
                         cl_mem unread);

#endif
