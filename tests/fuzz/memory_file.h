/* SPDX-License-Identifier: MIT */
/* Bytes as a file that is in memory only, so that readers of files can be fuzzed as they are. */
#pragma once

#include <stddef.h>
#include <stdint.h>

typedef struct {
    int file;
    char path[64];
} memory_file;

/* The file holds `size` bytes and is read by its path. Ends the process if there is no memory. */
void memory_file_open(memory_file *m, const uint8_t *data, size_t size);
void memory_file_close(memory_file *m);
