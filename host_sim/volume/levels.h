/* SPDX-License-Identifier: MIT */
/* From numbers to grey levels, and what of them was scanned: for files, and for memory of others. */
#pragma once

#include "volume/volume.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/*
 * How values become levels: low .. high becomes 0 .. 255, rounded to the nearest, and what lies beyond is
 * clamped. A value that is no number (NaN, or -inf: the dB of nothing), or the constant that lies outside the
 * scan, was not scanned and becomes 0. Where there are such, what was scanned is 1 at least.
 */
typedef struct {
    double low, high;
    bool gaps;        /* some values are no numbers */
    bool has_outside; /* `outside` is the value of what was not scanned */
    double outside;
} hs_levels;

/* No value was looked at yet: an empty range. */
void hs_levels_begin(hs_levels *levels);

/* Widens low .. high to hold those of `count` values that were scanned; `scanned` may be NULL: all. */
void hs_levels_widen(hs_levels *levels, const double *value, const uint8_t *scanned, size_t count);

/* The levels of `count` values; low < high. */
void hs_levels_of(const hs_levels *levels, const double *value, size_t count, uint8_t *out);

/* Checks that a range can be mapped: "values are ...", HS_ERR_INPUT, behind `what`. */
bool hs_levels_check(const hs_levels *levels, const char *what, hs_error *err);

/* hs_volume_mark_unscanned of a volume of these levels whose zeros may be what was not scanned. Where no 0
 * was mapped to 0, but the lowest of other values, that is so only if a corner of the volume holds it: else
 * all was scanned. */
bool hs_levels_mark_unscanned(const hs_levels *levels, hs_volume *volume, hs_error *err);

/* "; what lies outside the scan holds 16", for who tells of a volume; "" if nothing is to be said. */
void hs_levels_words(const hs_levels *levels, char *out, size_t bytes);

/* Reads the `count` values from voxel `at` on. */
typedef bool (*hs_values_fn)(void *context, uint64_t at, size_t count, double *out, hs_error *err);

/* Blocks of an eighth of a volume's sides, and how many of them tell what lies outside a scan. */
enum { HS_CORNERS = 8, HS_CORNERS_ENOUGH = 4 };

/*
 * Looks for the constant outside the scan: at four corners of the volume or more, blocks of an eighth of its
 * sides hold this one value, and between them is something else, as it is of a fan in its box. With `zero`, a
 * 0 needs no looking for. Corners are read in the order of the voxels, and no more of them than needed.
 */
bool hs_levels_find_outside(hs_levels *levels, const uint32_t size[3], bool zero, hs_values_fn read,
                            void *context, hs_error *err);
