/* SPDX-License-Identifier: MIT */
/* The voxels of a MetaImage file one after the other, checked: as bytes and as numbers. Internal to the
 * MetaImage reader and to what copies files. */
#ifndef HS_METAIMAGE_VOXELS_H
#define HS_METAIMAGE_VOXELS_H

#include "volume/metaimage_header.h"

enum { HS_MET_CHUNK = 8192 }; /* voxels that are read at once, at most */

typedef struct hs_met_voxels hs_met_voxels;

/* Opens the file and checks all that can be checked before a voxel is read. `err` must outlive the stream and
 * receives the errors of all functions below, unless _report_to names another. NULL on failure. */
hs_met_voxels *hs_met_voxels_open(const char *path, hs_error *err);
void hs_met_voxels_close(hs_met_voxels *voxels); /* NULL is allowed */

void hs_met_voxels_report_to(hs_met_voxels *voxels, hs_error *err);

const hs_met_header *hs_met_voxels_header(const hs_met_voxels *voxels);

/* The next `count` voxels, at most HS_MET_CHUNK: as numbers, all finite; and, unless `raw` is NULL, as bytes
 * of the file's type in this machine's order. Both are the stream's and good until the next call. NULL on
 * failure.
 */
const double *hs_met_voxels_read(hs_met_voxels *voxels, size_t count, const uint8_t **raw);

/* Passes over the next `count` voxels, whatever they hold. */
bool hs_met_voxels_skip(hs_met_voxels *voxels, size_t count);

/* To voxel `at`, counted from the file's first; what it costs says hs_met_data_seek. */
bool hs_met_voxels_seek(hs_met_voxels *voxels, uint64_t at);

/* Numbers from bytes of the type in this machine's order. */
void hs_met_decode(hs_met_type type, const uint8_t *raw, size_t count, double *value);

/*
 * From voxel `at` on, wherever the stream is: as bytes, of a file whose type has one byte; as numbers, all
 * finite, at most HS_MET_CHUNK of them, into a room of the caller's; and of those only the bytes, in this
 * machine's order, into room->raw. hs_met_voxels_threads may do so at a time, each with a room of its own; if
 * that is one, data is compressed, and what is asked for in order is inflated once.
 */
typedef struct {
    uint8_t raw[HS_MET_CHUNK * 8];
    double value[HS_MET_CHUNK];
} hs_met_room;
bool hs_met_voxels_bytes_at(hs_met_voxels *voxels, uint64_t at, size_t count, uint8_t *out, hs_error *err);
bool hs_met_voxels_read_at(hs_met_voxels *voxels, uint64_t at, size_t count, hs_met_room *room,
                           hs_error *err);
bool hs_met_voxels_raw_at(hs_met_voxels *voxels, uint64_t at, size_t count, hs_met_room *room, hs_error *err);
uint32_t hs_met_voxels_threads(const hs_met_voxels *voxels);

/* Succeeds if all voxels have been read and nothing follows. */
bool hs_met_voxels_finish(hs_met_voxels *voxels);

#endif
