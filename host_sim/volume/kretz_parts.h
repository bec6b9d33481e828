/* SPDX-License-Identifier: MIT */
/* The parts of the Kretz reader: the items of a KRETZFILE 1.0 stream, and what they say of its grey volume,
 * checked. */
#pragma once

#include "volume/beams.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

#define HS_KRETZ_MAGIC_BYTES 16u
#define HS_KRETZ_MAGIC       "KRETZFILE 1.0   " /* the first bytes of every file */
#define HS_KRETZ_MAX_ITEMS   65536u             /* real files have some hundred */
#define HS_KRETZ_HEAD_BYTES  132u               /* tell a KRETZFILE, and a DICOM file that may hold one */

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
    bool padded;      /* a last byte that belongs to no item makes the length even, as DICOM wants it */
} hs_kretz_items;

/* True if these first bytes of a file are those of a DICOM file. */
bool hs_kretz_is_dicom(const uint8_t *head, size_t bytes);

/*
 * Opens a file that begins with the magic, or a DICOM file of implicit or explicit little endian that holds
 * one such stream in its private group 7FE1. HS_ERR_INPUT names file, element and value: no stream or two of
 * them, another transfer syntax, an element that does not fit in the file, more than 65536 elements, or,
 * unless `folder` is NULL, a file that lies elsewhere. Any thread.
 */
bool hs_kretz_items_open(hs_kretz_items *items, const char *path, const char *folder, hs_error *err);

/* The next item. At the end of the stream, which is the item (FFFF,FFFF) or the end of the file, *more is
 * false. HS_ERR_INPUT: an item whose header or payload does not fit in the stream, numbers of the other byte
 * order, more items than HS_KRETZ_MAX_ITEMS. */
bool hs_kretz_items_next(hs_kretz_items *items, hs_kretz_item *item, bool *more, hs_error *err);

/* Reads `bytes` bytes from `offset` on straight into `out`. HS_ERR_INPUT. */
bool hs_kretz_items_read(const hs_kretz_items *items, uint64_t offset, void *out, size_t bytes,
                         hs_error *err);

/* Safe on a zeroed struct. */
void hs_kretz_items_close(hs_kretz_items *items);

#define HS_KRETZ_MIN_PITCH  0.01   /* mm between samples, or a voxel's edge */
#define HS_KRETZ_MAX_PITCH  5.0    /* mm */
#define HS_KRETZ_MIN_SPAN   0.01   /* rad: of a narrower fan the copy would be one voxel wide */
#define HS_KRETZ_MAX_OFFSET 1000.0 /* mm: start of the samples, and place of the sweep's axis */
#define HS_KRETZ_TIMES      65536u /* volumes of a sequence */

typedef struct {
    bool cartesian;
    uint32_t size[3]; /* samples, lines, planes; or voxels along x, y, z. Each 1 (beams: 2) .. 2048 */
    double spacing;   /* mm: a Cartesian voxel's edge */
    hs_beams beams;   /* else: the geometry, with tables but without voxels; not mirrored */
    uint64_t voxels;  /* where those of the first volume begin; the others follow without a gap */
    uint32_t count;   /* volumes, >= 1 */
} hs_kretz_header;

/*
 * Walks all items and checks what they say. Everything is checked in 64 bits before anything is allocated.
 * HS_ERR_INPUT names the file, the item and its value; HS_ERR_MEMORY. Texts, which are personal data, and
 * unknown items are skipped by their length and never read. On failure the header is zeroed.
 */
bool hs_kretz_header_read(hs_kretz_items *items, hs_kretz_header *header, hs_error *err);

/* Frees the tables. Safe on a zeroed struct. */
void hs_kretz_header_free(hs_kretz_header *header);
