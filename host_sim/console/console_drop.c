/* SPDX-License-Identifier: MIT */
/* Volumes that are dropped on a page: copies in a private folder, which goes with the console. */
#include "console/console.h"

#include "core/text.h"

#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <sys/stat.h>
#include <unistd.h>

enum { PART = 1 << 18, NAME = 200, SAME_NAME = 100 };

void hs_console_drop_open(hs_console_files *files) {
    char token[HS_CONSOLE_TOKEN], real[PATH_MAX], folder[PATH_MAX + 64];
    hs_error ignored = {0};
    const char *const where = getenv("TMPDIR");
    if (!hs_console_make_token(token, &ignored) || !realpath(where && where[0] ? where : "/tmp", real))
        return;
    (void)snprintf(folder, sizeof folder, "%s/host_sim_console_%s", real, token);
    files->folder[files->count] = strdup(folder);
    files->drops = files->folder[files->count] != NULL;
    files->count += files->drops;
}

void hs_console_drop_close(const hs_console_files *files) {
    if (!files->drops) return;
    const char *const folder = files->folder[files->count - 1];
    DIR *all = opendir(folder);
    for (const struct dirent *one; all && (one = readdir(all)) != NULL;)
        (void)unlinkat(dirfd(all), one->d_name, 0); /* "." and ".." stay */
    if (all) (void)closedir(all);
    (void)rmdir(folder);
}

/* A new file by the name of the dropped one, as far as that may be a file's; -1: there is none. */
static int make_file(const char *folder, const char *given, char name[HS_CONSOLE_PATH], char path[PATH_MAX]) {
    int made = -1;
    for (int n = 1; made < 0 && n < SAME_NAME; n++) {
        const int front = n > 1 ? snprintf(name, HS_CONSOLE_PATH, "%d_", n) : 0;
        (void)snprintf(name + front, HS_CONSOLE_PATH - (size_t)front, "%s", given);
        for (char *c = name; *c; c++)
            if (*c == '/' || (unsigned char)*c < 0x20 || *c == 0x7f || (c == name && *c == '.')) *c = '_';
        (void)snprintf(path, PATH_MAX, "%s/%s", folder, name);
        made = open(path, O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0600);
        if (made < 0 && errno != EEXIST) return -1;
    }
    return made;
}

/* All that comes, into the file. */
static bool copy(FILE *file, const char *name, uint64_t bytes, hs_console_receive receive, void *connection,
                 hs_error *err) {
    char *part = malloc(PART);
    bool ok = part || hs_fail(err, HS_ERR_MEMORY, "%s: no memory", name);
    while (ok && bytes > 0) {
        const int came = receive(connection, part, bytes < PART ? (size_t)bytes : PART);
        if (came <= 0) ok = hs_fail(err, HS_ERR_INPUT, "%s: did not come whole.", name);
        if (ok && fwrite(part, 1, (size_t)came, file) != (size_t)came)
            ok = hs_fail(err, HS_ERR_OUTPUT, "%s: no copy can be written: %s.", name, strerror(errno));
        bytes -= ok ? (uint64_t)came : 0;
    }
    free(part);
    return ok;
}

bool hs_console_drop_take(const hs_console_files *files, const char *given, uint64_t bytes,
                          hs_console_receive receive, void *connection, char name[HS_CONSOLE_PATH],
                          hs_error *err) {
    char path[PATH_MAX];
    const size_t length = strlen(given);
    const char *const ending = length > 4 ? given + length - 4 : "";
    if (length > NAME || (strcasecmp(ending, ".mha") != 0 && strcasecmp(ending, ".vol") != 0))
        return hs_fail(err, HS_ERR_INPUT, "%.60s: only .mha and .vol can be dropped.", given);
    if (!files->drops) return hs_fail(err, HS_ERR_OUTPUT, "%s: the console has no folder for it.", given);
    (void)mkdir(files->folder[files->count - 1], 0700); /* nobody else knows its name */
    const int made = make_file(files->folder[files->count - 1], given, name, path);
    FILE *file = made >= 0 ? fdopen(made, "wb") : NULL;
    if (!file) return hs_fail(err, HS_ERR_OUTPUT, "%s: no copy can be made: %s.", given, strerror(errno));
    bool ok = copy(file, given, bytes, receive, connection, err);
    if (fclose(file) != 0 && ok)
        ok = hs_fail(err, HS_ERR_OUTPUT, "%s: no copy can be written: %s.", given, strerror(errno));
    if (!ok) (void)unlink(path);
    return ok;
}
