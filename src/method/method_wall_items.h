/* SPDX-License-Identifier: MIT */
/* Method wall's work, a work item a ray, a block, a cell or a pixel: cl/wall/items_*.cl. */
#ifndef SV_METHOD_WALL_ITEMS_H
#define SV_METHOD_WALL_ITEMS_H

#include "method/method_wall_work.h"

extern const sv_wall_work sv_wall_items;
extern const char *const sv_wall_items_kernels[];
sv_source sv_wall_items_source(void);

#endif
