/* SPDX-License-Identifier: MIT */
/* The lines of a MetaImage header: fields, values, and what can be said against a value. Internal to the
 * MetaImage reader. */
#ifndef HS_METAIMAGE_TEXT_H
#define HS_METAIMAGE_TEXT_H

#include "base/error.h"

#include <stddef.h>
#include <stdint.h>

enum { HS_MET_SHOWN_BYTES = 64 }; /* of a value in a message */

/* The fields that are used. All others are skipped unseen. */
typedef enum {
    HS_MET_F_OBJECT_TYPE,
    HS_MET_F_NDIMS,
    HS_MET_F_DIM_SIZE,
    HS_MET_F_ELEMENT_TYPE,
    HS_MET_F_ELEMENT_SPACING,
    HS_MET_F_ELEMENT_SIZE,
    HS_MET_F_CHANNELS,
    HS_MET_F_BINARY,
    HS_MET_F_BINARY_MSB,
    HS_MET_F_ELEMENT_MSB,
    HS_MET_F_COMPRESSED,
    HS_MET_F_COMPRESSED_SIZE,
    HS_MET_F_HEADER_SIZE,
    HS_MET_F_DATA_FILE,
    HS_MET_F_TRANSFORM, /* TransformMatrix, Rotation or Orientation */
    HS_MET_F_OFFSET,    /* Offset, Position or Origin */
    HS_MET_F_ANATOMICAL,
    HS_MET_F_KINDS,
    HS_MET_F_ULTRASOUND, /* UltrasoundImageOrientation */
    HS_MET_F_COUNT
} hs_met_field;

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

/* Reads the text of `path`, up to 16 MB of it. Errors as in hs_metaimage_read. Free it either way. */
bool hs_met_text_read(hs_met_text *text, const char *path, hs_error *err);
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

#endif
