/* SPDX-License-Identifier: MIT */
/* A scene from its file. */
#ifndef HS_SCENE_READ_H
#define HS_SCENE_READ_H

#include "base/error.h"
#include "scene/scene_spec.h"

/* A scene file's text, up to 1 MiB; free() it. NULL: HS_ERR_INPUT names the file, HS_ERR_MEMORY. */
char *hs_scene_read_file(const char *path, hs_error *err);

/* Reads a scene from such a text; `path` is for messages, which name file, line and field. */
bool hs_scene_read_text(const char *path, const char *text, hs_scene_spec *spec, hs_error *err);

#endif
