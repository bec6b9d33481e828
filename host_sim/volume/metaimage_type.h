/* SPDX-License-Identifier: MIT */
/* The types a MetaImage voxel may have. */
#ifndef HS_METAIMAGE_TYPE_H
#define HS_METAIMAGE_TYPE_H

#include <stdint.h>

typedef enum {
    HS_MET_CHAR = 0,
    HS_MET_UCHAR,
    HS_MET_SHORT,
    HS_MET_USHORT,
    HS_MET_INT,
    HS_MET_UINT,
    HS_MET_LONG_LONG,
    HS_MET_ULONG_LONG,
    HS_MET_FLOAT,
    HS_MET_DOUBLE,
    HS_MET_TYPES
} hs_met_type;

/* "MET_CHAR", ...; static. */
const char *hs_met_type_name(hs_met_type type);
/* Bytes of a voxel. */
uint32_t hs_met_type_bytes(hs_met_type type);

#endif
