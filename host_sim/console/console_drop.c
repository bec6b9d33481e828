/* SPDX-License-Identifier: MIT */
/* Volumes that are dropped on a page: copies in a private folder, which goes with the console. */
#include "console/console.h"

#include "core/json_text.h"
#include "core/text.h"

#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <inttypes.h>
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

enum { PART = 1 << 18, NAME = 200, SAME_NAME = 100 };

#define PREFIX "host_sim_console_"

/* Removes a folder by name, and the files in it, which `fd` has open. */
static void remove_folder(int fd, int parent, const char *name) {
    const int again = dup(fd);
    DIR *all = again >= 0 ? fdopendir(again) : NULL;
    if (all) rewinddir(all);
    for (const struct dirent *one; all && (one = readdir(all)) != NULL;)
        (void)unlinkat(fd, one->d_name, 0); /* "." and ".." stay */
    if (all)
        (void)closedir(all);
    else if (again >= 0)
        (void)close(again);
    (void)unlinkat(parent, name, AT_REMOVEDIR);
}

/* Whether a name is that of a folder of copies: the prefix and a token. */
static bool is_drop_name(const char *name) {
    const size_t front = sizeof PREFIX - 1;
    return strncmp(name, PREFIX, front) == 0 && strlen(name + front) == HS_CONSOLE_TOKEN - 1 &&
           strspn(name + front, "0123456789abcdef") == HS_CONSOLE_TOKEN - 1;
}

/* A folder of the user's own, locked; -1: it is none, or somebody holds it. The lock goes with its process,
 * however that ends. */
static int lock_folder(int parent, const char *name) {
    struct stat what;
    const int fd = openat(parent, name, O_RDONLY | O_DIRECTORY | O_NOFOLLOW | O_CLOEXEC);
    if (fd >= 0 && fstat(fd, &what) == 0 && what.st_uid == geteuid() && flock(fd, LOCK_EX | LOCK_NB) == 0)
        return fd;
    if (fd >= 0) (void)close(fd);
    return -1;
}

static void sweep(const char *where) {
    DIR *all = opendir(where);
    for (const struct dirent *one; all && (one = readdir(all)) != NULL;) {
        const int fd = is_drop_name(one->d_name) ? lock_folder(dirfd(all), one->d_name) : -1;
        if (fd < 0) continue;
        remove_folder(fd, dirfd(all), one->d_name);
        (void)close(fd);
    }
    if (all) (void)closedir(all);
}

/* Makes the folder and holds it; -1: neither. Another console that starts may sweep it before it is locked.
 */
static int make_folder(const char *folder) {
    struct stat what;
    for (int n = 0; n < 3; n++) {
        (void)mkdir(folder, 0700); /* nobody else knows its name */
        const int fd = lock_folder(AT_FDCWD, folder);
        if (fd >= 0 && stat(folder, &what) == 0) return fd;
        if (fd >= 0) (void)close(fd);
    }
    return -1;
}

void hs_console_drop_open(hs_console_files *files) {
    char token[HS_CONSOLE_TOKEN], real[PATH_MAX], folder[PATH_MAX + 64];
    hs_error ignored = {0};
    const char *const where = getenv("TMPDIR");
    if (!hs_console_make_token(token, &ignored) || !realpath(where && where[0] ? where : "/tmp", real))
        return;
    sweep(real);
    (void)snprintf(folder, sizeof folder, "%s/" PREFIX "%s", real, token);
    files->folder[files->count] = strdup(folder);
    files->drop_fd = files->folder[files->count] ? make_folder(folder) : -1;
    files->drops = files->drop_fd >= 0;
    if (files->drops)
        files->count++;
    else
        free(files->folder[files->count]);
}

void hs_console_drop_close(hs_console_files *files) {
    if (!files->drops) return;
    remove_folder(files->drop_fd, AT_FDCWD, files->folder[files->count - 1]);
    (void)close(files->drop_fd);
    files->drops = false;
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

uint64_t hs_console_drop_room(const hs_console_files *files) {
    uint64_t taken = 0;
    struct stat what;
    DIR *all = files->drops ? opendir(files->folder[files->count - 1]) : NULL;
    for (const struct dirent *one; all && (one = readdir(all)) != NULL;)
        if (fstatat(dirfd(all), one->d_name, &what, AT_SYMLINK_NOFOLLOW) == 0 && S_ISREG(what.st_mode))
            taken += (uint64_t)what.st_size;
    if (all) (void)closedir(all);
    return taken < HS_CONSOLE_DROP_BYTES ? HS_CONSOLE_DROP_BYTES - taken : 0;
}

/* A new file of the folder, with all that comes. */
static bool take(const hs_console_files *files, const char *given, uint64_t bytes, hs_console_receive receive,
                 void *connection, char name[HS_CONSOLE_PATH], char path[PATH_MAX], hs_error *err) {
    if (!files->drops) return hs_fail(err, HS_ERR_OUTPUT, "%s: the console has no folder for it.", given);
    const int made = make_file(files->folder[files->count - 1], given, name, path);
    FILE *file = made >= 0 ? fdopen(made, "wb") : NULL;
    if (!file) return hs_fail(err, HS_ERR_OUTPUT, "%s: no copy can be made: %s.", given, strerror(errno));
    bool ok = copy(file, given, bytes, receive, connection, err);
    if (fclose(file) != 0 && ok)
        ok = hs_fail(err, HS_ERR_OUTPUT, "%s: no copy can be written: %s.", given, strerror(errno));
    if (!ok) (void)unlink(path);
    return ok;
}

/* What the console itself reads. */
static bool is_own(const char *name) {
    const size_t length = strlen(name);
    const char *const ending = length > 4 ? name + length - 4 : "";
    return strcasecmp(ending, ".mha") == 0 || strcasecmp(ending, ".vol") == 0;
}

/* A copy, as a page is told of it. */
static char *told_of(const char *name) {
    json_t *root = json_pack("{s:[o], s:s}", "paths", hs_json_text(name), "told", "");
    char *text = root ? json_dumps(root, JSON_COMPACT) : NULL;
    json_decref(root);
    return text;
}

bool hs_console_take_volume(const hs_console_files *files, const char *given, uint64_t bytes,
                            hs_console_receive receive, void *connection, char **made, hs_error *err) {
    char name[HS_CONSOLE_PATH], path[PATH_MAX], room[32];
    if (given[0] == '\0' || strlen(given) > NAME)
        return hs_fail(err, HS_ERR_INPUT, "%.60s: a file has a name, of %d bytes at most.", given, NAME);
    if (!is_own(given) && !files->reader)
        return hs_fail(err, HS_ERR_INPUT, "%.60s: only .mha and .vol can be dropped.", given);
    if (!take(files, given, bytes, receive, connection, name, path, err)) return false;
    if (is_own(given)) {
        *made = told_of(name);
        return *made || hs_fail(err, HS_ERR_MEMORY, "%s: no memory", given);
    }
    (void)snprintf(room, sizeof room, "%" PRIu64, hs_console_drop_room(files));
    const bool ok = hs_console_ask(files->reader, "read", path, room, made, err);
    if (!ok) (void)unlink(path);
    return ok;
}

bool hs_console_take_picture(const hs_console_files *files, const char *given, uint64_t bytes,
                             hs_console_receive receive, void *connection, char **made, hs_error *err) {
    char name[HS_CONSOLE_PATH], path[PATH_MAX];
    if (!files->reader)
        return hs_fail(err, HS_ERR_INPUT,
                       "DICOM: \"smartvis console\" makes it, as \"smartvis dicom\" does.");
    if (!take(files, "picture.png", bytes, receive, connection, name, path, err)) return false;
    const bool ok = hs_console_ask(files->reader, "dicom", path, given, made, err);
    (void)unlink(path);
    return ok;
}
