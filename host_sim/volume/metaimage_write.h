/* SPDX-License-Identifier: MIT */
/* Writes arrays as MetaImage files, whole (metaimage_stream.h writes piece by piece). docs/metaimage.md
 * states the mapping. */
#ifndef HS_METAIMAGE_WRITE_H
#define HS_METAIMAGE_WRITE_H

#include "base/error.h"
#include "volume/pose.h"

#include <stdint.h>

typedef enum { HS_ARRAY_U8 = 0, HS_ARRAY_U16, HS_ARRAY_F32 } hs_array_type;

/* An array to be written; x fastest, then y, then z. */
typedef struct {
    hs_array_type type;
    const void *data;    /* size[0] * size[1] * size[2] elements, borrowed */
    uint32_t dims;       /* 2 or 3 */
    uint32_t size[3];    /* elements along x, y, z; size[2] is ignored if dims is 2 */
    double spacing[3];   /* mm, > 0; the same */
    bool compress;       /* zlib */
    const hs_pose *pose; /* borrowed; of 3 dimensions. NULL: the default one */
} hs_metaimage_array;

/* Writes "<name>.mha", or "<name>.mhd" and beside it "<name>.raw" ("<name>.zraw" if compressed), by the
 * ending of `path`. Each file is written under a temporary name and renamed, the data before the header.
 * HS_ERR_OUTPUT names the path and the field or the system's reason. */
bool hs_metaimage_write(const char *path, const hs_metaimage_array *array, hs_error *err);

#endif
