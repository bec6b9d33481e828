/* SPDX-License-Identifier: MIT */
/* The constants of the wall's surface by their names. */
#ifndef WALL_CONSTANT_H
#define WALL_CONSTANT_H

#include "wall_layout.h"

/* The field of that name, "block_mm" or another number of sv_wall_settings; NULL if there is none. */
double *wall_constant(sv_wall_settings *s, const char *key);

#endif
