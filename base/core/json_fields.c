/* SPDX-License-Identifier: MIT */
#include "core/json_fields.h"

#include <stdarg.h>
#include <stdbool.h>
#include <stdio.h>
#include <string.h>

bool(hs_json_fail)(const hs_json *at, const char *format, ...) {
    char message[512];
    va_list args;
    va_start(args, format);
    vsnprintf(message, sizeof message, format, args);
    va_end(args);
    return hs_fail(at->file->err, HS_ERR_INPUT, "%s: %s: %s", at->file->path,
                   at->where[0] ? at->where : at->file->whole, message);
}

static const char *found(const json_t *value) {
    switch (json_typeof(value)) {
    case JSON_OBJECT:
        return "an object";
    case JSON_ARRAY:
        return "an array";
    case JSON_STRING:
        return "a string";
    case JSON_INTEGER:
    case JSON_REAL:
        return "a number";
    case JSON_NULL:
        return "null";
    default:
        return "a truth value";
    }
}

/* True for an object; else records what was found. */
static bool is_object(const hs_json *value) {
    if (json_is_object(value->value)) return true;
    return hs_json_fail(value, "is %s, expected an object", found(value->value));
}

bool hs_json_is_array(const hs_json *value, size_t min, size_t max) {
    if (!json_is_array(value->value))
        return hs_json_fail(value, "is %s, expected an array", found(value->value));
    size_t size = json_array_size(value->value);
    if (size >= min && size <= max) return true;
    if (min == max) return hs_json_fail(value, "has %zu elements, expected %zu", size, min);
    return hs_json_fail(value, "has %zu elements, expected %zu .. %zu", size, min, max);
}

bool hs_json_member(const hs_json *object, const char *key, hs_json *out) {
    json_t *value = json_object_get(object->value, key);
    if (!value) return false;
    out->file = object->file;
    out->value = value;
    snprintf(out->where, sizeof out->where, "%.90s%s%.30s", object->where, object->where[0] ? "." : "", key);
    return true;
}

bool hs_json_type(const hs_json *object, hs_json *type, const char **name) {
    if (!is_object(object)) return false;
    if (!hs_json_member(object, "type", type)) return hs_json_fail(object, "has no field 'type'");
    if (!json_is_string(type->value)) return hs_json_fail(type, "is not a string");
    *name = json_string_value(type->value);
    return true;
}

void hs_json_element(const hs_json *array, size_t index, hs_json *out) {
    out->file = array->file;
    out->value = json_array_get(array->value, index);
    snprintf(out->where, sizeof out->where, "%.100s[%zu]", array->where, index);
}

static bool number(const hs_json *v, double min, double max, double *out) {
    if (!json_is_number(v->value)) return hs_json_fail(v, "is %s, expected a number", found(v->value));
    double x = json_number_value(v->value);
    if (!(x >= min && x <= max)) return hs_json_fail(v, "is %.16g, expected %.16g .. %.16g", x, min, max);
    *out = x;
    return true;
}

static bool integer(const hs_json *v, const hs_json_field *f, uint64_t *out) {
    if (!json_is_integer(v->value)) return hs_json_fail(v, "is %s, expected a whole number", found(v->value));
    double checked;
    if (!number(v, f->min, f->max, &checked)) return false;
    *out = (uint64_t)json_integer_value(v->value);
    return true;
}

bool hs_json_numbers(const hs_json *v, size_t count, double min, double max, double *out) {
    if (!hs_json_is_array(v, count, count)) return false;
    for (size_t i = 0; i < count; i++) {
        hs_json part;
        hs_json_element(v, i, &part);
        if (!number(&part, min, max, &out[i])) return false;
    }
    return true;
}

/* Floats or doubles, one or an array of them. */
static bool numbers(const hs_json *v, const hs_json_field *f, char *out) {
    const size_t each = f->kind == HS_FIELD_FLOAT ? sizeof(float) : sizeof(double), count = f->bytes / each;
    double x[8];
    if (!(count == 1 ? number(v, f->min, f->max, x) : hs_json_numbers(v, count, f->min, f->max, x)))
        return false;
    for (size_t i = 0; i < count; i++) {
        const float single = (float)x[i];
        memcpy(out + i * each, f->kind == HS_FIELD_FLOAT ? (const void *)&single : &x[i], each);
    }
    return true;
}

static bool text(const hs_json *v, size_t room, char *out) {
    if (!json_is_string(v->value)) return hs_json_fail(v, "is %s, expected a string", found(v->value));
    const char *from = json_string_value(v->value);
    const size_t length = json_string_length(v->value);
    if (length >= room) return hs_json_fail(v, "has %zu bytes, expected at most %zu", length, room - 1);
    for (size_t i = 0; i < length; i++)
        if ((unsigned char)from[i] < 0x20 || from[i] == 0x7f)
            return hs_json_fail(v, "has a control character");
    memcpy(out, from, length + 1);
    return true;
}

bool hs_json_word(const hs_json *v, const char *const *words, uint32_t count, uint32_t *out) {
    const char *word = json_string_value(v->value), *quote = word ? "'" : "";
    char all[256] = "";
    size_t used = 0;
    for (*out = 0; word && *out < count; ++*out)
        if (strcmp(word, words[*out]) == 0) return true;
    for (uint32_t i = 0; i < count && used < sizeof all; i++)
        used += (size_t)snprintf(all + used, sizeof all - used, "%s%s", i ? ", " : "", words[i]);
    return hs_json_fail(v, "is %s%.40s%s, expected one of %s", quote, word ? word : found(v->value), quote,
                        all);
}

static bool read_field(const hs_json *v, const hs_json_field *f, void *out) {
    if (f->kind == HS_FIELD_OTHER) return true; /* its reader has it; there may be no `out` */
    char *to = (char *)out + f->offset;
    uint64_t n = 0;
    switch (f->kind) {
    case HS_FIELD_UINT:
        if (!integer(v, f, &n)) return false;
        *(uint32_t *)(void *)to = (uint32_t)n;
        return true;
    case HS_FIELD_WHOLE:
        return integer(v, f, (uint64_t *)(void *)to);
    case HS_FIELD_FLAG:
        *(bool *)(void *)to = json_is_true(v->value);
        return json_is_boolean(v->value) || hs_json_fail(v, "is %s, expected true or false", found(v->value));
    case HS_FIELD_TEXT:
        return text(v, f->bytes, to);
    case HS_FIELD_OWN:
        return f->read(v, f, to);
    default:
        return numbers(v, f, to);
    }
}

static bool read_object(const hs_json *object, const hs_json_field *fields, size_t count, bool typed,
                        void *out) {
    if (!is_object(object)) return false;
    const char *key;
    json_t *ignored;
    json_object_foreach(object->value, key, ignored) {
        bool known = typed && strcmp(key, "type") == 0;
        for (size_t i = 0; i < count; i++) known |= strcmp(key, fields[i].key) == 0;
        hs_json at;
        if (!known && hs_json_member(object, key, &at))
            return hs_json_fail(&at, "is no field of this object");
    }
    for (size_t i = 0; i < count; i++) {
        hs_json value;
        if (hs_json_member(object, fields[i].key, &value)) {
            if (!read_field(&value, &fields[i], out)) return false;
        } else if (fields[i].required) {
            return hs_json_fail(object, "has no field '%s'", fields[i].key);
        }
    }
    return true;
}

bool hs_json_read(const hs_json *object, const hs_json_field *fields, size_t count, void *out) {
    return read_object(object, fields, count, false, out);
}

bool hs_json_read_typed(const hs_json *object, const hs_json_field *fields, size_t count, void *out) {
    return read_object(object, fields, count, true, out);
}
