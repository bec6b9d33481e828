/* SPDX-License-Identifier: MIT */
/* A scene from its file. */
#ifndef HS_SCENE_READ_H
#define HS_SCENE_READ_H

#include "base/error.h"
#include "scene/scene_spec.h"

/* Reads a scene file. Errors name file, line and field. */
bool hs_scene_read(const char *path, hs_scene_spec *spec, hs_error *err);

/* The same from text; `path` is for messages. */
bool hs_scene_read_text(const char *path, const char *text, hs_scene_spec *spec, hs_error *err);

#endif
