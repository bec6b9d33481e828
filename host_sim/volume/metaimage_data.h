/* SPDX-License-Identifier: MIT */
/* The voxel bytes of a MetaImage file as one stream, compressed or not. Internal to the MetaImage reader. */
#ifndef HS_METAIMAGE_DATA_H
#define HS_METAIMAGE_DATA_H

#include "volume/metaimage_header.h"

typedef struct hs_met_data hs_met_data;

/* Opens the data file and checks its size against the header, before any voxel is allocated. `path` is the
 * header's file; it and `header` must outlive the stream. NULL on failure. */
hs_met_data *hs_met_data_open(const char *path, const hs_met_header *header, hs_error *err);

/* To byte `offset` of the voxels, 0 .. their number. Compressed data knows one way only: forward costs the
 * inflating of what is passed over, backward that of all from the first byte on. */
bool hs_met_data_seek(hs_met_data *data, uint64_t offset, hs_error *err);

/* The next `bytes` bytes. */
bool hs_met_data_read(hs_met_data *data, void *out, size_t bytes, hs_error *err);

/* `bytes` bytes from byte `offset` of the voxels on, of data that is not compressed: straight from the file
 * to `out`. Any number of threads at a time; the stream stays where it is. */
bool hs_met_data_read_at(const hs_met_data *data, uint64_t offset, void *out, size_t bytes, hs_error *err);

/* Succeeds if the stream ends here, as it should after the last voxel. */
bool hs_met_data_finish(hs_met_data *data, hs_error *err);

/* NULL is allowed. */
void hs_met_data_close(hs_met_data *data);

#endif
