/* SPDX-License-Identifier: MIT */
/* Which scenes there are, and where their files stand. */
#ifndef HS_SCENE_NAMES_H
#define HS_SCENE_NAMES_H

#include "base/error.h"

#include <stddef.h>
#include <stdint.h>

typedef enum {
    HS_SCENES_THESIS, /* the nine cases: E01 .. E04, M01 .. M03, D01, D02 */
    HS_SCENES_HARD,   /* H01 and on: what the nine do not have */
    HS_SCENES_REAL,   /* "real": before a volume that is given */
    HS_SCENES_GROUPS
} hs_scene_group;

/* The built-in scenes of a group, in their order; NULL from the last on. */
const char *hs_scene_of_group(hs_scene_group group, uint32_t index);

/* The file of a scene as text, and `path`, its place for messages. A name with a dot or a slash is a
 * path; "R<seed>_<number>" is a random scene, which has no file; others are built-in. free() it. NULL:
 * HS_ERR_INPUT or HS_ERR_MEMORY. */
char *hs_scene_text(const char *name_or_path, char *path, size_t size, hs_error *err);

#endif
