/* SPDX-License-Identifier: MIT */
#include "base/system.h"

#include <dlfcn.h>
#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

const char sys_library_ending[] = ".so", sys_list_separator[] = ":";

int sys_open(const char *path, sys_way way) {
    static const int flags[] = {
        [SYS_READ] = O_RDONLY, [SYS_NEW] = O_RDWR | O_CREAT | O_TRUNC, [SYS_MORE] = O_RDWR};
    struct stat found;
    const int file = open(path, flags[way] | O_CLOEXEC | O_NONBLOCK, 0600);
    if (file < 0 || (fstat(file, &found) == 0 && S_ISREG(found.st_mode))) return file;
    (void)close(file);
    errno = EINVAL;
    return -1;
}

bool sys_is_file(const char *path) {
    struct stat found;
    return stat(path, &found) == 0 && S_ISREG(found.st_mode);
}

bool sys_same_file(const char *a, const char *b) {
    struct stat one, other;
    return stat(a, &one) == 0 && stat(b, &other) == 0 && one.st_dev == other.st_dev &&
           one.st_ino == other.st_ino;
}

bool sys_replace(const char *from, const char *to) {
    return rename(from, to) == 0;
}

bool sys_is_absolute(const char *path) {
    return path[0] == '/';
}

char *sys_full_path(const char *path) {
    return realpath(path, NULL);
}

bool sys_program(char *path, size_t bytes) {
    const ssize_t length = readlink("/proc/self/exe", path, bytes - 1);
    path[length > 0 ? length : 0] = '\0';
    return length > 0;
}

char **sys_arguments(int *count, char **argv) { /* NOLINT(readability-non-const-parameter) */
    (void)count;
    return argv;
}

void sys_own_folder(const void *inside, char *folder, size_t bytes) {
    Dl_info own;
    folder[0] = '\0';
    const char *slash = dladdr(inside, &own) && own.dli_fname ? strrchr(own.dli_fname, '/') : NULL;
    if (slash) (void)snprintf(folder, bytes, "%.*s", (int)(slash - own.dli_fname + 1), own.dli_fname);
}

void sys_close_when_unloaded(void *library) {
    if (library) (void)dlclose(library);
}
