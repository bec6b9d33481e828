/* SPDX-License-Identifier: MIT */
/* SHA-256 (FIPS 180-4) of files: whether one is what was installed. */
#pragma once

#include "core/error.h"

enum { HS_SHA256_TEXT = 65 }; /* 64 digits and the end */

/* The sum of a whole file in small hexadecimal digits, as sha256sum prints it. HS_ERR_INPUT names the path.
 */
bool hs_sha256_file(const char *path, char text[HS_SHA256_TEXT], hs_error *err);
