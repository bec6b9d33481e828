/* SPDX-License-Identifier: MIT */
#include "console/console_json.h"

#include <math.h>
#include <string.h>

static bool fail(const char *key, const char *what, hs_error *err) {
    return hs_fail(err, HS_ERR_INPUT, "message: %s: %s", key, what);
}

bool hs_console_object(const json_t *object, const char *name, const char *const *keys, hs_error *err) {
    if (!json_is_object(object)) return fail(name, "expected an object", err);
    const char *key;
    json_t *value;
    json_object_foreach((json_t *)object, key, value) {
        bool known = false;
        for (uint32_t i = 0; keys[i] && !known; i++) known = strcmp(key, keys[i]) == 0;
        if (!known) return hs_fail(err, HS_ERR_INPUT, "message: %s: '%.60s' is no field of it", name, key);
    }
    for (uint32_t i = 0; keys[i]; i++)
        if (!json_object_get(object, keys[i]))
            return hs_fail(err, HS_ERR_INPUT, "message: %s: '%s' is missing", name, keys[i]);
    return true;
}

static bool in_range(const json_t *value, const char *key, double low, double high, double *out,
                     hs_error *err) {
    if (!json_is_number(value)) return fail(key, "expected a number", err);
    *out = json_number_value(value);
    return (isfinite(*out) && *out >= low && *out <= high) ||
           hs_fail(err, HS_ERR_INPUT, "message: %s: %g is outside %g .. %g", key, *out, low, high);
}

bool hs_console_number(const json_t *object, const char *key, double low, double high, double *out,
                       hs_error *err) {
    return in_range(json_object_get(object, key), key, low, high, out, err);
}

bool hs_console_float(const json_t *object, const char *key, double low, double high, float *out,
                      hs_error *err) {
    double value = 0.0;
    if (!hs_console_number(object, key, low, high, &value, err)) return false;
    *out = (float)value;
    return true;
}

bool hs_console_whole(const json_t *object, const char *key, uint64_t low, uint64_t high, uint64_t *out,
                      hs_error *err) {
    const json_t *value = json_object_get(object, key);
    if (!json_is_integer(value)) return fail(key, "expected a whole number", err);
    const json_int_t number = json_integer_value(value);
    if (number < 0 || (uint64_t)number < low || (uint64_t)number > high)
        return hs_fail(err, HS_ERR_INPUT, "message: %s: %lld is outside %llu .. %llu", key, (long long)number,
                       (unsigned long long)low, (unsigned long long)high);
    *out = (uint64_t)number;
    return true;
}

bool hs_console_count(const json_t *object, const char *key, uint32_t low, uint32_t high, uint32_t *out,
                      hs_error *err) {
    uint64_t value = 0;
    if (!hs_console_whole(object, key, low, high, &value, err)) return false;
    *out = (uint32_t)value;
    return true;
}

bool hs_console_flag(const json_t *object, const char *key, bool *out, hs_error *err) {
    const json_t *value = json_object_get(object, key);
    *out = json_is_true(value);
    return json_is_boolean(value) || fail(key, "expected true or false", err);
}

bool hs_console_text(const json_t *object, const char *key, char *out, size_t bytes, hs_error *err) {
    const json_t *value = json_object_get(object, key);
    if (!json_is_string(value)) return fail(key, "expected a text", err);
    const char *text = json_string_value(value);
    const size_t length = json_string_length(value);
    if (length >= bytes)
        return hs_fail(err, HS_ERR_INPUT, "message: %s: %zu bytes, expected at most %zu", key, length,
                       bytes - 1);
    for (size_t i = 0; i < length; i++)
        if ((unsigned char)text[i] < 0x20 || text[i] == 0x7f)
            return fail(key, "has a control character", err);
    memcpy(out, text, length + 1);
    return true;
}

bool hs_console_word(const json_t *object, const char *key, const char *const *words, uint32_t count,
                     uint32_t *out, hs_error *err) {
    char word[64];
    if (!hs_console_text(object, key, word, sizeof word, err)) return false;
    for (*out = 0; *out < count; ++*out)
        if (strcmp(word, words[*out]) == 0) return true;
    return hs_fail(err, HS_ERR_INPUT, "message: %s: '%s' is not known", key, word);
}

bool hs_console_numbers(const json_t *object, const char *key, uint32_t count, double low, double high,
                        double *out, hs_error *err) {
    const json_t *array = json_object_get(object, key);
    if (!json_is_array(array) || json_array_size(array) != count)
        return hs_fail(err, HS_ERR_INPUT, "message: %s: expected %u numbers", key, count);
    for (uint32_t i = 0; i < count; i++)
        if (!in_range(json_array_get(array, i), key, low, high, &out[i], err)) return false;
    return true;
}
