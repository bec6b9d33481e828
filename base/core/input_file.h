/* SPDX-License-Identifier: MIT */
/* Opens and reads files that somebody else made. */
#pragma once

#include "core/error.h"

#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>

/* Opens a regular file for reading and sets *bytes to its size. On failure NULL, and HS_ERR_INPUT "<context>:
 * <reason>". Never waits, not even on a FIFO. */
FILE *hs_input_open(const char *path, const char *context, uint64_t *bytes, hs_error *err);

/* The same for a file that the file at `header` names: links must not lead out of that file's folder. NULL:
 * any file. */
FILE *hs_input_open_below(const char *header, const char *path, const char *context, uint64_t *bytes,
                          hs_error *err);

/* Reads `bytes` bytes from *at on, and moves *at behind what was read. Any number of threads at a time. NULL,
 * or why they cannot be read: the system's reason, or that the file became shorter. */
const char *hs_input_read_at(FILE *file, uint64_t *at, void *out, size_t bytes);
