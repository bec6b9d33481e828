/* SPDX-License-Identifier: MIT */
#pragma once

#include <jansson.h>

/* A JSON string. The bytes may be any, JSON holds UTF-8 only: if they are not, every byte from 0x80 on
 * becomes '?'. NULL gives "". The caller owns the result; NULL: no memory. Any thread. */
json_t *hs_json_text(const char *bytes);
