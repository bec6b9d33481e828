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

/* What a file must lie in or below, wherever links lead: the folder of the file at `header`, which names it,
 * and `folder`. Either may be NULL. The open file is asked, so a name that changes meanwhile changes nothing.
 */
typedef struct {
    const char *header, *folder;
} hs_input_bounds;

/* The same for such a file. */
FILE *hs_input_open_within(hs_input_bounds bounds, const char *path, const char *context, uint64_t *bytes,
                           hs_error *err);

/* Reads `bytes` bytes from *at on, and moves *at behind what was read. Any number of threads at a time. NULL,
 * or why they cannot be read: the system's reason, or that the file became shorter. */
const char *hs_input_read_at(FILE *file, uint64_t *at, void *out, size_t bytes);
