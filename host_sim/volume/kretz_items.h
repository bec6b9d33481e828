/* SPDX-License-Identifier: MIT */
/* The items of a KRETZFILE 1.0 stream. Internal to the Kretz reader. */
#ifndef HS_KRETZ_ITEMS_H
#define HS_KRETZ_ITEMS_H

#include "base/error.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

#define HS_KRETZ_MAGIC_BYTES 16u
#define HS_KRETZ_MAGIC       "KRETZFILE 1.0   " /* the first bytes of every file */
#define HS_KRETZ_MAX_ITEMS   65536u             /* real files have some hundred */

typedef struct {
    uint16_t group, element;
    uint32_t bytes;  /* of the payload */
    uint64_t offset; /* of the payload in the file; all of it lies in the stream */
} hs_kretz_item;

/* A stream from its first byte to its end. */
typedef struct {
    FILE *file;
    const char *path; /* for messages; must outlive this */
    uint64_t at, end; /* bytes from the file's start: the next item, and the end of the stream */
    uint32_t count;   /* items so far */
} hs_kretz_items;

/* Opens the file and checks the magic. HS_ERR_INPUT names the file. Any thread. */
bool hs_kretz_items_open(hs_kretz_items *items, const char *path, hs_error *err);

/* The next item. At the end of the stream, which is the item (FFFF,FFFF) or the end of the file, *more is
 * false. HS_ERR_INPUT: an item whose header or payload does not fit in the stream, numbers of the other byte
 * order, more items than HS_KRETZ_MAX_ITEMS. */
bool hs_kretz_items_next(hs_kretz_items *items, hs_kretz_item *item, bool *more, hs_error *err);

/* Reads `bytes` bytes from `offset` on straight into `out`. HS_ERR_INPUT. */
bool hs_kretz_items_read(const hs_kretz_items *items, uint64_t offset, void *out, size_t bytes,
                         hs_error *err);

/* Safe on a zeroed struct. */
void hs_kretz_items_close(hs_kretz_items *items);

#endif
