/* SPDX-License-Identifier: MIT */
/* A file's bytes, and what zlib makes of them, with nothing else: what reading a
 * volume is measured against. */
#ifndef HS_PLAIN_BYTES_H
#define HS_PLAIN_BYTES_H

#include "base/error.h"

#include <stddef.h>
#include <stdint.h>

/* The file's bytes from `first` on, up to *bytes of them, in one piece of new memory that the caller frees;
 * *bytes becomes their number. NULL with HS_ERR_INPUT or HS_ERR_MEMORY. */
uint8_t *hs_plain_bytes(const char *path, uint64_t first, size_t *bytes, hs_error *err);

/* Reads the zlib or gzip data from `first` to the file's end in one piece, and inflates its first `bytes`
 * bytes into another; both are freed. HS_ERR_INPUT or HS_ERR_MEMORY. */
bool hs_plain_inflate(const char *path, uint64_t first, size_t bytes, hs_error *err);

#endif
