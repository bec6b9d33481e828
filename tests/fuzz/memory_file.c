/* SPDX-License-Identifier: MIT */
#include "fuzz/memory_file.h"

#include <stdio.h>
#include <stdlib.h>
#include <sys/mman.h>
#include <unistd.h>

void memory_file_open(memory_file *m, const uint8_t *data, size_t size) {
    m->file = memfd_create("fuzz", 0);
    if (m->file < 0) abort();
    for (size_t done = 0; done < size;) {
        const ssize_t n = write(m->file, data + done, size - done);
        if (n <= 0) abort();
        done += (size_t)n;
    }
    (void)snprintf(m->path, sizeof m->path, "/proc/self/fd/%d", m->file);
}

void memory_file_close(memory_file *m) {
    (void)close(m->file);
}
