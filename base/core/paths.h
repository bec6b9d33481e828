/* SPDX-License-Identifier: MIT */
/* Paths of files: joined, beside the program, temporary; and folders for them. */
#pragma once

#include "core/error.h"

#include <stddef.h>

/* Makes the folder (and its parents) and proves that a file can be written there.
 * HS_ERR_OUTPUT names the path. */
bool hs_path_make_folder(const char *path, hs_error *err);

/* Writes "<folder>/<name>" to out; HS_ERR_OUTPUT if it is longer than `bytes`. */
bool hs_path_join(const char *folder, const char *name, char *out, size_t bytes, hs_error *err);

/* True if the path's last part has this ending, and more before it. */
bool hs_path_ends(const char *path, const char *ending);

/* Makes an empty file "<stem><number>" that no other has, and writes its path to out. Returns its descriptor,
 * for writing; -1 with errno. */
int hs_path_first(const char *stem, char *out, size_t bytes);

/* Writes "<folder of the running program>/<name>" to out: what was moved together is found together. False if
 * the program cannot be told (no /proc) or the path is longer than `bytes`; out is then "". */
bool hs_path_beside_program(const char *name, char *out, size_t bytes);
