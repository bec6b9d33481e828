/* SPDX-License-Identifier: MIT */
#include "core/input_file.h"

#include "core/system.h"

#include <errno.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

static bool is_beside(int descriptor, const char *header) {
    char folder[SYS_PATH];
    const char *slash = strrchr(header, '/');
    const int length = slash ? snprintf(folder, sizeof folder, "%.*s", (int)(slash - header) + 1, header)
                             : snprintf(folder, sizeof folder, ".");
    return length < SYS_PATH && sys_is_below(descriptor, folder);
}

FILE *hs_input_open_within(hs_input_bounds bounds, const char *path, const char *context, uint64_t *bytes,
                           hs_error *err) {
    const int descriptor = sys_open(path, SYS_READ);
    struct stat status;
    if (descriptor < 0 || fstat(descriptor, &status) != 0) {
        const char *why = errno == EINVAL ? "not a regular file" : strerror(errno);
        hs_fail(err, HS_ERR_INPUT, "%s: cannot be read: %s", context, why);
    } else if (bounds.header && !is_beside(descriptor, bounds.header)) {
        hs_fail(err, HS_ERR_INPUT, "%s: cannot be read: a link leads out of the header's folder", context);
    } else if (bounds.folder && !sys_is_below(descriptor, bounds.folder)) {
        hs_fail(err, HS_ERR_INPUT, "%s: cannot be read: it lies outside of the folder that was opened",
                context);
    } else {
        *bytes = (uint64_t)status.st_size;
        FILE *file = fdopen(descriptor, "rb");
        if (file) return file;
        hs_fail(err, HS_ERR_MEMORY, "%s: no memory to read the file", context);
    }
    if (descriptor >= 0) (void)close(descriptor);
    return NULL;
}

FILE *hs_input_open(const char *path, const char *context, uint64_t *bytes, hs_error *err) {
    return hs_input_open_within((hs_input_bounds){NULL, NULL}, path, context, bytes, err);
}

const char *hs_input_read_at(FILE *file, uint64_t *at, void *out, size_t bytes) {
    for (uint8_t *to = out; bytes > 0;) {
        const ptrdiff_t got = sys_read_at(fileno(file), to, bytes, *at);
        if (got <= 0) return got < 0 ? strerror(errno) : "it became shorter";
        to += got;
        *at += (uint64_t)got;
        bytes -= (size_t)got;
    }
    return NULL;
}
