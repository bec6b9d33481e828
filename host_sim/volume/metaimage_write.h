/* SPDX-License-Identifier: MIT */
/* Writes MetaImage files, whole or piece by piece: volumes, sequences of volumes. docs/metaimage.md
 * states the mapping. */
#pragma once

#include "volume/metaimage.h"

/* What is written; x fastest, then y, z and time. */
typedef struct {
    hs_met_type type;
    uint32_t dims;       /* 3, or 4: a sequence of size[3] volumes */
    uint32_t size[4];    /* elements; those beyond dims are ignored */
    double spacing[3];   /* mm, > 0; the same */
    bool spacing_unsaid; /* nobody knows it: the file does not say it either */
    const hs_pose *pose; /* of a volume or a sequence; borrowed until _open returns. NULL: the default one */
    const hs_frame_fields *fields; /* of the size[3] volumes, borrowed until the end; NULL: nothing to say */
    bool compress;                 /* zlib */
} hs_metaimage_format;

typedef struct hs_metaimage_stream hs_metaimage_stream;

/* Begins a file, whose name ends in .mha, under a temporary name. `err` must outlive the stream and receives
 * the errors of all its functions: HS_ERR_OUTPUT names the path and the field or the system's reason;
 * HS_ERR_MEMORY. NULL on failure. */
hs_metaimage_stream *hs_metaimage_stream_open(const char *path, const hs_metaimage_format *format,
                                              hs_error *err);

/* The next elements, in this machine's byte order. */
bool hs_metaimage_stream_write(hs_metaimage_stream *stream, const void *data, uint64_t bytes);

/* Ends and renames; fails unless all elements were written. Frees the stream
 * either way, and leaves nothing behind on failure. */
bool hs_metaimage_stream_close(hs_metaimage_stream *stream);

/* Gives up: frees the stream and removes what was written. NULL is allowed. */
void hs_metaimage_stream_discard(hs_metaimage_stream *stream);

/* Writes all elements, `data`, in one go: the same file, errors and rules. */
bool hs_metaimage_write(const char *path, const hs_metaimage_format *format, const void *data, hs_error *err);
