/* SPDX-License-Identifier: MIT */
/* The parts of the MetaImage reader, also for what copies or measures files: text, header, data, voxels. */
#pragma once

#include "volume/metaimage.h"

#include <stddef.h>
#include <stdint.h>

/* What a result says in ITK_FileNotes, the one field that ITK hands on from format to format, where its
 * source does not say how it lies in the patient. */
#define HS_MET_UNPLACED "SmartVis: not the axes of a patient"

enum { HS_MET_SHOWN_BYTES = 64 }; /* of a value in a message */

/* The fields that are used, by their first name. All others are skipped unseen. */
#define HS_MET_FIELDS(X)                                                                                     \
    X(OBJECT_TYPE, "ObjectType")                                                                             \
    X(NDIMS, "NDims")                                                                                        \
    X(DIM_SIZE, "DimSize")                                                                                   \
    X(ELEMENT_TYPE, "ElementType")                                                                           \
    X(ELEMENT_SPACING, "ElementSpacing")                                                                     \
    X(ELEMENT_SIZE, "ElementSize")                                                                           \
    X(DISTANCE_UNITS, "DistanceUnits")                                                                       \
    X(CHANNELS, "ElementNumberOfChannels")                                                                   \
    X(BINARY, "BinaryData")                                                                                  \
    X(BINARY_MSB, "BinaryDataByteOrderMSB")                                                                  \
    X(ELEMENT_MSB, "ElementByteOrderMSB")                                                                    \
    X(COMPRESSED, "CompressedData")                                                                          \
    X(COMPRESSED_SIZE, "CompressedDataSize")                                                                 \
    X(HEADER_SIZE, "HeaderSize")                                                                             \
    X(DATA_FILE, "ElementDataFile")                                                                          \
    X(TRANSFORM, "TransformMatrix")                                                                          \
    X(OFFSET, "Offset")                                                                                      \
    X(ANATOMICAL, "AnatomicalOrientation")                                                                   \
    X(NOTES, "ITK_FileNotes")                                                                                \
    X(KINDS, "Kinds")                                                                                        \
    X(ULTRASOUND, "UltrasoundImageOrientation")                                                              \
    X(APEX, "UltrasoundApex")
#define HS_MET_FIELD_ID(id, name) HS_MET_F_##id,
typedef enum { HS_MET_FIELDS(HS_MET_FIELD_ID) HS_MET_F_COUNT } hs_met_field;
#undef HS_MET_FIELD_ID

/* One used field as it stands in the text; line 0: it is missing. */
typedef struct {
    const char *name; /* as the file spells it */
    const char *value;
    unsigned line; /* counts from 1 */
} hs_met_value;

/* The text of a header. Values point into `text`. */
typedef struct {
    const char *path; /* borrowed */
    hs_error *err;    /* borrowed */
    char *text;
    hs_met_value fields[HS_MET_F_COUNT];
    hs_met_value *frames; /* the fields "Seq_Frame<number>_<what>" of a sequence, in the file's order */
    size_t frame_count;
    uint64_t bytes; /* of the text, the line of ElementDataFile included */
} hs_met_text;

/* Reads the text of `path`, up to 16 MB of it, which must lie in `folder`, unless that is NULL. Errors as in
 * hs_metaimage_read. Free it either way. */
bool hs_met_text_read(hs_met_text *text, const char *path, const char *folder, hs_error *err);
void hs_met_text_free(hs_met_text *text);

/* True if the field is there. */
bool hs_met_has(const hs_met_text *text, hs_met_field id);

/* "<file>:<line>: <Field> is '<value>', expected <expected>". Returns false. */
bool hs_met_bad_value(const hs_met_text *text, hs_met_field id, const char *expected);
bool hs_met_bad(const hs_met_text *text, const hs_met_value *value, const char *expected);

/* "<file>:<line>: <Field>: <reason>", for fields whose value may be somebody's. Returns false. */
bool hs_met_wrong(const hs_met_text *text, const hs_met_value *value, const char *reason);

/* "<file>: <Field> is missing". Returns false. */
bool hs_met_missing(const hs_met_text *text, hs_met_field id);

/* Makes a value fit for a one-line message. */
void hs_met_shown(const char *value, char out[HS_MET_SHOWN_BYTES]);

/* True at the end of a value. */
bool hs_met_at_end(const char *value);

/* Reads the next decimal number without sign and moves *value behind it; or a finite number. */
bool hs_met_unsigned(const char **value, uint64_t *out);
bool hs_met_number(const char **value, double *out);

/* True, False, 1, 0, T or F in any case; `absent` if the field is not there. */
bool hs_met_bool(const hs_met_text *text, hs_met_field id, bool absent, bool *out);

#define HS_MET_MAX_FRAMES 100000u /* volumes in a file */

/*
 * Checks Kinds against the number of dimensions (3 or 4). A sequence of pictures, whose third axis is time,
 * is refused by name: as a volume it would be misread. Such a file has fields of its frames, or calls its
 * third axis a list or time. PLUS calls it so in the volumes that it reconstructs, too: those have no fields
 * of frames, and `placed`, a third spacing other than 1 or a third offset other than 0, which pictures never
 * have.
 */
bool hs_met_kinds(const hs_met_text *text, uint64_t dims, bool placed);

/* True for one volume that was cut out of a sequence and kept all that this said of its volumes: which of
 * them it is, is not said. */
bool hs_met_is_cut(const hs_met_text *text, uint64_t dims);

/* The fields of all `count` volumes: *fields is the caller's to free, and NULL if the file
 * has none of them. Fields that are not used are skipped unseen. */
bool hs_met_frames(const hs_met_text *text, uint32_t count, hs_frame_fields **fields);

/* A checked header. Line numbers count from 1 and are 0 for a field that is not there. */
typedef struct {
    uint32_t dims; /* 3 or 4 */
    uint32_t size[3];
    uint32_t frames;         /* volumes: 1 if dims is 3 */
    char size_text[48];      /* "4 3 2", as DimSize says it */
    hs_frame_fields *fields; /* of every volume; NULL: the file says nothing about them */
    double unit;             /* mm of the file's unit of length */
    double spacing[3];       /* mm; 1 if not stated */
    bool spacing_stated;
    uint32_t channels; /* of a voxel, 1, 3 or 4; those of grey are alike, a fourth may be anything */
    hs_pose pose;
    hs_probe probe;
    bool probe_stated; /* else it is a guess */
    double apex[3];    /* where the lines met, mm from the volume's corner, if apex_said */
    bool apex_said;
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

/* Reads and checks the header of `path`, as hs_met_text_read does. `fields` is the caller's either way. */
bool hs_met_header_read(const char *path, const char *folder, hs_met_header *header, hs_error *err);

enum { HS_MET_CHUNK = 8192 }; /* voxels that are read at once, at most */

typedef struct hs_met_voxels hs_met_voxels;

/* Opens the file and checks all that can be checked before a voxel is read; `path` must outlive it. With a
 * `folder` header and data must lie in it. NULL on failure. */
hs_met_voxels *hs_met_voxels_open(const char *path, const char *folder, hs_error *err);
void hs_met_voxels_close(hs_met_voxels *voxels); /* NULL is allowed */

/* From now on NaN and -inf are values, too: of what was not scanned. */
void hs_met_voxels_allow_gaps(hs_met_voxels *voxels);

const hs_met_header *hs_met_voxels_header(const hs_met_voxels *voxels);

/* Numbers from bytes of the type in this machine's order. */
void hs_met_decode(hs_met_type type, const uint8_t *raw, size_t count, double *value);

/*
 * From voxel `at` on, wherever the stream is: as bytes, of a file whose type has one byte; as numbers, all
 * finite, at most HS_MET_CHUNK of them, into a room of the caller's, with their bytes in this machine's
 * order; and of those only the bytes. hs_met_voxels_threads may do so at a time, each with a room of its own;
 * if that is one, data is compressed, and what is asked for in order is inflated once.
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

/* Succeeds if nothing follows the last voxel. What compressed data has before it is inflated for that. */
bool hs_met_voxels_finish(hs_met_voxels *voxels, hs_error *err);
