/* SPDX-License-Identifier: MIT */
#include "base/input_file.h"

#include "base/system.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

/* The kernel's name of what was opened is compared, so nobody can change a link in between. */
static bool is_below(int descriptor, const char *header) {
    char link[64], file[4096];
    (void)snprintf(link, sizeof link, "/proc/self/fd/%d", descriptor);
    const ssize_t bytes = readlink(link, file, sizeof file - 1);
    const char *slash = strrchr(header, '/');
    char *named = slash ? strndup(header, (size_t)(slash - header) + 1) : strdup(".");
    char *folder = named ? realpath(named, NULL) : NULL;
    const size_t length = folder && folder[1] != '\0' ? strlen(folder) : 0; /* "/" holds everything */
    file[bytes > 0 ? bytes : 0] = '\0';
    const bool below = folder && strncmp(file, folder, length) == 0 && file[length] == '/';
    free(folder);
    free(named);
    return below;
}

FILE *hs_input_open_below(const char *header, const char *path, const char *context, uint64_t *bytes,
                          hs_error *err) {
    const int descriptor = sys_open(path, SYS_READ);
    struct stat status;
    if (descriptor < 0 || fstat(descriptor, &status) != 0) {
        const char *why = errno == EINVAL ? "not a regular file" : strerror(errno);
        hs_fail(err, HS_ERR_INPUT, "%s: cannot be read: %s", context, why);
    } else if (header && !is_below(descriptor, header)) {
        hs_fail(err, HS_ERR_INPUT, "%s: cannot be read: a link leads out of the header's folder", context);
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
    return hs_input_open_below(NULL, path, context, bytes, err);
}

const char *hs_input_read_at(FILE *file, uint64_t *at, void *out, size_t bytes) {
    for (uint8_t *to = out; bytes > 0;) {
        const ssize_t got = pread(fileno(file), to, bytes, (off_t)*at);
        if (got < 0 && errno == EINTR) continue;
        if (got <= 0) return got < 0 ? strerror(errno) : "it became shorter";
        to += got;
        *at += (uint64_t)got;
        bytes -= (size_t)got;
    }
    return NULL;
}
