/* SPDX-License-Identifier: MIT */
/* How the tables of a scene file's fields are written. */
#ifndef HS_SCENE_FIELDS_H
#define HS_SCENE_FIELDS_H

#include "scene/scene_json.h"

#define HS_COUNT(a) (sizeof(a) / sizeof((a)[0]))
#define FIELD(type, member, kind, min, max, required)                                                        \
    { #member, HS_FIELD_##kind, offsetof(type, member), min, max, required }
#define NAMED(key, type, member, kind, min, max, required)                                                   \
    { key, HS_FIELD_##kind, offsetof(type, member), min, max, required }
#define OTHER(key, required)                                                                                 \
    { key, HS_FIELD_OTHER, 0, 0, 0, required }

#endif
