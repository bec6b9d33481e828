/* SPDX-License-Identifier: MIT */
/* The text part of a MetaImage file. Internal to the MetaImage reader. */
#ifndef HS_METAIMAGE_HEADER_H
#define HS_METAIMAGE_HEADER_H

#include "volume/frame_fields.h"
#include "volume/metaimage_type.h"
#include "volume/volume.h"

/* A checked header. Line numbers count from 1 and are 0 for a field that is not there. */
typedef struct {
    uint32_t dims; /* 3 or 4 */
    uint32_t size[3];
    uint32_t frames;         /* volumes: 1 if dims is 3 */
    char size_text[48];      /* "4 3 2", as DimSize says it */
    hs_frame_fields *fields; /* of every volume; NULL: the file says nothing about them */
    double spacing[3];       /* mm */
    hs_pose pose;
    hs_probe probe;
    hs_met_type type;
    const char *type_name; /* static, "MET_UCHAR" */
    uint32_t element_bytes;
    bool big_endian;
    bool compressed;
    bool has_compressed_size;
    uint64_t compressed_size; /* bytes, if has_compressed_size */
    bool header_from_end;     /* HeaderSize = -1: the data ends where the file ends */
    uint64_t header_size;     /* bytes before the data in the data file; LOCAL: at least local_start */
    bool local;               /* the data is in the header's own file */
    uint64_t local_start;     /* bytes of the text part */
    char data_path[4096];     /* the data file; the header's own path if local */
    char data_name[256];      /* ElementDataFile, made fit for a message */
    unsigned dim_line, compressed_size_line, header_size_line, data_line;
} hs_met_header;

/* Reads and checks the header of `path`. Errors as in hs_metaimage_read. Free it either way. */
bool hs_met_header_read(const char *path, hs_met_header *header, hs_error *err);
void hs_met_header_free(hs_met_header *header);

#endif
