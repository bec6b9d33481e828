/* SPDX-License-Identifier: MIT */
/* Method wall: the surface told by the wall (docs/surface.md). */
#ifndef SV_METHOD_WALL_H
#define SV_METHOD_WALL_H

#include "method/method.h"

extern const sv_method sv_method_wall;

#endif
