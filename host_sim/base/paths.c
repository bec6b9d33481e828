/* SPDX-License-Identifier: MIT */
#include "base/paths.h"

#include <errno.h>
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

/* mkdir -p: every prefix that ends before a slash, then the whole path. */
static bool make_folders(const char *path, hs_error *err) {
    char prefix[PATH_MAX];
    const size_t length = strlen(path);
    if (length == 0 || length >= sizeof prefix)
        return hs_fail(err, HS_ERR_OUTPUT, "'%s': a folder's path has 1 .. %d characters", path,
                       PATH_MAX - 1);
    for (size_t i = 1; i <= length; i++) {
        if (path[i] != '/' && path[i] != '\0') continue;
        memcpy(prefix, path, i);
        prefix[i] = '\0';
        if (mkdir(prefix, 0777) != 0 && errno != EEXIST)
            return hs_fail(err, HS_ERR_OUTPUT, "%s: cannot make the folder: %s", prefix, strerror(errno));
    }
    return true;
}

bool hs_path_make_folder(const char *path, hs_error *err) {
    char probe[PATH_MAX];
    if (!make_folders(path, err) || !hs_path_join(path, ".host_sim_XXXXXX", probe, sizeof probe, err))
        return false;
    const int file = mkstemp(probe);
    if (file < 0) return hs_fail(err, HS_ERR_OUTPUT, "%s: cannot write there: %s", path, strerror(errno));
    close(file);
    unlink(probe);
    return true;
}

bool hs_path_join(const char *folder, const char *name, char *out, size_t bytes, hs_error *err) {
    const int length = snprintf(out, bytes, "%s/%s", folder, name);
    return (length >= 0 && (size_t)length < bytes) ||
           hs_fail(err, HS_ERR_OUTPUT, "%s/%s: the path is longer than %zu characters", folder, name,
                   bytes - 1);
}

int hs_path_temporary(const char *stem, const char *ending, char *out, size_t bytes, hs_error *err) {
    const char *const folder = getenv("TMPDIR");
    char name[NAME_MAX];
    (void)snprintf(name, sizeof name, "%s_XXXXXX%s", stem, ending);
    if (!hs_path_join(folder ? folder : "/tmp", name, out, bytes, err)) return -1;
    const int file = mkstemps(out, (int)strlen(ending));
    if (file < 0) (void)hs_fail(err, HS_ERR_OUTPUT, "%s: cannot be made: %s", out, strerror(errno));
    return file;
}
