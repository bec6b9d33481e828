/* SPDX-License-Identifier: MIT */
/* The line of a value in JSON text: jansson tells lines for syntax errors only. */
#ifndef HS_SCENE_LOCATE_H
#define HS_SCENE_LOCATE_H

/* Line of the value at a path such as "a[3].b" in well-formed JSON text; the nearest enclosing value's if the
 * path does not exist. 1 is the first line. */
unsigned hs_json_line(const char *text, const char *where);

#endif
