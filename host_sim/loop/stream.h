/* SPDX-License-Identifier: MIT */
/* The volumes of a sequence, read ahead by a thread of their own; a few are in memory, never all. */
#ifndef HS_STREAM_H
#define HS_STREAM_H

#include "loop/sequence.h"

#define HS_STREAM_VOLUMES 3u /* in memory at most: the one in use, and the two that come next */

typedef struct hs_stream hs_stream;

/* Reads the first volume and starts the thread, which has the sequence to itself until hs_stream_close; it
 * must outlive the stream. NULL with the errors of hs_sequence_read, or HS_ERR_MEMORY. */
hs_stream *hs_stream_open(hs_sequence *sequence, hs_error *err);

/* Waits for the thread. NULL is allowed. */
void hs_stream_close(hs_stream *stream);

uint32_t hs_stream_count(const hs_stream *stream);

/* Size, spacing and geometry of all its volumes, pose and name of the first. Its voxels may be those of any:
 * do not read them. */
const hs_volume *hs_stream_shape(const hs_stream *stream);

/* Volume `index` (0 .. count - 1), which stays as it is until the next call; waits if it is still on its way.
 * Those that follow it, and after the last one the first, are then read ahead. The voxels lie in one of
 * HS_STREAM_VOLUMES places in turn. NULL with the errors of hs_sequence_read. One thread at a time. */
const hs_volume *hs_stream_get(hs_stream *stream, uint32_t index, hs_error *err);

#endif
