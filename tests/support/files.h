/* SPDX-License-Identifier: MIT */
/* A folder for the files of a test. */
#pragma once

#include "support/unit.h"

/* cmocka group setup and teardown: a new folder, and all that is in it gone. */
int files_setup(void **state);
int files_teardown(void **state);

/* Number of files in the folder. */
int files_count(void);

/* The path of a file in the folder, kept for the test. */
const char *files_path(const char *name);

/* A file of `text` (NULL for none) and `bytes` bytes of data behind it. */
void files_write(const char *name, const char *text, const void *data, size_t bytes);
