/* SPDX-License-Identifier: MIT */
/* Makes KRETZFILE files item by item, without the writer under test. */
#pragma once

#include "support/metaimage_files.h"
#include "volume/kretz.h"

/* What an item's payload is made of. */
typedef enum { KRETZ_U16, KRETZ_U32, KRETZ_F64, KRETZ_BYTES } kretz_type;

typedef struct {
    uint16_t group, element;
    kretz_type type;
    uint32_t count; /* values; with KRETZ_BYTES bytes, which count up from value[0] */
    double value[8];
    const uint8_t *bytes; /* KRETZ_BYTES: these, unless NULL */
} kretz_item;

/* A file under way: at most KRETZ_ITEMS items, in this order. */
enum { KRETZ_ITEMS = 32 };
typedef struct {
    kretz_item item[KRETZ_ITEMS];
    uint32_t count;
    bool no_end; /* leave out the item that ends the stream */
} kretz_plan;

/* A small good file: 4 samples of 0.5 mm from 10 mm on, 3 lines, 2 planes, the axis at -5 mm, voxels 1, 2, 3
 * ..., one text, and the end. */
enum { KRETZ_SAMPLES = 4, KRETZ_LINES = 3, KRETZ_PLANES = 2, KRETZ_VOXELS = 24 };
kretz_plan kretz_good(void);

/* Where the item is in the plan; the test fails if it is not. */
kretz_item *kretz_find(kretz_plan *plan, uint16_t group, uint16_t element);

/* Takes an item out, or puts one at the end of the others. */
void kretz_drop(kretz_plan *plan, uint16_t group, uint16_t element);
void kretz_add(kretz_plan *plan, kretz_item item);

/* The file's bytes, kept for the test. */
uint8_t *kretz_bytes_of(const kretz_plan *plan, size_t *bytes);

/* Writes it in the folder of metaimage_files.h. */
void kretz_file(const char *name, const kretz_plan *plan);

/* Opens a file and reads its first volume; kept; the test fails if that does not go. */
hs_volume kretz_volume(const char *name, const hs_kretz_options *options);

/* Opens it and expects HS_ERR_INPUT with the file's name and `told` in the message. */
void kretz_refused(const char *name, const char *told);
