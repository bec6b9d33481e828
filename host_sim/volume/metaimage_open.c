/* SPDX-License-Identifier: MIT */
#include "volume/metaimage_open.h"

#include <errno.h>
#include <fcntl.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

FILE *hs_met_open(const char *path, const char *context, uint64_t *bytes, hs_error *err) {
    const int descriptor = open(path, O_RDONLY | O_NONBLOCK | O_CLOEXEC);
    struct stat status;
    if (descriptor < 0 || fstat(descriptor, &status) != 0) {
        hs_fail(err, HS_ERR_INPUT, "%s: cannot be read: %s", context, strerror(errno));
    } else if (!S_ISREG(status.st_mode)) {
        hs_fail(err, HS_ERR_INPUT, "%s: cannot be read: not a regular file", context);
    } else {
        *bytes = (uint64_t)status.st_size;
        FILE *file = fdopen(descriptor, "rb");
        if (file) return file;
        hs_fail(err, HS_ERR_MEMORY, "%s: no memory to read the file", context);
    }
    if (descriptor >= 0) (void)close(descriptor);
    return NULL;
}
