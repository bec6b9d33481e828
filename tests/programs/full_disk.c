/* SPDX-License-Identifier: MIT */
/* For LD_PRELOAD: every disk has one MiB left. */
#include <sys/statvfs.h>

int statvfs(const char *path, struct statvfs *out) {
    *out = (struct statvfs){.f_bsize = 4096, .f_frsize = 4096, .f_blocks = 100000, .f_bavail = 256};
    return 0;
}
