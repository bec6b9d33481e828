/* SPDX-License-Identifier: MIT */
/*
 * Bytes that are kept by a key from one process to the next, in files of the user's own. A part of
 * smartvis/author_programs.h. Where POSIX is not declared (smartvis/author_runtime.h) nothing is kept.
 *
 * The folder is SMARTVIS_KERNEL_CACHE, else $XDG_CACHE_HOME/smartvis/kernels, else
 * ~/.cache/smartvis/kernels; if that variable is empty, there is none. It is made for the user alone. A
 * folder or a file that belongs to somebody else, or that others may write, is not used.
 *
 * A file is a head, the whole key and the bytes: it is taken only if every part of it is as it was written.
 * It is written under another name, then renamed. The oldest go when all need more than SVA_KEPT_MIB.
 */
#ifndef SMARTVIS_AUTHOR_KEPT_H
#define SMARTVIS_AUTHOR_KEPT_H

#include "smartvis/author_runtime.h"

#if SVA_RUNTIME_POSIX
#include <dirent.h>
#include <fcntl.h>
#include <sys/resource.h>
#endif

SMARTVIS_BEGIN_C

enum { SVA_KEPT_MIB = 128, SVA_KEPT_FILE_MIB = 64, SVA_KEPT_NAME = 100 };
#define SVA_KEPT_MAGIC "smartvis kept 1" /* and its 0: 16 bytes */

typedef struct sva_kept {
    int folder;               /* open, or -1 */
    char why[SVA_CACHE_TEXT]; /* why there is none, or why nothing was written; "": nothing to say */
} sva_kept;

/* A file's first bytes. */
typedef struct sva_kept_head {
    char magic[16];
    uint64_t key_bytes, bytes, sum;
} sva_kept_head;

/* Goes on with a sum (FNV-1a); SVA_KEPT_SUM to begin with. */
#define SVA_KEPT_SUM 0xcbf29ce484222325ull
static inline uint64_t sva_kept_sum(uint64_t sum, const void *data, size_t bytes) {
    const unsigned char *from = (const unsigned char *)data;
    for (size_t i = 0; i < bytes; i++) sum = (sum ^ from[i]) * 0x100000001b3ull;
    return sum;
}

/* Where a file's bytes begin and how many they are; 0: it is not this key's, or not as it was written. */
static inline size_t sva_kept_find(const unsigned char *file, size_t size, const void *key, size_t key_bytes,
                                   size_t *bytes) {
    sva_kept_head head;
    *bytes = 0;
    if (size < sizeof head) return 0;
    memcpy(&head, file, sizeof head);
    const size_t rest = size - sizeof head, at = sizeof head + key_bytes;
    if (memcmp(head.magic, SVA_KEPT_MAGIC, sizeof head.magic) != 0 || head.key_bytes != key_bytes ||
        rest <= key_bytes || head.bytes != rest - key_bytes ||
        memcmp(file + sizeof head, key, key_bytes) != 0)
        return 0;
    if (sva_kept_sum(SVA_KEPT_SUM, file + at, size - at) != head.sum) return 0;
    *bytes = size - at;
    return at;
}

#if SVA_RUNTIME_POSIX
/* The folder's name. False: there is none, or it is too long. */
static inline int sva_kept_folder(char *out, size_t bytes) {
    const char *named = getenv("SMARTVIS_KERNEL_CACHE"), *cache = getenv("XDG_CACHE_HOME"),
               *home = getenv("HOME");
    const int length = named                      ? snprintf(out, bytes, "%s", named)
                       : cache && cache[0] == '/' ? snprintf(out, bytes, "%s/smartvis/kernels", cache)
                       : home && home[0] == '/'   ? snprintf(out, bytes, "%s/.cache/smartvis/kernels", home)
                                                  : 0;
    return length > 0 && (size_t)length < bytes;
}

/* Makes what is not there. 0, or why the first of it cannot be made. */
static inline int sva_kept_make(const char *folder) {
    char path[SVA_CACHE_PATH];
    int code = 0;
    (void)snprintf(path, sizeof path, "%s", folder);
    for (char *end = path; *end;) {
        end += strspn(end, "/");
        end += strcspn(end, "/");
        const char next = *end;
        *end = '\0';
        if (mkdir(path, S_IRWXU) != 0 && errno != EEXIST && code == 0) code = errno;
        *end = next;
    }
    return code;
}

/* Of the user, and nobody else may write to it. */
static inline int sva_kept_is_mine(const struct stat *info) {
    return info->st_uid == geteuid() && (info->st_mode & (S_IWGRP | S_IWOTH)) == 0;
}

/* Opens the folder, which is made if that is asked for; for sva_kept_close. */
static inline void sva_kept_open(sva_kept *k, int make) {
    char folder[SVA_CACHE_PATH];
    struct stat info;
    memset(&info, 0, sizeof info);
    k->folder = -1;
    k->why[0] = '\0';
    if (!sva_kept_folder(folder, sizeof folder)) return;
    const int made = make ? sva_kept_make(folder) : 0;
    k->folder = open(folder, O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    memset(&info, 0, sizeof info);
    if (k->folder < 0)
        (void)snprintf(k->why, sizeof k->why, "the folder %s cannot be opened: %s", folder,
                       strerror(made ? made : errno));
    else if (fstat(k->folder, &info) != 0 || !sva_kept_is_mine(&info))
        (void)snprintf(k->why, sizeof k->why, "the folder %s %s, expected one that only the user may write",
                       folder, info.st_uid == geteuid() ? "can be written by others" : "is another user's");
    else
        return;
    if (k->folder >= 0) (void)close(k->folder);
    k->folder = -1;
}

static inline void sva_kept_close(sva_kept *k) {
    if (k->folder >= 0) (void)close(k->folder);
    k->folder = -1;
}

static inline void sva_kept_name(char out[SVA_KEPT_NAME], const void *key, size_t key_bytes) {
    (void)snprintf(out, SVA_KEPT_NAME, "%016llx.kernels",
                   (unsigned long long)sva_kept_sum(SVA_KEPT_SUM, key, key_bytes));
}

static inline int sva_kept_is_ours(const char *name) {
    return strspn(name, "0123456789abcdef") == 16 && strncmp(name + 16, ".kernels", 8) == 0;
}

/* A whole file, to be freed; NULL: it is not to be used. */
static inline unsigned char *sva_kept_load(int file, size_t *size) {
    struct stat info;
    unsigned char *all = NULL;
    size_t got = 0;
    ssize_t now = 1;
    if (fstat(file, &info) != 0 || !S_ISREG(info.st_mode) || !sva_kept_is_mine(&info) || info.st_size <= 0 ||
        info.st_size > (off_t)SVA_KEPT_FILE_MIB << 20)
        return NULL;
    *size = (size_t)info.st_size;
    all = (unsigned char *)malloc(*size);
    while (all && got < *size && (now > 0 || (now < 0 && errno == EINTR))) {
        now = read(file, all + got, *size - got);
        if (now > 0) got += (size_t)now;
    }
    if (got == *size) return all;
    free(all);
    return NULL;
}

/* What was kept by this key: `bytes` bytes from `at` on of what is to be freed; or NULL. */
static inline unsigned char *sva_kept_read(const sva_kept *k, const void *key, size_t key_bytes, size_t *at,
                                           size_t *bytes) {
    char name[SVA_KEPT_NAME];
    size_t size = 0;
    sva_kept_name(name, key, key_bytes);
    /* Without O_NONBLOCK a pipe of that name would be waited for. */
    const int file = openat(k->folder, name, O_RDONLY | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC);
    unsigned char *all = file < 0 ? NULL : sva_kept_load(file, &size);
    *at = all ? sva_kept_find(all, size, key, key_bytes, bytes) : 0;
    if (*at > 0) (void)futimens(file, NULL); /* it is used: others are older */
    if (file >= 0) (void)close(file);
    if (*at > 0) return all;
    free(all);
    return NULL;
}

/* Removes the oldest, never `spared`, until all together have at most so many bytes. */
static inline void sva_kept_sweep(const sva_kept *k, uint64_t most, const char *spared) {
    for (int more = 1; more;) {
        char oldest[SVA_KEPT_NAME] = "";
        time_t since = 0;
        uint64_t all = 0;
        struct stat info;
        const int again = openat(k->folder, ".", O_RDONLY | O_DIRECTORY | O_CLOEXEC);
        DIR *folder = again < 0 ? NULL : fdopendir(again);
        for (const struct dirent *e; folder && (e = readdir(folder)) != NULL;) {
            const size_t length = strlen(e->d_name);
            if (!sva_kept_is_ours(e->d_name) || length >= sizeof oldest ||
                fstatat(k->folder, e->d_name, &info, AT_SYMLINK_NOFOLLOW) != 0 || !S_ISREG(info.st_mode))
                continue;
            all += (uint64_t)info.st_size + 1; /* an empty file, too */
            if (strcmp(e->d_name, spared) == 0 || (oldest[0] && info.st_mtime >= since)) continue;
            memcpy(oldest, e->d_name, length + 1);
            since = info.st_mtime;
        }
        if (folder)
            (void)closedir(folder);
        else if (again >= 0)
            (void)close(again);
        more = oldest[0] && all > most && unlinkat(k->folder, oldest, 0) == 0;
    }
}

static inline int sva_kept_put(int file, const void *data, size_t bytes) {
    const char *from = (const char *)data;
    while (bytes > 0) {
        const ssize_t now = write(file, from, bytes);
        if (now < 0 && errno != EINTR) return 0;
        if (now > 0) {
            from += now;
            bytes -= (size_t)now;
        }
    }
    return 1;
}

/* A file beyond the process's limit would end it by SIGXFSZ. */
static inline int sva_kept_fits(uint64_t bytes) {
    struct rlimit limit;
    const int fits = bytes <= (uint64_t)SVA_KEPT_FILE_MIB << 20 &&
                     (getrlimit(RLIMIT_FSIZE, &limit) != 0 || bytes <= limit.rlim_cur);
    if (!fits) errno = EFBIG;
    return fits;
}

/* Keeps bytes by this key, in the place of what was kept by it; k->why says why not. */
static inline void sva_kept_write(sva_kept *k, const void *key, size_t key_bytes, const void *data,
                                  size_t bytes) {
    char name[SVA_KEPT_NAME], part[SVA_KEPT_NAME + 60];
    sva_kept_head head;
    memset(&head, 0, sizeof head);
    memcpy(head.magic, SVA_KEPT_MAGIC, sizeof head.magic);
    head.key_bytes = key_bytes;
    head.bytes = bytes;
    head.sum = sva_kept_sum(SVA_KEPT_SUM, data, bytes);
    sva_kept_name(name, key, key_bytes);
    /* Other threads and processes may be writing the same. */
    (void)snprintf(part, sizeof part, "%s.%ld.%p", name, (long)getpid(), (void *)&head);
    const int file =
        !sva_kept_fits((uint64_t)sizeof head + key_bytes + bytes)
            ? -1
            : openat(k->folder, part, O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, S_IRUSR | S_IWUSR);
    int ok = file >= 0 && sva_kept_put(file, &head, sizeof head) && sva_kept_put(file, key, key_bytes) &&
             sva_kept_put(file, data, bytes) && renameat(k->folder, part, k->folder, name) == 0;
    if (!ok)
        (void)snprintf(k->why, sizeof k->why, "a file of %llu bytes cannot be written: %s",
                       (unsigned long long)bytes, strerror(errno));
    if (!ok && file >= 0) (void)unlinkat(k->folder, part, 0);
    if (file >= 0) (void)close(file);
    if (ok) sva_kept_sweep(k, (uint64_t)SVA_KEPT_MIB << 20, name);
}

/* Removes all that is kept. */
static inline void sva_kept_empty(void) {
    sva_kept k;
    sva_kept_open(&k, 0);
    if (k.folder >= 0) sva_kept_sweep(&k, 0, "");
    sva_kept_close(&k);
}
#else
static inline void sva_kept_empty(void) {}
#endif

SMARTVIS_END_C

#endif
