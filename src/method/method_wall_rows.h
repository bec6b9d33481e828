/* SPDX-License-Identifier: MIT */
/* Method wall's work, a work item a row of rays: cl/wall/wall_*.cl. */
#ifndef SV_METHOD_WALL_ROWS_H
#define SV_METHOD_WALL_ROWS_H

#include "method/method_wall_work.h"

extern const sv_wall_work sv_wall_rows;
extern const char *const sv_wall_rows_kernels[];
sv_source sv_wall_rows_source(void);

#endif
