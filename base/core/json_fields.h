/* SPDX-License-Identifier: MIT */
/* Typed fields of a JSON object; every error names file and field. */
#pragma once

#include "core/error.h"

#include <jansson.h>
#include <stddef.h>
#include <stdint.h>

/* A file, or a message, that is being read. */
typedef struct {
    const char *path, *whole; /* for messages: where the text is from, and what all of it is called */
    hs_error *err;
} hs_json_file;

/* A value and where it stands: "structures[2].radii_mm". */
typedef struct {
    const hs_json_file *file;
    json_t *value;
    char where[128];
} hs_json;

typedef enum {
    HS_FIELD_FLOAT,  /* float, or an array of them: as many as the member has, at most 8 */
    HS_FIELD_DOUBLE, /* the same of double */
    HS_FIELD_UINT,   /* uint32_t */
    HS_FIELD_WHOLE,  /* uint64_t */
    HS_FIELD_FLAG,   /* bool */
    HS_FIELD_TEXT,   /* char[], without control characters */
    HS_FIELD_OWN,    /* what `read` makes of it */
    HS_FIELD_OTHER   /* allowed, read by the caller */
} hs_field_kind;

/* One field: a number is in min .. max. Its destination is `offset` bytes from the start of the struct, and
 * has `bytes`. */
typedef struct hs_json_field {
    const char *key;
    hs_field_kind kind;
    size_t offset, bytes;
    double min, max;
    bool required;
    bool (*read)(const hs_json *value, const struct hs_json_field *field, void *to);
} hs_json_field;

/* Reads the fields of an object; one that is absent keeps its value. A key that is not in the table is an
 * error. */
bool hs_json_read(const hs_json *object, const hs_json_field *fields, size_t count, void *out);

/* hs_json_read of an object whose type hs_json_type has read. */
bool hs_json_read_typed(const hs_json *object, const hs_json_field *fields, size_t count, void *out);

/* A member or an element. False (no error) if it is not there. */
bool hs_json_member(const hs_json *object, const char *key, hs_json *out);
void hs_json_element(const hs_json *array, size_t index, hs_json *out);

/* Records "<file>: <field>: <message>" and returns false. */
bool hs_json_fail(const hs_json *at, const char *format, ...) __attribute__((format(printf, 2, 3)));
#ifdef __clang_analyzer__ /* as for hs_fail: it always returns false */
#define hs_json_fail(...) ((void)hs_json_fail(__VA_ARGS__), false)
#endif

/* True for an array of min .. max items; else records what was found. */
bool hs_json_is_array(const hs_json *value, size_t min, size_t max);

/* An array of `count` numbers in min .. max. */
bool hs_json_numbers(const hs_json *array, size_t count, double min, double max, double *out);

/* One of `count` words, as its index. */
bool hs_json_word(const hs_json *value, const char *const *words, uint32_t count, uint32_t *out);

/* The text in the field "type" of an object, and where it stands. False with an error if there is none. */
bool hs_json_type(const hs_json *object, hs_json *type, const char **name);

/* How tables of fields are written. */
#define HS_COUNT(a)                                   (sizeof(a) / sizeof((a)[0]))
#define FIELD(type, member, kind, min, max, required) NAMED(#member, type, member, kind, min, max, required)
#define NAMED(key, type, member, kind, min, max, required)                                                   \
    { key, HS_FIELD_##kind, offsetof(type, member), sizeof((type *)NULL)->member, min, max, required, NULL }
#define OWN(key, type, member, read, min, max, required)                                                     \
    { key, HS_FIELD_OWN, offsetof(type, member), sizeof((type *)NULL)->member, min, max, required, read }
#define OTHER(key, required)                                                                                 \
    { key, HS_FIELD_OTHER, 0, 0, 0, 0, required, NULL }
