/* SPDX-License-Identifier: MIT */
#include "volume/metaimage_type.h"

static const struct {
    const char *name;
    uint32_t bytes;
} types[HS_MET_TYPES] = {
    [HS_MET_CHAR] = {"MET_CHAR", 1},
    [HS_MET_UCHAR] = {"MET_UCHAR", 1},
    [HS_MET_SHORT] = {"MET_SHORT", 2},
    [HS_MET_USHORT] = {"MET_USHORT", 2},
    [HS_MET_INT] = {"MET_INT", 4},
    [HS_MET_UINT] = {"MET_UINT", 4},
    [HS_MET_LONG_LONG] = {"MET_LONG_LONG", 8},
    [HS_MET_ULONG_LONG] = {"MET_ULONG_LONG", 8},
    [HS_MET_FLOAT] = {"MET_FLOAT", 4},
    [HS_MET_DOUBLE] = {"MET_DOUBLE", 8},
};

const char *hs_met_type_name(hs_met_type type) {
    return types[type].name;
}

uint32_t hs_met_type_bytes(hs_met_type type) {
    return types[type].bytes;
}
