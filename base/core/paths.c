/* SPDX-License-Identifier: MIT */
#include "core/paths.h"

#include "core/system.h"

#include <errno.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

/* mkdir -p: every prefix that ends before a slash, then the whole path. */
static bool make_folders(const char *path, hs_error *err) {
    char prefix[SYS_PATH];
    const size_t length = strlen(path);
    if (length == 0 || length >= sizeof prefix)
        return hs_fail(err, HS_ERR_OUTPUT, "'%s': a folder's path has 1 .. %d characters", path,
                       SYS_PATH - 1);
    for (size_t i = 1; i <= length; i++) {
        if (path[i] != '/' && path[i] != '\0') continue;
        memcpy(prefix, path, i);
        prefix[i] = '\0';
        if (!sys_make_folder(prefix))
            return hs_fail(err, HS_ERR_OUTPUT, "%s: cannot make the folder: %s", prefix, strerror(errno));
    }
    return sys_is_folder(path) || hs_fail(err, HS_ERR_OUTPUT, "%s: is no folder", path); /* "C:", or a file */
}

int hs_path_first(const char *stem, char *out, size_t bytes) {
    int file = -1;
    for (unsigned i = 0; file < 0 && i < 1000; i++) {
        const int length = snprintf(out, bytes, "%s%u", stem, i);
        errno = ENAMETOOLONG;
        if (length < 0 || (size_t)length >= bytes) break;
        file = sys_open(out, SYS_FIRST);
        if (file < 0 && errno != EEXIST) break;
    }
    return file;
}

bool hs_path_make_folder(const char *path, hs_error *err) {
    char stem[SYS_PATH], probe[SYS_PATH];
    if (!make_folders(path, err) || !hs_path_join(path, ".host_sim_", stem, sizeof stem, err)) return false;
    const int file = hs_path_first(stem, probe, sizeof probe);
    if (file < 0) return hs_fail(err, HS_ERR_OUTPUT, "%s: cannot write there: %s", path, strerror(errno));
    (void)close(file);
    (void)sys_remove(probe);
    return true;
}

bool hs_path_ends(const char *path, const char *ending) {
    const size_t n = strlen(path), m = strlen(ending);
    return n > m && path[n - m - 1] != '/' && strcmp(path + n - m, ending) == 0;
}

bool hs_path_join(const char *folder, const char *name, char *out, size_t bytes, hs_error *err) {
    const int length = snprintf(out, bytes, "%s/%s", folder, name);
    return (length >= 0 && (size_t)length < bytes) ||
           hs_fail(err, HS_ERR_OUTPUT, "%s/%s: the path is longer than %zu characters", folder, name,
                   bytes - 1);
}
