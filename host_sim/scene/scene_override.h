/* SPDX-License-Identifier: MIT */
/* Fields of a scene file that a command line sets otherwise. */
#ifndef HS_SCENE_OVERRIDE_H
#define HS_SCENE_OVERRIDE_H

#include "base/error.h"

/*
 * The text of a scene with PATH=VALUE applied, as JSON; free() it. PATH names fields by dots and elements
 * by their index, "structures[0].gap_mm"; an artefact may be named by its type, "artefacts.haze.level_db".
 * VALUE is JSON, or a word. An artefact is on if any field of it is set, or with VALUE "on"; "off" takes
 * it, or any other field, away. NULL: HS_ERR_USAGE names the assignment and what is wrong, HS_ERR_MEMORY.
 */
char *hs_scene_override(const char *path, const char *text, const char *assignment, hs_error *err);

#endif
