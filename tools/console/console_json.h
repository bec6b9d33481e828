/* SPDX-License-Identifier: MIT */
/* Fields of a page's message, checked one by one: a field that is missing, unknown or out of range is an
 * error that names it. */
#ifndef HS_CONSOLE_JSON_H
#define HS_CONSOLE_JSON_H

#include "base/error.h"

#include <jansson.h>
#include <stdint.h>

/* An object that has these keys and no others; `keys` ends with NULL. `name` is what messages call the
 * object. */
bool hs_console_object(const json_t *object, const char *name, const char *const *keys, hs_error *err);

/* Member `key`, of the type and in low .. high. */
bool hs_console_number(const json_t *object, const char *key, double low, double high, double *out,
                       hs_error *err);
bool hs_console_float(const json_t *object, const char *key, double low, double high, float *out,
                      hs_error *err);
bool hs_console_whole(const json_t *object, const char *key, uint64_t low, uint64_t high, uint64_t *out,
                      hs_error *err);
bool hs_console_count(const json_t *object, const char *key, uint32_t low, uint32_t high, uint32_t *out,
                      hs_error *err);
bool hs_console_flag(const json_t *object, const char *key, bool *out, hs_error *err);

/* Text of fewer than `bytes` bytes without control characters, copied; and one of `count` words, as its
 * index. */
bool hs_console_text(const json_t *object, const char *key, char *out, size_t bytes, hs_error *err);
bool hs_console_word(const json_t *object, const char *key, const char *const *words, uint32_t count,
                     uint32_t *out, hs_error *err);

/* An array of `count` numbers in low .. high. */
bool hs_console_numbers(const json_t *object, const char *key, uint32_t count, double low, double high,
                        double *out, hs_error *err);

#endif
