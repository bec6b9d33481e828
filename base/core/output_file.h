/* SPDX-License-Identifier: MIT */
/* A result file that appears whole or not at all: written under a temporary name, then renamed. */
#pragma once

#include "core/error.h"

#include <stddef.h>
#include <stdio.h>

/* Between open and commit or discard. Zeroed: nothing is open. */
typedef struct {
    FILE *file;      /* write here, or through hs_output_write */
    char *path;      /* the name it gets in the end */
    char *temporary; /* the name it has until then, in the same folder */
} hs_output_file;

/* Creates "<path>.tmp<number>". SIGINT, SIGTERM and SIGHUP remove it, if they would end the program.
 * HS_ERR_OUTPUT names the path and the system's reason; an existing `path` that is no regular file (a folder,
 * a device) is refused, since the rename would replace it. */
bool hs_output_open(hs_output_file *output, const char *path, hs_error *err);

/* Writes all bytes or fails with HS_ERR_OUTPUT. The file stays open either way. */
bool hs_output_write(hs_output_file *output, const void *data, size_t bytes, hs_error *err);

/* Flushes, closes and renames over `path`. On failure nothing is left behind. Either way the struct is
 * zeroed. */
bool hs_output_commit(hs_output_file *output, hs_error *err);

/* Closes and removes the temporary file, then zeroes the struct. Safe on a zeroed struct. */
void hs_output_discard(hs_output_file *output);

/* Finds out now, not after minutes, whether a file can be written. NULL: none is wanted. HS_ERR_OUTPUT. */
bool hs_output_try(const char *path, hs_error *err);
